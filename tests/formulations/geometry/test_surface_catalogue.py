"""Every surface of revolution against sympy (from its position alone) and closed forms."""

from __future__ import annotations

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
    assert classes - {"Surface"} == {Plate.__name__, SurfaceOfRevolution.__name__}


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


def test_hyperbolic_paraboloid_is_refused_by_its_own_geometry() -> None:
    """Cartesian lines on z = x^2 - y^2: not orthogonal, and x = const meets the surface at a varying angle."""
    x, y = sp.symbols("x y", real=True)
    position = sp.Matrix([x, y, x**2 - y**2])
    x1, x2 = position.diff(x), position.diff(y)
    assert sp.simplify(x1.dot(x2) + 4 * x * y) == 0
    normal = x1.cross(x2)
    cosine = normal[0] / sp.sqrt(normal.dot(normal))
    assert sp.simplify(cosine + 2 * x / sp.sqrt(1 + 4 * x**2 + 4 * y**2)) == 0
    assert sp.simplify(cosine.diff(y)) != 0


# --- closed forms -----------------------------------------------------------------------------------------------


def test_annulus_is_flat_and_looks_down() -> None:
    r, phi = np.array([0.5, 2.0]), np.array([0.3, 4.0])
    surface, geometry = annulus(), annulus().geometry(r, phi)
    assert np.all(geometry.k == 0)
    np.testing.assert_allclose(geometry.A, np.stack([np.ones(2), r], axis=-1), rtol=SYMBOLIC)
    np.testing.assert_allclose(geometry.B, np.stack([1 / r, np.zeros(2)], axis=-1), rtol=SYMBOLIC)
    np.testing.assert_allclose(surface.frame(r, phi)[:, 2], np.broadcast_to([0, 0, -1.0], (2, 3)), atol=SYMBOLIC)


def test_cone_closed_form() -> None:
    s = np.array([0.5, 1.0, 3.0])
    geometry = cone(0.6).geometry(s, 0 * s)
    np.testing.assert_allclose(geometry.k, np.stack([0 * s, 1 / (s * np.tan(0.6))], axis=-1), atol=SYMBOLIC)
    np.testing.assert_allclose(geometry.A, np.stack([1 + 0 * s, s * np.sin(0.6)], axis=-1), rtol=SYMBOLIC)
    np.testing.assert_allclose(geometry.B[:, 0], 1 / s, rtol=SYMBOLIC)


@pytest.mark.parametrize("angle", [0.0, -0.3, np.pi / 2, np.nan])
def test_cone_refuses_a_half_angle_that_is_none(angle: float) -> None:
    with pytest.raises(ValueError, match=r"must lie in \(0, pi/2\)"):
        cone(angle)


def test_hyperboloid_closed_form() -> None:
    """Gauss curvature -1/(1 + 2 z^2)^2 for a = c = 1, and the two formulas of the docstring."""
    a, c, z = 1.3, 0.7, np.array([-1.0, 0.0, 0.4])
    r = a * np.sqrt(1 + (z / c) ** 2)
    A1 = np.sqrt(1 + (a**2 * z / (c**2 * r)) ** 2)
    geometry = hyperboloid(a, c).geometry(z, 0 * z)
    expected = {
        "A": [A1, r],
        "k": [-(a**4) / (c**2 * r**3 * A1**3), 1 / (r * A1)],
        "B": [a**2 * z / (c**2 * r**2 * A1), 0 * z],
    }
    for name, values in expected.items():
        np.testing.assert_allclose(getattr(geometry, name), np.stack(values, axis=-1), atol=SYMBOLIC, err_msg=name)
    unit = hyperboloid(1.0, 1.0).geometry(z, 0 * z)
    np.testing.assert_allclose(unit.k.prod(axis=-1), -1 / (1 + 2 * z**2) ** 2, rtol=SYMBOLIC)


@pytest.mark.parametrize("axial", [0.4, 1.3])
def test_whole_torus_has_no_total_curvature(axial: float) -> None:
    """Gauss and Bonnet: the integral of k1 k2 A1 A2 over the whole section vanishes."""
    t = np.linspace(0, 2 * np.pi, 200)[:-1]  # the trapezoidal rule of a periodic function
    geometry = elliptic_torus(3.0, 0.8, axial).geometry(t, 0 * t)
    assert abs(np.mean(geometry.k.prod(axis=-1) * geometry.A.prod(axis=-1))) <= SYMBOLIC


def test_elliptic_torus_closed_form_and_the_round_one() -> None:
    Rc, a, b, t = 3.0, 0.8, 1.3, np.linspace(-2, 2, 7)
    geometry = elliptic_torus(Rc, a, b).geometry(t, 0 * t)
    A1, r = np.hypot(a * np.sin(t), b * np.cos(t)), Rc + a * np.cos(t)
    np.testing.assert_allclose(geometry.A, np.stack([A1, r], axis=-1), rtol=SYMBOLIC)
    np.testing.assert_allclose(geometry.k, np.stack([a * b / A1**3, b * np.cos(t) / (A1 * r)], axis=-1), atol=SYMBOLIC)
    np.testing.assert_allclose(geometry.B[:, 0], -a * np.sin(t) / (A1 * r), atol=SYMBOLIC)
    round_one, round_torus = elliptic_torus(Rc, a, a).geometry(t, 0 * t), torus(Rc, a).geometry(t, 0 * t)
    for name in "AkB":
        np.testing.assert_array_equal(getattr(round_one, name), getattr(round_torus, name))
