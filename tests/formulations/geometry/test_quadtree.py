"""Refined grids: what hangs where, the uniform grid where all is refined, and shells that do not notice the hanging."""

import numpy as np
import pytest
from scipy.sparse.linalg import splu, spsolve
from scipy.spatial.transform import Rotation

from contact.algorithms.semismooth import Semismooth
from contact.obstacles.foundation import RigidPlane, against_plane
from contact.problem import ContactSolution, Outcome
from formulations.conditions.boundary import Supports
from formulations.discretisation import Discretisation
from formulations.element.strain_operator import ON_LINES
from formulations.geometry.grid import Grid
from formulations.geometry.nested_dissection import elimination_order
from formulations.geometry.quadtree import DEEPEST, Quadtree
from formulations.geometry.surfaces import Plate, cylinder, sphere
from formulations.loads import Pressure, edge_force
from formulations.section.laminate import Laminate, Ply
from formulations.shell import ShellModel
from formulations.strains.catalogue import MEASURES
from studies.scenes.contact.base import outer_face
from support.problems.shells import PATCHES, SKEW_LAMINATE, Patch, make_shell

ISO = "isoparametric"
PATCH = 1e-10  # relative error of a patch test: rounding times the condition number
MOST_FILL = 1.25  # of minimum degree's
RIGID = 1e-11  # least eigenvalues of a free shell over the largest


def over(patch: Patch, n1: int, n2: int) -> Quadtree:
    return Quadtree.over(*patch.grid(n1, n2).lines)


def random(tree: Quadtree, times: int, seed: int = 0, share: float = 0.25) -> Quadtree:
    rng = np.random.default_rng(seed)
    for _ in range(times):
        tree = tree.refined(rng.random(len(tree.leaves)) < share)
    return tree


# --- the grid -----------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("periodic", [False, True])
@pytest.mark.parametrize("times", [0, 1, 2])
def test_refined_everywhere_it_is_the_uniform_grid(periodic, times) -> None:
    lines = np.array([0, 1, 2.5]), np.linspace(0, 2 * np.pi, 7)
    tree = Quadtree.over(*lines, periodic=periodic)
    for _ in range(times):
        tree = tree.everywhere()
    halved = [np.interp(np.linspace(0, len(a) - 1, 2**times * (len(a) - 1) + 1), np.arange(len(a)), a) for a in lines]
    actual, uniform = tree.grid(), Grid.tensor(*halved, periodic=periodic)
    np.testing.assert_array_equal(actual.elements, uniform.elements)
    for name in ("nodes", "centre", "half"):
        np.testing.assert_allclose(getattr(actual, name), getattr(uniform, name), rtol=0, atol=1e-14)
    assert actual.hanging is None


@pytest.mark.parametrize("periodic", [False, True])
@pytest.mark.parametrize("seed", range(2))
def test_neighbours_are_a_level_apart_and_every_hanging_node_is_the_middle_of_an_edge(periodic, seed) -> None:
    lines = np.array([0, 1, 2.5, 2.7]), np.linspace(0, 2 * np.pi, 6)
    tree = random(Quadtree.over(*lines, periodic=periodic), 5, seed)
    grid = tree.grid()
    assert tree.leaves[:, 0].max() >= 4
    assert 4 * grid.half.prod(axis=1).sum() == pytest.approx(2.7 * 2 * np.pi)
    # a node inside a side of an element, by brute force: always its middle
    corners = grid.centre[:, None] + grid.half[:, None] * np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]])
    inside = set()
    for turn in (0, 2 * np.pi) if periodic else (0,):
        at = grid.nodes + np.array([0, turn])
        for side in range(4):
            a, b = corners[:, side], corners[:, (side + 1) % 4]
            axis = side % 2
            along = (at[None, :, axis] - a[:, None, axis]) / (b - a)[:, None, axis]
            on = np.abs(at[None, :, 1 - axis] - a[:, None, 1 - axis]) < 1e-9
            _, nodes = np.nonzero(on & (along > 1e-9) & (along < 1 - 1e-9))
            np.testing.assert_allclose(along[on & (along > 1e-9) & (along < 1 - 1e-9)], 0.5, atol=1e-9)
            inside |= set(nodes.tolist())
    assert inside == set(grid.hanging.nodes.tolist())
    assert len(grid.hanging.nodes) == len(inside) > 10
    # what is linear is carried exactly, whatever hangs on what
    shares = grid.hanging.shares.toarray()
    np.testing.assert_allclose(shares.sum(axis=1), 1, atol=1e-14)
    assert not shares[:, grid.hanging.nodes].any()
    if not periodic:
        np.testing.assert_allclose(shares @ grid.nodes, grid.nodes, atol=1e-13)


