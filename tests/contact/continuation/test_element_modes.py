"""Motions of elements alone are counted apart, with the grid that has none; what the body does is still counted."""

import math
from collections.abc import Callable
from dataclasses import replace
from functools import partial

import numpy as np
import pytest
from scipy import sparse

from contact.catalogue import ALGORITHMS
from contact.continuation.stability import STABLE, UNSTABLE, Stability, stability
from contact.problem import ContactSolution, without_contact
from contact.solvers.sparse import factor_flops, factorise
from formulations.conditions.boundary import Supports
from formulations.discretisation import Discretisation
from formulations.element_modes import ElementModes, neighbours
from formulations.geometry.grid import Grid, QuadGrid
from formulations.geometry.surfaces import NodalSurface, Plate, Surface, cylinder
from formulations.loads import Pressure, edge_lengths
from formulations.section.laminate import Laminate, Ply
from formulations.shell import ShellModel
from formulations.strains.catalogue import MEASURES
from studies.scenes.complete import complete
from studies.solving.result import CONVERGED
from studies.solving.solve import solve
from support.problems.differences import rotation

E, H, L = 1000.0, 0.1, 10.0  # of strips, with nu = 0
EI = E * H**3 / 12  # per width
CLOSED_FORM = 1e-3  # of a critical load


def shell(
    surface: Surface, ends: tuple[float, float], mesh: tuple[int, int], h: float, *edges: str, **loads
) -> ShellModel:
    """A piece 0 <= a <= ends of a surface on an even mesh; edges: as for Supports."""
    grid = Grid.tensor(*(np.linspace(0, end, n + 1) for end, n in zip(ends, mesh, strict=True)))
    laminate = Laminate((Ply.isotropic(E, 0.0, h),), d_minus=-h / 2)
    masks = Supports.of_edges(grid, *edges).masks
    discretisation = Discretisation.build(surface, grid, laminate, *masks, ordered=True)
    return ShellModel(discretisation, MEASURES["exact"], newton="plain", **loads)


def pushed(model: ShellModel, force: np.ndarray) -> ShellModel:
    """Under dead forces (N,) along a1, half on each face."""
    nodal = np.zeros((len(force), 6))
    nodal[:, :2] = force[:, None] / 2
    return replace(model, forces=model.discretisation.reduce(nodal))


def verdict(model: ShellModel) -> Stability:
    """On the equilibrium that Newton finds from rest."""
    n = model.discretisation.n_free
    problem = without_contact(model.linearise, n, ordered=True)
    state = ALGORITHMS["semismooth"]().solve(problem, ContactSolution.at_rest(n, 0))
    assert state.outcome.converged
    return stability(replace(problem, element_modes=partial(ElementModes, model)), state)


def test_the_sentence_counts_those_of_elements_beside_those_of_the_body() -> None:
    """Three eigenvalues are negative: one of the body is not said to be one of these two, or all that there are."""
    sentence = Stability(1, element_modes=2, cuts=(1, 2), aspect=3.2).sentence
    assert sentence.startswith(
        "unstable: 1 negative eigenvalue of the tangent on the motions that contact leaves free,"
    )
    assert ", apart from 2 modes of elements alone up to 3.2 times wider than long, not of the body" in sentence


def critical(at: Callable[[float], ShellModel], guess: float) -> float:
    """The load at which the first eigenvalue that is counted turns negative, to a tenth of CLOSED_FORM."""
    low, high = 0.9 * guess, 1.1 * guess
    assert (verdict(at(low)).negative, verdict(at(high)).negative) == (0, 1)
    while high - low > CLOSED_FORM / 10 * guess:
        middle = (low + high) / 2
        low, high = (low, middle) if verdict(at(middle)).negative else (middle, high)
    return (low + high) / 2


def buckles(at: Callable[[float], ShellModel], load: float) -> bool:
    """Whether the first eigenvalue that is counted turns negative within CLOSED_FORM of the load."""
    return [verdict(at((1 + side) * load)).negative for side in (-CLOSED_FORM, CLOSED_FORM)] == [0, 1]


