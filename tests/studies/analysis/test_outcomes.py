"""What is said of measures and contact algorithms, from sweeps made up here."""

from __future__ import annotations

import math

import pandas as pd
import pytest

from studies.analysis.outcomes import contact_summary, outcomes
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
    found = outcomes(contact).set_index(["axis", "name", "scene"])
    assert set(found.index.get_level_values("axis")) == {"contact"}  # one measure alone is no comparison
    counts = ["planned", "solved", "path_ends", "failed", "refused"]
    assert found.loc[("contact", "lcp", "heavy-strip"), counts].tolist() == [4, 1, 0, 3, 0]
    assert found.loc[("contact", "lcp", "heavy-strip"), "cause"] == "3 iteration limit"
    assert found.loc[("contact", "qp", ""), counts].tolist() == [8, 6, 0, 1, 1]
    assert found.loc[("contact", "qp", "strip-contact"), "cause"] == "1 no energy"


def test_a_path_that_another_algorithm_follows_to_its_load_is_a_failure(contact) -> None:
    """All but qp, whose path ends, have a state there; where none has one the path of the problem ends."""
    found = outcomes(contact).set_index(["axis", "name", "scene"])
    assert found.loc[("contact", "qp", "heavy-strip"), "cause"] == "1 limit point, which another passes"
    there = (contact["scene"] == "heavy-strip") & (contact["n1"] == 64)
    none = contact.assign(outcome=contact["outcome"].mask(there, "not-converged"))
    none["path_end"] = none["path_end"].mask(there, "limit point")
    found = outcomes(none).set_index(["axis", "name", "scene"])
    assert found.loc[("contact", "qp", "heavy-strip"), ["path_ends", "failed"]].tolist() == [1, 0]
    assert found.loc[("contact", "semismooth", "heavy-strip"), ["path_ends", "failed"]].tolist() == [1, 0]


def test_ratios_are_of_what_both_solve(contact) -> None:
    found = contact_summary(contact).set_index("algorithm")
    assert found.loc["lcp", ["both", "both_scenes"]].tolist() == [5, 2]
    assert found.loc["lcp", "seconds_ratio"] == pytest.approx(0.5)
    assert found.loc["lcp", "operations_ratio"] == pytest.approx(0.5)
    assert found.loc["qp", "solved_share"] == pytest.approx(6 / 7)
    assert found.loc["lcp", "causes"] == "3 iteration limit in heavy-strip"
    assert found.loc["qp", "refusals"] == "1 no energy"
    assert list(found.index)[-1] == "lcp", "the one that solves least is last"


def test_intervals_are_those_of_scenes_and_rest_on_five_problems(contact: pd.DataFrame) -> None:
    """Two scenes with ratios of their own: however many cells, the interval spans both."""
    strip = cells("strip-contact", "half_force", 2.0, "load_fraction=5", contacts={"semismooth": 1.0, "lcp": 0.5})
    heavy = cells("heavy-strip", "lift_force", 1.0, contacts={"semismooth": 1.0, "lcp": 4.0})
    found = contact_summary(pd.concat([strip, heavy], ignore_index=True)).set_index("algorithm").loc["lcp"]
    assert found[["seconds_low", "seconds_high"]].tolist() == pytest.approx([0.5, 4.0])
    few = contact[(contact["scene"] == "strip-contact") | (contact["contact"] != "lcp")]
    found = contact_summary(few).set_index("algorithm").loc["lcp"]
    assert found["both"] == 4
    assert math.isnan(found["seconds_ratio"])


def test_of_equal_problems_the_one_that_is_solved_counts(contact) -> None:
    lost = contact[contact["contact"] == "semismooth"].assign(outcome="cap-hit")
    both = [outcomes(table) for table in (contact, pd.concat([lost, contact], ignore_index=True))]
    own = [found[found["name"] == "semismooth"]["solved"].tolist() for found in both]
    assert own[0] == own[1]
