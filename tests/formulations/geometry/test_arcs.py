"""The middle of an edge with directors at its ends: circles, halves alike, any rotation, derivatives by differences."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from formulations.geometry.arcs import Arcs

H = 0.1


def arcs(x: np.ndarray) -> Arcs:
    return Arcs.between(x, H, np.broadcast_to(np.eye(12), (len(x), 12, 12)))


def middle(x: np.ndarray) -> np.ndarray:
    """(k, 2, 3)"""
    ends = x.reshape(-1, 2, 2, 3)
    return ends.mean(axis=1) + arcs(x).bow


def on_circle(angle: float, radius: float = 2.0) -> np.ndarray:
    """Both faces (6,) at an angle."""
    normal = np.array([np.sin(angle), 0.0, np.cos(angle)])
    return np.concatenate([(radius + d) * normal for d in (-H / 2, H / 2)])


def test_the_middle_of_a_circle_is_met_to_the_fourth_order() -> None:
    errors = []
    for angle in (0.2, 0.1):
        ends = np.concatenate([on_circle(-angle), on_circle(angle)])[None]
        errors.append(np.max(np.abs(middle(ends)[0].ravel() - on_circle(0.0))))
    assert np.log2(errors[0] / errors[1]) == pytest.approx(4, abs=0.1)


def test_both_halves_have_the_same_stretch_and_shear(rng) -> None:
    """To the first order of the director's turn: halves about the straight middle differ by that order."""
    moved, pattern = [], rng.normal(size=(1, 2, 3))
    for turn in (1e-3, 1e-4):
        v = turn * pattern
        ends = np.zeros((1, 2, 2, 3))
        ends[:, 1, :, 0], ends[:, :, 1, 2] = 1.0, H
        ends[:, :, 1] += H * v
        x_a = middle(ends.reshape(1, 12))[0]
        x_b, x_c = ends[0]
        d_a, d_b, d_c = (x[1] - x[0] for x in (x_a, x_b, x_c))
        differ = [(x_a[f] - x_b[f]) @ (d_a + d_b) - (x_c[f] - x_a[f]) @ (d_a + d_c) for f in (0, 1)]
        moved.append(np.max(np.abs(differ)) / (H * turn))
    assert moved[0] < 0.02
    assert moved[1] < 0.2 * moved[0]


def test_it_turns_with_its_ends(rng) -> None:
    x, turn = rng.normal(size=(3, 4, 3)), Rotation.from_rotvec([1.0, -0.3, 2.0]).as_matrix()
    np.testing.assert_allclose(middle((x @ turn.T + 1.0).reshape(3, 12)), middle(x.reshape(3, 12)) @ turn.T + 1.0)


def test_derivatives_by_differences(rng) -> None:
    x, v, dv = rng.normal(size=(3, 5, 12))
    edges, force, step = arcs(x), rng.normal(size=(5, 2, 3)), 1e-5
    np.testing.assert_allclose(edges.moved(v), middle(x + v) - middle(x), rtol=1e-10, atol=1e-10)
    edges = edges.through(rng.normal(size=(5, 2, 3)))
    by_difference = (edges.moved(v + step * dv) - edges.moved(v - step * dv)) / (2 * step)
    np.testing.assert_allclose(np.einsum("kfxn,kn->kfx", edges.slope(v), dv), by_difference, rtol=1e-6, atol=1e-6)
    change = (edges.slope(v + step * dv) - edges.slope(v - step * dv)) / (2 * step)
    found = np.einsum("kmn,kn->km", edges.curvature(v, force), dv)
    np.testing.assert_allclose(found, np.einsum("kfx,kfxn->kn", force, change), rtol=1e-6, atol=1e-6)


def test_a_middle_beside_the_arc_turns_with_its_ends(rng) -> None:
    x, offset, turn = rng.normal(size=(3, 12)), rng.normal(size=(3, 2, 3)), Rotation.from_rotvec([1.0, -0.3, 2.0])
    edges = arcs(x).through(offset)
    turned = turn.apply(x.reshape(-1, 3)).reshape(3, 12)
    expected = x.reshape(3, 2, 2, 3).mean(axis=1) + offset
    there = turn.apply(expected.reshape(-1, 3)).reshape(3, 2, 3)
    np.testing.assert_allclose(expected + edges.moved(turned - x), there, rtol=0, atol=1e-10)
