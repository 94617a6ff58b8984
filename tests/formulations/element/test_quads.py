"""The element on any quadrilateral: rigid motions, patches, derivatives, areas, and the order of elimination."""

from dataclasses import replace
from itertools import product

import numpy as np
import pytest
from scipy import sparse
from scipy.sparse.linalg import splu, spsolve
from scipy.spatial.transform import Rotation

from formulations.discretisation import Discretisation
from formulations.element.mixed import MEMBRANES
from formulations.element.quad_geometry import QuadGeometry
from formulations.element.strain_operator import GAUSS
from formulations.geometry.grid import DISTORTIONS, Grid, QuadGrid, distorted
from formulations.geometry.nested_dissection import elimination_order
from formulations.geometry.surfaces import NodalSurface, Plate, cylinder, sphere, torus
from formulations.loads import Pressure
from formulations.section.laminate import Laminate, Ply
from formulations.shell import ShellModel
from formulations.strains.catalogue import EXACT_TERMS, MEASURES
from formulations.strains.measure import EXACT_LAW, StrainMeasure, quadratic_measure
from support.problems.shells import QUADRILATERALS, quadrilateral

WALL = Laminate((Ply(1000.0, 500.0, 200.0, 150.0, 0.3, 0.3, 0.4, 0.05), Ply.isotropic(700.0, 0.3, 0.07)), -0.05)
PIECES = {  # surface, ends of a1 and a2; some frames are left-handed
    "plate": (Plate(), (0.0, 1.0), (0.0, 1.3)),
    "cylinder": (cylinder(2.0), (0.0, 1.0), (0.0, 0.6)),
    "torus": (torus(3.0, 1.0), (0.2, 1.0), (0.0, 0.5)),
    "sphere": (sphere(2.0), (0.1, 0.7), (0.0, 0.6)),
}


def quads(piece: str, distortion: str = "random", n: int = 4, amount: float = 0.25) -> Discretisation:
    """A free piece of a surface on n x (n + 1) quadrilaterals."""
    surface, a1, a2 = PIECES[piece]
    grid = distorted(Grid.tensor(np.linspace(*a1, n + 1), np.linspace(*a2, n + 2)), distortion, amount)
    return Discretisation.build(surface, grid, WALL, np.zeros((grid.n_nodes, 6), bool), interpolation="quads")


def on_nodes(body: Discretisation, u_minus: np.ndarray, u_plus: np.ndarray) -> np.ndarray:
    """Unknowns of the Cartesian displacements of both faces."""
    frame = body.surface.frame(*body.grid.nodes.T)
    v = np.stack([np.einsum("nix,nx->ni", frame, u) for u in (u_minus, u_plus)], axis=-1)
    return body.map.restrict(v.reshape(-1, 6))


@pytest.mark.parametrize("piece", PIECES)
@pytest.mark.parametrize("distortion", DISTORTIONS)
def test_an_exact_measure_meets_rigid_motions(piece: str, distortion: str) -> None:
    body, turn = quads(piece, distortion), Rotation.from_rotvec([0.5, -0.9, 1.1]).as_matrix()
    shift = np.array([1.0, 2.0, 3.0])
    u = on_nodes(body, *(shift + X @ turn.T - X for X in body.positions()))
    small = on_nodes(body, *(shift + np.cross([0.3, -0.2, 0.5], X) for X in body.positions()))
    for thickness_strain, membrane in (("projected", "compatible"), ("balanced", "relaxed"), ("nodal", "compatible")):
        for name in ("exact", "elongation"):
            shell = ShellModel(body, MEASURES[name], thickness_strain=thickness_strain, membrane=membrane)
            assert np.abs(shell.mode_strains(u)).max() < 1e-12
        linear = ShellModel(body, MEASURES["linear"], thickness_strain=thickness_strain, membrane=membrane)
        assert np.abs(linear.mode_strains(small)).max() < 1e-12
        assert np.abs(linear.mode_strains(u)).max() > 0.1


