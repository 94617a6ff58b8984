"""Walls under pressure, linear: tube, sphere, torus, a tyre's; and pressed by a plane, nonlinear: ring, strip, tyre.

Under pressure the displacement is nearly uniform through the thickness; what the shell misses is its 1/r (tube) or
1/r^2 (sphere). Under the contact the wall is squeezed and indented over a length of the order of its thickness or less.
A shell has one stretch of its director for that.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from contact.catalogue import ALGORITHMS
from contact.continuation.load_stepping import follow
from contact.obstacles.foundation import Candidates, RigidPlane, against
from contact.problem import ContactProblem, ContactSolution
from formulations.conditions.boundary import Supports
from formulations.discretisation import Discretisation
from formulations.geometry.grid import Grid
from formulations.geometry.surfaces import Plate, Surface, cylinder, sphere, torus
from formulations.section.laminate import Laminate, Ply
from formulations.shell import ShellModel
from formulations.solid import SolidDiscretisation, SolidModel
from formulations.strains.catalogue import EXACT, LINEAR
from studies.experiments.shell_limits.bending import QUARTER, STRIP, E, R, layered, wall
from studies.experiments.shell_limits.bodies import Answer, Solid, Variant, body_of, solved_shell, usual_shell
from studies.scenes.closed_forms.elasticity import lame_growth
from studies.scenes.complete import complete
from studies.scenes.contact.base import outer_face
from studies.scenes.element import spaced_lines
from studies.scenes.statics import area_load
from studies.solving.solve import solve

NU = 0.3
P = 1.0  # MPa: everything is linear
SECTOR = np.pi / 6
SLICE = np.deg2rad(2.0)  # of a body of revolution: quadratic sides follow the circle to 1e-8


@dataclass(frozen=True)
class Vessel:
    """A piece of a surface under inner pressure, its growth read at (0, 0), where it is largest or uniform.

    ends, across: where a1 and a2 end, from 0.  clamped: the end of a1; every other edge is a plane, or a cone, of
    symmetry.  axisymmetric: nothing varies along a2.  uniform_along: nothing varies along a1.  inner: the surface is
    the inner face, not the middle.
    """

    surface: Surface
    radius: float
    ends: float
    across: float
    nu: float = NU
    clamped: bool = False
    axisymmetric: bool = True
    uniform_along: bool = False
    inner: bool = False

    def laminate(self, ratio: float) -> Laminate:
        """One isotropic layer."""
        h = ratio * self.radius
        return Laminate((Ply.isotropic(E, self.nu, h),), 0.0 if self.inner else -h / 2)

    def lines(self, n: int, to_end: bool) -> tuple[np.ndarray, np.ndarray]:
        """Grid lines, closer towards the clamp."""
        s = np.linspace(0.0, 1.0, (1 if self.uniform_along else n) + 1)
        first = self.ends * (np.sin(np.pi / 2 * s) if to_end else s)
        return first, np.linspace(0.0, self.across, (n if self.uniform_along or not self.axisymmetric else 1) + 1)

    def shell(self, ratio: float, n: int, variant: Variant) -> Answer:
        """Growth of both faces, and of their mean."""
        laminate, grid = self.laminate(ratio), Grid.tensor(*self.lines(n, self.clamped))
        end = "clamped" if self.clamped else "symmetric"
        supports = Supports.of_edges(grid, "symmetric", end, "symmetric", "symmetric")
        body = body_of(self.surface, grid, laminate, supports, variant)
        v = body.expand(solved_shell(usual_shell(body, LINEAR, variant.section, p=P, area=variant.area)))
        return self._read(v[grid.node_at(0.0, 0.0), 4:], ratio, body.n_free)

    def solid(self, ratio: float, n: int) -> Answer:
        """The same of hexahedra, a quarter of n through the wall."""
        body = Solid.over(self.surface, *self.lines(n, self.clamped), self.laminate(ratio), max(1, n // 4))
        mesh = body.mesh
        body = body.hold(0, mesh.on(0, 0.0)).hold(0, mesh.on(0, self.ends))
        body = body.hold(1, mesh.on(1, 0.0)).hold(1, mesh.on(1, self.across))
        if self.axisymmetric and not self.uniform_along:
            body = body.hold(1)
        if self.clamped:
            body = body.hold(2, mesh.on(0, self.ends))
        u, unknowns = body.solve(pressure=P)
        return self._read(u[body.line(0.0, 0.0)[[0, -1]], 2], ratio, unknowns)

    def _read(self, faces: Sequence[float] | np.ndarray, ratio: float, unknowns: int) -> Answer:
        """Growth in units of p R^2/(E h)."""
        inner, outer = np.asarray(faces) * E * ratio / (P * self.radius)
        return Answer({"growth": float(0.5 * (inner + outer)), "growth of the inner face": float(inner)}, unknowns)

    def lame(self, ratio: float) -> dict[str, float]:
        """Of a tube, or of a sphere."""
        a, b = (self.radius * (1 + side * ratio / 2) for side in (-1, 1))
        faces = [P * lame_growth(r, a, b, E, self.nu, sphere=not self.uniform_along) for r in (a, b)]
        return self._read(faces, ratio, 0).values


TUBE = Vessel(cylinder(100.0), 100.0, 50.0, SECTOR, uniform_along=True)
BALL = Vessel(sphere(100.0), 100.0, SECTOR, SECTOR, axisymmetric=False)
TORUS = Vessel(torus(300.0, 100.0), 100.0, np.pi, SLICE)
TYRE = Vessel(torus(200.0, 50.0), 50.0, np.deg2rad(120.0), SLICE, nu=0.45, clamped=True, inner=True)


ALGORITHM = "semismooth"
STRAIGHT = 1e-9  # what rounding takes off the component of a unit vector along its own axis
NO_NU = 0.0  # nu, as in the scenes of the ring and of the strip


@dataclass(frozen=True, eq=False)
class Pressed:
    """A body before a plane: what it is and what of its outer face may touch."""

    body: ShellModel | SolidModel
    candidates: Candidates
    plane: RigidPlane

    def force(self, travel: float, *, loaded: bool = False) -> float:
        """Sum of the contact forces [N] when the plane has travelled inwards; ``loaded``: with the load grown, too.

        Raises ArithmeticError when the path ends before.
        """

        def at(share: float) -> ContactProblem:
            body = self.body.scaled(share) if loaded else self.body
            plane = self.plane.moved(-share * travel * self.plane.normal)
            return against(body.linearise, self.candidates, plane)

        start = ContactSolution.at_rest(self.body.discretisation.n_free, len(self.candidates.reference))
        (point,) = follow(at, 0.0, [1.0], ALGORITHMS[ALGORITHM](), start)
        if not point.outcome.converged:
            raise ArithmeticError(f"pressed to {point.reached:g} of its travel: {point.outcome.value}")
        return float(np.sum(at(1.0).nodal_forces(point.solution.pressure)))


def solid_before(plane: RigidPlane, solid: Solid, still: np.ndarray, forces: np.ndarray | None = None) -> Pressed:
    """A solid under dead forces (N, 3); nodes ``still`` of its outer face cannot touch.

    Raises ValueError for a support that is not along a Cartesian axis.
    """
    fixed = np.zeros_like(solid.held)
    nodes, component = np.nonzero(solid.held)
    along = np.abs(solid.frame(solid.mesh.parameter[nodes])[np.arange(len(nodes)), component])
    if np.any(along.max(axis=1) < 1 - STRAIGHT):
        raise ValueError("a support of a pressed solid must be along a Cartesian axis")
    fixed[nodes, along.argmax(axis=1)] = True
    body = SolidDiscretisation.build(solid.mesh, solid.laminate, fixed)
    free = np.setdiff1d(np.unique(solid.mesh.outer), still)
    weights = solid.mesh.face_areas(solid.mesh.outer)[free]
    candidates = Candidates(solid.mesh.x[free], body.displacement_operator(free), weights)
    load = None if forces is None else forces.ravel()[body.free]
    return Pressed(SolidModel(body, forces=load), candidates, plane)


def shell_before(
    plane: RigidPlane, body: Discretisation, still: np.ndarray, variant: Variant, forces: np.ndarray | None = None
) -> Pressed:
    """A shell with the element and the measure of the scenes under nodal forces (N, 6)."""
    model = usual_shell(body, EXACT, variant.section, forces=forces)
    return Pressed(model, outer_face(body, np.setdiff1d(np.arange(body.grid.n_nodes), still)), plane)


CRUSHED = R / 4  # travel of each plate
AWAY = np.array([1.0, 0.0, 0.0])


def ring_shell(ratio: float, n: int, variant: Variant) -> Answer:
    """A quarter of the ring of the scene, lines closer towards the plate."""
    h = ratio * R
    grid = Grid.tensor(STRIP, spaced_lines(0.0, QUARTER, n, True))
    supports = Supports.of_edges(grid, *("symmetric",) * 4)
    body = body_of(cylinder(R), grid, wall(h, NO_NU, variant), supports, variant)
    pressed = shell_before(RigidPlane(AWAY, R + h / 2), body, grid.on_line(1, QUARTER), variant)
    return Answer({"force": pressed.force(CRUSHED) * _ring_unit(h)}, body.n_free)


def ring_solid(ratio: float, n: int) -> Answer:
    """The same, finer towards the contact."""
    h = ratio * R
    lines = spaced_lines(0.0, QUARTER, n, True)
    solid = Solid.over(cylinder(R), STRIP, lines, layered(h, max(2, n // 8), NO_NU))
    mesh = solid.mesh
    solid = solid.hold(0).hold(1, mesh.on(1, 0.0)).hold(1, mesh.on(1, QUARTER))
    pressed = solid_before(RigidPlane(AWAY, R + h / 2), solid, mesh.on(1, QUARTER))
    return Answer({"force": pressed.force(CRUSHED) * _ring_unit(h)}, pressed.body.discretisation.n_free)


def _ring_unit(h: float) -> float:
    """R^2/(E I) of half the width that a quarter carries."""
    return 2 * R**2 / (E * h**3 / 12)


SPAN = 100.0  # mm: half of the strip
GAP = 0.05  # of the thickness: so small that nothing but the contact is nonlinear to speak of
OVER = 5.0  # the pressure over that at which the thin strip touches
UP = np.array([0.0, 0.0, 1.0])


def strip_shell(ratio: float, n: int, variant: Variant) -> Answer:
    """Half of the strip of the scene without its freedom of shear: that of the law."""
    h = ratio * SPAN
    grid = Grid.tensor(spaced_lines(0.0, SPAN, n, True, True), STRIP)
    supports = Supports.of_edges(grid, "clamped", "symmetric", "symmetric", "symmetric")
    body = body_of(Plate(), grid, wall(h, NO_NU, variant), supports, variant)
    forces = area_load(body, lambda a1, a2: _strip_load(h) * UP)
    plane = RigidPlane(UP, h / 2 + GAP * h)
    pressed = shell_before(plane, body, grid.on_line(0, 0.0), variant, forces)
    return Answer({"half force": pressed.force(0.0, loaded=True) * _strip_unit(h)}, body.n_free)


def strip_solid(ratio: float, n: int) -> Answer:
    """The same, half of the pressure on each face."""
    h = ratio * SPAN
    lines = spaced_lines(0.0, SPAN, n, True, True)
    solid = Solid.over(Plate(), lines, STRIP, layered(h, max(2, n // 8), NO_NU, to_inner=True))
    mesh = solid.mesh
    solid = solid.hold(1).hold(0, mesh.on(0, 0.0)).hold(2, mesh.on(0, 0.0)).hold(0, mesh.on(0, SPAN))
    up = _strip_load(h) / 2 * UP
    inner, outer = (
        solid.traction(face, lambda x, at: np.broadcast_to(up, x.shape)) for face in (mesh.inner, mesh.outer)
    )
    pressed = solid_before(RigidPlane(UP, h / 2 + GAP * h), solid, mesh.on(0, 0.0), inner + outer)
    return Answer({"half force": pressed.force(0.0, loaded=True) * _strip_unit(h)}, pressed.body.discretisation.n_free)


def _strip_load(h: float) -> float:
    """OVER times 24 D g/a^4 [MPa]."""
    return OVER * 24 * E * h**3 / 12 * GAP * h / SPAN**4


def _strip_unit(h: float) -> float:
    """a^3/(D g) per width."""
    return SPAN**3 / (E * h**3 / 12 * GAP * h)


TRAVEL, DESIGN = 10.0, 4.8  # mm; thickness for which the tyre's own pressure is meant
INNER_RADIUS = 50.0  # mm: R1_mm


def tyre_settings(ratio: float) -> dict[str, str]:
    """The isotropic tyre under a pressure that strains every wall alike."""
    h = ratio * INNER_RADIUS
    return {
        **{"E_MPa": "20", "nu": "0.45", "plies": "1", "ply_thickness_mm": repr(h), "delta_mm": repr(TRAVEL)},
        **{"p0_MPa": repr(0.15 * h / DESIGN), "load": "follower"},
    }


def _tyre(scene: str, ratio: float, mesh: str, settings: dict[str, str]) -> Answer:
    result = solve(*complete(scene, tyre_settings(ratio) | settings, mesh, contact=ALGORITHM))
    if not result.outcome.converged:
        raise ArithmeticError(f"{scene} at h/R = {ratio:g}: {result.reason}")
    force = result.quantities["force_N"] / ratio
    growth = 0.5 * sum(result.quantities[f"inflated_equator_{face}_mm"] for face in ("inner", "outer"))
    return Answer({"force": force, "growth": growth}, int(result.counters["dofs"]))


def tyre_shell(ratio: float, n: int, variant: Variant) -> Answer:
    """The scene ``tyre``, n elements along the meridian and as many around but two."""
    options = {"pressure_area": variant.area, "section": variant.section, "surfaces": variant.surfaces}
    return _tyre("tyre", ratio, f"{n}x{n - 2}", options)


def tyre_solid(ratio: float, n: int) -> Answer:
    """The scene ``tyre-solid``."""
    return _tyre("tyre-solid", ratio, f"{n}x{n * 9 // 7 // 2 * 2}", {})
