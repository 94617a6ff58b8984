"""Supports by name, forces along edges, prescribed displacements and reactions, each against a closed form."""

import math

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from formulations.conditions.boundary import EDGES, Supports
from formulations.discretisation import Discretisation
from formulations.geometry.grid import Grid
from formulations.geometry.surfaces import Plate, annulus, cylinder, torus
from formulations.loads import Pressure, edge_force, edge_lengths
from formulations.section.laminate import Laminate, Ply
from formulations.shell import ShellModel
from formulations.strains.catalogue import MEASURES
from support.problems.shells import make_shell, newton, nodal_components

ROUNDING = 1e-12  # relative
LENGTH = 1e-5  # two Gauss points on a curved line of 5 pieces


def discretise(surface, grid, laminate, supports=None, interpolation="curvilinear") -> Discretisation:
    supports = supports or Supports.none(grid)
    return Discretisation.build(surface, grid, laminate, *supports.masks, interpolation=interpolation)


def solved(shell: ShellModel, steps: int = 1) -> np.ndarray:
    """Newton from rest to rounding, in equal steps of the load."""
    u = np.zeros(shell.discretisation.n_free)
    for factor in np.arange(1, steps + 1) / steps:
        u = newton(shell.scaled(factor), u)
    return u


# --- the vocabulary -----------------------------------------------------------------------------------------------


@pytest.fixture
def corner_grid() -> Grid:
    return Grid.tensor(np.array([0.0, 1.0, 2.0]), np.array([0.0, 1.0]))


def held(supports: Supports, node: int) -> tuple[str, str]:
    """Faces held, and components hinged, at a node: ("1- 1+", "3")."""
    fixed, hinged = supports.masks
    faces = [f"{i + 1}{face}" for i in range(3) for f, face in enumerate("-+") if fixed[node, 2 * i + f]]
    return " ".join(faces), " ".join(str(i + 1) for i in np.flatnonzero(hinged[node]))


def test_words_hold_what_they_say(corner_grid) -> None:
    free = Supports.none(corner_grid)
    line = corner_grid.on_line(0, 0.0)
    for supports, faces, hinges in (
        (free.clamped(line), "1- 1+ 2- 2+ 3- 3+", ""),
        (free.symmetric(line, 0), "1- 1+", ""),
        (free.symmetric(line, 1), "2- 2+", ""),
        (free.diaphragm(line, 0), "", "2 3"),
        (free.diaphragm(line, 1), "", "1 3"),
        (free.hard_diaphragm(line, 0), "2- 2+", "3"),
        (free.hard_diaphragm(line, 1), "1- 1+", "3"),
        (free.hinged(line), "", "1 2 3"),
        (free.hinged(line, (0, 2)), "", "1 3"),
        (free.hold(line, (0, 1, 2), ("inner",)), "1- 2- 3-", ""),
        (free.hold(line, (2,), ("outer",)), "3+", ""),
    ):
        assert {held(supports, node) for node in line} == {(faces, hinges)}
        assert {held(supports, node) for node in set(range(6)) - set(line)} == {("", "")}
    assert not np.any(free.masks[0])


def test_supports_that_meet_add_up(corner_grid) -> None:
    """Both orders alike; a face and the middle of a component held leave nothing of it."""
    node = corner_grid.node_at(0.0, 0.0)
    free = Supports.none(corner_grid)
    for supports in (free.hinged(node).symmetric(node, 0), free.symmetric(node, 0).hinged(node)):
        assert held(supports, node) == ("1- 1+", "2 3")
    assert held(free.hinged(node, (2,)).hold(node, (2,), ("inner",)), node) == ("3- 3+", "")


ON_BOTH_FACES = "both faces held"
TURNS = {  # word: does it let a plate turn about the edge itself (at which height), and within the plane of the edge?
    "clamped": (None, False),
    "symmetric": (None, True),
    "diaphragm": (0.0, False),
    "hard-diaphragm": (0.0, False),
    "hinged": (0.0, False),
    "hinged inside": (-0.5, False),
    "hinged outside": (0.5, False),
    ON_BOTH_FACES: (None, False),
}


def supported(word: str, free: Supports, edge: np.ndarray, axis: int) -> Supports:
    if word == ON_BOTH_FACES:
        return free.hold(edge, (1 - axis, 2))
    if word.startswith("hinged "):
        return free.hold(edge, (0, 1, 2), ({"inside": "inner", "outside": "outer"}[word.split()[1]],))
    return EDGES[word](free, edge, axis)


