"""The reference problems with friction: each against what is known of it."""

from __future__ import annotations

import pytest

from studies.experiments.friction.greco import SLIPS, friction_table

FRICTION = -1405.3  # N/mm, on graded meshes of 9-node quadrilaterals, 64x64 and 96x96 alike


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
