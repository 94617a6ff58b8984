"""Surfaces: the closed forms against numerical differentiation of position and frame (all of them: see _catalogue)."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from support.problems.differences import central_difference

STEP = 0.015  # of the 8th-order differences: truncation and rounding both below 1e-12 where lengths are about 1
DERIVATIVE = 1e-11  # numerical against closed derivatives, all lengths are about 1
ORTHONORMAL = 1e-14


def along(patch, rng, quantity: Callable, direction: int) -> np.ndarray:
    """Derivative by a_direction of quantity(a1, a2) at random points."""
    shift = np.eye(2)[direction]
    a1, a2 = patch.points(rng, 7)
    return central_difference(lambda t: quantity(a1 + t * shift[0], a2 + t * shift[1]), STEP), a1, a2


@pytest.mark.parametrize("direction", [0, 1])
def test_lame_parameters_and_tangents_are_the_derivative_of_position(patch, rng, direction) -> None:
    slope, a1, a2 = along(patch, rng, patch.surface.position, direction)
    geometry, frame = patch.surface.geometry(a1, a2), patch.surface.frame(a1, a2)
    np.testing.assert_allclose(slope, geometry.A[:, [direction]] * frame[:, direction], rtol=0, atol=DERIVATIVE)


@pytest.mark.parametrize("direction", [0, 1])
def test_curvatures_are_the_derivative_of_the_normal(patch, rng, direction) -> None:
    """de3/(A_a da_a) = k_a e_a: the vector equation also says that the coordinates are principal."""
    slope, a1, a2 = along(patch, rng, lambda *a: patch.surface.frame(*a)[:, 2], direction)
    geometry, frame = patch.surface.geometry(a1, a2), patch.surface.frame(a1, a2)
    expected = (geometry.A * geometry.k)[:, [direction]] * frame[:, direction]
    np.testing.assert_allclose(slope, expected, rtol=0, atol=DERIVATIVE)


@pytest.mark.parametrize("direction", [0, 1])
def test_B_is_the_derivative_of_the_other_lame_parameter(patch, rng, direction) -> None:
    slope, a1, a2 = along(patch, rng, lambda *a: patch.surface.geometry(*a).A, direction)
    geometry = patch.surface.geometry(a1, a2)
    expected = slope[:, 1 - direction] / geometry.A.prod(axis=-1)
    np.testing.assert_allclose(geometry.B[:, direction], expected, rtol=0, atol=DERIVATIVE)


def test_frame_is_orthonormal_and_points_outwards(patch, rng) -> None:
    a1, a2 = patch.points(rng, 20)
    frame = patch.surface.frame(a1, a2)
    product = np.einsum("...ik,...jk->...ij", frame, frame)
    np.testing.assert_allclose(product, np.broadcast_to(np.eye(3), product.shape), rtol=0, atol=ORTHONORMAL)
    assert np.all(np.sum(patch.outwards(patch.surface.position(a1, a2)) * frame[:, 2], axis=-1) > 0)


def test_scalars_and_arrays_broadcast(patch) -> None:
    """One a1 against many a2 gives the points of the grid line."""
    a1, a2 = patch.low[0], np.linspace(patch.low[1], patch.high[1], 4)
    for f in (patch.surface.position, patch.surface.frame, lambda *a: patch.surface.geometry(*a).k):
        one_by_one = np.stack([f(np.array(a1), a) for a in a2])
        np.testing.assert_allclose(f(np.array(a1), a2), one_by_one, rtol=0, atol=ORTHONORMAL)
