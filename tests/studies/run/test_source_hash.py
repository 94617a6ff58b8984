"""The import closure that identities are made of, on a copy of our sources that a test may edit."""

from __future__ import annotations

import ast
import json
import shutil
import subprocess
import sys
from fnmatch import fnmatchcase
from pathlib import Path
from pkgutil import resolve_name

import pytest

from studies.ask.scene import has_contact
from studies.run import plan
from studies.run.lists import MAKERS
from studies.run.plan import SOLVERS, planned
from studies.run.source_hash import (
    BESIDE_A_CELL,
    ONLY_WITH,
    PACKAGES,
    ROOT,
    closure,
    hashed,
    sources_hash,
)
from studies.scenes import SCENES
from studies.scenes.complete import Cell

TYRE = (*SOLVERS, "studies.scenes.tyre.scene", "contact.algorithms.lcp")


@pytest.fixture
def copied(tmp_path: Path) -> Path:
    for package in PACKAGES:
        shutil.copytree(ROOT / package, tmp_path / package, ignore=shutil.ignore_patterns("__pycache__"))
    return tmp_path


def test_what_solves_a_cell_decides_its_identity_and_nothing_else(copied: Path) -> None:
    decide = {
        *("formulations.element.mixed", "formulations.strains.quantities", "contact.newton.step"),
        *("contact.algorithms.lcp", "studies.solving.solve", "studies.scenes.element"),
        *("studies.scenes.tyre.scene", "studies.scenes.tyre.press"),
    }
    nothing = {
        *("contact.algorithms.qp", "contact.catalogue", "studies.scenes.benchmarks.hemisphere", "studies.scenes"),
        *("studies.run.running", "studies.run.lists", "studies.run.task", "studies.experiments.epsilon"),
        *("studies.cli", "studies.scenes.complete", "studies.output.provenance"),
    }
    made_of = set(hashed(TYRE, without=BESIDE_A_CELL))
    assert made_of >= decide
    assert made_of.isdisjoint(nothing)
    assert all(
        any((ROOT / name.replace(".", "/")).with_suffix(end).exists() for end in (".py", "")) for name in nothing
    )
    before = sources_hash(TYRE, copied, without=BESIDE_A_CELL)
    assert before == sources_hash(TYRE, ROOT, without=BESIDE_A_CELL)  # of the sources, not of where they lie
    for file, matters in (("studies/cli.py", False), ("contact/newton/step.py", True)):
        path = copied / file
        path.write_text(path.read_text(encoding="utf-8") + "\nEDITED = True\n", encoding="utf-8")
        copied = copied.rename(copied.with_name(f"{copied.name}-edited"))  # sources are read once from a place
        assert (sources_hash(TYRE, copied, without=BESIDE_A_CELL) != before) == matters


TRACED = """
import json, sys
from dataclasses import replace
from importlib import import_module
from contact.catalogue import ALGORITHMS
from studies.run import plan
from studies.run.source_hash import BESIDE_A_CELL, closure
from studies.scenes import SCENES
from studies.scenes.complete import complete
from studies.solving.solve import solve

STRIP, PANEL, BEAM = ("strip-contact", "4x1"), ("pressed-panel", "4x4"), ("cantilever", "4x1")
ASKED = [
    *((*STRIP, {}, name) for name in ALGORITHMS),
    *((*STRIP, {"mu": "0.3"}, name) for name in ("semismooth", "qp")),
    (*PANEL, {"element": "refined"}, "semismooth"),
    *((*BEAM, asked, "semismooth") for asked in (
        {}, {"element": "quads", "distort": "0.1"}, {"element": "arc", "bending": "arc"}, {"tolerance": "1e-14"},
        {"surfaces": "3", "law": "neo-hooke"},
    )),
    *(("roof-a", "2x2", {"path": path}, "semismooth") for path in ("series", "arc-length")),
    ("tyre", "6x6", {"delta_mm": "5"}, "semismooth"),
    *((scene, "2x2", {}, "semismooth") for scene in ("panel", "pagano", "manufactured")),
    ("inflated-membrane", "4x1", {"load_fraction": "1.2,2"}, "semismooth"),
    ("hemisphere", "2x2", {"load_fraction": "0.1"}, "semismooth"),
]
cells = [complete(scene, asked, mesh, contact=contact) for scene, mesh, asked, contact in ASKED]
scene, request = cells[-1]
cut = ((0, 0, 1), (0, 1, 0), (0, 1, 1), (1, 0, 0), (1, 0, 1), (1, 1, 0), (1, 1, 1))
cells.append((scene, replace(request, leaves=cut)))
parts = [type(each).__module__ for each, _ in cells] + [each.__module__ for each in ALGORITHMS.values()]
for name in closure([*plan.SOLVERS, *parts], without=BESIDE_A_CELL):
    import_module(name)
made, called, found = [], set(), []
plan.sources_hash = lambda modules, *, without: made.append(closure(modules, without=without)) or ""

def hear(frame, event, told):
    if event == "call":
        called.add(frame.f_globals.get("__name__") or "")

for scene, request in cells:
    plan.identity(request)
    called.clear()
    sys.setprofile(hear)
    solve(scene, request)
    sys.setprofile(None)
    ours = {name for name in called if name.startswith(("formulations.", "contact.", "studies."))}
    found.append([sorted(ours), sorted(made[-1])])
print(json.dumps(found))
"""
ASIDE = {"contact.catalogue", "studies.scenes", "studies.scenes.plugins"}  # of BESIDE_A_CELL: they find parts


