"""The middle of an edge with directors at its ends: circles, halves alike, any rotation, derivatives by differences.

The order of elimination: every node once, separators that separate, and less fill than a minimum degree's.
"""

from itertools import pairwise

import numpy as np
import pytest
from scipy import sparse
from scipy.sparse.linalg import splu
from scipy.spatial.transform import Rotation

from contact.problem import ContactSolution
from contact.solvers.sparse import checked_solve, factorise
from formulations.conditions.dof_map import DofMap, Images
from formulations.geometry.arcs import Arcs
from formulations.geometry.nested_dissection import dissection
from studies.scenes.complete import complete as resolve
from studies.scenes.tyre.model import TyreModel
from studies.scenes.tyre.scene import Tyre
from support.problems.shells import make_shell

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
    actual = np.einsum("kmn,kn->km", edges.curvature(v, force), dv)
    np.testing.assert_allclose(actual, np.einsum("kfx,kfxn->kn", force, change), rtol=1e-6, atol=1e-6)


def test_a_middle_beside_the_arc_turns_with_its_ends(rng) -> None:
    x, offset, turn = rng.normal(size=(3, 12)), rng.normal(size=(3, 2, 3)), Rotation.from_rotvec([1.0, -0.3, 2.0])
    edges = arcs(x).through(offset)
    turned = turn.apply(x.reshape(-1, 3)).reshape(3, 12)
    expected = x.reshape(3, 2, 2, 3).mean(axis=1) + offset
    there = turn.apply(expected.reshape(-1, 3)).reshape(3, 2, 3)
    np.testing.assert_allclose(expected + edges.moved(turned - x), there, rtol=0, atol=1e-10)


ROUNDING = 1e-9  # relative: what another order of elimination leaves of a solution
MOST_FILL = 1.15  # of minimum degree's, where the two are close


def built(mesh: str, model: str) -> TyreModel:
    _, request = resolve("tyre", {"element": "paper", "delta_mm": "20"}, mesh, model=model)
    return Tyre().build(request)


def tangent(model: TyreModel) -> sparse.csc_matrix:
    return model.shell.linearise(np.zeros(model.n_unknowns)).tangent


def fill(A: sparse.csc_matrix, order: str) -> int:
    return int(splu(A, permc_spec=order, diag_pivot_thresh=1e-3, options={"SymmetricMode": True}).nnz)


@pytest.mark.parametrize("periodic", [False, True])
def test_every_node_is_eliminated_once(periodic) -> None:
    for n1, n2 in ((1, 1), (1, 7), (9, 2), (2, 2), (3, 3), (17, 6), (12, 31)):
        last = np.array([0, n1 * n2 - 1])
        for kept in (None, last):
            order = dissection((n1, n2), periodic=periodic, last=kept)
            np.testing.assert_array_equal(np.sort(order), np.arange(n1 * n2))
        assert np.isin(last, order[-len(np.union1d(last, np.arange(n1) * n2 if periodic else last)) :]).all()


def neighbours(n: int) -> sparse.csr_matrix:
    """Lines of a grid that share an element."""
    return sparse.diags_array([1.0, 1.0, 1.0], offsets=[-1, 0, 1], shape=(n, n), format="csr")


def test_the_last_line_separates_what_comes_before_it() -> None:
    """Without the middle line the graph of elements falls into two halves, numbered one after the other."""
    shape = (15, 9)
    order = dissection(shape)
    graph = sparse.kron(neighbours(shape[0]), neighbours(shape[1]), format="csr")[order][:, order]
    half = 7 * 9
    np.testing.assert_array_equal(order[2 * half :], 7 * 9 + np.arange(9))
    assert graph[:half, half : 2 * half].nnz == 0


def test_unknowns_follow_the_nodes(rng) -> None:
    """Numbered node by node in the given order, images and held ones left out; the map stays the same map."""
    fixed = rng.random((12, 6)) < 0.2
    images = Images(np.array([3, 7]), np.array([5, 0]), np.ones((2, 3)))
    order = rng.permutation(12)
    plain, ordered = DofMap.build(fixed, images=images), DofMap.build(fixed, images=images, order=order)
    first = ordered.number.reshape(-1, 6).max(axis=1)
    for before, after in pairwise(node for node in order if node not in images.nodes and first[node] >= 0):
        assert first[before] < first[after]
    full = plain.expand(rng.normal(size=plain.n))
    np.testing.assert_array_equal(ordered.expand(ordered.restrict(full)), full)
    np.testing.assert_array_equal(images.followed, [0, 5])


@pytest.mark.parametrize("model", ["full", "half"])
def test_fill_at_the_default_mesh_is_close_to_minimum_degree(model) -> None:
    K = tangent(built("42x40", model))
    assert fill(K, "NATURAL") <= MOST_FILL * fill(K, "MMD_AT_PLUS_A")


@pytest.mark.slow
def test_fill_on_a_fine_mesh_is_less_than_minimum_degree() -> None:
    K = tangent(built("168x160", "full"))
    assert fill(K, "NATURAL") < fill(K, "MMD_AT_PLUS_A")


def test_the_order_does_not_change_the_solution(rng) -> None:
    K = tangent(built("18x16", "half"))
    b = rng.normal(size=K.shape[0])
    kept, actual = (checked_solve(factorise(K, ordered=ordered), K, b) for ordered in (True, False))
    np.testing.assert_allclose(kept, actual, rtol=0, atol=ROUNDING * np.abs(actual).max())


def test_a_part_with_images_fills_no_more_than_a_ring() -> None:
    """Nodes that others follow are cut out; left where they are, they tie the two halves together."""
    model = built("42x40", "half")
    grid, images = model.part.grid, model.part.images
    assert images is not None
    K = tangent(model)
    fixed = np.zeros((grid.n_nodes, 6), bool)
    fixed[[*range(grid.node_shape[1]), *range(grid.n_nodes - grid.node_shape[1], grid.n_nodes)]] = True
    blind = DofMap.build(fixed, images=images, order=dissection(grid.node_shape))
    order = np.empty(blind.n, int)
    known = model.shell.discretisation.map.number
    order[blind.number[known >= 0]] = known[known >= 0]
    assert fill(K, "NATURAL") < fill(sparse.csc_matrix(K[order][:, order]), "NATURAL")


def test_scenes_are_ordered_and_tell_their_problems(curved_patch) -> None:
    model = built("12x12", "half")
    column, _, press = model.stages()
    assert model.shell.ordered
    assert column.begin(None)[0](1.0).ordered
    assert press.begin(ContactSolution.at_rest(model.n_unknowns, 0))[0](1.0).ordered
    assert not make_shell(curved_patch.surface, curved_patch.grid(2, 2)).ordered
