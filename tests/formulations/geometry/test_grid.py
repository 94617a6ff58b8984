"""Grid and discretisation: connectivity against scikit-fem, the periodic seam, areas, mass, displacements in space."""

import math

import numpy as np
import pytest
from skfem import Basis, BilinearForm, ElementQuad1

from formulations.discretisation import Discretisation
from formulations.geometry.grid import CORNERS, Grid, graded_lines
from formulations.geometry.surfaces import Plate, cylinder, sphere, torus
from formulations.section.laminate import Laminate, Ply
from support.problems.differences import fitted_order
from support.problems.shells import SKEW_LAMINATE, make_shell, nodal_components

ROUNDING = 1e-13  # relative
SLOPE = (1.9, 2.1)  # of the error of the areas: one point per element

LINES1 = graded_lines([-0.4, 0.1, 0.9], [2, 3])
LINES2 = graded_lines([0.2, 1.0, 1.3], [3, 2])
THICK = Laminate((Ply.isotropic(1.0, 0.3, 0.3),), d_minus=-0.1)


def discretise(surface, grid: Grid) -> Discretisation:
    return Discretisation.build(surface, grid, THICK, np.zeros((grid.n_nodes, 6), bool))


def test_graded_lines_are_piecewise_uniform() -> None:
    np.testing.assert_allclose(LINES1, [-0.4, -0.15, 0.1, 11 / 30, 19 / 30, 0.9], rtol=0, atol=ROUNDING)


@pytest.mark.parametrize(
    ("breaks", "counts"), [([0, 1], [1, 1]), ([0, 1, 2], [1]), ([0, 1], [0]), ([0, 2, 1], [1, 1]), ([0, 0], [1])]
)
def test_bad_graded_lines_are_refused(breaks, counts) -> None:
    with pytest.raises(ValueError, match="increasing breaks and positive counts"):
        graded_lines(breaks, counts)


def test_elements_are_the_cells_of_the_scikit_fem_mesh() -> None:
    """Corner r of an element lies at centre + half * CORNERS[r]; together they are scikit-fem's cells."""
    grid = Grid.tensor(LINES1, LINES2)
    corners = grid.centre[:, None] + grid.half[:, None] * CORNERS
    np.testing.assert_allclose(grid.nodes[grid.elements], corners, rtol=0, atol=ROUNDING)
    cells = {frozenset(map(tuple, cell)) for cell in np.round(grid.mesh.p[:, grid.mesh.t].T, 9)}
    assert {frozenset(map(tuple, cell)) for cell in np.round(grid.nodes[grid.elements], 9)} == cells
    assert len(cells) == len(grid.elements) == (len(LINES1) - 1) * (len(LINES2) - 1)


def test_nodes_reshape_to_the_lines() -> None:
    grid = Grid.tensor(LINES1, LINES2)
    first, second = np.moveaxis(grid.nodes.reshape(*grid.node_shape, 2), -1, 0)
    assert np.all(first == LINES1[:, None])
    assert np.all(second == LINES2[None, :])


def test_periodic_seam_joins_the_last_line_to_the_first() -> None:
    grid = Grid.tensor(LINES1, np.linspace(-math.pi, math.pi, 7), periodic=True)
    assert grid.node_shape == (len(LINES1), 6)
    assert len(grid.elements) == (len(LINES1) - 1) * 6
    corners = grid.centre[:, None] + grid.half[:, None] * CORNERS
    apart = grid.nodes[grid.elements] - corners
    np.testing.assert_allclose(apart[..., 0], 0, rtol=0, atol=ROUNDING)
    np.testing.assert_allclose(np.exp(1j * apart[..., 1]), 1, rtol=0, atol=10 * ROUNDING)
    assert np.sum(apart[..., 1] < -1) == 2 * (len(LINES1) - 1)  # two corners of each seam element are unwrapped
    uses = np.bincount(grid.elements.ravel()).reshape(grid.node_shape)
    assert np.all(uses[[0, -1]] == 2)
    assert np.all(uses[1:-1] == 4)


def test_nodes_are_found_by_line_and_by_point() -> None:
    grid = Grid.tensor(LINES1, LINES2)
    assert np.all(grid.nodes[grid.on_line(0, 0.1), 0] == pytest.approx(0.1))
    assert len(grid.on_line(0, 0.1)) == len(LINES2)
    assert len(grid.on_line(1, 0.25)) == 0
    np.testing.assert_allclose(grid.nodes[grid.node_at(0.9, 1.0)], [0.9, 1.0], rtol=ROUNDING)
    with pytest.raises(ValueError, match=r"no node at \(0.5, 1\)"):
        grid.node_at(0.5, 1.0)


def closed_areas(d: float) -> dict[str, float]:
    """Areas of plate, cylinder, sphere and torus patches over the box of the lines, at distance d."""
    (a, b), (c, e) = LINES1[[0, -1]], LINES2[[0, -1]]
    Rc, R = 3.0, 2.0 + d
    zone = math.sin(b) - math.sin(a)
    return {
        "plate": (b - a) * (e - c),
        "cylinder": (b - a) * (e - c) * R,
        "sphere": R**2 * zone * (e - c),
        "torus": (R * Rc * (b - a) + R**2 * zone) * (e - c),
    }