def column(width: float, mesh: tuple[int, int], h: float = H) -> ShellModel:
    """A strip that stands on a clamp."""
    return shell(Plate(), (L, width), mesh, h, "clamped", "free", "free", "free")


def euler(model: ShellModel, P: float) -> ShellModel:
    """The column under P [N/mm] at its top."""
    nodes, lengths = edge_lengths(model.discretisation, 0, L)
    force = np.zeros(model.discretisation.grid.n_nodes)
    force[nodes] = -P * lengths
    return pushed(model, force)


def greenhill(model: ShellModel, q: float) -> ShellModel:
    """The column under its own weight q [MPa]."""
    return pushed(model, -q * model.discretisation.nodal_areas("mid"))


def ring(mesh: tuple[int, int], p: float) -> ShellModel:
    """A quarter of a ring of the radius L under the pressure p [MPa] on its inner face."""
    edges, follows = ("symmetric", "free", "symmetric", "symmetric"), Pressure(-p, follower=True)
    return shell(cylinder(L), (1.0, math.pi / 2), mesh, H, *edges, pressure=follows)


@pytest.mark.parametrize(("width", "mesh"), [(1.0, (128, 1)), (5.0, (64, 1))])
def test_columns_buckle_where_euler_and_greenhill_say(width: float, mesh: tuple[int, int]) -> None:
    P, q = math.pi**2 * EI / (4 * L**2), 7.8373 * EI / L**3
    assert buckles(partial(euler, column(width, mesh)), P)
    assert buckles(partial(greenhill, column(width, mesh)), q)


def test_a_ring_under_pressure_buckles_at_3_EI() -> None:
    """The inner face is smaller than the middle by h/2R, and what its stretch adds to the load makes up for it."""
    p = 3 * EI / L**3
    assert buckles(partial(ring, (1, 128)), p)


@pytest.mark.slow
def test_a_column_still_buckles_where_its_elements_have_modes() -> None:
    """A thick one whose elements are 64, 32 and 16 times wider than long: the last are not driven."""
    P = math.pi**2 * E * 0.5**3 / 12 / (4 * L**2)
    wide, less, square = (partial(euler, column(10.0, (64, n), 0.5)) for n in (1, 2, 4))
    actual = critical(wide, P)
    assert buckles(less, actual)
    assert buckles(square, actual)
    counts = [verdict(at(1.01 * actual)) for at in (wide, less, square)]
    assert [count.negative for count in counts] == [1, 1, 1]
    assert [count.word for count in counts] == [UNSTABLE] * 3
    assert counts[0].element_modes > counts[1].element_modes > counts[2].element_modes == 0


@pytest.mark.parametrize(("n", "modes"), [(116, 0), (140, 6), pytest.param(256, 68, marks=pytest.mark.slow)])
def test_modes_of_elements_of_a_cantilever_are_no_instability(n: int, modes: int) -> None:
    """At 1.34 % of compression at its clamp, from about 120 elements of its length and one of its width on."""
    scene, request = complete("cantilever", {"load_fraction": "1"}, (n, 1))
    solution = solve(scene, request)
    record = solution.loads[-1].certificate["stability"]
    assert (record["word"], record["negative"], record["element_modes"]) == (STABLE, 0, modes)
    assert (solution.verdict, solution.unstable) == (CONVERGED, [])
    if not modes:
        assert solution.notes == []
        return
    assert record["cuts"][0] == 1
    mesh = (n, record["cuts"][1])
    assert solution.notes[0].endswith(f"of elements alone, not of the shell: {n}x{mesh[1]} removes them")
    cut = solve(*complete("cantilever", {"load_fraction": "1"}, mesh)).loads[-1].certificate["stability"]
    assert (cut["negative"], cut["element_modes"]) == (0, 0)


@pytest.mark.slow
def test_a_strip_that_a_couple_rolls_up_buckles_sideways_and_its_elements_have_modes_beside_that() -> None:
    """The couple follows the director: a rod of these stiffnesses leaves its plane at 0.796 of a full circle."""
    loads = {"load_fraction": "0.785,0.81,1"}
    whole, long = (solve(*complete("sze-moment", loads, mesh)) for mesh in ((24, 1), (128, 1)))
    counts = [[step["stability"]["negative"] for step in actual.steps] for actual in (whole, long)]
    assert counts == [[0, 1, 1], [0, 1, 1]]
    alone = [actual.steps[-1]["stability"]["element_modes"] for actual in (whole, long)]
    assert alone == [0, 40]
    assert long.verdict == UNSTABLE


