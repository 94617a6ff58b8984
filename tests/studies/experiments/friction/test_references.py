"""The reference problems with friction: each against what is known of it."""

from __future__ import annotations

import math

import pytest

from contact.friction.problem import State
from studies.experiments.friction.bars import capstan_table, drum_table, strip_table
from studies.experiments.friction.greco import FRICTION, SLIPS, friction_table
from studies.experiments.friction.rigid_bodies import block, pushed_up


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
    assert block(math.radians(26.565), mu, 0.0).state[0] == state


@pytest.mark.slow
def test_the_dragged_strip() -> None:
    row = strip_table(meshes=(25,), steps=(1,)).iloc[0]
    assert row["converged"]
    assert abs(row["end"]) < 0.01
    assert abs(row["back"]) < 0.01
    assert abs(row["loop"]) < 0.01
    assert row["slip_mm"] == pytest.approx(40, abs=4)
    assert row["least_dissipation"] >= 0


@pytest.mark.slow
def test_partial_slip_on_the_drum() -> None:
    row = drum_table(meshes=(50,)).iloc[0]
    assert row["outcome"] == "converged"
    assert abs(row["error"]) < 1e-3
    assert row["slip_rad"] == pytest.approx(math.log(1.5) / 0.3, abs=0.04)


@pytest.mark.slow
def test_the_capstan() -> None:
    table = capstan_table(n=25)
    assert (table["outcome"] == "converged").all()
    assert (table["slipping"] == 26).all()
    assert (table["error"].abs() < 0.01).all()
