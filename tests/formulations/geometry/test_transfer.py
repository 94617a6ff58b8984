"""Fields carried between grids: cubics exactly, circles closed, modes as derivatives.

Every surface of revolution against sympy, from its position alone; the plane.
"""

import typing
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import pytest
import sympy as sp

from formulations.geometry import surfaces as surface_module
from formulations.geometry.grid import Grid
from formulations.geometry.quadtree import Quadtree
from formulations.geometry.surfaces import (
    Plate,
    SurfaceOfRevolution,
    annulus,
    cone,
    cylinder,
    elliptic_torus,
    hyperboloid,
    sphere,
    torus,
)
from formulations.geometry.transfer import Transfer

LINES = np.array([0.0, 0.1, 0.4, 0.5, 0.9, 1.0]), np.linspace(-1.0, 2.0, 8)
FINER = np.linspace(0.0, 1.0, 14), np.linspace(-1.0, 2.0, 10)
POWERS = ((0, 0), (1, 0), (0, 1), (1, 1))


def between(here: Grid, there: Grid) -> Transfer:
    actual = Transfer.between(here, there)
    assert actual is not None
    return actual


def with_hanging_nodes() -> Grid:
    tree = Quadtree.over(*LINES)
    return tree.refined(np.arange(len(tree.leaves)) == len(tree.leaves) // 2).grid()


def cubic(x: np.ndarray) -> np.ndarray:
    return np.stack([x[:, 0] ** 3 - x[:, 1] ** 2 * x[:, 0], 2 + x[:, 1] ** 3], axis=1)


def test_cubics_are_carried_exactly() -> None:
    here, there = Grid.tensor(*LINES), Grid.tensor(*FINER)
    assert between(here, there).nodal(cubic(here.nodes)) == pytest.approx(cubic(there.nodes))


def test_a_grid_with_hanging_nodes_takes_them_too() -> None:
    here, there = Grid.tensor(*LINES), with_hanging_nodes()
    assert there.hanging is not None
    assert between(here, there).nodal(cubic(here.nodes)) == pytest.approx(cubic(there.nodes))


def test_the_same_grid_keeps_every_value() -> None:
    here, rng = Grid.tensor(*LINES), np.random.default_rng(3)
    values = rng.normal(size=(here.n_nodes, 6))
    assert between(here, here).nodal(values) == pytest.approx(values)
    modes = rng.normal(size=(len(here.elements), 4))
    assert between(here, here).modes(modes, POWERS) == pytest.approx(modes)


@pytest.mark.parametrize("degree", [1, 3])
def test_on_a_circle_the_error_falls_with_the_order_everywhere(degree: int) -> None:
    errors = []
    for n in (16, 32):
        lines = np.linspace(0, 1, 3), np.linspace(0, 2 * np.pi, n + 1)
        here = Grid.tensor(*lines, periodic=True)
        there = Grid.tensor(lines[0], np.linspace(0, 2 * np.pi, 3 * n + 1), periodic=True)
        carried = between(here, there).nodal(np.sin(here.nodes[:, 1]), degree)
        errors.append(np.abs(carried - np.sin(there.nodes[:, 1])).max())
    assert np.log2(errors[0] / errors[1]) == pytest.approx(degree + 1, abs=0.2)


def test_modes_of_a_bilinear_field_are_those_of_the_other_grid() -> None:
    def modes(grid: Grid) -> np.ndarray:
        """Of 1 + 2 x + 3 y + 4 x y in each element."""
        (x, y), (h, k) = grid.centre.T, grid.half.T
        return np.stack([1 + 2 * x + 3 * y + 4 * x * y, (2 + 4 * y) * h, (3 + 4 * x) * k, 4 * h * k], axis=1)

    here, there = Grid.tensor(*LINES), Grid.tensor(*FINER)
    assert between(here, there).modes(modes(here), POWERS) == pytest.approx(modes(there))


def test_grids_that_do_not_fit_have_no_transfer() -> None:
    here = Grid.tensor(*LINES)
    assert Transfer.between(here, Grid.tensor(LINES[0], 1.01 * LINES[1])) is None
    assert Transfer.between(here, Grid.tensor(*LINES, periodic=True)) is None
    assert Transfer.between(with_hanging_nodes(), here) is None


def test_one_element_along_a_coordinate_is_enough() -> None:
    here, there = Grid.tensor(np.array([0.0, 1.0]), FINER[1]), Grid.tensor(FINER[0], FINER[1])
    values = here.nodes[:, 0] + here.nodes[:, 1] ** 2
    assert between(here, there).nodal(values) == pytest.approx(there.nodes[:, 0] + there.nodes[:, 1] ** 2)
    modes = np.ones((len(here.elements), 1))
    assert between(here, there).modes(modes, ((0, 0),)) == pytest.approx(np.ones((len(there.elements), 1)))


SYMBOLIC = 1e-12  # two evaluations of the same formula, lengths about 1
S, PHI = sp.symbols("s phi", real=True)


@dataclass(frozen=True)
class Entry:
    """A surface, its meridian (r(s), z(s)) written down once more, and the range of s to look at."""

    surface: SurfaceOfRevolution
    meridian: tuple[sp.Expr, sp.Expr]
    low: float
    high: float


CATALOGUE = {
    "cylinder": Entry(cylinder(2.0), (sp.Integer(2), S), -1.0, 1.5),
    "sphere": Entry(sphere(1.5), (1.5 * sp.cos(S), 1.5 * sp.sin(S)), -0.9, 1.1),
    "torus": Entry(torus(3.0, 1.0), (3 + sp.cos(S), sp.sin(S)), -2.2, 1.2),
    "elliptic_torus": Entry(elliptic_torus(3.0, 0.8, 1.3), (3 + 0.8 * sp.cos(S), 1.3 * sp.sin(S)), -2.2, 1.2),
    "annulus": Entry(annulus(), (S, sp.Integer(0)), 0.4, 2.0),
    "cone": Entry(cone(0.6), (S * sp.sin(0.6), S * sp.cos(0.6)), 0.5, 2.0),
    "hyperboloid": Entry(hyperboloid(1.2, 0.9), (sp.Rational(12, 10) * sp.sqrt(1 + (S / 0.9) ** 2), S), -1.0, 1.3),
}


def symbolic(meridian: tuple[sp.Expr, sp.Expr]) -> dict[str, Callable]:
    """Position, A, k, B, frame and the mixed terms of both fundamental forms, all from the position vector."""
    r, z = meridian
    x = sp.Matrix([r * sp.cos(PHI), r * sp.sin(PHI), z])
    x1, x2 = x.diff(S), x.diff(PHI)
    A1, A2 = sp.sqrt(x1.dot(x1)), sp.sqrt(x2.dot(x2))
    e1, e2 = x1 / A1, x2 / A2
    e3 = e2.cross(e1)  # left-handed (e1, e2, e3)
    expressions = {
        "position": x.T,
        "A": sp.Matrix([[A1, A2]]),
        "k": sp.Matrix([[-x.diff(S, 2).dot(e3) / A1**2, -x.diff(PHI, 2).dot(e3) / A2**2]]),  # second form, de3 = k e
        "B": sp.Matrix([[A2.diff(S) / (A1 * A2), A1.diff(PHI) / (A1 * A2)]]),
        "frame": sp.Matrix.hstack(e1, e2, e3).T,
        "mixed": sp.Matrix([[x1.dot(x2), x.diff(S).diff(PHI).dot(e3)]]),
    }
    return {name: sp.lambdify((S, PHI), expression) for name, expression in expressions.items()}


@pytest.fixture(params=CATALOGUE)
def entry(request: pytest.FixtureRequest) -> Entry:
    return CATALOGUE[request.param]


def test_every_surface_of_the_module_is_in_the_catalogue() -> None:
    hints = {name: typing.get_type_hints(f).get("return") for name, f in vars(surface_module).items() if callable(f)}
    factories = {name for name, kind in hints.items() if kind is SurfaceOfRevolution and not name.startswith("_")}
    assert factories == set(CATALOGUE)
    classes = {name for name, c in vars(surface_module).items() if isinstance(c, type) and hasattr(c, "position")}
    of_nodes = surface_module.NodalSurface.__name__  # it has no coordinates
    assert classes - {"Surface", of_nodes} == {Plate.__name__, SurfaceOfRevolution.__name__}


def test_geometry_and_frame_are_those_of_the_position_vector(entry: Entry, rng) -> None:
    expected = symbolic(entry.meridian)
    s, phi = rng.uniform(entry.low, entry.high, 20), rng.uniform(-3, 3, 20)
    geometry, position = entry.surface.geometry(s, phi), entry.surface.position(s, phi)
    by_name = {"position": position, "frame": entry.surface.frame(s, phi)}
    by_name |= {name: getattr(geometry, name) for name in "AkB"}
    for name, values in by_name.items():
        by_hand = np.array([expected[name](*point) for point in zip(s, phi, strict=True)]).reshape(values.shape)
        np.testing.assert_allclose(values, by_hand, rtol=0, atol=SYMBOLIC, err_msg=name)
    mixed = [expected["mixed"](*point) for point in zip(s, phi, strict=True)]
    np.testing.assert_allclose(mixed, 0, atol=SYMBOLIC)  # the coordinates are principal


@pytest.mark.parametrize("angle", [0.0, -0.3, np.pi / 2, np.nan])
def test_cone_refuses_a_half_angle_that_is_none(angle: float) -> None:
    with pytest.raises(ValueError, match=r"must lie in \(0, pi/2\)"):
        cone(angle)


def test_a_plate_is_its_coordinates(rng) -> None:
    a1, a2 = rng.normal(size=(2, 5))
    geometry = Plate().geometry(a1, a2)
    np.testing.assert_array_equal(Plate().position(a1, a2), np.stack([a1, a2, 0 * a1], axis=-1))
    np.testing.assert_array_equal(Plate().frame(a1, a2), np.broadcast_to(np.eye(3), (5, 3, 3)))
    for name, value in (("A", 1.0), ("k", 0.0), ("B", 0.0)):
        np.testing.assert_array_equal(getattr(geometry, name), np.full((5, 2), value))


def test_scalars_and_arrays_broadcast(patch) -> None:
    """One a1 against many a2 gives the points of the grid line, outside of the body along e3."""
    a1, a2 = patch.low[0], np.linspace(patch.low[1], patch.high[1], 4)
    for f in (patch.surface.position, patch.surface.frame, lambda *a: patch.surface.geometry(*a).k):
        one_by_one = np.stack([f(np.array(a1), a) for a in a2])
        np.testing.assert_allclose(f(np.array(a1), a2), one_by_one, rtol=0, atol=SYMBOLIC)
    position, frame = patch.surface.position(np.array(a1), a2), patch.surface.frame(np.array(a1), a2)
    assert np.all(np.sum(patch.outwards(position) * frame[:, 2], axis=-1) > 0)