LONG = ("32x2", "16x4", "4x16", "2x32")
STABLE_ONES = (
    [("cantilever", mesh) for mesh in ("64x1", "128x1", *LONG)]
    + [("hemisphere", mesh) for mesh in ("1x16", *LONG)]
    + [("tyre", mesh) for mesh in ("8x8", "24x8", "8x24")]
    + [(scene, mesh) for scene in ("sze-annulus", "strip-contact", "ring", "panel") for mesh in LONG]
    + [
        ("semicylinder-90-0-90", "16x4"),
        ("semicylinder-90-0-90", "16x8"),
        ("crushed-ring", "8x8"),
        ("pressurised-cylinder", "16x4"),
    ]
)


@pytest.mark.slow
@pytest.mark.parametrize(("scene", "mesh"), STABLE_ONES)
def test_no_state_is_unstable_because_its_elements_are_long(scene: str, mesh: str) -> None:
    """Up to 16 times longer than on an even grid, both ways; on finer grids all of these are stable."""
    settings = {"tyre": {"delta_mm": "5,10"}, "hemisphere": {"load_fraction": "0.2"}}.get(scene, {})
    solution = solve(*complete(scene, settings, mesh))
    assert solution.verdict == CONVERGED
    assert solution.unstable == []


@pytest.mark.parametrize("turned", [0.0, 1.1])
def test_the_drive_of_a_compressed_element_is_its_strain_over_its_ratio(turned: float) -> None:
    """rho = 3 eps (b/l)^2 in membrane compression, eps (b/l)^2/sqrt(3) in bending; however turned."""
    eps, length, width = 1e-3, 0.2, 2.0
    model = shell(Plate(), (5 * length, width), (5, 1), H, "free", "free", "free", "free")
    R = rotation(np.array([0.3, -0.7, 0.5]), turned)
    for bent, factor in ((False, 3.0), (True, 1 / math.sqrt(3))):
        faces = (-eps, eps) if bent else (-eps, -eps)
        v = np.zeros((model.discretisation.grid.n_nodes, 6))
        for face, strain in enumerate(faces):
            x = model.discretisation.positions()[face]
            there = x + strain * (x - 2.5 * length) * (1, 0, 0)
            v[:, face::2] = there @ R.T - x
        rho = ElementModes(model, model.discretisation.map.restrict(v)).drive
        assert rho[2, 1] == pytest.approx(eps * (width / length) ** 2 * factor, rel=10 * eps)  # in the middle
        assert rho[:, 0].max() < 5 * eps


def test_smooth_motions_have_no_alternating_shear() -> None:
    """Where the shear on xi2 is the same in all elements it costs nothing; where it alternates, thrice all of it."""
    n, length, width = 6, 0.5, 2.0
    model = shell(Plate(), (n * length, width), (n, 1), H, "free", "free", "free", "free")
    nodes = model.discretisation.grid.nodes
    modes, overlooked = [], ElementModes(model, np.zeros(model.discretisation.n_free))
    for along in (nodes[:, 0], (-1.0) ** np.round(nodes[:, 0] / length)):
        v = np.zeros((len(nodes), 6))
        v[:, 2] = v[:, 3] = (nodes[:, 1] - width / 2) * along  # v2 of both faces
        modes.append(model.discretisation.map.restrict(v))
    first, second = overlooked.stiffness
    smooth, alternating = (float(mode @ second @ mode) / 2 for mode in modes)
    G, slope = E / 2, width / length  # v2,1 from one node to the next at a2 = 0 and width
    assert alternating == pytest.approx((n - 1) * 0.5 * G * H * slope**2 * length * width)
    assert smooth == pytest.approx(0, abs=1e-9 * alternating)
    assert max(abs(first @ mode).max() for mode in modes) < 1e-9 * alternating
    assert [overlooked.alternating(mode[:, None]) for mode in modes] == [0, 1]
    assert overlooked.alternating(np.stack(modes, axis=1)) == 1


