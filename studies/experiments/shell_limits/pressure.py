"""Vessels under pressure, linear: tube, sphere, closed torus, and the wall of a tyre clamped at its rim.

The displacement is nearly uniform through the thickness; what the shell misses is its 1/r (tube) or 1/r^2 (sphere).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from formulations.conditions.boundary import Supports
from formulations.discretisation import Discretisation
from formulations.geometry.grid import Grid
from formulations.geometry.surfaces import Surface, cylinder, sphere, torus
from formulations.section.laminate import Laminate, Ply
from formulations.strains.catalogue import LINEAR
from studies.experiments.shell_limits.bodies import Answer, Solid, solved_shell, usual_shell
from studies.experiments.shell_limits.ladder import Variant
from studies.scenes.closed_forms.elasticity import lame_growth

E, NU = 1000.0, 0.3  # MPa
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
        body = Discretisation.build(self.surface, grid, laminate, *supports.masks, ordered=True)
        v = solved_shell(usual_shell(body, LINEAR, variant.section, p=P, area=variant.area))
        return self._read(v[grid.node_at(0.0, 0.0), 4:], ratio, body.n_free)

    def straight(self, ratio: float, n: int) -> Answer:
        """As ``solid``, its displacement linear through the wall."""
        return self.solid(ratio, n, straight=True)

    def solid(self, ratio: float, n: int, *, straight: bool = False) -> Answer:
        """The same of hexahedra, a quarter of n through the wall."""
        body = Solid.over(self.surface, *self.lines(n, self.clamped), self.laminate(ratio), max(1, n // 4))
        mesh = body.mesh
        body = body.hold(0, mesh.on(0, 0.0)).hold(0, mesh.on(0, self.ends))
        body = body.hold(1, mesh.on(1, 0.0)).hold(1, mesh.on(1, self.across))
        if self.axisymmetric and not self.uniform_along:
            body = body.hold(1)
        if self.clamped:
            body = body.hold(2, mesh.on(0, self.ends))
        u, unknowns = body.solve(pressure=P, straight=straight)
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
