"""Powers of strains, errors and times whose law is known."""

from __future__ import annotations

import math

import numpy as np
import pandas as pd
import pytest

from studies.analysis.comparisons.tyre_models import grids_reaching, reaching
from studies.analysis.powers import curved_beam_limits, epsilon_laws, fitted_law, fitted_power

AMOUNTS = [0.2, 0.1, 0.05]


@pytest.mark.parametrize(("rate", "coefficient"), [(1, 0.3), (2, -0.5), (4, -0.125)])
def test_power_of_a_strain_with_a_higher_term(rate: int, coefficient: float) -> None:
    found = fitted_power(AMOUNTS, [coefficient * a**rate * (1 - a**2 / 3) for a in AMOUNTS])
    assert found == (pytest.approx(rate, abs=0.01), pytest.approx(coefficient, rel=1e-5))


@pytest.mark.parametrize("strains", [[1e-15, -2e-15, 1e-15], [math.nan] * 3, [0.2, 0.1, -0.05]])
def test_rounding_and_a_change_of_sign_have_no_power(strains: list[float]) -> None:
    assert all(map(math.isnan, fitted_power(AMOUNTS, strains)))


def test_a_law_is_found_between_its_two_ends() -> None:
    epsilon = pd.Series(10.0 ** np.arange(-2, 9))
    slope, *ends = fitted_law(epsilon, 1 / (epsilon + 1) + 1e-6)  # soft below 1, a floor above 1e6
    assert slope == pytest.approx(-1, abs=0.02)
    assert ends == [pytest.approx(10.0), pytest.approx(1e5)]
    assert math.isnan(fitted_law(epsilon, pd.Series(np.ones(11)))[0])
    assert math.isnan(fitted_law(epsilon, pd.Series(np.zeros(11)))[0])


def test_ends_of_a_made_up_study() -> None:
    """Penetration 0.1/epsilon, force error -2e-3/epsilon; the displacement form breaks down at 1e6."""
    epsilon = 10.0 ** np.arange(-2, 13)
    broken = np.where(epsilon >= 1e6, "rounding", "converged")
    common = {"case": "tyre", "epsilon": epsilon, "penetration_mm": 0.1 / epsilon, "force_error": -2e-3 / epsilon}
    study = [pd.DataFrame({**common, "form": "multiplier", "outcome": "converged"})]
    study.append(pd.DataFrame({**common, "form": "displacement", "outcome": broken}))
    (found,) = epsilon_laws(pd.concat(study)).to_dict("records")
    assert found["penetration_slope"] == pytest.approx(-1, abs=1e-9)
    assert found["soft_until"] == pytest.approx(0.1)  # error 0.02
    assert found["level_from"] == pytest.approx(1e10)  # the last error above 1e-12 is that of 1e9
    assert found["breaks_at"] == pytest.approx(1e6)
    assert (found["best"], found["best_error"]) == (pytest.approx(1e5), pytest.approx(2e-8))


def test_orders_of_beams_are_those_that_were_put_in() -> None:
    rows = [(h, n, 1 - 0.1 / n**2) for h in (0.1, 0.01) for n in (4, 8, 16, 32)]
    found = curved_beam_limits(pd.DataFrame(rows, columns=["h_over_R", "elements", "ratio"]))
    assert list(found["h_over_R"]) == [0.1, 0.01]
    np.testing.assert_allclose(found[["order", "limit"]], [[2, 1], [2, 1]], rtol=1e-9)


def test_one_good_grid_does_not_count() -> None:
    grids = pd.DataFrame({"unknowns": [1, 2, 3, 4], "error": [0.1, 0.001, -0.02, 0.005]})
    assert reaching(grids, 0.01)["unknowns"] == 4
    assert reaching(grids.iloc[:3], 0.01) is None
    table = pd.concat([grids.assign(family="uniform"), grids.assign(family="adapted", unknowns=[0.5, 1, 1.5, 2])])
    found = grids_reaching(table.assign(element="paper")).set_index(["within", "family"])
    assert list(found.loc[0.01, "unknowns"]) == [4, 2]
    assert found.loc[(0.01, "adapted"), "share"] == 0.5
    assert found.loc[0.002, ["mesh", "unknowns", "error", "share"]].isna().all(axis=None)


def test_each_error_has_its_own_grid() -> None:
    grids = pd.DataFrame({"unknowns": [1, 2, 3, 4], "error": [0.1, -0.005, 0.001, 0.0], "element": "paper"})
    found = grids_reaching(pd.concat([grids.assign(family="local"), grids.iloc[:2].assign(family="uniform")]))
    assert found["within"].tolist() == [0.01, 0.01, 0.002, 0.002]
    np.testing.assert_array_equal(found["unknowns"], [2, 2, 3, np.nan])
    np.testing.assert_array_equal(found["share"], [1, 1, np.nan, np.nan])