def test_too_deep_is_refused() -> None:
    tree = Quadtree.over(np.array([0.0, 1.0]), np.array([0.0, 1.0]))
    for _ in range(DEEPEST):
        tree = tree.refined(np.arange(len(tree.leaves)) == 0)
    with pytest.raises(ValueError, match=f"{DEEPEST} levels at most"):
        tree.refined(np.arange(len(tree.leaves)) == 0)


# --- shells on it --------------------------------------------------------------------------------------------------


def clamped(grid: Grid, surface, interpolation: str = "curvilinear", **loads) -> ShellModel:
    supports = Supports.none(grid).clamped(grid.on_line(0, float(grid.nodes[:, 0].min())))
    shell = Discretisation.build(
        surface, grid, SKEW_LAMINATE, *supports.masks, interpolation=interpolation, ordered=True
    )
    return ShellModel(shell, MEASURES["exact"], **loads)


@pytest.mark.parametrize("name", PATCHES)
@pytest.mark.parametrize("interpolation", ON_LINES)
def test_tangent_by_differences(name, interpolation, rng) -> None:
    patch = PATCHES[name]
    grid = random(over(patch, 3, 2), 3).grid()
    pressure = Pressure(0.01, follower=True, area="face")
    shell = clamped(grid, patch.surface, interpolation, pressure=pressure)
    u, du = 0.02 * rng.normal(size=(2, shell.discretisation.n_free))
    step = 1e-5
    by_difference = (shell.residual(u + step * du) - shell.residual(u - step * du)) / (2 * step)
    actual = shell.linearise(u).tangent @ du
    np.testing.assert_allclose(actual, by_difference, rtol=0, atol=1e-8 * np.max(np.abs(actual)))


@pytest.mark.parametrize("name", PATCHES)
@pytest.mark.parametrize("seed", range(2))
def test_a_free_shell_has_its_rigid_motions_and_no_other_mode_without_energy(name, seed) -> None:
    """Where positions are interpolated, on any grid; the hanging corner must lie on the chord for that."""
    patch = PATCHES[name]
    shell = make_shell(patch.surface, random(over(patch, 2, 2), 3, seed).grid(), interpolation="isoparametric")
    K = shell.linearise(np.zeros(shell.discretisation.n_free)).tangent.toarray()
    values = np.linalg.eigvalsh((K + K.T) / 2) / np.max(np.abs(K))
    assert np.all(np.abs(values[:6]) < RIGID)
    assert values[6] > 100 * RIGID


@pytest.mark.parametrize("seed", range(3))
def test_patch(seed) -> None:
    """A stretched and twisted plate, its edges given: the inside is found, hanging nodes and all.

    A bent one would not be: its deflection is quadratic, and a hanging node lies on the chord.
    """
    grid = random(over(PATCHES["plate"], 3, 2), 3, seed).grid()
    x, y = grid.nodes.T
    strains = np.array([2e-3, 2e-3, -1.5e-3, -1.5e-3, 2e-3, 5e-3])  # E11-, E11+, E22-, E22+, 2E12-, 2E12+
    D, h = SKEW_LAMINATE.stiffness(), SKEW_LAMINATE.thickness
    stretch = -D[10, :6] @ strains / D[10, 10]  # leaves E33 without a resultant
    exact = np.empty((grid.n_nodes, 6))
    for face, sign in enumerate((-1, 1)):
        e11, e22, shear = strains[face::2]
        exact[:, face], exact[:, 2 + face] = e11 * x + shear / 2 * y, e22 * y + shear / 2 * x
        exact[:, 4 + face] = -(strains[5] - strains[4]) / (2 * h) * x * y + sign * h / 2 * stretch
    shell = make_shell(Plate(), grid, SKEW_LAMINATE, measure="linear")
    number = shell.discretisation.map.number.reshape(-1, 6)
    edge = (np.isin(x, (x.min(), x.max())) | np.isin(y, (y.min(), y.max()))) & (number[:, 0] >= 0)
    given = np.zeros(shell.discretisation.n_free, bool)
    given[number[edge].ravel()] = True
    tangent = shell.linearise(np.zeros(len(given))).tangent
    u = np.where(given, shell.discretisation.map.restrict(exact), 0.0)
    u[~given] = spsolve(tangent[~given][:, ~given], -(tangent @ u)[~given])
    actual = shell.discretisation.expand(u)
    np.testing.assert_allclose(actual, exact, rtol=0, atol=PATCH * np.max(np.abs(exact)))


