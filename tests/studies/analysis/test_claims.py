"""The ledger of claims: how a verdict follows from an interval, and that every claim can be judged, or says why not."""

from __future__ import annotations

import math
import shlex
from pathlib import Path

import pandas as pd
import pytest

from studies.analysis.statements.tables import (
    CONFIRMED,
    QUALIFIED,
    REFUTED,
    UNTESTED,
    Verdict,
    always,
    banded,
    claims_table,
    counted,
    judged,
    read_claims,
)
from studies.cli import _parser
from studies.output.atomic import write_table

CLAIMS = read_claims()


def test_verdicts_of_intervals_tendencies_and_laws() -> None:
    """A tendency stands with half of its problems; a law falls with one."""
    for low, high, status in (
        (0.99, 1.01, CONFIRMED),
        (1.05, 1.2, QUALIFIED),
        (1.11, 1.2, REFUTED),
        (0.5, 0.89, REFUTED),
    ):
        assert banded((low, high), (0.9, 1.1), "", "", 1).status == status
    assert [counted(right, 4, "").status for right in (4, 3, 2, 1, 0)] == [CONFIRMED, *[QUALIFIED] * 2, *[REFUTED] * 2]
    assert [always(broken, 4, "").status for broken in (0, 1)] == [CONFIRMED, REFUTED]


def test_an_empty_store_tests_nothing(tmp_path: Path) -> None:
    actual = claims_table(tmp_path, "none")["claims"]
    assert set(actual["status"]) == {UNTESTED}
    assert len(actual) == len(CLAIMS) >= 40
    assert actual["claim"].is_unique
    assert (actual[["sentence", "source", "regime"]] != "").all(axis=None)


def test_a_missing_table_leaves_its_claims_untested_alone(tmp_path: Path) -> None:
    row = {"problem": "3x3", "plain_period": 3, "semismooth": "converged, cycle detected"}
    (tmp_path / "tables").mkdir()
    write_table(tmp_path / "tables" / "cycles.csv", pd.DataFrame([row, {**row, "plain_period": 0}]))
    table = claims_table(tmp_path, "none")["claims"].set_index("claim")
    assert set(table.index[table["status"] != UNTESTED]) == {"no-cycles", "any-start"}
    assert table.loc["no-cycles", "measured"] == "the textbook method cycles on 1 of 2 published problems"
    assert table.loc["any-start", "high"] == 1.0


def test_commands_can_be_typed() -> None:
    commands = {claim["command"] for claim in CLAIMS.values()} - {""}
    assert len(commands) > 5
    for command in commands:
        program, *words = shlex.split(command)
        assert program == "footprint"
        _parser(words).parse_args(words)


def test_sentences_that_claims_rest_on_are_said_by_somebody() -> None:
    text = "".join(path.read_text() for path in Path("studies/analysis/statements").iterdir() if path.is_file())
    named = {claim["statement"] for claim in CLAIMS.values() if "statement" in claim}
    assert len(named) > 5
    assert {name for name in named if f'"{name}"' not in text} == set()


# --- judges on tables whose verdict is known --------------------------------------------------------------------


def budget(change: float, within: float, changed: str = "linear", delta: float = 20.0) -> pd.DataFrame:
    return pd.DataFrame([{"changed": changed, "delta_mm": delta, "change": change, "within": within}])


def verdict(name: str, **tables: pd.DataFrame) -> Verdict | None:
    return judged(CLAIMS[name], tables.get)


def test_twice_the_force() -> None:
    """That of another travel, or of another change, is no evidence."""
    for change, within, status in ((1.0, 0.05, CONFIRMED), (0.8, 0.2, QUALIFIED), (0.35, 0.05, REFUTED)):
        actual = verdict("linear-doubles", tyre_budget=budget(change, within))
        assert actual is not None
        assert (actual.status, actual.low) == (status, pytest.approx(1 + change - within))
    assert verdict("linear-doubles", tyre_budget=budget(1.0, 0.05, delta=5.0)) is None
    assert verdict("full-law", tyre_budget=budget(0.0, 0.001)) is None


def test_a_crossing_is_no_convergence() -> None:
    """Errors of 0.5, 2 and 0.4 %: the first grid is followed by one that is beyond 1 %, the last is not."""
    rows = [
        {"family": "uniform", "element": "refined", "unknowns": n, "error": e}
        for n, e in enumerate((5e-3, -2e-2, 4e-3))
    ]
    actual = verdict("one-grid", work_precision=pd.DataFrame(rows))
    assert (actual.status, actual.problems, actual.low) == (REFUTED, 2, 0.5)
    assert "1 of 2" in verdict("finer-is-better", work_precision=pd.DataFrame(rows)).measured


def test_what_was_not_counted_tests_nothing() -> None:
    """A tendency and a law of no problem are neither true nor false, and an interval of none is not an interval."""
    none = pd.DataFrame({"family": ["uniform"], "element": ["paper"], "unknowns": [9], "error": [0.5], "mesh": ["4x4"]})
    assert [verdict(name, work_precision=none) for name in ("one-grid", "finer-is-better")] == [None, None]
    both = pd.concat([none, none.assign(family="patch", mesh="6x6")]).assign(element="refined")
    assert verdict("refine-the-patch", work_precision=both) is None
    claim = {"from": "t", "measured": "{of}", "values": {"right": "count where x > 9", "of": "count where x > 1"}}
    assert judged(claim, {"t": pd.DataFrame({"x": [0.0]})}.get) is None


def test_a_measure_is_surely_within_or_not() -> None:
    """An error of 4 ± 2 % is not surely within 5 %, and what has no limit does not count."""
    row = {"row": "variant", "axis": "measure", "name": "donnell", "regime": "contact", "settings": "", "asked": 0.01}
    errors = {"ring": (0.04, 0.02), "scordelis-lo": (0.01, 0.01), "semicylinder": (math.nan, math.nan)}
    rows = [
        {**row, "scene": scene, "unknowns": 9.0, "quantity": "q", "formulation_error": e, "within": w}
        for scene, (e, w) in errors.items()
    ]
    actual = verdict("donnell-cylinders", measure_limits=pd.DataFrame(rows))
    assert (actual.status, actual.problems, actual.low) == (QUALIFIED, 2, 0.5)