def test_classical_measures_keep_their_laws_on_a_patch() -> None:
    """Where all elements turn alike, the strain left is that of the table, c = cos(angle): on a plate, out of it."""
    body, angle = quads("plate"), 0.6
    turn = Rotation.from_rotvec([0.0, angle, 0.0]).as_matrix()
    u = on_nodes(body, *(X @ turn.T - X for X in body.positions()))
    for name, measure in MEASURES.items():
        strain = ShellModel(body, measure).gauss_strains(u)[..., 0]  # E11 of the inner face
        expected = measure.rigid_body_law.out_of_plane(angle, 1.0) if measure.rigid_body_law.out_of_plane else 0.0
        np.testing.assert_allclose(strain, expected, atol=1e-12, err_msg=name)


@pytest.mark.parametrize("distortion", DISTORTIONS)
def test_a_uniform_state_has_the_strains_of_the_formulas_on_any_mesh(distortion: str) -> None:
    """Of every measure, also where shears are no vector: their axes are those of the laminate, not of sides."""
    body, rng = quads("plate", distortion), np.random.default_rng(5)
    G, beta = 0.2 * rng.standard_normal((3, 3)), 0.2 * rng.standard_normal(3)
    G[:, 2] = 0.0
    middle = np.mean(body.positions(), axis=0) @ G.T
    u = on_nodes(body, *(middle + sign * WALL.thickness / 2 * beta for sign in (-1, 1)))
    q = np.append(np.repeat([G[0, 0], G[1, 0], -G[2, 0], G[1, 1], G[0, 1], -G[2, 1]], 2), beta)
    for name, measure in MEASURES.items():
        expected = np.broadcast_to(measure.strain(q), (len(body.grid.elements), 4, 11))
        np.testing.assert_allclose(ShellModel(body, measure).gauss_strains(u), expected, atol=1e-12, err_msg=name)


STRANGE = {**EXACT_TERMS, "E11": {"l1": 1, "beta3 l1": 1}}  # the strain of a face knows of the director


@pytest.mark.parametrize(
    "measure", [*MEASURES.values(), quadratic_measure("strange", STRANGE, reference="", rigid_body_law=EXACT_LAW)]
)
def test_the_tangent_is_the_derivative_of_the_residual(measure: StrainMeasure) -> None:
    rng = np.random.default_rng(1)
    shell = ShellModel(
        quads("torus", n=2),
        measure,
        newton="plain",
        thickness_strain="balanced",
        membrane="relaxed",
        pressure=Pressure(3.0, follower=True),
        initial=0.1 * np.arange(11.0),
    )
    u, du = 0.03 * rng.standard_normal((2, shell.discretisation.n_free))
    slope = (shell.residual(u + 1e-5 * du) - shell.residual(u - 1e-5 * du)) / 2e-5
    tangent = shell.linearise(u).tangent @ du
    assert np.linalg.norm(slope - tangent) < 1e-7 * np.linalg.norm(tangent)


STATES = {  # strains and curvatures (11, 22, 2 12)
    f"{kind} {direction}": np.eye(6)[place].reshape(2, 3)
    for place, (kind, direction) in enumerate(product(("membrane", "bending"), ("11", "22", "12")))
}


