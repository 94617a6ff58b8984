"""What is said of measures and contact algorithms, from sweeps made up here.

Powers of strains, errors and times whose law is known.

Factors of peers over shells from made-up tables.
"""

from __future__ import annotations

import math

import numpy as np
import pandas as pd
import pytest

from studies.analysis.outcomes import contact_summary, outcomes
from studies.analysis.powers import epsilon_laws, fitted_law, fitted_power
from studies.analysis.tyre import grids_reaching, reaching
from studies.analysis.uncertainty import peer_factors
from support.stores.convergence import cells

CONTACTS = {"semismooth": 1.0, "lcp": 0.5, "qp": 2.0}
NO_CURVES = pd.DataFrame(columns=["scene", "measure", "load", "error"])


@pytest.fixture(scope="module")
def contact() -> pd.DataFrame:
    """Three algorithms on two scenes; lcp fails on all but one mesh of the second, qp refuses one of the first."""
    table = pd.concat(
        [
            cells("strip-contact", "half_force", 2.0, "load_fraction=5", contacts=CONTACTS),
            cells("heavy-strip", "lift_force", 1.0, contacts=CONTACTS),
        ],
        ignore_index=True,
    ).assign(path_end="", reason="")
    table["c.operations"] *= 10
    lost = (table["scene"] == "heavy-strip") & (table["contact"] == "lcp") & (table["n1"] > 8)
    table.loc[lost, "outcome"] = "cap-hit"
    refused = (table["scene"] == "strip-contact") & (table["contact"] == "qp") & (table["n1"] == 8)
    table.loc[refused, ["outcome", "reason"]] = ["unsupported", "qp does not apply: no energy"]
    ended = (table["scene"] == "heavy-strip") & (table["contact"] == "qp") & (table["n1"] == 64)
    table.loc[ended, ["outcome", "path_end"]] = ["not-converged", "limit point"]
    return table


def test_what_became_of_each_problem(contact) -> None:
    table = outcomes(contact).set_index(["axis", "name", "scene"])
    assert set(table.index.get_level_values("axis")) == {"contact"}  # one measure alone is not a comparison
    counts = ["planned", "solved", "path_ends", "failed", "refused"]
    assert table.loc[("contact", "lcp", "heavy-strip"), counts].tolist() == [4, 1, 0, 3, 0]
    assert table.loc[("contact", "lcp", "heavy-strip"), "cause"] == "3 iteration limit"
    assert table.loc[("contact", "qp", ""), counts].tolist() == [8, 6, 0, 1, 1]
    assert table.loc[("contact", "qp", "strip-contact"), "cause"] == "1 no energy"


def test_a_path_that_another_algorithm_follows_to_its_load_is_a_failure(contact) -> None:
    """All but qp, whose path ends, have a state there; where none has one the path of the problem ends."""
    table = outcomes(contact).set_index(["axis", "name", "scene"])
    assert table.loc[("contact", "qp", "heavy-strip"), "cause"] == "1 limit point, which another passes"
    there = (contact["scene"] == "heavy-strip") & (contact["n1"] == 64)
    none = contact.assign(outcome=contact["outcome"].mask(there, "not-converged"))
    none["path_end"] = none["path_end"].mask(there, "limit point")
    table = outcomes(none).set_index(["axis", "name", "scene"])
    assert table.loc[("contact", "qp", "heavy-strip"), ["path_ends", "failed"]].tolist() == [1, 0]
    assert table.loc[("contact", "semismooth", "heavy-strip"), ["path_ends", "failed"]].tolist() == [1, 0]


def test_ratios_are_of_what_both_solve(contact) -> None:
    table = contact_summary(contact).set_index("algorithm")
    assert table.loc["lcp", ["both", "both_scenes"]].tolist() == [5, 2]
    assert table.loc["lcp", "seconds_ratio"] == pytest.approx(0.5)
    assert table.loc["lcp", "operations_ratio"] == pytest.approx(0.5)
    assert table.loc["qp", "solved_share"] == pytest.approx(6 / 7)
    assert table.loc["lcp", "causes"] == "3 iteration limit in heavy-strip"
    assert table.loc["qp", "refusals"] == "1 no energy"
    assert list(table.index)[-1] == "lcp", "the one that solves least is last"


