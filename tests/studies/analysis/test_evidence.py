"""Declarations: each kind of value on a table whose numbers are seen by eye, and what has nothing to rest on."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pandas as pd
import pytest

from studies.analysis.evidence import NothingError, read_declarations, read_values
from studies.analysis.statements.tables import read_claims, read_sentences, said_by

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
    for of, found in (
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
        assert value(of) == found, of


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
    told = {"by": "mesh", "each": {"mesh#": "first mesh", "low#": "min error"}, "text": "{low#:.1f} on {mesh#}"}
    text = ["It is <told>", ".", {"when": "_bar > 1", "text": "!"}]
    sentence = {"name": "x", "page": "p", "from": "runs", "scope": "{_bar:g}", "text": text}
    (found,) = said_by({**sentence, "values": {"_bar": 0.3, "told": {**told, "join": "and"}}}, TABLES.get)
    assert dict(found.values) == {"mesh0": "4x4", "low0": -0.2, "mesh1": "8x8", "low1": 0.1}
    assert found.text.format(**found.values) == "It is -0.2 on 4x4 and 0.1 on 8x8."
    assert (found.scope, found.problems) == ("0.3", 4)
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