SURFACES = {"plate": Plate(), "cylinder": cylinder(2.0), "sphere": sphere(2.0), "torus": torus(3.0, 2.0)}
DISTANCES = {"mid": (THICK.d_minus + THICK.d_plus) / 2, "outer": THICK.d_plus}


@pytest.mark.parametrize("name", SURFACES)
@pytest.mark.parametrize("face", DISTANCES)
def test_nodal_areas_sum_to_the_area_of_the_surface(name, face) -> None:
    """Exactly where the area is constant over an element, to second order elsewhere."""
    exact, sizes, errors = closed_areas(DISTANCES[face])[name], [], []
    for n in (1, 2, 4):
        lines = (graded_lines([-0.4, 0.1, 0.9], [2 * n, 3 * n]), graded_lines([0.2, 1.0, 1.3], [3 * n, 2 * n]))
        areas = discretise(SURFACES[name], Grid.tensor(*lines)).nodal_areas(face)
        assert np.all(areas > 0)
        sizes.append(1 / n)
        errors.append(abs(areas.sum() / exact - 1))
    if name in ("plate", "cylinder"):
        assert max(errors) <= ROUNDING
    else:
        assert SLOPE[0] <= fitted_order(sizes, errors) <= SLOPE[1]


@pytest.mark.parametrize("face", DISTANCES)
@pytest.mark.parametrize("periodic", [False, True])
def test_nodal_mass_rows_sum_to_nodal_areas(face, periodic) -> None:
    grid = Grid.tensor(LINES1, np.linspace(-math.pi, math.pi, 7), periodic=periodic)
    shell = discretise(torus(3.0, 2.0), grid)
    mass = shell.nodal_mass(face)
    np.testing.assert_allclose(mass @ np.ones(grid.n_nodes), shell.nodal_areas(face), rtol=ROUNDING)
    assert abs(mass - mass.T).max() == 0


def test_nodal_mass_of_a_plate_is_that_of_scikit_fem() -> None:
    grid = Grid.tensor(LINES1, LINES2)
    basis = Basis(grid.mesh, ElementQuad1())
    theirs = BilinearForm(lambda u, v, w: u * v).assemble(basis).toarray()
    ours = [int(np.argmin(np.linalg.norm(grid.nodes - p, axis=1))) for p in basis.doflocs.T]
    mass = discretise(Plate(), grid).nodal_mass("mid").toarray()
    np.testing.assert_allclose(mass[np.ix_(ours, ours)], theirs, rtol=0, atol=ROUNDING)


def test_a_translation_is_the_same_vector_everywhere(patch, rng) -> None:
    """Through ``cartesian`` and through ``displacement_operator``, on both faces; and positions lie on the normal."""
    grid, c = patch.grid(3, 4), rng.normal(size=3)
    shell = make_shell(patch.surface, grid).discretisation
    u = nodal_components(patch.surface, grid, SKEW_LAMINATE, lambda x: np.broadcast_to(c, x.shape))
    nodes = rng.permutation(grid.n_nodes)[:5]
    for face, actual in enumerate(shell.cartesian(u)):
        np.testing.assert_allclose(actual, np.broadcast_to(c, actual.shape), rtol=0, atol=10 * ROUNDING)
        at_nodes = shell.displacement_operator(nodes, face) @ u
        np.testing.assert_allclose(at_nodes.reshape(-1, 3), actual[nodes], rtol=0, atol=10 * ROUNDING)
    inner, outer = shell.positions()
    np.testing.assert_allclose(np.linalg.norm(outer - inner, axis=1), SKEW_LAMINATE.thickness, rtol=10 * ROUNDING)
    middle = inner + (outer - inner) * (-SKEW_LAMINATE.d_minus / SKEW_LAMINATE.thickness)
    np.testing.assert_allclose(middle, patch.surface.position(*grid.nodes.T), rtol=0, atol=10 * ROUNDING)


def test_assembly_is_the_sum_over_elements_and_skips_held_rows(rng) -> None:
    grid = Grid.tensor(LINES1, np.linspace(-math.pi, math.pi, 4), periodic=True)
    fixed = rng.random((grid.n_nodes, 6)) < 0.2
    shell = Discretisation.build(torus(3.0, 1.0), grid, THICK, fixed)
    matrices, vectors = rng.normal(size=(len(grid.elements), 24, 24)), rng.normal(size=(len(grid.elements), 24))
    dense, load = np.zeros((6 * grid.n_nodes,) * 2), np.zeros(6 * grid.n_nodes)
    for element, matrix, vector in zip(grid.elements, matrices, vectors, strict=True):
        dofs = (6 * element[:, None] + np.arange(6)).ravel()
        np.add.at(dense, np.ix_(dofs, dofs), matrix)
        np.add.at(load, dofs, vector)
    free = np.flatnonzero(~fixed.ravel())
    assembled = shell.assemble(matrices).toarray()
    np.testing.assert_allclose(assembled, dense[np.ix_(free, free)], rtol=0, atol=10 * ROUNDING)
    np.testing.assert_allclose(shell.gather(vectors), load[free], rtol=0, atol=10 * ROUNDING)
