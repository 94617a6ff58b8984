"""Candidates in planes of symmetry that no facet is at right angles to: they slide in the plane, and over its edge."""

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy import sparse

from contact.faces.pair import Pair
from contact.faces.patches import shape
from contact.faces.rubbing import Rubbing
from contact.faces.sampling import at_nodes
from contact.faces.symmetry import ends_in_planes

WEDGE, RADIUS = math.radians(40.0), 2.0
ROUNDING = 1e-13
LEVELS = 3  # points along each line of both


def wedge(above: float, *, held: bool = True) -> tuple[Pair, np.ndarray]:
    """A facet pair of a cylinder about z, master inside, slave ``above`` it, between the planes of angles 0 and WEDGE.

    With the normals (6, 3) of the planes of the slave's points. Not held, every coordinate is an unknown.
    """
    angles = np.repeat([0.0, WEDGE], LEVELS)
    out = np.column_stack([np.cos(angles), np.sin(angles), np.zeros_like(angles)])
    normals = np.column_stack([-np.sin(angles), np.cos(angles), np.zeros_like(angles)])
    z = np.tile(np.arange(LEVELS, dtype=float), 2)[:, None] * [0.0, 0.0, 1.0]
    slave, master = (RADIUS + above) * out + 0.9 * z + [0.0, 0.0, 0.1], RADIUS * out + z
    x, count = np.vstack([slave, master]), len(angles)
    along_z = np.tile([0.0, 0.0, 1.0], (count, 1))
    ways = np.stack([out, along_z], axis=2) if held else np.tile(np.eye(3), (count, 1, 1))
    operator = sparse.block_diag([*ways, *ways], format="csr")
    low = count + np.arange(LEVELS - 1)
    patches = np.column_stack([low, low + LEVELS, low + LEVELS + 1, low + 1])
    return Pair(x, sparse.csr_matrix(operator), patches, at_nodes(np.arange(count), 2 * count, np.ones(count))), normals


def anchored(pair: Pair, anchors: np.ndarray) -> np.ndarray:
    """Where the anchors (m, 3) are at rest."""
    N = shape(anchors[:, 1:])[0]
    return np.einsum("ml,mlc->mc", N, pair.reference[pair.master[anchors[:, 0].astype(int)]])


@pytest.mark.parametrize("above", [-0.05, 0.05])
def test_anchors_of_candidates_in_a_plane_are_in_it(above: float) -> None:
    """Feet on the facet are not: they are off by the height over it, above cos(a), times sin(a), a half the wedge."""
    pair, normals = wedge(above)
    off = np.einsum("mc,mc->m", anchored(pair, Rubbing.at_rest(pair).anchors), normals)
    np.testing.assert_allclose(off, 0.0, atol=ROUNDING)
    free, _ = wedge(above, held=False)
    beside = np.abs(np.einsum("mc,mc->m", anchored(free, Rubbing.at_rest(free).anchors), normals))
    np.testing.assert_allclose(beside, abs(above) * math.cos(WEDGE / 2) * math.sin(WEDGE / 2), rtol=1e-9)


def test_they_slip_in_the_plane_alone() -> None:
    """By what they move along it against the anchor; nothing in the other way, whatever both bodies do."""
    pair, _ = wedge(0.05)
    slip = Rubbing.at_rest(pair)
    u = 0.1 * np.random.default_rng(0).normal(size=pair.operator.shape[1])
    s, S = slip(u), slip.jacobian(u).toarray().reshape(len(slip.nodes), 2, -1)
    assert np.all(s[:, 1] == 0)
    assert np.all(S[:, 1] == 0)
    assert np.all(np.any(S[:, 0] != 0, axis=1))
    u = np.zeros_like(u)
    u[1 : 2 * len(slip.nodes) : 2] = 0.2  # of the slave along the axis
    np.testing.assert_allclose(np.abs(slip(u)[:, 0]), 0.2, rtol=1e-12)


def test_edges_are_those_in_the_same_plane() -> None:
    """Not the one in the other plane, nor any that may leave it, nor one that is beside it."""
    pair, _ = wedge(0.05)
    corners = np.tile(pair.master[0], (2 * LEVELS, 1))
    which, ends = ends_in_planes(pair.nodes, pair.reference, pair.operator, corners)
    assert which.tolist() == list(range(2 * LEVELS))
    assert ends.tolist() == [[0, 3]] * LEVELS + [[1, 2]] * LEVELS
    free, _ = wedge(0.05, held=False)
    assert not len(ends_in_planes(free.nodes, free.reference, free.operator, corners)[0])
    x = pair.reference.copy()
    x[pair.nodes] += [0.0, 1e-3, 0.0]
    assert not len(ends_in_planes(pair.nodes, x, pair.operator, corners)[0])


def test_where_two_planes_cross_the_anchor_is_the_corner_there() -> None:
    """The lower rims of both held along the axis, too: their candidates have no slip at all."""
    pair, _ = wedge(0.05)
    low = np.arange(0, 4 * LEVELS, LEVELS)
    kept = sparse.diags_array(np.where(np.isin(np.arange(8 * LEVELS), 2 * low + 1), 0.0, 1.0))
    reference = pair.reference.copy()
    reference[low, 2] = 0.0
    held = replace(pair, reference=reference, operator=sparse.csr_matrix(pair.operator @ kept))
    slip = Rubbing.at_rest(held)
    rims = low[:2]
    np.testing.assert_array_equal(slip.anchors[rims], [[0, -1, -1], [0, 1, -1]])
    u = 0.1 * np.random.default_rng(1).normal(size=held.operator.shape[1])
    assert np.all(slip(u)[rims] == 0)
    assert slip(u)[1, 0] != 0
