"""Options of the element: verdicts and shares of the thickness strain, on records made up."""

from __future__ import annotations

import math
from typing import Any

import pandas as pd
import pytest

from studies.analysis.elements import confirmed, limit_of, nearest, turns_at, verdict_of
from studies.run.lists import LADDERS

(ROOF,) = (ladder for ladder in LADDERS if ladder.name == "roof-a")


def record(*, end: float | None = None, converged: bool = False, **quantities: float) -> dict[str, Any]:
    found = {} if end is None else {"press_limit_point": end}
    return {"outcome": "converged" if converged else "step-limit", "quantities": quantities | found}


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
