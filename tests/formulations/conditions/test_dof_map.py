"""Supports: the signed map of held and hinged displacements, alone and in a shell."""

import numpy as np
import pytest

from formulations.conditions.dof_map import DofMap, Images
from support.problems.shells import make_shell

ROUNDING = 1e-12  # relative


def random_supports(rng: np.random.Generator, nodes: int) -> tuple[np.ndarray, np.ndarray]:
    """Held displacements (N, 6) and, where none of the pair is held, hinges (N, 3)."""
    fixed = rng.random((nodes, 6)) < 0.2
    hinged = (rng.random((nodes, 3)) < 0.4) & ~(fixed[:, 0::2] | fixed[:, 1::2])
    return fixed, hinged


def test_held_hinged_and_free_displacements(rng) -> None:
    fixed, hinged = random_supports(rng, 15)
    supports = DofMap.build(fixed, hinged)
    assert supports.n == np.sum(~fixed) - hinged.sum()
    v = supports.expand(rng.uniform(0.5, 1.0, supports.n))
    assert np.all((v == 0) == fixed)
    np.testing.assert_array_equal((v[:, 0::2] + v[:, 1::2])[hinged], 0.0)
    assert np.all((v < 0).reshape(-1, 3, 2)[..., 1] == hinged)  # nothing but the outer face of a hinge is turned round


def test_forces_go_the_way_of_the_transpose(rng) -> None:
    """Equal work: f . (T u) = (T^T f) . u, and the sparse matrix is the same T."""
    supports = DofMap.build(*random_supports(rng, 15))
    u, f = rng.normal(size=supports.n), rng.normal(size=(15, 6))
    T = supports.matrix().toarray()
    np.testing.assert_allclose(supports.expand(u).ravel(), T @ u, rtol=0, atol=ROUNDING)
    np.testing.assert_allclose(supports.gather(f), T.T @ f.ravel(), rtol=0, atol=ROUNDING)


def test_no_hinge_no_sign(rng) -> None:
    fixed, hinged = random_supports(rng, 8)
    assert np.all(DofMap.build(fixed).sign >= 0)
    assert np.any(DofMap.build(fixed, hinged).sign < 0)
    free = DofMap.build(fixed)
    np.testing.assert_array_equal(free.number.reshape(fixed.shape)[~fixed], np.arange(free.n))


def test_impossible_supports_are_refused() -> None:
    fixed, hinged = np.zeros((3, 6), bool), np.zeros((3, 3), bool)
    fixed[1, 3] = hinged[1, 1] = True
    with pytest.raises(ValueError, match="component 2 is hinged and held at the same node"):
        DofMap.build(fixed, hinged)
    with pytest.raises(ValueError, match="every displacement is held"):
        DofMap.build(np.ones((3, 6), bool))
    chain = Images(np.array([0, 1]), np.array([1, 2]), np.ones((2, 3)))
    with pytest.raises(ValueError, match="an image follows an image"):
        DofMap.build(np.zeros((3, 6), bool), images=chain)


def test_a_hinged_shell_is_the_loose_shell_on_the_map(curved_patch, rng) -> None:
    """Residual T^T r(T u) and tangent T^T K(T u) T, through the sparse pattern with its signs."""
    grid = curved_patch.grid(3, 2)
    fixed, hinged = random_supports(rng, grid.n_nodes)
    held = make_shell(curved_patch.surface, grid, fixed=fixed, hinged=hinged)
    T = DofMap.build(fixed, hinged).matrix()
    u = 0.1 * rng.normal(size=held.discretisation.n_free)
    some, everything = held.linearise(u), make_shell(curved_patch.surface, grid).linearise(T @ u)
    np.testing.assert_allclose(some.residual, T.T @ everything.residual, rtol=0, atol=ROUNDING * everything.scale)
    difference = abs(some.tangent - T.T @ everything.tangent @ T).max()
    assert difference <= ROUNDING * abs(everything.tangent).max()
    forces = rng.normal(size=(grid.n_nodes, 6))
    np.testing.assert_allclose(held.discretisation.reduce(forces), T.T @ forces.ravel(), rtol=0, atol=ROUNDING)
    nodes = np.arange(grid.n_nodes)
    for face, x in enumerate(held.discretisation.cartesian(u)):
        operator = held.discretisation.displacement_operator(nodes, face)
        np.testing.assert_allclose((operator @ u).reshape(-1, 3), x, rtol=0, atol=ROUNDING)
