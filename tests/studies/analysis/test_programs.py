"""Factors of peers over shells from made-up tables, and what the page says of them."""

from __future__ import annotations

import math

import pandas as pd
import pytest

from reports.chapters.programs import factors_said
from studies.analysis.programs import peer_factors

OURS, THEIRS = ("footprint", "a"), ("peer", "b")


def made_up(ours: list[float], theirs: list[float], bar: float = 50.0, part: float = 0.1) -> pd.DataFrame:
    """Errors of meshes 1, 2, ...; ours take 1, 2, ... seconds, of which ``part`` are factorisations, theirs 60 each."""
    rows = [
        {
            **{"problem": "p", "program": line[0], "family": line[1], "mesh": f"{k}x{k}", "unknowns": 10 * k},
            **{"value": 8.0 * (1 + error), "error": error, "seconds": step * k, "units": step * k},
            **{"within": 0.01, "bar": bar, "uncertainty": 0.002},
            **{"start": 0.2 * step * k, "assembly": 0.4 * step * k, "factorisation": part * step * k},
        }
        for line, errors, step in ((OURS, ours, 1.0), (THEIRS, theirs, 60.0))
        for k, error in enumerate(errors, 1)
    ]
    return pd.DataFrame(rows)


def row(table: pd.DataFrame, program: str) -> pd.Series:
    return table[table["program"] == program].iloc[0]


def test_a_coarse_mesh_within_by_luck_is_not_sufficient() -> None:
    found = peer_factors(made_up([0.0, 0.02, -0.01, 0.001], [0.02, 0.001]))
    assert (row(found, "footprint")["mesh"], row(found, "peer")["mesh"]) == ("3x3", "2x2")
    assert row(found, "peer")["factor"] == pytest.approx(120 / 3)
    assert row(found, "peer")["bare"] == pytest.approx(120 / 0.3)
    assert row(found, "peer")["finest_error"] == 0.001
    assert row(found, "peer")["apart"] == pytest.approx(0.0)


def test_a_line_that_does_not_stay_within_has_no_sufficient_mesh() -> None:
    for errors in ([0.0, 0.02], [math.nan, math.nan], [0.0, math.nan]):
        found = peer_factors(made_up(errors, [0.001]))
        assert row(found, "footprint")["mesh"] == ""
        assert pd.isna(row(found, "peer")["factor"])
        assert factors_said(found) == ["p, within 1.00 %: no line of `footprint` gets and stays there."]
        found = peer_factors(made_up([0.001], errors))
        assert factors_said(found) == ["p, within 1.00 %: no line of `peer` gets and stays there."]
        assert "no line of `footprint` nor `peer` gets" in factors_said(peer_factors(made_up(errors, errors)))[0]


def test_the_cheapest_line_of_a_program_counts() -> None:
    table = made_up([0.0], [0.0])
    slower = table.assign(family="slower", seconds=3 * table["seconds"])
    found = peer_factors(pd.concat([slower, table]))
    assert list(found["cheapest"]) == [False, False, True, True]
    assert list(found[found["program"] == "peer"]["factor"]) == [180.0, 60.0]
    assert "`peer` (b, 1x1) takes 60.0 times the time of `footprint` (a, 1x1)" in factors_said(found)[0]
    assert factors_said(found)[0].endswith(" Its other lines: slower 180.0 times.")
    never = table[table["program"] == "peer"].assign(family="never", error=0.02)
    assert "other lines" not in factors_said(peer_factors(pd.concat([table, never])))[0]


def test_the_sentence_follows_the_bar() -> None:
    assert factors_said(peer_factors(made_up([0.0], [0.0], bar=60.0)))[0].endswith("; the bar of 60 is met.")
    assert factors_said(peer_factors(made_up([0.0], [0.0], bar=math.nan)))[0].endswith("(a, 1x1).")
    missed = factors_said(peer_factors(made_up([0.0], [0.0], bar=61.0)))[0]
    assert "the bar of 61 is missed. Time goes to elements 40 %, the rest 30 %, mesh and start 20 %, fact" in missed
    assert missed.endswith("with nothing else the factor would be 600.0, and the bar would be met.")
    hopeless = factors_said(peer_factors(made_up([0.0], [0.0], bar=601.0)))[0]
    assert hopeless.endswith("with nothing else the factor would be 600.0, and the bar would be missed.")
