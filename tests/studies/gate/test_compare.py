"""The gate: planted losses are caught and named, noise is not, and a baseline has an owner and a reason."""

from __future__ import annotations

import datetime
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from studies.ask.request import Request, Settings
from studies.ask.scene import UsageError
from studies.commands.comparison import comment
from studies.gate.baseline import COMMAND, OUTCOME, TOLERANCES, UPDATES, bound_of, read_baseline, read_bounds
from studies.gate.compare import NothingComparedError, check, compared, failures, lines, measured, update

EXACT = 6.69964  # mm, the cantilever's tip deflection under the whole load, as its scene says
MESHES = (8, 16, 32, 64)
SIGNED = ("Anna", "why")
BOUND = """[[bound]]
column = "{column}"
worse = "{worse}"
relative = {relative}
absolute = {absolute}
owner = "Anna"
date = 2026-01-31
reason = "as planted"
"""
BOUNDS = "\n".join(
    BOUND.format(column=column, worse=worse, relative=relative, absolute=absolute)
    for column, worse, relative, absolute in (
        ("q.*", "either", 1e-6, 1e-9),
        ("error.*", "up", 0.005, 1e-7),
        ("order.*", "down", 0.0, 0.05),
        ("c.*", "up", 0.04, 0.0),
    )
)


def campaign(order: float = 2.0, loss: float = 0.0, counters: float = 1.0) -> pd.DataFrame:
    """Cantilevers on a ladder, as collect() gives them; the deflection has a reference, the slope has none."""
    rows = []
    for n in MESHES:
        mesh_error = 0.5 * n**-order
        rows.append(
            {
                "label": f"cantilever {n}",
                "scene": "cantilever",
                "measure": "exact",
                "n1": n,
                "n2": 1,
                "outcome": "converged",
                "command": f"footprint solve cantilever --mesh {n}x1 --set load_fraction=1 --out DIR",
                "request": Request("cantilever", mesh=(n, 1), settings=Settings({"load_fraction": (1.0,)})),
                "q.load_fraction": 1.0,
                "q.tip_deflection_mm": EXACT * (1 - mesh_error) * (1 - loss),
                "q.slope": 2 + mesh_error,
                "c.factorisations": round(20 * counters),
                "c.dofs": 12 * n,
            }
        )
    return pd.DataFrame(rows)


@pytest.fixture
def baseline(tmp_path: Path) -> Path:
    (tmp_path / TOLERANCES).write_text(BOUNDS)
    update(campaign(), tmp_path / "quick.csv", "Anna", "the first one")
    return tmp_path / "quick.csv"


def test_the_same_again_is_silent(baseline: Path) -> None:
    assert check(campaign(), baseline) == []


def test_rounding_is_silent(baseline: Path, rng: np.random.Generator) -> None:
    for _ in range(20):
        table = campaign()
        for name in [column for column in table if column.startswith("q.tip") or column == "q.slope"]:
            table[name] *= 1 + 1e-10 * rng.normal(size=len(table))
        assert check(table, baseline) == []


def test_half_an_order_less_is_caught_and_named(baseline: Path) -> None:
    """The coarsest mesh is as good as before: what is lost is the order."""
    table = campaign(order=1.5)
    table["q.slope"] = 2 + 0.5 * 8**-0.5 * np.array(MESHES, float) ** -1.5
    by_name = {f.column: f for f in failures(check(table, baseline)) if f.label == "cantilever 64"}
    assert by_name["order.slope"].what == "worse"
    assert float(by_name["order.slope"].before) == pytest.approx(2.0, abs=1e-6)
    assert float(by_name["order.slope"].now) == pytest.approx(1.5, abs=1e-6)
    assert "order.tip_deflection_mm" in by_name


@pytest.mark.parametrize("sign", [1, -1])
def test_one_per_cent_of_accuracy_is_caught_and_named(baseline: Path, sign: int) -> None:
    """A shift of the value by 1 %: beyond the reference it is a loss, too."""
    table = campaign(loss=0.01 if sign > 0 else -0.02)
    actual = failures(check(table, baseline))
    assert ("cantilever 64", "error.tip_deflection_mm", "worse") in {(f.label, f.column, f.what) for f in actual}


def test_one_per_cent_more_of_the_error_is_caught(baseline: Path) -> None:
    table = campaign()
    table["q.tip_deflection_mm"] = EXACT - 1.01 * (EXACT - table["q.tip_deflection_mm"])
    actual = failures(check(table, baseline))
    assert {f.column for f in actual} == {"error.tip_deflection_mm"}
    assert len(actual) == len(MESHES)


