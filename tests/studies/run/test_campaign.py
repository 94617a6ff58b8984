"""Campaigns as files: what the shipped ones promise, and crosses as they are written."""

from __future__ import annotations

from collections import Counter
from pathlib import Path

import pandas as pd
import pytest

from contact.algorithms.semismooth import Semismooth
from contact.catalogue import ALGORITHMS
from contact.problem import ContactProblem
from formulations.strains.catalogue import MEASURES
from studies.ask.scene import UsageError, has_contact
from studies.cli import main
from studies.run.campaign import SHIPPED, find, names
from studies.run.collect import COLUMNS, collect
from studies.run.lists import LISTS, MAKERS, add_tables
from studies.run.plan import plan, planned
from studies.run.running import run
from studies.scenes import SCENES
from studies.scenes.complete import Cell
from studies.scenes.plugins import used


def test_standard_crosses_what_was_promised() -> None:
    """Six scenes at the least, by all measures, all algorithms, four meshes and two tolerances, beside the report."""
    standard = find("standard")
    labels = {cell.label for cell in standard.cells}
    assert {cell.label for cell in LISTS["report"].cells()} <= labels
    assert set(standard.tables) == set(LISTS["report"].tables)
    swept = [cell for cell in standard.cells if cell.label.startswith("sweep ")]
    combinations = Counter((c.scene, c.options["measure"], c.options["contact"]) for c in swept)
    scenes = {scene for scene, *_ in combinations}
    assert len(scenes) >= 6
    algorithms = {scene: ALGORITHMS if has_contact(SCENES[scene]) else ["semismooth"] for scene in scenes}
    assert set(combinations) == {(s, m, c) for s in scenes for m in MEASURES for c in algorithms[s]}
    assert set(combinations.values()) == {4 * 2}
    for scene in scenes:
        own = [cell for cell in swept if cell.scene == scene]
        assert len({cell.options["mesh"] for cell in own}) == 4
        assert len({cell.settings["tolerance"] for cell in own}) == 2
    assert not any(cell.artefacts for cell in swept)


@pytest.mark.parametrize(
    "name", ["quick", *(pytest.param(name, marks=pytest.mark.slow) for name in ("standard", "full"))]
)
def test_rows_of_shipped_campaigns_are_solved_or_have_a_reason(name: str) -> None:
    rows = plan(find(name))
    assert len({row.cell.label for row in rows}) == len(rows)
    assert all((row.id is None) == bool(row.reason) for row in rows)
    assert sum(row.id is not None for row in rows) > 0.9 * len(rows)


def test_names_are_those_of_files_and_lists() -> None:
    assert {"quick", "standard", "full"} == {path.stem for path in SHIPPED.glob("*.toml")}
    assert set(names()) == {"quick", "standard", "full", *LISTS}
    assert len({find(name).title for name in names()}) == len(names())
    assert find("benchmarks").cells == tuple(LISTS["benchmarks"].cells())


def test_a_cross_is_the_product_of_its_axes_and_a_scene_says_the_last_word(tmp_path: Path) -> None:
    path = tmp_path / "c.toml"
    path.write_text(
        'lists = ["benchmarks"]\n[[cross]]\nname = "x"\nmeasures = ["exact", "linear"]\nsteps = 2\n'
        'set = { load_fraction = [0.5, 1.0] }\nvary = { solver = ["splu"] }\n'
        '[cross.scenes.cantilever]\nmeshes = ["2x1", "4x1"]\n'
        '[cross.scenes.hemisphere]\nmeasures = ["exact"]\nmeshes = ["4x4"]\nset = { load_fraction = "1" }\n'
    )
    campaign = find(str(path))
    own = campaign.cells[len(LISTS["benchmarks"].cells()) :]
    assert [cell.label for cell in own] == [
        *(f"x cantilever {m} {n}x1 solver=splu" for m in ("exact", "linear") for n in (2, 4)),
        "x hemisphere exact 4x4 solver=splu",
    ]
    assert own[0].settings == {"load_fraction": "0.5,1", "solver": "splu"}
    assert own[0].options == {"measure": "exact", "mesh": "2x1", "steps": 2}
    assert own[-1].settings["load_fraction"] == "1"
    assert own[0].command == (
        "footprint solve cantilever --measure exact --mesh 2x1 --steps 2 --set load_fraction=0.5,1 --set solver=splu"
        " --out DIR"
    )


