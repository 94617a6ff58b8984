"""A curved panel of angle plies pressed on a plane: quadrilaterals of any shape have the force of its own lines."""

from functools import cache

import pytest

from support.problems.solved import solved

KINDS = ("random", "trapezoid", "skew")


@cache
def force(mesh: str, kind: str = "", mu: str = "") -> float:
    """At 2 mm of travel [N], where the panel is flattened; on its own lines unless a kind of distortion is given."""
    moved = {"distort": "0.2", "distortion": kind} if kind else {"element": "refined"}
    return solved("pressed-panel", mesh, delta_mm="2", **moved, **({"mu": mu} if mu else {})).quantities["force_N"]


def test_moved_nodes_have_the_force_of_lines_of_curvature() -> None:
    assert force("24x24", "random") == pytest.approx(force("24x24"), rel=5e-3)


@pytest.mark.slow
@pytest.mark.parametrize(("mesh", "mu", "within"), [("64x64", "", 2e-4), ("32x32", "0.3", 2e-3)])
def test_the_limit_is_one_whatever_the_mesh(mesh: str, mu: str, within: float) -> None:
    for kind in KINDS:
        assert force(mesh, kind, mu) == pytest.approx(force(mesh, "", mu), rel=within)