@pytest.fixture(scope="module")
def traced() -> list[tuple[set[str], set[str]]]:
    """Of cells of many kinds: the modules whose functions are called in a solve, and those that decide the identity."""
    found = subprocess.run([sys.executable, "-c", TRACED], capture_output=True, text=True, check=True).stdout
    return [(set(called), set(made)) for called, made in json.loads(found)]


@pytest.mark.slow
def test_nothing_is_called_in_a_cell_that_does_not_decide_its_identity(traced: list[tuple[set[str], set[str]]]) -> None:
    for called, made in traced:
        assert {"studies.solving.solve", "contact.verify"} <= called
        assert called - made <= ASIDE
    assert any("contact.continuation.critical_points" in called for called, _ in traced)  # at the end of a path


@pytest.mark.slow
@pytest.mark.parametrize("what", ONLY_WITH)
def test_what_is_left_out_without_something_is_called_with_it(
    what: str, traced: list[tuple[set[str], set[str]]]
) -> None:
    """And some cells are made without it: each reason is one."""

    def alike(names: set[str]) -> set[str]:
        return {name for name in names if any(fnmatchcase(name, each) for each in ONLY_WITH[what])}

    assert any(alike(called) for called, _ in traced)
    assert any(not alike(made) for _, made in traced)


def test_a_scene_that_takes_no_contact_condition_makes_no_candidates() -> None:
    """By what its module imports: obstacles, or faces."""
    none = [name for name in SCENES if not has_contact(SCENES[name])]
    assert {"cantilever", "hemisphere", "roof-a"} <= set(none)
    for name in none:
        modules = closure([type(SCENES[name]).__module__], without=BESIDE_A_CELL)
        assert not [each for each in modules if each.startswith(("contact.obstacles.", "contact.faces."))], name


def test_a_part_from_outside_leaves_nothing_out(monkeypatch: pytest.MonkeyPatch) -> None:
    """It may have candidates, quadrilaterals or friction of its own."""
    asked: list[tuple[str, ...]] = []
    monkeypatch.setattr(plan, "sources_hash", lambda modules, *, without: asked.append(without) or "")
    monkeypatch.setattr(plan, "modules_of", lambda *names: ("stranger",))
    planned(Cell("a", "cantilever", {"mesh": "4x1"}))
    assert asked == [BESIDE_A_CELL]