@pytest.mark.parametrize("state", STATES)
def test_patches_of_membrane_and_bending(state: str) -> None:
    """A plate of one skew ply whose edges are moved as a constant strain moves them: the nodes inside follow."""
    h, (strain, curvature) = 0.05, 1e-3 * STATES[state]
    ply = Laminate.single(Ply(1000.0, 500.0, 200.0, 150.0, 0.3, 0.25, 0.4, h))
    grid = distorted(Grid.tensor(np.linspace(0, 1, 5), np.linspace(0, 1.3, 5)), "random", 0.35)
    x, y = grid.nodes.T
    D = ply.stiffness()
    through = -(D[10, :6] @ np.repeat(strain, 2)) / D[10, 10]  # no stress across the wall

    def exact(z: float) -> np.ndarray:
        e, k = strain, curvature
        along = [(e[0] - z * k[0]) * x + (e[2] - z * k[2]) * y / 2, (e[1] - z * k[1]) * y + (e[2] - z * k[2]) * x / 2]
        return np.stack([*along, through * z + (k[0] * x**2 + k[1] * y**2 + k[2] * x * y) / 2], axis=-1)

    v = np.stack([exact(-h / 2), exact(h / 2)], axis=-1).reshape(-1, 6)
    edge = np.concatenate([grid.on_line(axis, end) for axis in (0, 1) for end in grid.ends[axis]])
    held = np.zeros_like(v, bool)
    held[edge] = True
    body = Discretisation.build(Plate(), grid, ply, held, interpolation="quads")
    for membrane in ("compatible", "relaxed"):
        shell = ShellModel(body, MEASURES["linear"], prescribed=np.where(held, v, 0.0), membrane=membrane)
        rest = shell.linearise(np.zeros(body.n_free))
        actual = shell.displacements(spsolve(rest.tangent, -rest.residual))
        np.testing.assert_allclose(actual, v, atol=1e-12 * np.abs(v).max())


def test_rectangles_have_the_strains_of_an_isoparametric_grid_but_for_products_in_shears_across() -> None:
    surface, a1, a2 = PIECES["plate"]
    grid = Grid.tensor(np.linspace(*a1, 4), np.linspace(*a2, 5))
    free = np.zeros((grid.n_nodes, 6), bool)
    both = [
        ShellModel(Discretisation.build(surface, grid, WALL, free, interpolation=word), MEASURES["exact"])
        for word in ("quads", "isoparametric")
    ]
    u = 0.01 * np.random.default_rng(0).standard_normal(both[0].discretisation.n_free)
    one, other = (shell.mode_strains(u) for shell in both)
    across = [*range(6, 10), 13, 14, 18, 19]  # 2E13 and 2E23 on the modes 00, 01 and 10
    same = np.delete(np.arange(one.shape[1]), across)
    np.testing.assert_allclose(one[:, same], other[:, same], atol=1e-14)
    assert 1e-4 < np.abs(one - other)[:, across].max() / np.abs(other[:, across]).max() < 0.1  # products on sides
    linear = [ShellModel(shell.discretisation, MEASURES["linear"]).mode_strains(u) for shell in both]
    np.testing.assert_allclose(linear[0], linear[1], atol=1e-14)
    np.testing.assert_allclose(both[0].mean_resultants(u)[:, :6], both[1].mean_resultants(u)[:, :6], atol=1e-11)


@pytest.mark.parametrize("piece", PIECES)
def test_modes_in_the_plane_leave_what_is_orthogonal_to_them(piece: str) -> None:
    geometry = quads(piece).geometry
    assert isinstance(geometry, QuadGeometry)
    taken = np.random.default_rng(4).standard_normal((len(geometry.weight), 4, 7))
    taken[..., 6] = 0.0
    kept = np.einsum("egim,em->egi", geometry.turn, np.einsum("ek,ekm->em", taken.reshape(-1, 28), geometry.projection))
    left, weight = taken[..., :6] - kept[..., :6], geometry.share[..., None] * [1, 1, 1, 1, 0.5, 0.5]
    assert np.abs(np.einsum("egi,egi,egi->e", left, weight, kept[..., :6])).max() < 1e-14
    assert np.abs(np.einsum("egi,egi,egim->em", left, weight, geometry.turn[:, :, :6])).max() < 1e-14


@pytest.mark.parametrize("membrane", MEMBRANES)
@pytest.mark.parametrize("name", QUADRILATERALS)
def test_only_rigid_motions_cost_an_element_nothing(name: str, membrane: str) -> None:
    shell = ShellModel(quadrilateral(name), MEASURES["linear"], membrane=membrane)
    energies = np.linalg.eigvalsh(shell.linearise(np.zeros(24)).tangent.toarray())
    assert np.abs(energies[:6]).max() < 1e-13
    assert energies[6] > 5e-6


