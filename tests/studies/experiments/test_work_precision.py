"""Grids of the tyre against what they cost: rounds of a refinement as rows, and the reference of all errors."""

import numpy as np
import pandas as pd
import pytest

from studies.experiments.work_precision import COLUMNS, rows_of_rounds, work_precision_study

ISOTROPIC = {"E_MPa": "20", "nu": "0.45", "load": "follower", "delta_mm": "10"}
SOLID = 523.8  # N, two independent programs with three-dimensional elements, known to 0.3 %
MESH = (12, 24)


def test_rounds_cost_what_was_spent_until_them() -> None:
    """The second round is that of a grid cut everywhere: it was solved in the first."""
    rounds = pd.DataFrame(
        {
            **{"value": [90.0, 97.5, 98.5], "finer": [97.5, 99.0, 99.6], "limit": [100.0, 99.5, 100.0]},
            **{"unknowns": [10, 40, 70], "finer_unknowns": [40, 160, 280]},
            **{"seconds": [6.0, 17.0, 40.0], "finer_seconds": [4.0, 16.0, 32.0]},
            "own_seconds": [1.0, 4.0, 6.0],
        }
    )
    table = rows_of_rounds(rounds, 0.5).set_index("family")
    local, limit = table.loc["local"], table.loc["extrapolated"]
    np.testing.assert_array_equal(local[["unknowns", "force_N"]], [(10, 90.0), (40, 97.5), (70, 98.5)])
    np.testing.assert_array_equal(local[["own_s", "total_s"]], [(1.0, 1.5), (4.0, 6.5), (6.0, 29.5)])
    np.testing.assert_array_equal(limit[["unknowns", "force_N"]], [(40, 100.0), (160, 99.5), (280, 100.0)])
    np.testing.assert_array_equal(limit[["own_s", "total_s"]], [(4.0, 6.5), (16.0, 23.5), (32.0, 63.5)])
    assert local["mesh"].tolist() == limit["mesh"].tolist() == ["round 1", "round 2", "round 3"]


@pytest.mark.slow
def test_the_reference_is_known_as_well_as_it_says() -> None:
    """The isotropic tyre at 10 mm against solids; the first local grid is the uniform one of the same mesh."""
    table = work_precision_study(ISOTROPIC, {"uniform": [MESH]}, (200,), 0.05, MESH)
    reference, apart, known = table[["reference_N", "apart", "known"]].iloc[0]
    assert known <= 0.05
    assert abs(reference / SOLID - 1) <= known + 0.003
    np.testing.assert_allclose(table["error"], table["force_N"] / reference - 1, rtol=1e-12)
    limits = []
    for _, own in table.groupby("element"):
        assert own["family"].unique().tolist() == ["uniform", "adapted", "local", "extrapolated"]
        family = own.set_index("family")[list(COLUMNS[1:])]
        first = family.loc["local"].iloc[0]
        assert first["force_N"] == pytest.approx(family.loc["uniform", "force_N"], rel=1e-9)
        assert first["unknowns"] == family.loc["uniform", "unknowns"]
        limits.append(family.loc["extrapolated", "force_N"].iloc[-1])
        assert family.loc["adapted", "total_s"] > family.loc["adapted", "own_s"]
    assert reference == pytest.approx(np.mean(limits), rel=1e-12)
    assert apart == pytest.approx(abs(limits[0] - limits[1]) / reference, rel=1e-9)
    assert apart / 2 <= known
    assert np.all(table["own_s"] <= table["total_s"])