@pytest.mark.slow
@pytest.mark.parametrize(("scene", "mesh"), [("roof-a", (8, 8)), ("roof-b", (4, 16))])
def test_a_roof_that_has_snapped_is_unstable_by_itself_however_near_its_limit_point(scene: str, mesh: tuple) -> None:
    """Between its limit points one eigenvalue is negative, and as small as one likes: none is of elements."""
    solution = solve(*complete(scene, {}, mesh))
    counts = [step["stability"]["negative"] + step["stability"]["element_modes"] for step in solution.steps]
    assert max(counts) == 1
    assert [step["stability"]["element_modes"] for step in solution.steps] == [0] * len(counts)
    assert solution.notes == []


def test_neighbours_share_a_side_and_close_around_a_seam() -> None:
    grid = Grid.tensor(np.linspace(0, 1, 4), np.linspace(0, 1, 5), periodic=True)
    pairs = [{tuple(pair) for pair in neighbours(grid, axis).tolist()} for axis in (0, 1)]
    assert pairs[0] == {(4 * i + j, 4 * i + 4 + j) for i in range(2) for j in range(4)}
    assert pairs[1] == {(4 * i + j, 4 * i + (j + 1) % 4) for i in range(3) for j in range(4)}


def test_elements_of_a_mesh_without_lines_are_as_long_as_on_a_grid() -> None:
    """2 x 0.5 mm, compressed by 20 % along the short sides."""
    model = shell(Plate(), (8.0, 1.0), (4, 2), H, "clamped", "free", "free", "free")
    grid, own = model.discretisation.grid, model.discretisation
    surface = NodalSurface.of(
        np.column_stack([grid.nodes, np.zeros(grid.n_nodes)]),
        np.tile([0.0, 0.0, 1.0], (grid.n_nodes, 1)),
        np.array([1.0, 0.0, 0.0]),
    )
    free = QuadGrid.over(grid.elements)
    body = Discretisation.build(surface, free, own.laminate, own.map.held, None, interpolation="quads")
    on_quads = ShellModel(body, MEASURES["exact"], newton="plain")
    pressed = np.zeros((grid.n_nodes, 6))
    pressed[:, 2:4] = -0.2 * grid.nodes[:, 1:]
    values = [ElementModes(each, each.discretisation.map.restrict(pressed)) for each in (model, on_quads)]
    assert values[0].aspect == pytest.approx(4.0)
    assert values[1].aspect == pytest.approx(values[0].aspect)
    assert np.allclose(values[1].drive, values[0].drive, rtol=1e-6, atol=1e-9)


@pytest.mark.parametrize(
    ("scene", "mesh"),
    [pytest.param("hemisphere", "32x32", marks=pytest.mark.slow), ("tyre", "36x36"), ("ring", "1x40")],
)
def test_the_tangent_that_couples_neighbours_has_an_order_of_its_own(scene: str, mesh: str) -> None:
    """All unknowns once; where a grid extends both ways it saves most of the operations, and counts the same."""
    named, request = complete(scene, {}, mesh)
    shell = named.build(request).shell
    u = np.zeros(shell.discretisation.n_free)
    modes = ElementModes(shell, u)
    order = modes.order
    assert order is not None
    np.testing.assert_array_equal(np.sort(order), np.arange(len(u)))
    first, second = modes.stiffness
    K = sparse.csc_matrix(shell.linearise(u, None).tangent + first + second)
    own, its = (factorise(A, ordered=True) for A in (K, sparse.csc_matrix(K[order][:, order])))
    assert factor_flops(its) < (0.5 if min(map(int, mesh.split("x"))) > 1 else 1.1) * factor_flops(own)
    b = np.random.default_rng(0).normal(size=len(u))
    np.testing.assert_allclose(
        its.solve(b[order]), own.solve(b)[order], rtol=1e-6, atol=1e-9 * np.abs(own.solve(b)).max()
    )