def test_ten_per_cent_more_factorisations_are_caught_and_named(baseline: Path) -> None:
    actual = failures(check(campaign(counters=1.1), baseline))
    assert {(f.column, f.what, f.before, f.now) for f in actual} == {("c.factorisations", "worse", "20", "22")}
    text = "\n".join(lines(actual))
    assert "cantilever 64" in text
    assert "c.factorisations" in text


def test_better_is_said_and_no_failure(baseline: Path) -> None:
    table = campaign(counters=0.5)
    table["q.tip_deflection_mm"] = EXACT - 0.5 * (EXACT - table["q.tip_deflection_mm"])
    actual = check(table, baseline)
    assert {(f.column, f.what) for f in actual} == {
        ("c.factorisations", "better"),
        ("error.tip_deflection_mm", "better"),
    }
    assert failures(actual) == []


def test_a_quantity_without_a_reference_must_stay(baseline: Path) -> None:
    table = campaign()
    table.loc[0, "q.slope"] *= 1 - 1e-4
    assert {(f.label, f.column, f.what) for f in failures(check(table, baseline))} == {
        ("cantilever 8", "q.slope", "changed")
    }


@pytest.mark.parametrize(
    ("change", "expected"),
    [
        (lambda t: t.iloc[1:], ("cantilever 8", "", "missing")),
        (lambda t: pd.concat([t, t.tail(1).assign(label="more")]), ("more", "", "new")),
        (lambda t: t.drop(columns="q.slope"), ("cantilever 8", "q.slope", "missing")),
        (lambda t: t.assign(**{"c.more": 3}), ("cantilever 8", "c.more", "new")),
        (lambda t: t.assign(**{"q.slope": [*t["q.slope"][:3], np.nan]}), ("cantilever 64", "q.slope", "missing")),
        (lambda t: t.assign(outcome="not-converged"), ("cantilever 8", "outcome", "worse")),
        (lambda t: t.assign(outcome="missing"), ("cantilever 8", "outcome", "worse")),
        (
            lambda t: t.assign(command=t["command"].str.replace("load_fraction=1", "load_fraction=0.5")),
            ("cantilever 8", "command", "changed"),
        ),
    ],
)
def test_what_else_fails(
    baseline: Path, change: Callable[[pd.DataFrame], pd.DataFrame], expected: tuple[str, str, str]
) -> None:
    assert expected in {(f.label, f.column, f.what) for f in failures(check(change(campaign()), baseline))}


def test_zero_cells_are_a_failure(baseline: Path) -> None:
    with pytest.raises(NothingComparedError, match="zero cells compared"):
        check(campaign().iloc[:0], baseline)
    with pytest.raises(NothingComparedError, match="zero cells compared"):
        check(campaign().assign(label=list("abcd")), baseline)


@pytest.mark.parametrize("outcome", ["missing", "time", "memory", "crash"])
def test_what_the_machine_did_not_finish_is_no_baseline(baseline: Path, outcome: str) -> None:
    before = baseline.read_bytes()
    table = campaign()
    table.loc[2, "outcome"] = outcome
    with pytest.raises(UsageError, match=rf"1 cells are not finished, the first is 'cantilever 32': {outcome}"):
        update(table, baseline, *SIGNED)
    assert baseline.read_bytes() == before


def test_an_update_is_recorded_and_then_holds(baseline: Path) -> None:
    slower = campaign(counters=1.1)
    update(slower, baseline, "Boris", "one\nmore")
    assert check(slower, baseline) == []
    log = pd.read_csv(baseline.parent / UPDATES)
    assert list(log["owner"]) == ["Anna", "Boris"]
    assert all(map(datetime.date.fromisoformat, log["date"]))
    assert log["reason"].iloc[1] == "one more"
    assert log["changed"].iloc[1] == "4 worse"


@pytest.mark.parametrize(
    ("broken", "message"),
    [
        (BOUNDS.replace('owner = "Anna"\n', "", 1), r"bound 1 \(q\.\*\): .*'owner'"),
        (
            BOUNDS.replace("date = 2026-01-31", 'date = "soon"', 1),
            r"bound 1 \(q\.\*\): needs an owner, a reason and a date",
        ),
        (
            BOUNDS.replace('reason = "as planted"', 'reason = " "', 1),
            r"bound 1 \(q\.\*\): needs an owner, a reason and",
        ),
        (BOUNDS.replace('worse = "up"', 'worse = "more"', 1), r"bound 2 \(error\.\*\): worse must be one of up, down"),
        (BOUNDS.replace("relative = 0.04", "relative = -1", 1), r"relative and absolute in \[0, inf\)"),
        (BOUNDS + "relativ = 1\n", "'relativ'"),
        (BOUNDS.replace("[[bound]]", "[bound", 1), "cannot be read"),
        ("[bound]\ncolumn = 'error.*'\n", r"bound 1 is not a table: \[\[bound\]\] has two brackets"),
    ],
)
def test_bounds_are_refused_in_one_line(tmp_path: Path, broken: str, message: str) -> None:
    (tmp_path / TOLERANCES).write_text(broken)
    with pytest.raises(UsageError, match=message):
        read_bounds(tmp_path / TOLERANCES)


