"""The reference problems with friction: each against what is known of it."""

from __future__ import annotations

import math

import pytest

from contact.coulomb import State
from studies.experiments.friction.closed_forms.rigid_bodies import block, pushed_up
from studies.experiments.friction.discrete.greco import FRICTION, SLIPS, friction_table


@pytest.mark.slow
@pytest.mark.parametrize("n", [16, 32])
def test_the_greco_plate_on_coarse_meshes(n: int) -> None:
    """What they give: 5e-4 of the slips, 5e-4 of the friction; the naive set cycles."""
    table = friction_table([n]).set_index("algorithm")
    assert set(table.index[table["outcome"] != "converged"]) == {"trial-and-error"}
    assert table.loc["trial-and-error", "outcome"] == "cycling"
    assert table.loc["semismooth", "error"] < 5e-4
    assert table.loc["semismooth", "friction_N"] == pytest.approx(FRICTION, rel=5e-4)


@pytest.mark.slow
def test_the_greco_plate_on_a_fine_mesh() -> None:
    table = friction_table([64]).set_index("algorithm")
    assert table.loc["trial-and-error", "outcome"] == "cycling"
    for place, slip in zip(("0", "1.25", "5", "7.5", "11.25"), SLIPS, strict=True):
        assert table.loc["semismooth", f"slip_{place}"] == pytest.approx(slip, rel=5e-4)
    assert table.loc["semismooth", "friction_N"] == pytest.approx(FRICTION, rel=1e-4)


def test_the_wedge_slides_at_the_limit_of_the_rigid_one() -> None:
    assert pushed_up() == pytest.approx(0.412371, abs=5e-7)


@pytest.mark.parametrize(("mu", "state"), [(0.49, State.SLIP), (0.5, State.STICK)])
def test_the_block_on_the_slope(mu: float, state: State) -> None:
    assert block(math.radians(26.565), mu, 0.0).rubbed.state[0] == state
