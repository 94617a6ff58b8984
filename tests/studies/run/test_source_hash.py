"""The import closure that identities are made of, on a copy of our sources that a test may edit."""

from __future__ import annotations

import ast
import shutil
import subprocess
import sys
from fnmatch import fnmatchcase
from pathlib import Path
from pkgutil import resolve_name

import pytest

from contact.catalogue import ALGORITHMS
from studies.run import plan
from studies.run.lists import MAKERS
from studies.run.plan import SOLVERS, planned
from studies.run.source_hash import (
    BESIDE_A_CELL,
    FRICTION,
    INSIDE_A_WALL,
    OF_ARCS,
    OF_QUADS,
    PACKAGES,
    ROOT,
    closure,
    hashed,
    sources_hash,
)
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
        *("contact.algorithms.lcp", "studies.solving.solve", "studies.run.record", "studies.scenes.element"),
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


def test_a_cell_without_friction_is_made_without_its_sources(monkeypatch: pytest.MonkeyPatch) -> None:
    """With it they decide; without it nothing of theirs is called once it is loaded, but what tells there is none."""
    asked: list[set[str]] = []

    def seen(modules, root=ROOT, *, without=()):
        asked.append(closure(modules, root, without=without))
        return ""

    monkeypatch.setattr(plan, "sources_hash", seen)
    for mu in ("0", "0.3"):
        planned(Cell("a", "strip-contact", {"mesh": "4x1"}, {"mu": mu}))
    smooth, rubbed = asked
    rubs = {name for name in rubbed if any(fnmatchcase(name, each) for each in FRICTION)}
    assert rubs > {"contact.newton.friction_run", "studies.solving.friction_stages"}
    assert not smooth & rubs
    code = "import sys; from studies.solving.solve import solve; import studies.run.record\n"
    code += "from studies.scenes.complete import complete\n"
    code += "from contact.catalogue import ALGORITHMS; list(ALGORITHMS.values())\n"
    code += "from studies.scenes import SCENES; list(SCENES.values()); called = set()\n"
    code += "sys.setprofile(lambda frame, *_: called.add(frame.f_globals.get('__name__')))\n"
    code += f"for name in {tuple(ALGORITHMS)}: solve(*complete('strip-contact', {{}}, '4x1', contact=name))\n"
    code += "for scene, mesh, asked in (\n"
    code += "    ('panel', '2x2', {}), ('tyre', '6x6', {'delta_mm': '5'}), ('pagano', '2x2', {}),\n"
    code += "    ('manufactured', '2x2', {}),\n"
    code += "): solve(*complete(scene, asked, mesh))\n"
    code += "solve(*complete('pressed-panel', {'element': 'refined'}, '4x4'))\n"
    code += "sys.setprofile(None); print(*filter(None, called))"
    called = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout.split()
    assert "contact.newton.loop" in called
    assert not set(called) & rubs
    assert not [name for name in called for each in (*INSIDE_A_WALL, *OF_QUADS, *OF_ARCS) if fnmatchcase(name, each)]


@pytest.mark.parametrize(("scene", "files"), [("cantilever", 78), ("strip-contact", 81)])
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