def test_a_value_without_a_bound_is_refused(baseline: Path) -> None:
    (baseline.parent / TOLERANCES).write_text(BOUNDS.replace('"c.*"', '"c.dofs"'))
    with pytest.raises(UsageError, match=r"no bound covers c\.factorisations of 'cantilever 8'"):
        check(campaign(), baseline)
    with pytest.raises(UsageError, match=r"no bound covers c\.factorisations"):
        update(campaign(), baseline, *SIGNED)


def test_the_last_bound_wins_and_can_be_for_some_cells(tmp_path: Path) -> None:
    narrow = BOUND.format(column="c.*", worse="up", relative=0.5, absolute=0.0) + 'cells = "cantilever ?"\n'
    (tmp_path / TOLERANCES).write_text(f"{BOUNDS}\n{narrow}")
    bounds = read_bounds(tmp_path / TOLERANCES)
    assert bound_of(bounds, "cantilever 8", "c.dofs").relative == 0.5
    assert bound_of(bounds, "cantilever 16", "c.dofs").relative == 0.04


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("label,column,value\na,1\n", "cannot be read"),
        ("label,column\na,1\n", "cannot be read"),
        ("label,column,value\na,c.x,1\na,c.x,2\n", "cannot be read: .*duplicate"),
        ("label,column,value\na,outcome,converged\na,command,run\na,c.x,many\n", "cannot be read: .*many"),
        ("label,column,value\na,outcome,converged\n", "cannot be read: .*command"),
        ("label,column,value\na,outcome,converged\nb,command,run\n", "a cell has no outcome or no command"),
    ],
)
def test_a_damaged_baseline_is_refused(tmp_path: Path, text: str, message: str) -> None:
    (tmp_path / "quick.csv").write_text(text)
    with pytest.raises(UsageError, match=message):
        read_baseline(tmp_path / "quick.csv")


def test_a_missing_baseline_says_how_to_make_one(tmp_path: Path) -> None:
    with pytest.raises(UsageError, match=r"check --campaign quick --update --owner NAME --reason TEXT makes one"):
        check(campaign(), tmp_path / "quick.csv")


def test_values_survive_the_file(baseline: Path) -> None:
    pd.testing.assert_frame_equal(read_baseline(baseline), measured(campaign()))


def test_infinite_and_missing_numbers(baseline: Path) -> None:
    bounds = read_bounds(baseline.parent / TOLERANCES)
    before, now = measured(campaign()), measured(campaign())
    now.loc[(now["label"] == "cantilever 8") & (now["column"] == "q.slope"), "value"] = "nan"
    now.loc[(now["label"] == "cantilever 16") & (now["column"] == "q.slope"), "value"] = "inf"
    values = [(f.label, f.column, f.now) for f in compared(before, now, bounds)]
    assert values == [("cantilever 8", "q.slope", "nan"), ("cantilever 16", "q.slope", "inf")]


def test_the_comment_of_a_review(baseline: Path) -> None:
    bounds = read_bounds(baseline.parent / TOLERANCES)
    now = campaign(counters=1.1)
    now.loc[3, "outcome"] = "time"
    now = pd.concat([now.iloc[1:], now.tail(1).assign(label="more")])
    text = comment("quick", campaign(), now, bounds, "not asked for")
    assert "A: 4 of 4 cells ran, 4 converged. B: 2 of 4 cells ran, 2 converged, 2 time." in text
    assert "**Worse (3)**" in text
    assert "| cantilever 16 | c.factorisations | 20 | 22 | +0.8 |" in text
    assert "| cantilever 64 | outcome | converged | time | the same |" in text
    assert "**Missing (1)**" in text
    assert "| more | the cell |" in text
    same = comment("quick", campaign(), campaign(), bounds, "not asked for")
    assert "Nothing changed beyond the bounds." in same


def test_a_cell_that_ends_otherwise_is_worse_only_where_it_has_been_solved() -> None:
    before, now = (
        pd.DataFrame([("a", COMMAND, "run"), ("a", OUTCOME, outcome)], columns=["label", "column", "value"])
        for outcome in ("not-converged", "converged")
    )
    assert [each.what for each in compared(before, now, ())] == ["changed"]
    assert [each.what for each in compared(now, before, ())] == ["worse"]