def test_intervals_are_those_of_scenes_and_rest_on_five_problems(contact: pd.DataFrame) -> None:
    """Two scenes with ratios of their own: however many cells, the interval spans both."""
    strip = cells("strip-contact", "half_force", 2.0, "load_fraction=5", contacts={"semismooth": 1.0, "lcp": 0.5})
    heavy = cells("heavy-strip", "lift_force", 1.0, contacts={"semismooth": 1.0, "lcp": 4.0})
    actual = contact_summary(pd.concat([strip, heavy], ignore_index=True)).set_index("algorithm").loc["lcp"]
    assert actual[["seconds_low", "seconds_high"]].tolist() == pytest.approx([0.5, 4.0])
    few = contact[(contact["scene"] == "strip-contact") | (contact["contact"] != "lcp")]
    actual = contact_summary(few).set_index("algorithm").loc["lcp"]
    assert actual["both"] == 4
    assert math.isnan(actual["seconds_ratio"])


def test_of_equal_problems_the_one_that_is_solved_counts(contact) -> None:
    lost = contact[contact["contact"] == "semismooth"].assign(outcome="cap-hit")
    both = [outcomes(table) for table in (contact, pd.concat([lost, contact], ignore_index=True))]
    own = [actual[actual["name"] == "semismooth"]["solved"].tolist() for actual in both]
    assert own[0] == own[1]


AMOUNTS = [0.2, 0.1, 0.05]


def test_power_of_a_strain_with_a_higher_term() -> None:
    for rate, coefficient in ((1, 0.3), (2, -0.5), (4, -0.125)):
        actual = fitted_power(AMOUNTS, [coefficient * a**rate * (1 - a**2 / 3) for a in AMOUNTS])
        assert actual == (pytest.approx(rate, abs=0.01), pytest.approx(coefficient, rel=1e-5))
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
    (actual,) = epsilon_laws(pd.concat(study)).to_dict("records")
    stiff = 510.45 / 4.8
    assert actual["wall"] == pytest.approx(stiff)
    assert actual["force_slope"] == pytest.approx(-1, abs=1e-9)
    assert actual["error_at_wall"] == pytest.approx(2e-3 / stiff)
    assert actual["growth_at_wall"] == pytest.approx(stiff / 100)
    assert actual["growth_at_ten"] == pytest.approx(stiff / 10)
    assert actual["fails_at"] == pytest.approx(1e6 / stiff)
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
    actual = grids_reaching(table.assign(element="paper")).set_index(["within", "family"])
    assert list(actual.loc[0.01, "unknowns"]) == [4, 2]
    assert actual.loc[(0.01, "adapted"), "share"] == 0.5
    assert actual.loc[0.002, ["mesh", "unknowns", "error", "share"]].isna().all(axis=None)


def test_each_error_has_its_own_grid() -> None:
    errors = [0.1, -0.005, 0.001, 0.0, 0.0]
    grids = pd.DataFrame({"unknowns": range(1, 6), "error": errors, "element": "paper"})
    coarse = pd.concat([grids.iloc[:2], grids.iloc[1:2].assign(unknowns=3), grids.iloc[1:2].assign(unknowns=4)])
    actual = grids_reaching(pd.concat([grids.assign(family="local"), coarse.assign(family="uniform")]))
    assert actual["within"].tolist() == [0.01, 0.01, 0.002, 0.002]
    np.testing.assert_array_equal(actual["unknowns"], [2, 2, 3, np.nan])
    np.testing.assert_array_equal(actual["share"], [1, 1, np.nan, np.nan])


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
    actual = peer_factors(made_up([0.0, 0.02, -0.01, 0.001], [0.02, 0.001]))
    assert (row(actual, "footprint")["mesh"], row(actual, "peer")["mesh"]) == ("3x3", "2x2")
    assert row(actual, "peer")["factor"] == pytest.approx(120 / 3)
    assert row(actual, "peer")["bare"] == pytest.approx(120 / 0.3)
    assert row(actual, "peer")["apart"] == pytest.approx(0.0)


def test_a_line_that_does_not_stay_within_has_no_sufficient_mesh() -> None:
    for errors in ([0.0, 0.02], [math.nan, math.nan], [0.0, math.nan]):
        actual = peer_factors(made_up(errors, [0.001]))
        assert row(actual, "footprint")["mesh"] == ""
        assert pd.isna(row(actual, "peer")["factor"])
        assert row(peer_factors(made_up([0.001], errors)), "peer")["mesh"] == ""


def test_the_cheapest_line_of_a_program_counts() -> None:
    table = made_up([0.0], [0.0])
    slower = table.assign(family="slower", seconds=3 * table["seconds"])
    actual = peer_factors(pd.concat([slower, table]))
    assert list(actual[actual["program"] == "peer"]["factor"]) == [180.0, 60.0]