def test_a_fibre_that_bends_along_a_side_of_a_parallelogram_is_a_mode() -> None:
    corners = np.array([[0.0, 0.0], [2.0, 0.0], [2.7, 0.6], [0.7, 0.6]])
    middle = np.column_stack([corners, np.zeros(4)]) @ Rotation.from_rotvec([0.0, 0.0, 0.4]).as_matrix().T
    surface = NodalSurface.of(middle, np.tile([0.0, 0.0, 1.0], (4, 1)), np.tile([1.0, 0.0, 0.0], (4, 1)))
    free = np.zeros((4, 6), bool)
    grid = QuadGrid.over(np.arange(4)[None])
    geometry = Discretisation.build(surface, grid, WALL, free, interpolation="quads").geometry
    assert isinstance(geometry, QuadGeometry)
    c, s = np.cos(0.4), np.sin(0.4)
    taken = np.zeros((4, 7))
    taken[:, :6] = GAUSS[:, 1:] * np.repeat([c * c, s * s, 2 * c * s], 2)
    modes = taken.reshape(28) @ geometry.projection[0]
    np.testing.assert_allclose((geometry.turn[0] @ modes)[:, :6], taken[:, :6], atol=1e-14)
    assert np.count_nonzero(np.abs(modes) > 1e-14) == 2  # of both faces


def test_areas_of_nodes_and_elements_are_those_of_the_mesh() -> None:
    body = quads("plate")
    x = body.grid.nodes[body.grid.elements]
    diagonals = x[:, 2] - x[:, 0], x[:, 3] - x[:, 1]
    area = 0.5 * np.abs(diagonals[0][:, 0] * diagonals[1][:, 1] - diagonals[0][:, 1] * diagonals[1][:, 0])
    np.testing.assert_allclose(body.geometry.weight, area, rtol=1e-13)
    for face in ("mid", "outer"):
        mass = body.nodal_mass(face)
        np.testing.assert_allclose(np.asarray(mass.sum(axis=1)).ravel(), body.nodal_areas(face), rtol=1e-12)
    y = body.grid.nodes @ [1.0, -2.0]
    moment = float(np.ones(len(y)) @ body.nodal_mass("mid") @ y)  # int y dA over a rectangle: area times its middle
    assert moment == pytest.approx(1.3 * (0.5 - 1.3), rel=1e-12)


def test_pressure_on_a_closed_face_has_no_resultant_but_that_of_its_rim() -> None:
    """p int n dA over an interpolated face is p/2 times the sum of r x dr around its edge, in any state."""
    body = quads("sphere")
    shell = ShellModel(body, MEASURES["exact"], pressure=Pressure(2.0, follower=True))
    u = 0.02 * np.random.default_rng(3).standard_normal(body.n_free)
    _, external, _ = shell.element_contributions(u, None)
    assert external is not None
    nodal = body.nodal(external)
    frame = body.surface.frame(*body.grid.nodes.T)
    force = np.einsum("ni,nix->x", nodal[:, ::2], frame)
    at = body.positions()[0] + body.cartesian(u)[0]
    sides = body.grid.elements[:, [[0, 1], [1, 2], [2, 3], [3, 0]]].reshape(-1, 2)
    _, place, count = np.unique(np.sort(sides, axis=1), axis=0, return_inverse=True, return_counts=True)
    rim = sides[count[place.ravel()] == 1]
    expected = 2.0 * 0.5 * np.cross(at[rim[:, 0]], at[rim[:, 1]]).sum(axis=0)
    way = np.sign(expected @ force)
    np.testing.assert_allclose(force, way * expected, rtol=1e-10, atol=1e-12)


