"""Surfaces inside the wall on any quadrilaterals: rigid motions, patches in three dimensions, derivatives."""

from itertools import product

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from formulations.discretisation import Discretisation
from formulations.geometry.grid import DISTORTIONS, Grid, distorted
from formulations.geometry.surfaces import Plate, Surface, cylinder, sphere, torus
from formulations.loads import Pressure
from formulations.section.laminate import Laminate, Ply
from formulations.shell import ShellModel
from formulations.strains.catalogue import MEASURES
from support.problems.differences import difference_order
from support.problems.shells import QUADRILATERALS, everywhere, quadrilateral

SKEW = Ply(1000.0, 500.0, 200.0, 150.0, 0.3, 0.25, 0.4, 0.07)
WALL = Laminate((SKEW, Ply.isotropic(700.0, 0.3, 0.05)), -0.05)
RUBBER = Laminate((Ply.isotropic(3.0, 0.4, 0.1), Ply.isotropic(1.0, 0.49, 0.08)), -0.05)
PIECES: dict[str, tuple[Surface, tuple[float, float], tuple[float, float]]] = {
    "plate": (Plate(), (0.0, 1.0), (0.0, 1.3)),
    "cylinder": (cylinder(2.0), (0.0, 1.0), (0.0, 0.6)),
    "torus": (torus(3.0, 1.0), (0.2, 1.0), (0.0, 0.5)),
    "sphere": (sphere(2.0), (0.1, 0.7), (0.0, 0.6)),
}
RELAXED = {"thickness_strain": "balanced", "membrane": "relaxed"}
of_walls = pytest.mark.parametrize("surfaces", ["3", "2/ply"])


def quads(piece: str, surfaces: str, distortion: str = "random", n: int = 3, wall: Laminate = WALL) -> Discretisation:
    """A free piece of a surface on n x (n + 1) quadrilaterals."""
    surface, a1, a2 = PIECES[piece]
    grid = distorted(Grid.tensor(np.linspace(*a1, n + 1), np.linspace(*a2, n + 2)), distortion, 0.25)
    free = np.zeros((grid.n_nodes, 6), bool)
    return Discretisation.build(surface, grid, wall, free, interpolation="quads", surfaces=surfaces)


@of_walls
@pytest.mark.parametrize(("piece", "distortion"), list(product(PIECES, DISTORTIONS)))
def test_an_exact_measure_meets_rigid_motions(surfaces, piece, distortion) -> None:
    body, turn = quads(piece, surfaces, distortion), Rotation.from_rotvec([0.5, -0.9, 1.1]).as_matrix()
    u = everywhere(body, lambda x: np.array([1.0, 2.0, 3.0]) + x @ turn.T - x)
    small = everywhere(body, lambda x: np.array([1.0, 2.0, 3.0]) + np.cross([0.3, -0.2, 0.5], x))
    for options in (RELAXED, {"thickness_strain": "nodal"}, {}):
        for name in ("exact", "elongation"):
            assert np.abs(ShellModel(body, MEASURES[name], **options).mode_strains(u)).max() < 1e-11
        assert np.abs(ShellModel(body, MEASURES["linear"], **options).mode_strains(small)).max() < 1e-11


@of_walls
@pytest.mark.parametrize("distortion", DISTORTIONS)
def test_a_uniform_state_has_the_strains_of_the_formulas(rng, surfaces, distortion) -> None:
    """Of every measure, in the axes of the laminate, at both faces of a plate."""
    body, G = quads("plate", surfaces, distortion), 0.2 * rng.normal(size=(3, 3))
    u = everywhere(body, lambda x: x @ G.T)
    q = np.append(np.repeat([G[0, 0], G[1, 0], -G[2, 0], G[1, 1], G[0, 1], -G[2, 1]], 2), G[:, 2])
    for name, measure in MEASURES.items():
        expected = np.broadcast_to(measure.strain(q), (len(body.grid.elements), 4, 11))
        actual = ShellModel(body, measure).gauss_strains(u)
        np.testing.assert_allclose(actual, expected, atol=1e-12, err_msg=name)


@of_walls
@pytest.mark.parametrize("measure", MEASURES)
def test_the_tangent_is_the_derivative_of_the_residual(rng, measure, surfaces) -> None:
    options = {**RELAXED, "pressure": Pressure(3.0, follower=True), "initial": 0.1 * np.arange(11.0)}
    shell = ShellModel(quads("torus", surfaces, n=2), MEASURES[measure], newton="plain", **options)
    u, du = 0.003 * rng.normal(size=(2, shell.discretisation.n_free))
    assert difference_order(shell, u, du) >= 1.9


def test_the_tangent_of_a_law_at_points(rng) -> None:
    body = quads("torus", "3", n=2, wall=RUBBER)
    shell = ShellModel(body, MEASURES["exact"], law="neo-hooke", newton="plain", **RELAXED)
    u, du = 0.003 * rng.normal(size=(2, body.n_free))
    assert difference_order(shell, u, du) >= 1.9


@pytest.mark.parametrize("place", range(6))
@pytest.mark.parametrize("membrane", ["compatible", "relaxed"])
def test_patches_of_membrane_and_bending(place, membrane) -> None:
    """A plate of one skew ply, free of stress across the wall: no force is left on the nodes inside."""
    strain, curvature = np.eye(6)[place].reshape(2, 3)
    body = quads("plate", "3", n=4, wall=Laminate.single(SKEW))
    b = SKEW.stiffness()
    through = -b[3, :3] / b[3, 3]

    def field(x: np.ndarray) -> np.ndarray:
        (x1, x2, z), (e, k) = np.moveaxis(x, -1, 0), (strain, curvature)
        e1, e2, e12 = (e[i] - z * k[i] for i in range(3))
        w = 0.5 * (k[0] * x1**2 + k[1] * x2**2 + k[2] * x1 * x2)
        return np.stack(
            [e1 * x1 + e12 * x2 / 2, e2 * x2 + e12 * x1 / 2, w + z * (through @ e) - z**2 / 2 * (through @ k)], -1
        )

    residual = ShellModel(body, MEASURES["linear"], membrane=membrane).residual(everywhere(body, field))
    force = body.map.everywhere(residual)
    faces, within = force[: body.map.n_faces].reshape(-1, 6), force[body.map.n_faces :].reshape(-1, 3)
    edge = np.concatenate([body.grid.on_line(axis, end) for axis in (0, 1) for end in body.grid.ends[axis]])
    inside = np.setdiff1d(np.arange(body.grid.n_nodes), edge)
    size = np.abs(force).max()
    assert np.abs(faces[inside]).max() <= 1e-11 * size
    assert np.abs(within[inside]).max() <= 1e-11 * size


@pytest.mark.parametrize("surfaces", ["3", "5"])
@pytest.mark.parametrize("membrane", ["compatible", "relaxed"])
@pytest.mark.parametrize("name", QUADRILATERALS)
def test_only_rigid_motions_cost_an_element_nothing(name, membrane, surfaces) -> None:
    body = quadrilateral(name, surfaces)
    shell = ShellModel(body, MEASURES["linear"], membrane=membrane)
    energies = np.linalg.eigvalsh(shell.linearise(np.zeros(body.n_free)).tangent.toarray())
    assert np.abs(energies[:6]).max() < 1e-12 * energies[-1]
    assert energies[6] > 1e-7