def test_loads_and_reactions_balance() -> None:
    grid = random(over(PATCHES["wavy"], 3, 3), 3).grid()
    patch = PATCHES["wavy"]
    shell = clamped(grid, patch.surface, "isoparametric")
    end = float(grid.nodes[:, 0].max())
    line = edge_force(shell.discretisation, 0, end, lambda a1, a2: np.array([1e-3, -2e-3, 3e-3]))
    forces = shell.discretisation.reduce(line)
    shell = clamped(grid, patch.surface, "isoparametric", pressure=Pressure(1e-4), forces=forces)
    u = np.zeros(shell.discretisation.n_free)
    for _ in range(12):
        lin = shell.linearise(u)
        u = u - spsolve(lin.tangent, lin.residual)
    assert np.linalg.norm(shell.residual(u)) < 1e-10 * lin.scale
    np.testing.assert_allclose(shell.outside_and_spurious(u)[0], 0, atol=1e-9 * lin.scale)


@pytest.mark.parametrize("seed", [0, pytest.param(1, marks=pytest.mark.slow)])
def test_the_pressure_under_a_pressed_plate_converges_to_what_presses_it(seed) -> None:
    """A hanging node is not a candidate: its area goes to the ends of its edge. Forces balance, pressures have order 2.

    Loads act along the arcs, contact along the straight edges: between the two a moment of the order p l^3 is left.
    """
    tree, errors = random(over(PATCHES["plate"], 3, 2), 2, seed), []
    for _ in range(3):
        grid = tree.grid()
        fixed, hinged = Supports.of_edges(grid, *["symmetric"] * 4).masks
        plate = Laminate.single(Ply.isotropic(20.0, 0.3, 0.5))
        shell = make_shell(Plate(), grid, plate, fixed=fixed, hinged=hinged, measure="exact", pressure=Pressure(0.3))
        candidates = outer_face(shell.discretisation, grid.free_nodes)
        problem = against_plane(shell.linearise, candidates, RigidPlane(np.array([0.0, 0.0, 1.0]), plate.d_plus))
        m = len(candidates.weights)
        lying = ContactSolution(np.zeros(shell.discretisation.n_free), np.zeros(m), np.ones(m, bool), Outcome.CONVERGED)
        solution = Semismooth().solve(problem, lying)
        assert solution.outcome is Outcome.CONVERGED
        area = np.prod(np.ptp(grid.nodes, axis=0))
        assert candidates.weights.sum() == pytest.approx(area)
        assert candidates.weights @ solution.pressure == pytest.approx(0.3 * area, rel=1e-12)
        errors.append(float(np.max(np.abs(solution.pressure / 0.3 - 1))))
        tree = tree.everywhere()
    assert errors[0] < 0.03
    assert np.all(np.array(errors[:-1]) > 4 * np.array(errors[1:]))


@pytest.mark.parametrize("seed", range(2))
def test_a_free_shell_turns_without_strain(seed) -> None:
    """A finite rigid motion on an irregular grid: the nodes that hang follow it on their arcs."""
    patch = PATCHES["torus"]
    shell = make_shell(patch.surface, random(over(patch, 3, 2), 2, seed).grid(), SKEW_LAMINATE, interpolation=ISO)
    own = shell.discretisation
    turn = Rotation.from_rotvec([0.7, -1.1, 0.4]).as_matrix()
    frame = own.surface.frame(*own.grid.nodes.T)
    v = np.zeros((own.grid.n_nodes, 6))
    for face, x in enumerate(own.positions()):
        v[:, face::2] = np.einsum("nix,nx->ni", frame, x @ turn.T - x + [1.0, 2.0, -3.0])
    u = own.map.restrict(v)
    assert np.max(np.abs(shell.mode_strains(u))) < 1e-13
    assert np.max(np.abs(shell.residual(u))) < 1e-10 * np.max(np.abs(own.laminate.stiffness(shell.section)))