def test_an_element_turned_inside_out_is_named() -> None:
    nodes = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [2, 0, 0], [1.1, 0.2, 0]], float)
    elements = np.array([[0, 1, 2, 3], [1, 4, 5, 2]])
    surface = NodalSurface.of(nodes, np.tile([0.0, 0.0, 1.0], (6, 1)), np.array([1.0, 0.0, 0.0]))
    with pytest.raises(ValueError, match="element 1 has an angle of 180 degrees or more; 1 of 2 have"):
        Discretisation.build(surface, QuadGrid.over(elements), WALL, np.zeros((6, 6), bool), interpolation="quads")


def test_distortion_keeps_edges_and_refuses_what_does_not_exist() -> None:
    grid = Grid.tensor(np.linspace(0, 1, 6), np.linspace(0, 2 * np.pi, 9), periodic=True)
    for kind in DISTORTIONS:
        moved = distorted(grid, kind, 0.3)
        np.testing.assert_array_equal(moved.ends, grid.ends)
        assert len(moved.on_line(0, 0.0)) == len(grid.on_line(0, 0.0)) == 8
        assert np.ptp(moved.corners, axis=1).max() < 2.5 * np.pi / 4  # unwrapped across the seam
    open_grid = Grid.tensor(np.linspace(0, 1, 6), np.linspace(0, 2.0, 9))
    for end in open_grid.ends[1]:  # a seam there may not move: no step of a smooth map may be left beside it
        edge = open_grid.on_line(1, end)
        np.testing.assert_allclose(distorted(open_grid, "skew", 0.3).nodes[edge], open_grid.nodes[edge], atol=1e-15)
    with pytest.raises(ValueError, match="distortion 'wild' is not one of random, trapezoid, skew"):
        distorted(grid, "wild", 0.1)
    with pytest.raises(ValueError, match=r"distort = 0.5 must be in \[0, 0.4\]"):
        distorted(grid, "random", 0.5)


@pytest.mark.slow
def test_bisection_fills_in_hardly_more_than_the_lines_of_a_grid() -> None:
    grid = Grid.tensor(np.linspace(0, 1, 41), np.linspace(0, 1.5, 61))
    quad = replace(distorted(grid, "random", 0.3), node_shape=None)
    fill = []
    for order in (elimination_order(grid), elimination_order(quad)):
        np.testing.assert_array_equal(np.sort(order), np.arange(grid.n_nodes))
        body = Discretisation.build(Plate(), quad, WALL, np.zeros((grid.n_nodes, 6), bool), interpolation="quads")
        K = ShellModel(body, MEASURES["linear"]).linearise(np.zeros(body.n_free)).tangent
        unknowns = (6 * order[:, None] + np.arange(6)).ravel()
        K = K[unknowns][:, unknowns] + 1e3 * sparse.eye_array(len(unknowns))
        factor = splu(K.tocsc(), permc_spec="NATURAL", diag_pivot_thresh=0.0, options={"SymmetricMode": True})
        fill.append(factor.L.nnz)
    assert fill[1] < 1.3 * fill[0]


def test_resultants_of_a_section_without_symmetry_and_of_stress_at_rest_are_its_own() -> None:
    """On one and the same grid, whatever section and stress it has had before."""
    body, rng = quads("plate"), np.random.default_rng(0)
    u = 0.01 * rng.standard_normal(body.n_free)
    D = WALL.stiffness("nonsymmetric")
    shell = ShellModel(body, MEASURES["exact"], section="nonsymmetric")
    np.testing.assert_allclose(shell.mean_resultants(u), shell.mean_strains(u) @ D.T, rtol=0, atol=1e-12 * D.max())
    stress = rng.standard_normal(11)
    before, after = (ShellModel(body, MEASURES["exact"], initial=sign * stress).residual(u) for sign in (1, -1))
    alone = ShellModel(body, MEASURES["exact"]).residual(u)
    assert np.abs(after - before).max() > 1e-3 * np.abs(alone).max()
    np.testing.assert_allclose(before + after, 2 * alone, rtol=0, atol=1e-12 * np.abs(alone).max())
