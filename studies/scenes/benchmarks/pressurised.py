"""Thin shells under pressure against closed forms: cylinder, sphere, and the stress resultants of a torus.

Cylinder and sphere are membranes of St. Venant-Kirchhoff material (plane stress) under a follower pressure; the stretch
lam is the deformed over the reference radius. Virtual work gives::

    sphere                     p R/(E h) = (lam - 1/lam)/(1 - nu)
    cylinder of fixed length   p R/(E h) = (lam^2 - 1)/(2 (1 - nu^2))
    cylinder with open ends    p R/(E h) = (lam^2 - 1)/(2 sqrt(1 - nu (lam^2 - 1)))

Torus (linear): N_phi = p r (2 R + r sin phi)/(2 (R + r sin phi)), N_theta = p r/2 with phi from the crown. The
displacement of this membrane theory is singular at the crown, so the resultants are compared.
Sources: the first three are derived here; for the torus e.g. Timoshenko, Woinowsky-Krieger, Theory of Plates and Shells
(1959), section 108.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from itertools import chain

import numpy as np

from formulations.geometry.surfaces import Surface, cylinder, sphere, torus
from formulations.loads import PRESSURE_AREAS, Pressure
from formulations.section.laminate import Laminate, Ply
from formulations.shell import ShellModel
from studies.ask.declarations import CLOSED, FULL, LONG, Ladder, Sheet, ShellLimit, meshes, thickness_over
from studies.ask.scene import SOLVER, Declared, Reference, Request, SceneModel, Setting, UsageError
from studies.scenes.data import Row, references
from studies.scenes.element import ELEMENT, patch
from studies.scenes.statics import LOAD_FRACTIONS, StaticModel

E, NU, RADIUS = 1000.0, 0.3, 100.0  # MPa, -, mm
SECTOR = np.pi / 6  # of cylinder and sphere; symmetry holds all four edges or leaves one free
LARGEST = 1.2  # stretch at load fraction 1
THIN = 0.1  # mm
THICKNESS = Setting.positive("h_mm", THIN, "thickness; the closed forms hold for h/R to zero", 20)
CARRIER = "area that carries the pressure: of the mid-surface or of the true face"
AREA = Setting.one_of("pressure_area", PRESSURE_AREAS, "mid", CARRIER)
WALL: Mapping[str, str] = {
    "stretch": "deformed over reference radius of the middle surface",
    "thickness_ratio": "deformed over reference thickness",
}
FRACTIONS = (0.25, 0.5, 0.75, 1.0)
ALL_SYMMETRIC = ("symmetric",) * 4


def sphere_load(stretch: float) -> float:
    """Pressure p R/(E h) of the sphere."""
    return (stretch - 1 / stretch) / (1 - NU)


def fixed_cylinder_load(stretch: float) -> float:
    """Pressure p R/(E h) of the cylinder of fixed length."""
    return (stretch**2 - 1) / (2 * (1 - NU**2))


def open_cylinder_load(stretch: float) -> float:
    """Pressure p R/(E h) of the cylinder with open ends."""
    return (stretch**2 - 1) / (2 * float(np.sqrt(1 - NU * (stretch**2 - 1))))


def sphere_stretch(load: float) -> float:
    """Inverse of :func:`sphere_load`."""
    half = (1 - NU) * load / 2
    return half + float(np.sqrt(half**2 + 1))


def fixed_cylinder_stretch(load: float) -> float:
    """Inverse of :func:`fixed_cylinder_load`."""
    return float(np.sqrt(1 + 2 * (1 - NU**2) * load))


def open_cylinder_stretch(load: float) -> float:
    """Inverse of :func:`open_cylinder_load`: x = lam^2 - 1 solves x^2 + 4 nu P^2 x - 4 P^2 = 0."""
    linear = 2 * NU * load**2
    return float(np.sqrt(1 - linear + np.sqrt(linear**2 + 4 * load**2)))


def _references(
    at: Mapping[str, float | str], stretch_at: Callable[[float], float], largest: float, contraction: float
) -> tuple[Reference, ...]:
    """Stretch and thickness ratio sqrt(1 - c (lam^2 - 1)) at the default fractions; -E33 = c E_hoop in plane stress."""
    rows: list[Row] = []
    for fraction in FRACTIONS:
        stretch = stretch_at(fraction * largest)
        ratio = float(np.sqrt(1 - contraction * (stretch**2 - 1)))
        where = {**at, "load_fraction": fraction, "h_mm": THIN}
        rows.append((where, {"stretch": stretch, "thickness_ratio": ratio}))
    within = {"stretch": 1e-3, "thickness_ratio": 2e-3}
    return references("exact", "St. Venant-Kirchhoff membrane, virtual work", within, rows)


def _inflated(request: Request, surface: Surface, length: float, edges: Sequence[str], largest: float) -> StaticModel:
    """The sector under the pressure ``largest`` E h/R; everything is uniform, so any node has the stretch."""
    h = request.number("h_mm")
    sector = patch(request, surface, (0, length), (0, SECTOR), Laminate.single(Ply.isotropic(E, NU, h)), edges)
    pressure = Pressure(largest * E * h / RADIUS, follower=True, area=request.choice("pressure_area"))

    def uniform(shell: ShellModel, u: np.ndarray) -> dict[str, float]:
        inner, outer = sector.expand(u)[:, 4:].mean(axis=0)
        return {"stretch": float(1 + 0.5 * (inner + outer) / RADIUS), "thickness_ratio": float(1 + (outer - inner) / h)}

    return StaticModel.of(request, sector, uniform, pressure=pressure)


class PressurisedCylinder(Declared):
    """A sector of the circle, a1 along the axis: the length is fixed, or one end is free to move."""

    name = "pressurised-cylinder"
    title = "Cylinder under follower pressure (St. Venant-Kirchhoff membrane)"
    default_mesh = (2, 4)
    settings = (
        LOAD_FRACTIONS,
        Setting.one_of("ends", ("fixed", "open"), "fixed", "ends of the cylinder, held or free along it"),
        THICKNESS,
        AREA,
        *ELEMENT,
        SOLVER,
    )
    references = (
        *_references({"ends": "fixed"}, fixed_cylinder_stretch, fixed_cylinder_load(LARGEST), NU / (1 - NU)),
        *_references({"ends": "open"}, open_cylinder_stretch, open_cylinder_load(LARGEST), NU),
    )
    quantities = WALL
    ladders = tuple(
        Ladder(CLOSED, meshes(2, 4), tuple(WALL), settings={**FULL, "ends": ends}, name=f"pressurised-cylinder-{ends}")
        for ends in ("fixed", "open")
    )
    sheet = Sheet("x", 40.0, 28.0, mesh="8x16")
    shell_limit = ShellLimit("inflated tube", thickness_over(RADIUS, "h_mm"))

    def build(self, request: Request) -> SceneModel:
        """The length is half a radius."""
        if request.choice("ends") == "open":
            end, load = "free", open_cylinder_load
        else:
            end, load = "symmetric", fixed_cylinder_load
        edges = ("symmetric", end, "symmetric", "symmetric")
        return _inflated(request, cylinder(RADIUS), RADIUS / 2, edges, load(LARGEST))


class PressurisedSphere(Declared):
    """A piece from the equator up, 30 by 30 degrees; the motion is radial, so each edge slides in its cone."""

    name = "pressurised-sphere"
    title = "Sphere under follower pressure (St. Venant-Kirchhoff membrane)"
    default_mesh = (4, 4)
    settings = (LOAD_FRACTIONS, THICKNESS, AREA, *ELEMENT, SOLVER)
    references = _references({}, sphere_stretch, sphere_load(LARGEST), 2 * NU / (1 - NU))
    quantities = WALL
    ladders = (Ladder(CLOSED, meshes(2, 2), tuple(WALL), settings=FULL),)
    sheet = Sheet("x", 40.0, 28.0, mesh="8x8")
    shell_limit = ShellLimit("inflated sphere", thickness_over(RADIUS, "h_mm"))

    def build(self, request: Request) -> SceneModel:
        """The supports leave no rigid motion."""
        return _inflated(request, sphere(RADIUS), SECTOR, ALL_SYMMETRIC, sphere_load(LARGEST))


TUBE, AXIS = 100.0, 300.0  # mm: radius r of the tube, distance R of its centre from the axis
TORUS_PRESSURE, TORUS_E = 0.01, 1e6  # MPa: p r = 1 N/mm strains a wall of 1 mm by 1e-6, so every measure is linear


PLACES = {"outer": (np.pi / 2, 1e-3), "crown": (0.0, 2e-2), "inner": (-np.pi / 2, 1e-3)}  # phi, uncertainty


def torus_resultants(phi: float) -> tuple[float, float]:
    """N_phi, N_theta [N/mm] of the linear membrane theory at phi [rad] from the crown, outwards positive."""
    out = AXIS + TUBE * float(np.sin(phi))
    return TORUS_PRESSURE * TUBE * (AXIS + out) / (2 * out), TORUS_PRESSURE * TUBE / 2


def _torus_references() -> tuple[Reference, ...]:
    """Both resultants at three points; bending of the wall shows most at the crown, as (h/r)^(1/3)."""
    source, at = "linear membrane theory, local and global equilibrium", {"load_fraction": 1.0, "h_mm": THIN}
    by_place = (
        references("exact", source, within, [(at, _named(place, torus_resultants(phi)))])
        for place, (phi, within) in PLACES.items()
    )
    return tuple(chain.from_iterable(by_place))


def _named(place: str, resultants: Sequence[float] | np.ndarray) -> dict[str, float]:
    """N_phi and N_theta at a place by their names."""
    return {f"N_{name}_{place}_N_per_mm": float(N) for name, N in zip(("phi", "theta"), resultants, strict=True)}


class PressurisedTorus(Declared):
    """Half a meridian, from the outer to the inner equator, over a sector of 10 degrees; four symmetry planes."""

    name = "pressurised-torus"
    title = "Torus under pressure (linear membrane resultants)"
    default_mesh = (64, 1)
    settings = (
        replace(LOAD_FRACTIONS, default=(1.0,), help="fractions of the pressure to report"),
        THICKNESS,
        AREA,
        *ELEMENT,
        SOLVER,
    )
    references = _torus_references()
    quantities = {
        name: f"membrane resultant {along}, sum of both faces, at the {place}{'' if place == 'crown' else ' equator'}"
        for place in PLACES
        for name, along in zip(_named(place, (0, 0)), ("along the meridian", "around the axis"), strict=True)
    }
    ladders = (  # one element around the axis: nothing varies there
        Ladder(CLOSED, LONG, tuple(name for place in ("crown", "inner") for name in _named(place, (0, 0)))),
    )
    sheet = Sheet(azimuth=-62.0, elevation=22.0, mesh="64x4")
    shell_limit = ShellLimit("inflated torus", thickness_over(TUBE, "h_mm"))

    def build(self, request: Request) -> SceneModel:
        """a1 runs from the outer equator over the crown to the inner one; raises UsageError without a node at the
        crown.
        """
        n1, n2 = request.mesh
        if n1 % 2 or n1 < 4:
            raise UsageError(f"mesh {n1}x{n2}: the first number must be even and at least 4")
        laminate = Laminate.single(Ply.isotropic(TORUS_E, NU, request.number("h_mm")))
        half = patch(request, torus(AXIS, TUBE), (0, np.pi), (0, np.deg2rad(10)), laminate, ALL_SYMMETRIC)

        def resultants(shell: ShellModel, u: np.ndarray) -> dict[str, float]:
            grid = shell.discretisation.grid
            first = np.flatnonzero(np.isclose(grid.centre[:, 1], grid.half[:, 1]))  # one element across, all the way
            along = first[np.argsort(grid.centre[first, 0])]
            faces = shell.mean_resultants(u)[along, :4].reshape(-1, 2, 2)  # (element, direction, face)
            return _at_three_points(grid.centre[along, 0], faces.sum(axis=-1))

        pressure = Pressure(TORUS_PRESSURE, follower=True, area=request.choice("pressure_area"))
        return StaticModel.of(request, half, resultants, pressure=pressure)


def _at_three_points(phi: np.ndarray, N: np.ndarray) -> dict[str, float]:
    """Resultants (n, 2) at the centres phi of elements, interpolated to the fourth order; even about both equators."""
    crown = int(np.searchsorted(phi, np.pi / 2))
    around = slice(crown - 2, crown + 2)
    return (
        _named("outer", _even(phi[:2], N[:2]))
        | _named("crown", _cubic(phi[around] - np.pi / 2) @ N[around])
        | _named("inner", _even(np.pi - phi[:-3:-1], N[:-3:-1]))
    )


def _even(x: np.ndarray, N: np.ndarray) -> np.ndarray:
    """At 0 from values N (2, ...) at the places x (2,): a + b x^2."""
    return (x[1] ** 2 * N[0] - x[0] ** 2 * N[1]) / (x[1] ** 2 - x[0] ** 2)


def _cubic(x: np.ndarray) -> np.ndarray:
    """Weights (4,) at 0 of the values at four places x in the cubic through them (Lagrange)."""
    return np.array([np.prod(np.delete(x, k) / (np.delete(x, k) - x_k)) for k, x_k in enumerate(x)])


SCENES = (PressurisedCylinder(), PressurisedSphere(), PressurisedTorus())