@pytest.mark.parametrize("interpolation", ON_LINES)
def test_hanging_nodes_do_not_lock_thin_shells(interpolation) -> None:
    """The hemisphere of MacNeal and Harder bends almost without stretching: straight edges held it at half of that."""
    values = []
    for irregular in (False, True):
        tree = Quadtree.over(np.linspace(0, np.deg2rad(72), 9), np.linspace(0, np.pi / 2, 9))
        tree = random(tree, 1, share=0.1) if irregular else tree
        grid = tree.grid()
        supports = Supports.of_edges(grid, "free", "free", "symmetric", "symmetric")
        supports = supports.hold(grid.node_at(0, 0), (0,), ("inner",))
        wall = Laminate.single(Ply.isotropic(6.825e7, 0.3, 0.04))
        held, hinged = supports.masks
        shell = make_shell(
            sphere(10.0), grid, wall, fixed=held, hinged=hinged, interpolation=interpolation, membrane="relaxed"
        )
        load = np.zeros((grid.n_nodes, 6))
        load[grid.node_at(0, 0), 4:], load[grid.node_at(0, np.pi / 2), 4:] = 0.5, -0.5
        f = shell.discretisation.reduce(load)
        values.append(float(f @ spsolve(shell.linearise(np.zeros(len(f))).tangent, f)))
    assert values[1] == pytest.approx(values[0], rel=0.1)


@pytest.mark.parametrize("interpolation", ON_LINES)
def test_order_two_is_kept(interpolation) -> None:
    """A pressed panel on diaphragms on one irregular grid, cut everywhere: its work converges with the second order."""
    tree = random(Quadtree.over(np.linspace(0, 1, 3), np.linspace(0, 1, 3)), 1, 3)
    work = []
    for _ in range(4):
        grid = tree.grid()
        supports = Supports.none(grid)
        for axis in (0, 1):
            for end in (0.0, 1.0):
                supports = supports.hard_diaphragm(grid.on_line(axis, end), axis)
        fixed, hinged = supports.masks
        options = {"interpolation": interpolation, "pressure": Pressure(1e-3), "measure": "exact"}
        shell = make_shell(cylinder(2.0), grid, SKEW_LAMINATE, fixed=fixed, hinged=hinged, **options)
        lin = shell.linearise(np.zeros(shell.discretisation.n_free))
        work.append(float(-lin.residual @ spsolve(lin.tangent, -lin.residual)))
        tree = tree.everywhere()
    steps = np.abs(np.diff(work))
    assert np.log2(steps[-2] / steps[-1]) == pytest.approx(2, abs=0.15)


@pytest.mark.parametrize("periodic", [False, True])
def test_the_order_of_elimination_keeps_the_fill_low(periodic) -> None:
    """Close to that of minimum degree on a grid refined towards a ring, as around a patch of contact."""
    tree = Quadtree.over(np.linspace(0, 1, 13), np.linspace(0, 2 * np.pi, 13), periodic=periodic)
    for _ in range(2):
        a1, a2 = tree.grid().centre.T
        tree = tree.refined(np.abs(np.hypot(a1 - 0.5, a2 - 3.0) - 0.3) < 0.15)
    grid = tree.grid()
    np.testing.assert_array_equal(np.sort(elimination_order(grid)), np.arange(grid.n_nodes))
    if periodic:  # the line that opens the ring is cut out of all else
        line = grid.on_line(1, 0.0)
        np.testing.assert_array_equal(np.sort(elimination_order(grid)[-len(line) :]), line)
    fixed = np.zeros((grid.n_nodes, 6), bool)
    fixed[grid.on_line(0, 0.0)] = True
    filled = []
    for ordered, rule in ((True, "NATURAL"), (False, "MMD_AT_PLUS_A")):
        shell = Discretisation.build(cylinder(2.0), grid, SKEW_LAMINATE, fixed, ordered=ordered)
        K = ShellModel(shell, MEASURES["exact"]).linearise(np.zeros(shell.n_free)).tangent
        filled.append(splu(K, permc_spec=rule, diag_pivot_thresh=1e-3, options={"SymmetricMode": True}).nnz)
    assert filled[0] < MOST_FILL * filled[1]


def test_a_hinge_holds_the_middle_of_a_hanging_node(rng) -> None:
    """On the line where it hangs between its ends, whatever these do."""
    grid = Quadtree.over(np.array([0.0, 1.0, 2.0]), np.array([0.0, 1.0])).refined(np.array([True, False])).grid()
    assert grid.hanging is not None
    hinged = np.zeros((grid.n_nodes, 3), bool)
    hinged[grid.on_line(0, 1.0), 2] = True
    shell = make_shell(Plate(), grid, hinged=hinged).discretisation
    v = shell.expand(0.01 * rng.normal(size=shell.n_free))[grid.on_line(0, 1.0)]
    assert np.abs(v[:, 4]).min() > 0
    np.testing.assert_allclose(v[:, 4] + v[:, 5], 0.0, rtol=0, atol=1e-15)
