"""Declarations: each kind of value on a table whose numbers are seen by eye, and what has nothing to rest on.

Options of the element: verdicts and shares of the thickness strain, on records made up.
"""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import pandas as pd
import pytest

from studies.analysis.elements import confirmed, limit_of, nearest, turns_at, verdict_of
from studies.analysis.evidence import NothingError, read_declarations, read_values
from studies.analysis.statements.tables import read_claims, read_sentences, said_by
from studies.run.lists import LADDERS

TABLES = {
    "runs": pd.DataFrame(
        {"who": ["a", "b", "a", "c"], "mesh": ["4x4", "4x4", "8x8", "8x8"], "error": [0.4, -0.2, 0.1, float("nan")]}
    ),
    "rules": pd.DataFrame({"bar": [0.3]}),
}
SHARED = {"name", "like", "from", "where", "columns", "sort", "once", "values", "machine"}
OF_CLAIMS = {"subject", "sentence", "source", "regime", "command", "statement", "measured", "band", "unit"}
OF_SENTENCES = {"page", "role", "need", "text", "scope", "maker"}
OF_LISTS = {"form", "from", "where", "once", "sort", "most", "join", "empty", "by", "each", "number", "text"}


def value(of: Any, **declaration: Any) -> Any:
    return read_values({"from": "runs", **declaration, "values": {"bar": 0.3, "x": of}}, TABLES.get)["x"]


def test_a_value_is_what_it_says() -> None:
    for of, actual in (
        ("count", 4),
        ("count where error > 0", 2),
        ("max abs(error)", 0.4),
        ("max abs(error) where who != 'a'", 0.2),
        ("first mesh where error < @bar and error > 0", "8x8"),
        ("last who", "c"),
        ("distinct who", 3),
        ("sum error", pytest.approx(0.3)),
        ("median error", 0.1),
        ("words mesh", "4x4, 8x8"),
        ("names who where error > 1", "none"),
        ("name who where error == error.max()", "`a`"),
        ("first bar from rules", 0.3),
        ("= bar + 1", 1.3),
        (2, 2.0),
        (
            {"form": "{who} {error}", "where": "error.notna()", "sort": "error", "most": 2, "join": "and"},
            "b -0.2 and a 0.1",
        ),
        ({"form": "{who}", "from": "runs", "once": "mesh"}, "a"),
        ({"form": "{who}", "where": "error > 1", "empty": "nobody"}, "nobody"),
    ):
        assert value(of) == actual, of


def test_columns_are_added_before_rows_are_chosen() -> None:
    total = {"columns": {"runs_of": "error.groupby(who).transform('count')"}, "where": ["mesh == '8x8'", "runs_of > 0"]}
    assert value("first runs_of", **total) == 2
    assert value("count", **total) == 1
    assert value("count", once="mesh") == 2


def test_what_rests_on_nothing_is_not_said_but_a_slip_is_an_error() -> None:
    """A column or an aggregate of another name would be a sentence that vanishes without a word."""
    for of in ("max error where error > 1", "first error from nowhere", "count from nowhere"):
        with pytest.raises(NothingError):
            value(of)
    with pytest.raises(NothingError):
        value("count", where="error > 1")
    for of in ("max eror", "count where eror > 1", "greatest error"):
        with pytest.raises((KeyError, pd.errors.UndefinedVariableError)):
            value(of)


def test_values_of_groups_are_numbered_and_stand_in_the_text() -> None:
    stated = {"by": "mesh", "each": {"mesh#": "first mesh", "low#": "min error"}, "text": "{low#:.1f} on {mesh#}"}
    text = ["It is <told>", ".", {"when": "_bar > 1", "text": "!"}]
    sentence = {"name": "x", "page": "p", "from": "runs", "scope": "{_bar:g}", "text": text}
    (actual,) = said_by({**sentence, "values": {"_bar": 0.3, "told": {**stated, "join": "and"}}}, TABLES.get)
    assert dict(actual.values) == {"mesh0": "4x4", "low0": -0.2, "mesh1": "8x8", "low1": 0.1}
    assert actual.text.format(**actual.values) == "It is -0.2 on 4x4 and 0.1 on 8x8."
    assert (actual.scope, actual.problems) == ("0.3", 4)
    assert list(said_by({**sentence, "values": {"_bar": 2}, "need": "_bar < 1"}, TABLES.get)) == []


def test_what_is_alike_is_said_once(tmp_path: Path) -> None:
    file = tmp_path / "x.toml"
    one = '[[a]]\nname = "one"\nwhere = "x"\nvalues.n = 1\nvalues.m = 2\n'
    file.write_text(one + '[[b]]\nname = "two"\nlike = "one"\nvalues.n = 3\n')
    (_, first), (array, two) = read_declarations(file)
    assert (array, two["where"], two["values"]) == ("b", "x", {"n": 3, "m": 2})
    assert first["values"] == {"n": 1, "m": 2}


