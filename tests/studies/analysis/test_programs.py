"""Factors of peers over shells from made-up tables."""

from __future__ import annotations

import math

import pandas as pd
import pytest

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
    assert row(found, "peer")["apart"] == pytest.approx(0.0)


def test_a_line_that_does_not_stay_within_has_no_sufficient_mesh() -> None:
    for errors in ([0.0, 0.02], [math.nan, math.nan], [0.0, math.nan]):
        found = peer_factors(made_up(errors, [0.001]))
        assert row(found, "footprint")["mesh"] == ""
        assert pd.isna(row(found, "peer")["factor"])
        assert row(peer_factors(made_up([0.001], errors)), "peer")["mesh"] == ""


def test_the_cheapest_line_of_a_program_counts() -> None:
    table = made_up([0.0], [0.0])
    slower = table.assign(family="slower", seconds=3 * table["seconds"])
    found = peer_factors(pd.concat([slower, table]))
    assert list(found[found["program"] == "peer"]["factor"]) == [180.0, 60.0]
