"""The arrows of the design: studies -> formulations, contact; those two know nothing of ours; reports reads tables."""

from __future__ import annotations

import ast
import json
import os
import shutil
import subprocess
import sys
import tomllib
from collections.abc import Iterator
from graphlib import CycleError, TopologicalSorter
from pathlib import Path
from typing import Any

import pytest

from studies.cli import main
from support.sources import DYNAMIC, nodes_of

ROOT = Path(__file__).parents[1]
ALLOWED = {
    "formulations": {"formulations"},
    "contact": {"contact"},
    "reports": {"reports"},
    "studies": {"studies", "formulations", "contact"},
}
MORE = {
    "studies/commands/campaigns.py": {"reports"},  # the command line hands the tables over
    "studies/commands/comparison.py": {"reports"},  # and how words stand in Markdown, or on a page
    "studies/commands/bench_solvers.py": {"reports"},
    "studies/commands/parts.py": {"reports"},
    "studies/commands/solve.py": {"reports"},
    "studies/commands/sweep.py": {"reports"},
    "studies/answers.py": {"reports"},  # as does an answer in a notebook
    "studies/cli.py": {"?"},  # the module of the command that is asked for
    "studies/analysis/everything.py": {"?"},  # those of the tables that are there
    "studies/commands/worker.py": {"?"},  # that of the table that is asked for
    "contact/catalogue.py": {"?"},  # that of the algorithm, or of the scene, that is asked for
    "studies/scenes/plugins.py": {"?"},  # modules of a user's own
    "studies/arena/solvers/base.py": {"?"},  # a solver that may not be installed
}
OURS = {*ALLOWED, "tests"}
OTHER_NAMES = {"PIL": "pillow", "markdown_it": "markdown-it-py", "skfem": "scikit-fem"}  # of what is imported
FILES = sorted(str(path.relative_to(ROOT)) for package in ALLOWED for path in (ROOT / package).rglob("*.py"))


def called(function: ast.expr) -> str:
    """The name of what is called, the last one of a.b.c."""
    return str(getattr(function, "attr", getattr(function, "id", "")))


