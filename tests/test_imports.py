"""The arrows of the design: studies -> formulations, contact; those two know nothing of ours; reports reads tables."""

from __future__ import annotations

import ast
import subprocess
import sys
from collections.abc import Iterator
from graphlib import CycleError, TopologicalSorter
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
ALLOWED = {
    "formulations": {"formulations"},
    "contact": {"contact"},
    "reports": {"reports"},
    "studies": {"studies", "formulations", "contact"},
}
MORE = {
    "studies/commands/campaign/report.py": {"reports"},  # the command line hands the tables over
    "studies/commands/solve.py": {"reports"},
    "studies/door/notebook.py": {"reports"},  # and so does that of a notebook
    "studies/cli.py": {"?"},  # the module of the command that is asked for
    "studies/door/plugins.py": {"?"},  # modules of a user's own
}
OURS = {*ALLOWED, "tests"}
FILES = sorted(str(path.relative_to(ROOT)) for package in ALLOWED for path in (ROOT / package).rglob("*.py"))


def called(function: ast.expr) -> str:
    """The name of what is called, the last one of a.b.c."""
    return str(getattr(function, "attr", getattr(function, "id", "")))


def imported(source: str) -> Iterator[str]:
    """Top-level names of all imports, wherever in the file; '.' stands for a relative import."""
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.Import):
            yield from (alias.name.split(".")[0] for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            yield "." if node.level else str(node.module).split(".")[0]
        elif isinstance(node, ast.Call) and called(node.func) in ("import_module", "__import__"):
            name = node.args[0] if node.args else None
            yield name.value.split(".")[0] if isinstance(name, ast.Constant) else "?"


def offences(file: str, source: str) -> set[str]:
    """What the file imports of ours but may not, relative imports, and dynamic ones nobody can follow."""
    allowed = ALLOWED[file.split("/")[0]] | MORE.get(file, set())
    return {name for name in imported(source) if name in {*OURS, ".", "?"} - allowed}


def test_arrows() -> None:
    found = {file: offences(file, (ROOT / file).read_text(encoding="utf-8")) for file in FILES}
    assert {file: names for file, names in found.items() if names} == {}


def test_the_packages_are_there() -> None:
    """The walk above has found what it is meant to guard."""
    packages = {file.split("/")[0] for file in FILES}
    assert packages >= {"formulations", "contact", "studies"}
    assert MORE.keys() <= set(FILES)


@pytest.mark.parametrize(
    ("file", "source", "found"),
    [
        ("formulations/shell.py", "from contact.problem import Outcome", {"contact"}),
        ("formulations/shell.py", "def f():\n    import studies.scene as s", {"studies"}),
        ("contact/newton/step.py", "import numpy, formulations.geometry.grid", {"formulations"}),
        (
            "contact/newton/step.py",
            "if 0:\n    from importlib import import_module\n    import_module('reports')",
            {"reports"},
        ),
        ("contact/newton/step.py", "__import__(name)", {"?"}),
        ("contact/newton/step.py", "from . import problem", {"."}),
        ("reports/site.py", "from studies import store", {"studies"}),
        ("studies/solving.py", "import reports", {"reports"}),
        ("studies/cli.py", "import reports", {"reports"}),
        ("studies/commands/campaign/report.py", "import reports", set()),
        ("studies/solving.py", "from contact import judge\nimport formulations\nimport numpy", set()),
        ("studies/solving.py", "import tests.conftest", {"tests"}),
    ],
)
def test_offences_are_seen(file, source, found) -> None:
    assert offences(file, source) == found


def module_of(file: str) -> str:
    return file.removesuffix(".py").removesuffix("/__init__").replace("/", ".")


def graph_of(sources: dict[str, str]) -> dict[str, set[str]]:
    """Our modules that each one imports, lazily or not; what only a type checker reads does not count."""
    modules = {module_of(file): source for file, source in sources.items()}
    graph = {}
    for name, source in modules.items():
        tree = ast.parse(source)
        guarded = [
            each for each in ast.walk(tree) if isinstance(each, ast.If) and "TYPE_CHECKING" in ast.unparse(each.test)
        ]
        typing = {id(node) for each in guarded for node in ast.walk(each)}
        wanted: set[str] = set()
        for node in ast.walk(tree):
            if id(node) in typing:
                continue
            if isinstance(node, ast.Import):
                wanted |= {alias.name for alias in node.names}
            elif isinstance(node, ast.ImportFrom):
                whole = {f"{node.module}.{alias.name}" for alias in node.names} & modules.keys()
                wanted |= whole or {str(node.module)}
        graph[name] = (wanted & modules.keys()) - {name}
    return graph


def test_nothing_imports_in_circles() -> None:
    graph = graph_of({file: (ROOT / file).read_text(encoding="utf-8") for file in FILES})
    assert sum(map(len, graph.values())) > 500  # the walk sees the imports
    TopologicalSorter(graph).prepare()


def test_a_circle_is_seen_even_a_lazy_one() -> None:
    lazy = {"studies/a.py": "def f():\n    from studies import b", "studies/b.py": "import studies.a"}
    with pytest.raises(CycleError):
        TopologicalSorter(graph_of(lazy)).prepare()
    typed = {**lazy, "studies/b.py": "if TYPE_CHECKING:\n    import studies.a"}
    TopologicalSorter(graph_of(typed)).prepare()


HEAVY = ("clarabel", "cvxpy", "matplotlib", "meshio", "osqp", "rich", "scipy.interpolate", "scipy.optimize", "skfem")


def test_a_solve_does_not_wait_for_what_it_may_never_need() -> None:
    """Each of these takes as long to load as a small solve takes."""
    told = f"import sys, studies.cli, studies.commands.solve; print([m for m in {HEAVY} if m in sys.modules])"
    found = subprocess.run([sys.executable, "-c", told], cwd=ROOT, capture_output=True, text=True, check=True)
    assert found.stdout.strip() == "[]"
