"""Bricks against closed forms: volumes, shape functions, and forces that keep their work."""

from __future__ import annotations

from itertools import product

import numpy as np
import pytest

from formulations.geometry.surfaces import Plate, Surface, cylinder, torus
from formulations.section.laminate import Laminate, Ply
from formulations.solid_mesh import CUBE, SolidMesh
from studies.exchange.problem import CENTRE, INNER, OUTER, PLACES, RING, Bricks, serendipity

H, QUARTER = 2.0, np.pi / 2
R, TUBE = 10.0, 4.0


def bricks_over(surface: Surface, a1: float, a2: float, n: int = 6, *, periodic: bool = False) -> Bricks:
    plies = tuple(Ply.isotropic(1.0, 0.3, share * H) for share in (0.25, 0.75))
    lines = np.linspace(0.0, a1, n + 1), np.linspace(0.0, a2, n + 1)
    return Bricks.of(SolidMesh.build(surface, *lines, Laminate(plies, -H / 2), periodic=periodic))


@pytest.fixture(scope="module")
def plate() -> Bricks:
    return bricks_over(Plate(), 3.0, 5.0)


@pytest.fixture(scope="module")
def tube() -> Bricks:
    return bricks_over(cylinder(R), 3.0, QUARTER)


def volume_of(bricks: Bricks) -> float:
    """By 27 Gauss points of shape functions that are found from their 20 monomials, r^a s^b t^c."""
    powers = np.array([p for p in product(range(3), repeat=3) if sum(each for each in p if each > 1) <= 2])
    assert len(powers) == 20
    coefficients = np.linalg.inv(np.prod((PLACES - 1.0)[:, None, :] ** powers, axis=-1))  # (monomial, node)
    at = 2 * CUBE.points - 1
    slopes = []
    for i in range(3):
        less = np.maximum(powers - np.eye(3, dtype=int)[i], 0)
        slopes.append(powers[:, i] * np.prod(at[:, None, :] ** less, axis=-1) @ coefficients)
    jacobian = np.einsum("dgn,enx->egdx", np.stack(slopes), bricks.x[bricks.elements])
    return float(8 * np.sum(np.linalg.det(jacobian) @ CUBE.weights))


def test_bodies_are_of_whole_bricks_in_the_order_of_abaqus(plate: Bricks, tube: Bricks) -> None:
    """No brick is inside out, no node is left over, and edges below, above and between have theirs in the middle."""
    # Pappus: the section of area 2 pi r h goes around with its centre on the circle of radius R
    ring = bricks_over(torus(R, TUBE), 2 * np.pi, 2 * np.pi, 16, periodic=True), 4 * np.pi**2 * R * TUBE * H, 1e-3
    edges = [*((i, (i + 1) % 4) for i in range(4)), *((4 + i, 4 + (i + 1) % 4) for i in range(4))]
    edges += [(i, 4 + i) for i in range(4)]
    for bricks, volume, within in ((plate, 15.0 * H, 1e-12), (tube, 3.0 * QUARTER * R * H, 1e-4), ring):
        assert volume_of(bricks) == pytest.approx(volume, rel=within)
        np.testing.assert_array_equal(np.unique(bricks.elements), np.arange(len(bricks.x)))
        assert all(len(set(element)) == 20 for element in bricks.elements)
        np.testing.assert_array_equal(bricks.mesh.x[bricks.of_mesh >= 0], bricks.x)
        x = bricks.x[bricks.elements]
        for middle, (a, b) in enumerate(edges, 8):
            off = np.linalg.norm(x[:, middle] - 0.5 * (x[:, a] + x[:, b]), axis=-1)
            assert np.all(off < 0.2 * np.linalg.norm(x[:, b] - x[:, a], axis=-1))
        for face, level, ply in ((INNER, -H / 2, 0), (OUTER, H / 2, 1)):
            nodes = bricks.face_nodes(face)
            np.testing.assert_allclose(bricks.parameter[nodes, 2], level)
            assert len(nodes) == np.sum(np.isclose(bricks.parameter[:, 2], level))
            assert set(bricks.ply[bricks.on(face)]) == {ply}


def test_axes_turn_by_the_angle_between_centre_and_gauss_point(plate: Bricks, tube: Bricks) -> None:
    assert plate.turning == pytest.approx(0, abs=1e-7)
    half, farthest = QUARTER / 6 / 2, np.sqrt(0.6)
    assert tube.turning == pytest.approx(farthest * half, rel=1e-9)


def test_shape_functions_are_one_at_their_node_and_hold_quadratics(rng: np.random.Generator) -> None:
    nodes = np.array([(-1, -1), (1, -1), (1, 1), (-1, 1), (0, -1), (1, 0), (0, 1), (-1, 0)], float)
    np.testing.assert_allclose(serendipity(*nodes.T), np.eye(8), atol=1e-15)
    s, t = rng.uniform(-1, 1, (2, 20))

    def field(s: np.ndarray, t: np.ndarray) -> np.ndarray:
        return 1 + 2 * s - t + 3 * s * t + s**2 - 2 * t**2 + s**2 * t

    np.testing.assert_allclose(serendipity(s, t) @ field(*nodes.T), field(s, t), atol=1e-14)


def test_forces_without_centres_do_the_same_work(tube: Bricks, rng: np.random.Generator) -> None:
    """On every displacement that the bricks can have: that of a centre is what its face says."""
    mesh = tube.mesh
    faces = np.concatenate([mesh.inner, mesh.outer])
    forces = np.zeros_like(mesh.x)
    forces[np.unique(faces)] = rng.normal(size=(len(np.unique(faces)), 3))
    u = rng.normal(size=tube.x.shape)
    whole = np.zeros_like(mesh.x)
    whole[tube.of_mesh >= 0] = u
    whole[faces[:, 4]] = np.einsum("r,frx->fx", CENTRE, whole[faces[:, RING]])
    assert np.sum(tube.without_centres(forces) * u) == pytest.approx(np.sum(forces * whole), rel=1e-12)
    forces[mesh.elements[0, 13]] = 1.0
    with pytest.raises(ValueError, match="inside the body"):
        tube.without_centres(forces)