@pytest.mark.parametrize("axis", [0, 1])
@pytest.mark.parametrize("word", TURNS)
def test_a_plate_turns_on_its_edge_as_far_as_the_word_says(word, axis) -> None:
    """A rigid rotation by 50 degrees either obeys the support, and then it costs nothing, or it does not obey it.

    A diaphragm with both faces held is none: the director would have to grow by 1/cos of its rotation.
    """
    h, angle = 0.1, math.radians(50)
    grid = Grid.tensor(np.linspace(0, 1, 3), np.linspace(0, 1, 4))
    edge = grid.on_line(axis, 0.0)
    laminate = Laminate.single(Ply.isotropic(200.0, 0.3, h))
    shell = discretise(Plate(), grid, laminate, supported(word, Supports.none(grid), edge, axis))
    height, in_plane = TURNS[word]

    def obeyed(about: np.ndarray, through: np.ndarray) -> bool:
        turn = Rotation.from_rotvec(angle * about).as_matrix()
        v = nodal_components(Plate(), grid, laminate, lambda x: (x - through) @ (turn - np.eye(3)).T)
        u = shell.map.restrict(v.reshape(-1, 6))
        same = bool(np.max(np.abs(shell.expand(u).ravel() - v)) <= ROUNDING)
        cost = ShellModel(shell, MEASURES["exact"]).energy(u)
        assert (cost <= 1e-24) == same
        return same

    along, across = np.eye(3)[1 - axis], np.eye(3)[axis]
    at_heights = {z: obeyed(along, np.array([0.0, 0.0, z * h])) for z in (-0.5, 0.0, 0.5)}
    assert at_heights == {z: z == height for z in at_heights}
    assert obeyed(across, np.zeros(3)) == in_plane


# --- edge forces --------------------------------------------------------------------------------------------------

OFFSET = Laminate((Ply.isotropic(200.0, 0.3, 0.2),), d_minus=0.1)  # the mid surface lies 0.2 outside of the reference
UNEQUAL = np.array([0.0, 0.1, 0.35, 0.5, 0.8, 1.0])


@pytest.mark.parametrize("interpolation", ["curvilinear", "isoparametric"])
@pytest.mark.parametrize("axis", [0, 1])
def test_edge_force_has_the_resultant_and_the_moment_of_its_traction(axis, interpolation) -> None:
    """On a torus, against a fine quadrature along the mid surface.

    Isoparametric: the work on a translation, the sum of the Cartesian nodal forces, is int t ds. Curvilinear: the work
    on constant local components, the sum of the local nodal forces, is int t.e_i ds.
    """
    lines = [0.3 + 0.9 * UNEQUAL, 0.5 + 0.8 * UNEQUAL]
    surface, d_bar = torus(3.0, 1.0), 0.2
    shell = discretise(surface, Grid.tensor(*lines), OFFSET, interpolation=interpolation)

    def traction(a1: np.ndarray, a2: np.ndarray) -> np.ndarray:
        return np.stack([1 + a1 * a2, a1 - a2, 2 * a2], axis=-1)

    at = lines[axis][-1]
    forces = edge_force(shell, axis, at, traction, (0.3, 0.7))
    t, weight = np.polynomial.legendre.leggauss(20)
    a = [np.full(20, at), np.full(20, at)]
    low, high = lines[1 - axis][[0, -1]]
    a[1 - axis] = (low + high + (high - low) * t) / 2
    g = surface.geometry(*a)
    ds = weight * (high - low) / 2 * (g.A * (1 + g.k * d_bar))[:, 1 - axis]
    if interpolation == "isoparametric":
        frame, exact = surface.frame(*shell.grid.nodes.T), ds @ traction(*a)
    else:
        frame = np.broadcast_to(np.eye(3), (shell.grid.n_nodes, 3, 3))
        exact = np.einsum("g,gix,gx->i", ds, surface.frame(*a), traction(*a))
    for face, share in enumerate((0.3, 0.7)):
        total = np.einsum("ni,nix->x", forces[:, face::2], frame)
        np.testing.assert_allclose(total, share * exact, rtol=0, atol=LENGTH * np.abs(exact).max())
    off = np.delete(np.arange(shell.grid.n_nodes), shell.grid.on_line(axis, at))
    assert np.all(forces[off] == 0)