def test_what_a_scene_sets_counts_before_an_axis_of_all(tmp_path: Path) -> None:
    path = tmp_path / "c.toml"
    path.write_text(
        '[[cross]]\ntolerances = [1e-3, 1e-6]\nvary = { nu = [0.2, 0.3] }\nset = { delta_mm = "0.2" }\n'
        "[cross.scenes.panel]\nset = { tolerance = 1e-9 }\nvary = { delta_mm = [0.1] }\n"
    )
    assert [dict(cell.settings) for cell in find(str(path)).cells] == [
        {"tolerance": "1e-09", "nu": nu, "delta_mm": "0.1"} for nu in ("0.2", "0.3")
    ]


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("", "has nothing to solve: it needs lists, or [[cross]] with scenes"),
        ("[[cross]]\n[cross.scenes]\n", "has nothing to solve"),
        ("[[cross]]\nmeasures = []\n[cross.scenes.panel]\n", "the axis measure has no value"),
        (
            "[[cross]]\n[cross.scenes.panel]\ntolerances = [1e-3]\nset = { tolerance = 1e-9 }\n",
            "tolerance of panel is both a setting and an axis: keep one of them",
        ),
        ('[[cross]]\n[cross.scenes.panel]\nset = { nu = "0.6" }\n', "no cell can be solved: nu = '0.6' must be"),
    ],
)
def test_a_campaign_that_solves_nothing_or_contradicts_itself_is_one_line(text, says, tmp_path: Path, capsys) -> None:
    (tmp_path / "c.toml").write_text(text)
    assert main(["run", str(tmp_path / "c.toml"), "--store", str(tmp_path / "store")]) == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert says in line
    assert not (tmp_path / "store").exists()


def test_a_cell_of_an_algorithm_whose_support_is_no_reason_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    class Odd(Semismooth):
        def supports(self, problem: ContactProblem) -> str | None:
            return True  # type: ignore[return-value]

    monkeypatch.setitem(ALGORITHMS, "odd", Odd)
    row = planned(Cell("a", "strip-contact", {"mesh": "4x1", "contact": "odd"}))
    assert row.id is None
    assert row.reason.endswith("supports returned True, not None or a reason")


def test_a_number_of_a_file_is_solved_with_all_its_digits(tmp_path: Path) -> None:
    """Six digits are enough for a label, and not for a modulus."""
    path = tmp_path / "c.toml"
    path.write_text(
        "[[cross]]\ntolerances = [1e-3, 1e-9]\nvary = { E_L_MPa = [510.451234] }\n"
        "[cross.scenes.tyre]\nset = { delta_mm = [1.23456789, 2.0, 1234567.5] }\n"
    )
    cells = find(str(path)).cells
    assert cells[0].label == "cross tyre tolerance=0.001 E_L_MPa=510.451234"
    assert [cell.settings["tolerance"] for cell in cells] == ["0.001", "1e-09"]
    assert cells[0].settings["delta_mm"] == "1.23456789,2,1234567.5"
    assert float(cells[0].settings["E_L_MPa"]) == 510.451234


@pytest.mark.slow
def test_the_table_has_a_row_for_everything_that_was_planned(tmp_path: Path) -> None:
    path = tmp_path / "c.toml"
    path.write_text(
        '[[cross]]\ncontacts = ["semismooth", "qp"]\ntolerances = [1e-3]\n'
        '[cross.scenes.cantilever]\nmeshes = ["2x1"]\n[cross.scenes.tyre]\nmeshes = ["12x12"]\n'
        'set = { delta_mm = "5,10" }\n'
    )
    run(find(str(path)), tmp_path / "store")
    next(iter((tmp_path / "store/cells").glob("*.json"))).unlink()
    table = collect(tmp_path / "store", "c")
    assert tuple(table.columns[: len(COLUMNS)]) == COLUMNS
    assert sorted(table["outcome"]) == ["converged", "converged", "missing"]
    tyre = table[(table["scene"] == "tyre") & (table["outcome"] == "converged")].iloc[0]
    assert (tyre["n1"], tyre["n2"], tyre["element"], tyre["section"]) == (12, 12, "refined", "constant-s33")
    assert tyre["tolerance"] == 1e-3
    assert tyre["epsilon"] == float("inf")
    assert tyre["q.delta_mm"] == 10.0
    assert tyre["q.force_N"] > 0
    assert tyre["c.operations"] > 1e5
    assert tyre["t.total"] > 0
    assert tyre["k.equilibrium"] <= 1e-3
    assert not [name for name in table.columns[len(COLUMNS) :] if name[:2] not in ("q.", "c.", "w.", "t.", "k.")]


