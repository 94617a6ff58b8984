"""Every surface of revolution against sympy, from its position alone; the plane."""

import typing
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import pytest
import sympy as sp

from formulations.geometry import surfaces as surface_module
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
    found = {"position": position, "frame": entry.surface.frame(s, phi)}
    found |= {name: getattr(geometry, name) for name in "AkB"}
    for name, values in found.items():
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