def test_edge_force_on_an_inner_line_counts_once_and_on_a_seam_too() -> None:
    """A ring line of a closed cylinder, first, inner and last, and a generator on the seam."""
    around, along = np.linspace(0, 2 * math.pi, 9), np.array([0.0, 0.4, 1.0])
    shell = discretise(cylinder(2.0), Grid.tensor(along, around, periodic=True), OFFSET)

    def outwards(a1: np.ndarray, a2: np.ndarray) -> np.ndarray:
        return np.stack([np.cos(a2), np.sin(a2), np.zeros_like(a2)], axis=-1)

    for value in along:
        forces = edge_force(shell, 0, value, outwards)
        assert forces[:, 4:].sum() == pytest.approx(2 * math.pi * 2.2, rel=ROUNDING)
        assert np.ptp(forces[shell.grid.on_line(0, value), 4:]) <= ROUNDING
    seam = edge_force(shell, 1, 0.0, outwards)
    assert seam[shell.grid.on_line(1, 0.0), 4] == pytest.approx([0.1, 0.25, 0.15], rel=ROUNDING)
    with pytest.raises(ValueError, match=r"the grid has no line a1 = 0\.5"):
        edge_force(shell, 0, 0.5, outwards)


def test_edge_lengths_of_an_annulus() -> None:
    """Arcs r da2 of unequal elements, and their sum."""
    angles = UNEQUAL * math.pi / 2
    shell = discretise(annulus(), Grid.tensor(np.array([1.0, 3.0]), angles), OFFSET)
    nodes, lengths = edge_lengths(shell, 0, 3.0)
    np.testing.assert_array_equal(nodes, shell.grid.on_line(0, 3.0))
    pieces = np.diff(angles) * 3.0
    np.testing.assert_allclose(lengths, (np.append(0, pieces) + np.append(pieces, 0)) / 2, rtol=ROUNDING)


# --- hinges -------------------------------------------------------------------------------------------------------


# --- prescribed displacements -------------------------------------------------------------------------------------


def test_prescribed_displacements_scale_and_must_be_held(curved_patch, rng) -> None:
    """Half of them is half of them; the residual is that of the whole shell at expand(u) + prescribed."""
    grid = curved_patch.grid(2, 3)
    fixed = rng.random((grid.n_nodes, 6)) < 0.3
    given = np.where(fixed, 0.1 * rng.normal(size=fixed.shape), 0.0)
    held_shell = make_shell(curved_patch.surface, grid, fixed=fixed, prescribed=given)
    loose = make_shell(curved_patch.surface, grid)
    u = 0.1 * rng.normal(size=held_shell.discretisation.n_free)
    for factor in (0.5, 1.0):
        everything = held_shell.discretisation.expand(u) + factor * given
        model = held_shell.scaled(factor)
        np.testing.assert_array_equal(model.displacements(u), everything)
        full = loose.linearise(everything.ravel())
        some = model.linearise(u)
        np.testing.assert_allclose(some.residual, full.residual[~fixed.ravel()], rtol=0, atol=ROUNDING * full.scale)
        np.testing.assert_allclose(
            model.reactions(u)[fixed], full.residual[fixed.ravel()], rtol=0, atol=ROUNDING * full.scale
        )
        assert np.all(model.reactions(u)[~fixed] == 0)
        assert some.scale == pytest.approx(full.scale, rel=ROUNDING)
    with pytest.raises(ValueError, match="a prescribed displacement must be held"):
        make_shell(curved_patch.surface, grid, fixed=fixed, prescribed=np.ones_like(given))


def test_reactions_balance_pressure_and_dead_pressure_is_counted() -> None:
    """A clamped square under its pressure, dead or following: the supports carry it all."""
    grid = Grid.tensor(np.linspace(0, 1, 5), np.linspace(0, 1, 5))
    edges = np.unique(np.concatenate([grid.on_line(axis, line) for axis in (0, 1) for line in (0.0, 1.0)]))
    supports = Supports.none(grid).clamped(edges)
    shell = discretise(Plate(), grid, Laminate.single(Ply.isotropic(200.0, 0.3, 0.05)), supports)
    for follower in (False, True):
        model = ShellModel(shell, MEASURES["exact"], pressure=Pressure(1e-3, follower=follower))
        u = solved(model)
        assert model.reactions(u)[:, 4:].sum() == pytest.approx(-1e-3, rel=1e-9 if not follower else 1e-3)
