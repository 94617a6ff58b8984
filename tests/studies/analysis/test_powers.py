"""Powers of strains, errors and times whose law is known."""

from __future__ import annotations

import math

import numpy as np
import pandas as pd
import pytest

from studies.analysis.powers import epsilon_laws, fitted_law, fitted_power
from studies.analysis.tyre import grids_reaching, reaching

AMOUNTS = [0.2, 0.1, 0.05]


def test_power_of_a_strain_with_a_higher_term() -> None:
    for rate, coefficient in ((1, 0.3), (2, -0.5), (4, -0.125)):
        found = fitted_power(AMOUNTS, [coefficient * a**rate * (1 - a**2 / 3) for a in AMOUNTS])
        assert found == (pytest.approx(rate, abs=0.01), pytest.approx(coefficient, rel=1e-5))
    for strains in ([1e-15, -2e-15, 1e-15], [math.nan] * 3, [0.2, 0.1, -0.05]):  # rounding, nothing, a change of sign
        assert all(map(math.isnan, fitted_power(AMOUNTS, strains)))


def test_a_law_is_found_between_its_two_ends() -> None:
    epsilon = pd.Series(10.0 ** np.arange(-2, 9))
    assert fitted_law(epsilon, 1 / (epsilon + 1) + 1e-6) == pytest.approx(-1, abs=0.02)  # soft below 1, a floor above
    assert math.isnan(fitted_law(epsilon, pd.Series(np.ones(11))))
    assert math.isnan(fitted_law(epsilon, pd.Series(np.zeros(11))))


def test_what_the_stiffness_of_the_wall_gives_a_penalty() -> None:
    """Force error -2e-3/epsilon, condition 1e3 epsilon over 1e5; the displacement form breaks down at 1e6."""
    epsilon = 10.0 ** np.arange(-2, 13)
    broken = np.where(epsilon >= 1e6, "rounding", "converged")
    common = {"case": "tyre", "epsilon": epsilon, "force_error": -2e-3 / epsilon, "condition": 1e3 * epsilon}
    study = [pd.DataFrame({**common, "form": "multiplier", "outcome": "converged"})]
    study.append(pd.DataFrame({**common, "form": "displacement", "outcome": broken}))
    study.append(study[0].iloc[:1].assign(epsilon=np.inf, condition=1e5, force_error=0.0))
    (found,) = epsilon_laws(pd.concat(study)).to_dict("records")
    stiff = 510.45 / 4.8
    assert found["wall"] == pytest.approx(stiff)
    assert found["force_slope"] == pytest.approx(-1, abs=1e-9)
    assert found["error_at_wall"] == pytest.approx(2e-3 / stiff)
    assert found["growth_at_wall"] == pytest.approx(stiff / 100)
    assert found["growth_at_ten"] == pytest.approx(stiff / 10)
    assert found["fails_at"] == pytest.approx(1e6 / stiff)
    always = pd.concat([study[0], study[1].assign(outcome="converged"), study[2]])
    assert epsilon_laws(always)["fails_at"].isna().all()


def test_one_good_grid_does_not_count() -> None:
    """Neither does the last one: BEHIND finer grids have to stay below the error, too."""
    behind = [0.003, 0.004]
    grids = pd.DataFrame({"unknowns": range(1, 7), "error": [0.1, 0.001, -0.02, 0.005, *behind]})
    assert reaching(grids, 0.01)["unknowns"] == 4
    assert reaching(grids.iloc[:5], 0.01) is None
    assert reaching(grids.iloc[:3], 0.01) is None
    table = pd.concat([grids.assign(family="uniform"), grids.assign(family="adapted", unknowns=grids["unknowns"] / 2)])
    found = grids_reaching(table.assign(element="paper")).set_index(["within", "family"])
    assert list(found.loc[0.01, "unknowns"]) == [4, 2]
    assert found.loc[(0.01, "adapted"), "share"] == 0.5
    assert found.loc[0.002, ["mesh", "unknowns", "error", "share"]].isna().all(axis=None)


def test_each_error_has_its_own_grid() -> None:
    errors = [0.1, -0.005, 0.001, 0.0, 0.0]
    grids = pd.DataFrame({"unknowns": range(1, 6), "error": errors, "element": "paper"})
    coarse = pd.concat([grids.iloc[:2], grids.iloc[1:2].assign(unknowns=3), grids.iloc[1:2].assign(unknowns=4)])
    found = grids_reaching(pd.concat([grids.assign(family="local"), coarse.assign(family="uniform")]))
    assert found["within"].tolist() == [0.01, 0.01, 0.002, 0.002]
    np.testing.assert_array_equal(found["unknowns"], [2, 2, 3, np.nan])
    np.testing.assert_array_equal(found["share"], [1, 1, np.nan, np.nan])
