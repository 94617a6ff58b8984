"""Rotations one after another: all is where it must be, and their order may not be exchanged."""

import math

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from studies.experiments.rotations import ANGLE, LENGTH, turned, turned_panel
from studies.experiments.specimens import Element

NOTHING = 1e-9  # Newton's iteration ends at forces of 1e-11 of those of strain 1


def test_rotations_are_those_of_scipy_and_may_not_be_exchanged() -> None:
    """About axes fixed in space, in the order Z, Y, X: lower case there."""
    angles = [ANGLE] * 3
    np.testing.assert_allclose(turned(3), Rotation.from_euler("zyx", angles).as_matrix(), atol=1e-15)
    other = Rotation.from_euler("xyz", angles).as_matrix()
    added = Rotation.from_rotvec(angles).as_matrix()
    for wrong in (other, added):
        assert np.abs(wrong - turned(3)).max() > 0.1


def misplaced(interpolation: str, n: int) -> float:
    """The largest distance of a node from where the rotations take it, over the panel's length."""
    panel, u = turned_panel(Element(interpolation, "balanced"), n)
    body = panel.discretisation
    x, frame = np.stack(body.positions()), body.surface.frame(*body.grid.nodes.T)
    moved = x + np.einsum("nij,nif->fnj", frame, panel.displacements(u).reshape(-1, 3, 2))
    return float(np.abs(moved - x @ turned(3).T).max() / LENGTH)


@pytest.mark.slow
def test_interpolated_positions_are_where_they_must_be_and_components_to_the_second_order() -> None:
    assert misplaced("isoparametric", 4) < NOTHING
    off = [misplaced("curvilinear", n) for n in (4, 8)]
    np.testing.assert_allclose(math.log2(off[0] / off[1]), 2, atol=0.2)