def imported(source: str) -> Iterator[str]:
    """Top-level names of all imports, wherever in the file; '.' stands for a relative import."""
    for node in nodes_of(source):
        if isinstance(node, ast.Import):
            yield from (alias.name.split(".")[0] for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            yield "." if node.level else str(node.module).split(".")[0]
        elif isinstance(node, ast.Call) and called(node.func) in DYNAMIC:
            name = node.args[0] if node.args else None
            yield name.value.split(".")[0] if isinstance(name, ast.Constant) else "?"


def offences(file: str, source: str) -> set[str]:
    """What the file imports of ours but may not, relative imports, and dynamic ones nobody can follow."""
    allowed = ALLOWED[file.split("/")[0]] | MORE.get(file, set())
    return {name for name in imported(source) if name in {*OURS, ".", "?"} - allowed}


def test_arrows() -> None:
    by_name = {file: offences(file, (ROOT / file).read_text(encoding="utf-8")) for file in FILES}
    assert {file: names for file, names in by_name.items() if names} == {}


def test_dependencies_and_extras_are_complete() -> None:
    """Whatever is imported comes with the suite or with an extra, and no dependency is without an import."""
    names = set[str]()
    for node in (node for file in FILES for node in nodes_of((ROOT / file).read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            names |= {alias.name.partition(".")[0] for alias in node.names}
        elif isinstance(node, ast.ImportFrom):
            names.add(str(node.module).partition(".")[0])
    names -= {*ALLOWED, *sys.stdlib_module_names, "pytest"}  # that of the template of an entry
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    declared = {text.split(">=")[0] for text in project["dependencies"]}
    extras = {text.split(">=")[0] for texts in project["optional-dependencies"].values() for text in texts}
    wanted = {OTHER_NAMES.get(name, name) for name in names}
    assert wanted - declared - extras == set()
    assert declared - wanted == set()


def test_the_packages_are_there() -> None:
    """The walk above has found what it is meant to guard."""
    packages = {file.split("/")[0] for file in FILES}
    assert packages >= {"formulations", "contact", "studies"}
    assert MORE.keys() <= set(FILES)


@pytest.mark.parametrize(
    ("file", "source", "found"),
    [
        ("formulations/shell.py", "from contact.problem import Outcome", {"contact"}),
        ("formulations/shell.py", "def f():\n    import studies.ask.scene as s", {"studies"}),
        ("contact/newton/step.py", "import numpy, formulations.geometry.grid", {"formulations"}),
        (
            "contact/newton/step.py",
            "if 0:\n    from importlib import import_module\n    import_module('reports')",
            {"reports"},
        ),
        ("contact/newton/step.py", "__import__(name)", {"?"}),
        ("contact/newton/step.py", "from . import problem", {"."}),
        ("reports/site.py", "from studies import store", {"studies"}),
        ("studies/solving/solve.py", "import reports", {"reports"}),
        ("studies/cli.py", "import reports", {"reports"}),
        ("studies/commands/campaigns.py", "import reports", set()),
        ("studies/solving/solve.py", "from contact import judge\nimport formulations\nimport numpy", set()),
        ("studies/solving/solve.py", "import tests.conftest", {"tests"}),
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
        nodes = nodes_of(source)
        ifs = [each for each in nodes if isinstance(each, ast.If)] if "TYPE_CHECKING" in source else []
        guarded = [each for each in ifs if "TYPE_CHECKING" in ast.unparse(each.test)]
        typing = {id(node) for each in guarded for node in ast.walk(each)}
        wanted: set[str] = set()
        for node in nodes:
            if id(node) in typing:
                continue
            if isinstance(node, ast.Import):
                wanted |= {alias.name for alias in node.names}
            elif isinstance(node, ast.ImportFrom):
                whole = {f"{node.module}.{alias.name}" for alias in node.names} & modules.keys()
                wanted |= whole or {str(node.module)}
        graph[name] = (wanted & modules.keys()) - {name}
    return graph


@pytest.fixture(scope="module")
def graph() -> dict[str, set[str]]:
    return graph_of({file: (ROOT / file).read_text(encoding="utf-8") for file in FILES})


def test_nothing_imports_in_circles(graph: dict[str, set[str]]) -> None:
    assert sum(map(len, graph.values())) > 500  # the walk sees the imports
    TopologicalSorter(graph).prepare()


def test_a_circle_is_seen_even_a_lazy_one() -> None:
    lazy = {"studies/a.py": "def f():\n    from studies import b", "studies/b.py": "import studies.a"}
    with pytest.raises(CycleError):
        TopologicalSorter(graph_of(lazy)).prepare()
    typed = {**lazy, "studies/b.py": "if TYPE_CHECKING:\n    import studies.a"}
    TopologicalSorter(graph_of(typed)).prepare()


ROOMS = (  # of studies, each imports those before it
    *(
        "output",
        "ask",
        "scenes",
        "solving",
        "run",
        "sweeps",
        "experiments",
        "catalogue",
        "exchange",
        "bench",
        "analysis",
        "fuzz",
    ),
    *("arena", "gate", "answers", "notebook", "commands", "cli", "footprint"),
)


def backwards(graph: dict[str, set[str]]) -> set[tuple[str, str]]:
    """Modules of studies and what they import of rooms that come after theirs."""
    place = {
        name: ROOMS.index(name.split(".")[1]) for name in graph if name.startswith("studies.")
    }  # what is there and not in ROOMS raises ValueError
    return {
        (name, other)
        for name, wanted in graph.items()
        for other in wanted
        if name in place and place.get(other, 0) > place[name]
    }


def test_rooms_of_studies_import_one_way(graph: dict[str, set[str]]) -> None:
    assert backwards(graph) == set()


def test_rooms_of_studies_stand_on_few_others(graph: dict[str, set[str]]) -> None:
    """The longest chain of rooms, each of which imports the next."""
    arrows = {(*name.split(".")[:2], *other.split(".")[:2]) for name, wanted in graph.items() for other in wanted}
    height = dict.fromkeys(ROOMS, 1)
    for room in ROOMS:
        below = [each for each in ROOMS if each != room and ("studies", room, "studies", each) in arrows]
        height[room] += max((height[each] for each in below), default=0)
    assert max(height.values()) <= 9


def test_an_import_backwards_is_seen() -> None:
    sources = {
        "studies/solving/solve.py": "def f():\n    import studies.analysis.verify",
        "studies/analysis/verify.py": "",
    }
    assert backwards(graph_of(sources)) == {("studies.solving.solve", "studies.analysis.verify")}


HEAVY = (
    *("clarabel", "cvxpy", "distributed", "matplotlib", "meshio", "osqp", "pandas", "skfem"),
    *("scipy.interpolate", "scipy.ndimage", "scipy.optimize", "scipy.spatial", "scipy.special", "scipy.stats"),
)
STARTED = {"_thread.start_new_thread", "os.fork", "os.posix_spawn", "os.system", "subprocess.Popen"}
COMMAND = f"""
import json, os, sys
from studies.cli import main
started, renamed = [], []
def hear(event, told):
    if event in {STARTED}:
        started.append([event, os.path.basename(str(told[0]))])
    elif event == "os.rename":
        renamed.append(os.path.basename(told[1]))
def loaded(names):
    return [name for name in names if name in sys.modules]
for words in ["--help"], ["--version"], ["slove"], []:
    try:
        main(words)
    except SystemExit:
        pass
light = loaded(["numpy", "scipy", "pandas"])
sys.addaudithook(hear)
code = main(["solve", "cantilever", "--mesh", "2x1", "--set", "load_fraction=0.1", "--out", sys.argv[1]])
threads = len(os.listdir("/proc/self/task")) if sys.platform == "linux" else 1
scenes = [name for name in sys.modules if name.startswith("studies.scenes.")]
contact = [name for name in sys.modules if name.startswith("contact.")]
found = dict(contact=contact, light=light, code=code, heavy=loaded({HEAVY}), started=started, renamed=renamed)
found |= dict(threads=threads, scenes=scenes)
open(sys.argv[1] + "/found", "w").write(json.dumps(found))
"""


@pytest.fixture(scope="module")
def found(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Any]:
    """What a process without settings of threads has loaded, started and written after help, and after a solve."""
    out = tmp_path_factory.mktemp("solved")
    environment = {name: value for name, value in os.environ.items() if not name.endswith("_NUM_THREADS")}
    words = [sys.executable, "-c", COMMAND, str(out)]
    subprocess.run(words, cwd=ROOT, env=environment, capture_output=True, check=True)
    return {**json.loads((out / "found").read_text()), "files": {path.name for path in out.iterdir()} - {"found"}}


def test_help_loads_nothing_that_computes(found: dict[str, Any]) -> None:
    assert found["light"] == []


def test_a_solve_does_not_wait_for_what_it_may_never_need(found: dict[str, Any]) -> None:
    """Each of these takes as long to load as a small solve takes."""
    assert found["code"] == 0
    assert found["heavy"] == []


def test_a_solve_loads_its_own_scene_alone(found: dict[str, Any]) -> None:
    assert "studies.scenes.benchmarks.cantilever" in found["scenes"]
    others = ("studies.scenes.tyre", "studies.scenes.contact", "studies.scenes.manufactured")
    assert [name for name in found["scenes"] if name.startswith(others) or "hemisphere" in name] == []


def test_a_solve_without_contact_loads_one_algorithm_and_nothing_of_friction(found: dict[str, Any]) -> None:
    algorithms = [name for name in found["contact"] if name.startswith("contact.algorithms.")]
    assert sorted(algorithms) == ["contact.algorithms.base", "contact.algorithms.semismooth"]
    assert [name for name in found["contact"] if "friction" in name or "tresca" in name] == []


def test_a_solve_starts_nothing_but_git_once_and_only_in_a_work_tree(found: dict[str, Any]) -> None:
    in_work_tree = (ROOT / ".git").exists() and shutil.which("git") is not None
    assert found["started"] == [["subprocess.Popen", "git"]] * in_work_tree
    assert found["threads"] == 1  # those of both OpenBLAS, too


def test_a_solve_writes_each_file_once(found: dict[str, Any]) -> None:
    assert found["files"] == {"result.json", "fields.vtu", "history.csv", "nodes.csv"}
    assert sorted(found["renamed"]) == sorted(found["files"])


@pytest.mark.parametrize("name", ["OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS"])
def test_threads_that_the_user_has_asked_for_are_left_alone(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    for each in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS"):
        monkeypatch.setenv(each, "before")  # so that it is put back
        monkeypatch.delenv(each)
    monkeypatch.setenv(name, "3")
    with pytest.raises(SystemExit):
        main(["--version"])
    assert os.environ[name] == "3"
    assert os.environ.get("OPENBLAS_NUM_THREADS", "3") == "3"  # its own name counts more than that of OpenMP
