"""The import closure that identities are made of, on a copy of our sources that a test may edit."""

from __future__ import annotations

import shutil
import subprocess
import sys
from fnmatch import fnmatchcase
from pathlib import Path

import pytest

from studies.campaigns import plan
from studies.campaigns.cell import Cell
from studies.campaigns.plan import SOLVERS, identity
from studies.experiments.tables import TABLES
from studies.store.source_hash import CATALOGUE, FRICTION, PACKAGES, ROOT, closure, sources_hash

TYRE = (*SOLVERS, "studies.scenes.tyre.scene")


@pytest.fixture
def copied(tmp_path: Path) -> Path:
    for package in PACKAGES:
        shutil.copytree(ROOT / package, tmp_path / package, ignore=shutil.ignore_patterns("__pycache__"))
    return tmp_path


@pytest.mark.parametrize(
    ("file", "matters"),
    [
        ("formulations/element/mixed.py", True),
        ("formulations/strains/__init__.py", True),
        ("contact/newton/step.py", True),
        ("contact/algorithms/lcp.py", True),
        ("studies/solving.py", True),
        ("studies/scenes/tyre/scene.py", True),
        ("studies/scenes/tyre/press.py", True),
        ("studies/scenes/element.py", True),
        ("studies/scenes/benchmarks/hemisphere.py", False),
        ("studies/scenes/__init__.py", False),
        ("studies/campaigns/run.py", False),
        ("studies/campaigns/report_cells.py", False),
        ("studies/experiments/epsilon.py", False),
        ("studies/cli.py", False),
    ],
)
def test_what_solves_a_cell_decides_its_identity_and_nothing_else(copied: Path, file: str, matters: bool) -> None:
    before = sources_hash(TYRE, copied, without=CATALOGUE)
    assert before == sources_hash(TYRE, ROOT, without=CATALOGUE)  # of the sources, not of where they lie
    path = copied / file
    path.write_text(path.read_text(encoding="utf-8") + "\nEDITED = True\n", encoding="utf-8")
    second = copied.rename(copied.with_name(f"{copied.name}-edited"))  # sources are read once from a place
    assert (sources_hash(TYRE, second, without=CATALOGUE) != before) == matters


def test_a_cell_without_friction_is_made_without_its_sources(monkeypatch: pytest.MonkeyPatch) -> None:
    """With it they decide; without it nothing of theirs is called."""
    asked: list[set[str]] = []

    def seen(modules, root=ROOT, *, without=()):
        asked.append(closure(modules, root, without=without))
        return ""

    monkeypatch.setattr(plan, "sources_hash", seen)
    for mu in ("0", "0.3"):
        identity(Cell("a", "strip-contact", {"mesh": "4x1"}, {"mu": mu}))
    smooth, rubbed = asked
    assert rubbed - smooth > {"contact.friction.run", "studies.friction.stages"}
    code = "import sys; from studies.solving import resolve, solve; import studies.store.record; called = set()\n"
    code += "sys.setprofile(lambda frame, *_: called.add(frame.f_globals.get('__name__')))\n"
    code += "solve(*resolve('strip-contact', {}, '4x1')); sys.setprofile(None); print(*filter(None, called))"
    called = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout.split()
    assert "contact.newton.loop" in called
    assert not set(called) & (rubbed - smooth)
    assert not [name for name in smooth if any(fnmatchcase(name, each) for each in FRICTION)]


def test_comments_and_docstrings_decide_nothing(tmp_path: Path) -> None:
    """And everything else does, a text among the statements, too."""

    def hashed(name: str, text: str) -> str:
        path = tmp_path / name / "studies" / "a.py"
        path.parent.mkdir(parents=True)
        path.write_text(text)
        return sources_hash(["studies.a"], tmp_path / name)

    plain = hashed("plain", 'def f(x):\n    y = 2 * x\n    return "y", y\n')
    said = '"""A module."""\n\n# why\ndef f(x):\n    """Twice."""\n    y = (2 * x)  # 2\n\n    return "y", y\n'
    assert hashed("said", said) == plain
    assert hashed("text", 'def f(x):\n    y = 2 * x\n    return "z", y\n') != plain
    assert hashed("number", 'def f(x):\n    y = 3 * x\n    return "y", y\n') != plain
    assert hashed("alone", 'def f(x):\n    """Nothing else."""\n') == hashed("empty", "def f(x):\n    pass\n")


def test_a_table_depends_on_the_scenes_that_it_solves() -> None:
    modules = closure([TABLES["epsilon"].__module__])
    assert {"studies.experiments.epsilon", "studies.scenes.tyre.scene", "contact.newton.step"} <= modules
    assert not {"studies.cli", "studies.campaigns.run", "studies.experiments.locking"} & modules


def test_imports_are_followed_wherever_they_stand(tmp_path: Path) -> None:
    for name, text in {
        "__init__": "",
        "a": "def f():\n    from studies import b",
        "b": "if 0:\n    import studies.c, numpy",
        "c": "from studies.d import name",
        "d": "name = 1",
        "e": "",
    }.items():
        path = tmp_path / "studies" / f"{name}.py"
        path.parent.mkdir(exist_ok=True)
        path.write_text(text)
    assert closure(["studies.a"], tmp_path) == {"studies", *(f"studies.{name}" for name in "abcd")}
    assert closure(["studies.a"], tmp_path, without=("studies.c",)) == {"studies", "studies.a", "studies.b"}


def test_identity_follows_what_decides_the_result() -> None:
    base = Cell("a", "cantilever", {"mesh": "4x1"})
    assert identity(base) == identity(Cell("another label", "cantilever", {"mesh": "4x1"}, artefacts=False))
    others = [
        Cell("a", "cantilever", {"mesh": "8x1"}),
        Cell("a", "cantilever", {"mesh": "4x1"}, {"load_fraction": "1"}),
        Cell("a", "cantilever", {"mesh": "4x1"}, {"tolerance": "1e-8"}),
    ]
    assert len({identity(cell) for cell in (base, *others)}) == len(others) + 1