def test_declarations_have_no_key_that_nobody_reads() -> None:
    """A key with a slip in it would be passed over."""
    for known, all_declared in ((OF_CLAIMS, read_claims().values()), (OF_SENTENCES, read_sentences())):
        for each in all_declared:
            assert set(each) <= SHARED | known, each.get("name")
            lists = [own for own in each["values"].values() if isinstance(own, dict)]
            assert {key for own in lists for key in own} <= OF_LISTS, each.get("name")


(ROOF,) = (ladder for ladder in LADDERS if ladder.name == "roof-a")


def record(*, end: float | None = None, converged: bool = False, **quantities: float) -> dict[str, Any]:
    actual = {} if end is None else {"press_limit_point": end}
    return {"outcome": "converged" if converged else "step-limit", "quantities": quantities | actual}


def sequences(limits: list[float], uncertainties: list[float]) -> pd.DataFrame:
    both = zip(limits, uncertainties, strict=True)
    rows = [(i, "roof-a", ROOF.family, "limit_load_fraction", *each) for i, each in enumerate(both)]
    other = (9, "roof-b", ROOF.family, "limit_load_fraction", 7.0, 1e-9)
    return pd.DataFrame([*rows, other], columns=["sequence", "ladder", "family", "quantity", "limit", "uncertainty"])


REFERENCES = pd.DataFrame(
    {"sequence": [0, 0, 9], "value": [0.72, 0.74, 7.0], "uncertainty": [0.01, 0.003, 1e-6]}, index=[5, 6, 7]
)


def test_nearest_are_those_that_no_other_share_beats() -> None:
    for errors, within, best in (
        ((-0.05, 0.01, 0.03), 0.0, {"balanced"}),
        ((-0.0109, 0.01, 0.03), 0.0, {"projected", "balanced"}),  # 0.09 % apart
        ((-0.0111, 0.01, 0.03), 0.0, {"balanced"}),
        ((-0.0111, 0.01, 0.03), 0.002, {"projected", "balanced"}),
        ((0.2, math.nan, -0.1), 0.0, {"nodal"}),
        ((math.nan, math.nan, math.nan), 0.0, set()),
    ):
        assert nearest(dict(zip(("projected", "balanced", "nodal"), errors, strict=True)), within) == best


def test_a_path_ends_where_its_record_says_unless_it_went_on() -> None:
    """A traced curve passes its limit points and converges: none of them is an end."""
    assert turns_at(record(end=0.68)) == 0.68
    assert math.isnan(turns_at(record(end=0.68, converged=True)))
    assert math.isnan(turns_at(record(limit_points=2.0)))  # failed for another reason


def test_a_finer_mesh_that_goes_on_does_not_confirm_an_end() -> None:
    for finer, said in (
        (record(converged=True), False),
        (record(end=0.95), False),
        (record(end=0.68 * 1.051), False),
        (record(end=0.68 * 1.049), True),
        (record(end=0.6), True),
    ):
        assert confirmed(record(end=0.68), finer) is said


def test_a_finer_mesh_that_passes_fewer_limit_points_does_not_confirm_the_others() -> None:
    two, none = (record(converged=True, limit_points=n) for n in (2.0, 0.0))
    assert confirmed(two, two)
    assert confirmed(none, two)
    assert not confirmed(two, none)
    assert confirmed(record(converged=True), record(converged=True))  # of no curve


def test_errors_are_of_the_most_certain_limit() -> None:
    assert limit_of(ROOF, sequences([0.73, 0.74], [0.02, -0.001]), REFERENCES) == (0.74, pytest.approx(0.001 / 0.74))
    assert limit_of(ROOF, sequences([0.73, math.nan], [0.02, math.nan]), REFERENCES)[0] == 0.73


def test_without_a_limit_they_are_of_the_most_certain_reference() -> None:
    unknown = [math.nan, math.nan]
    assert limit_of(ROOF, sequences(unknown, unknown), REFERENCES) == (0.74, 0.003)
    assert all(map(math.isnan, limit_of(ROOF, sequences(unknown, unknown), REFERENCES.iloc[2:])))


def test_verdict_is_that_of_the_coarsest_mesh() -> None:
    for default, paper, verdict in (
        (0.02, -0.05, "better"),
        (-0.05, 0.02, "worse"),
        (0.0301, 0.0305, "equal"),  # closer than 0.1 %
        (0.0001, 0.0009, "equal"),  # nothing left to gain
        (math.nan, 0.02, "not solved by both"),
    ):
        assert verdict_of(default, paper, 0.0) == verdict


def test_what_the_limit_does_not_tell_apart_is_equal() -> None:
    assert verdict_of(-0.05, 0.02, 0.029) == "worse"
    assert verdict_of(-0.05, 0.02, 0.031) == "equal"