# --- modules ------------------------------------------------------------------------------------------------------


def test_modules_are_imported_when_they_are_trusted_and_not_otherwise(tmp_path: Path) -> None:
    (tmp_path / "beside_it.py").write_text(f"import pathlib\npathlib.Path({str(tmp_path / 'ran')!r}).touch()\n")
    path = tmp_path / "c.toml"
    path.write_text('modules = ["beside_it"]\n[[cross]]\n[cross.scenes.cantilever]\n')
    with pytest.raises(UsageError, match=r"runs beside_it\.py beside it: allow this by footprint run --trust"):
        find(str(path))
    assert not (tmp_path / "ran").exists()
    find(str(path), trust=True)
    assert used() == (str(tmp_path / "beside_it.py"),)
    assert (tmp_path / "ran").exists()


@pytest.mark.parametrize("name", ["../beside", "/tmp/beside", "a.b", "a/b", "..", "", "linked"])
def test_modules_out_of_the_folder_are_refused_trusted_or_not(name: str, tmp_path: Path) -> None:
    (tmp_path / "own").mkdir()
    (tmp_path / "beside.py").write_text(f"import pathlib\npathlib.Path({str(tmp_path / 'ran')!r}).touch()\n")
    (tmp_path / "own" / "linked.py").symlink_to(tmp_path / "beside.py")
    (tmp_path / "own" / "c.toml").write_text(f'modules = ["{name}"]\n')
    with pytest.raises(UsageError, match=r"must be the name of a module beside it|leads out of the folder"):
        find(str(tmp_path / "own" / "c.toml"), trust=True)
    assert not (tmp_path / "ran").exists()


def test_a_campaign_is_named_by_its_file_too_and_a_long_label_is_no_part_of_a_reason(tmp_path: Path, capsys) -> None:
    name = "x" * 70
    text = f'[[cross]]\nname = "{name}"\n[cross.scenes.cantilever]\nmeshes = ["2x1", "0x1"]\nset.load_fraction = 0.1\n'
    (tmp_path / "own.toml").write_text(text)
    store = tmp_path / "store"
    assert main(["run", str(tmp_path / "own.toml"), "--store", str(store)]) == 0
    assert main(["table", str(tmp_path / "own.toml"), "--store", str(store)]) == 0
    assert f"{name} cantilever 0x1 mesh '0x1' must have at least 1" in capsys.readouterr().out


def test_rows_are_selected_by_whole_numbers_too(solved: Path, capsys: pytest.CaptureFixture[str]) -> None:
    def said(where: str) -> str:
        code = main(["table", "small", "--store", str(solved), "--where", where])
        printed = capsys.readouterr()
        return printed.out if code == 0 else printed.err

    assert said("n1=8").endswith("\n2 cells: 2 converged\n")
    assert said("c.dofs=-1").endswith("\n0 cells: none\n")
    assert "'n1=eight': this column has numbers" in said("n1=eight")
    assert "'n3=8' must be COLUMN=VALUE with one of label, " in said("n3=8")


@pytest.mark.parametrize("campaign", [["nofile.toml"], ["fuzz", "--seeds", "0:1"]])
@pytest.mark.parametrize(
    ("limit", "says"),
    [
        (["--time-limit", "1e7"], "time-limit = 10000000.0 must be a number in (0, 500000]"),
        (["--memory-limit", "1e14"], "memory-limit = 100000000000000.0 must be a number in (0, 1e+09]"),
        (["--memory-limit", "-1"], "memory-limit = -1.0 must be a number in (0, 1e+09]"),
    ],
)
def test_limits_that_no_process_is_held_to_are_one_line(
    campaign: list[str], limit: list[str], says: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["run", *campaign, *limit, "--store", str(tmp_path / "store")]) == 2
    assert capsys.readouterr().err == f"footprint: {says}\n"
    assert not (tmp_path / "store").exists()


def test_tables_of_ones_own_have_names_of_their_own() -> None:
    """A list, or a table, that is there already is refused, and leaves no trace."""

    def epsilon() -> pd.DataFrame:
        return pd.DataFrame()

    def nowhere() -> pd.DataFrame:
        return pd.DataFrame()

    for name, make, taken in (("own", epsilon, "epsilon"), ("limits", nowhere, "limits")):
        with pytest.raises(ValueError, match=f"'{taken}' is the name of a list or a table already"):
            add_tables(name, "of one's own", make)
    assert "own" not in LISTS
    assert "nowhere" not in MAKERS