@pytest.mark.parametrize(("scene", "files"), [("cantilever", 59), ("strip-contact", 73)])
def test_a_cell_is_made_of_few_files(scene: str, files: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """Every one that is hashed makes all cells anew when it is edited."""
    asked: list[dict[str, str]] = []

    def seen(modules, *, without):
        asked.append(hashed(modules, without=without))
        return ""

    monkeypatch.setattr(plan, "sources_hash", seen)
    planned(Cell("a", scene, {"mesh": "4x1"}))
    assert len(asked[0]) <= files


def test_what_is_imported_for_annotations_decides_nothing(tmp_path: Path) -> None:
    """Nor do packages that state nothing; without the future import annotations are evaluated."""
    future = "from __future__ import annotations\n"
    for name, text in {
        "__init__": '"""Nothing but words."""\n' + future,
        "a": future + "from studies.b import B, make\nfrom studies.c import C\nfrom studies.d import D\n"
        "def f(b: B, c: C | None) -> D:\n    return D(make(b))\n",
        "b": "B, make = 1, 2",
        "c": "C = 1",
        "d": "from studies.e import E\ndef D(e: E): pass",
        "e": "E = 1",
    }.items():
        path = tmp_path / "studies" / f"{name}.py"
        path.parent.mkdir(exist_ok=True)
        path.write_text(text)
    assert list(hashed(["studies.a"], tmp_path)) == [f"studies.{name}" for name in "abde"]


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


def test_data_that_a_module_names_beside_it_decide(tmp_path: Path) -> None:
    def hashed(name: str, data: str) -> str:
        path = tmp_path / name / "studies" / "a.py"
        path.parent.mkdir(parents=True)
        path.write_text('from pathlib import Path\ntext = Path(__file__).with_name("a.txt").read_text()\n')
        path.with_name("a.txt").write_text(data)
        path.with_name("b.txt").write_text(name)
        return sources_hash(["studies.a"], tmp_path / name)

    assert hashed("one", "1") == hashed("same", "1") != hashed("other", "2")


@pytest.mark.parametrize("named", ["NAME", '"missing.csv"', '"folder"', 'f"{NAME}.csv"', '"folder/a.csv"', "1"])
def test_what_is_no_file_beside_a_module_stops_no_hash(named: str, tmp_path: Path) -> None:
    path = tmp_path / "studies" / "a.py"
    (path.parent / "folder").mkdir(parents=True)
    path.write_text(f"from pathlib import Path\nNAME = 'x'\nplace = Path(__file__).with_name({named})\n")
    assert sources_hash(["studies.a"], tmp_path)


def test_our_modules_spell_out_the_data_beside_them() -> None:
    for package in PACKAGES:
        for path in (ROOT / package).rglob("*.py"):
            text = path.read_text(encoding="utf-8")
            for call in ast.walk(ast.parse(text)) if "with_name" in text else ():
                if isinstance(call, ast.Call) and ast.unparse(call.func) == "Path(__file__).with_name":
                    assert path.with_name(ast.literal_eval(call.args[0])).is_file(), path


def test_a_table_depends_on_the_scenes_that_it_solves() -> None:
    modules = closure([resolve_name(MAKERS["epsilon"]).__module__])
    assert {"studies.experiments.epsilon", "studies.scenes.tyre.scene", "contact.newton.step"} <= modules
    assert not {"studies.cli", "studies.run.running", "studies.experiments.locking"} & modules


def test_imports_are_followed_wherever_they_stand(tmp_path: Path) -> None:
    for name, text in {
        "__init__": "",
        "a": "def f():\n    from studies import b",
        "b": "if 0:\n    import studies.c, numpy",
        "c": "from studies.d import name",
        "d": "name = {'of a catalogue': 'studies.e'}",
        "e": "",
        "f": "",
    }.items():
        path = tmp_path / "studies" / f"{name}.py"
        path.parent.mkdir(exist_ok=True)
        path.write_text(text)
    assert closure(["studies.a"], tmp_path) == {"studies", *(f"studies.{name}" for name in "abcde")}
    assert closure(["studies.a"], tmp_path, without=("studies.c",)) == {"studies", "studies.a", "studies.b"}


def test_identity_follows_what_decides_the_result() -> None:
    base = Cell("a", "cantilever", {"mesh": "4x1"})
    assert planned(base).id == planned(Cell("another label", "cantilever", {"mesh": "4x1"}, artefacts=False)).id
    others = [
        Cell("a", "cantilever", {"mesh": "8x1"}),
        Cell("a", "cantilever", {"mesh": "4x1"}, {"load_fraction": "1"}),
        Cell("a", "cantilever", {"mesh": "4x1"}, {"tolerance": "1e-8"}),
    ]
    assert len({planned(cell).id for cell in (base, *others)}) == len(others) + 1
