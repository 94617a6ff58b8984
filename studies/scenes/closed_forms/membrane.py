"""A flat circular membrane of neo-Hooke's rubber with a fixed edge, blown up by a pressure that follows: its equations.

Nothing varies around the axis, S33 is nothing, and the membrane has no bending stiffness. With the meridian's stretch
a, that around b = r/R, the slope phi and the nominal stresses P_a = dW/da, P_b = dW/db of plane stress::

    R h P_a sin phi = p r^2/2,    (R h P_a cos phi)' = h P_b - p r a sin phi,    r' = a cos phi,    z' = -a sin phi

and the volume between the membrane and the plane of its edge grows by -pi r^2 z'.
The stretch at the centre is the parameter along the path, on which the pressure has a maximum. No shell enters here.
Source: Adkins, Rivlin, Phil. Trans. R. Soc. A 244 (1952) 505 (recalled).
"""

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.integrate import solve_ivp
from scipy.optimize import brentq, minimize_scalar

MOST, CLOSE = 60, 1e-14  # iterations of the stretch across, and their last step
FIRST, GROWTH = 0.05, 1.25  # of the pressures tried, over 4 mu h/R
STRETCHES = 1.3, 4.0  # at the centre, between which the largest pressure lies
CENTRE = 1e-4  # of the radius: where the integration begins
TIGHT = 1e-9


@dataclass(frozen=True, eq=False)
class InflatedMembrane:
    """lam, mu [MPa]: Lamé's constants; radius, thickness [mm]."""

    lam: float
    mu: float
    radius: float
    thickness: float

    def stresses(self, a: float, b: float) -> tuple[float, float]:
        """P_a and P_b [MPa]: the stretch across follows from mu (c^2 - 1) + lam ln(a b c) = 0."""
        grown, y = math.log(a * b), 0.0  # y = ln c
        for _ in range(MOST):
            square = math.exp(2 * y)
            step = (self.mu * (square - 1) + self.lam * (grown + y)) / (2 * self.mu * square + self.lam)
            y -= step
            if abs(step) < CLOSE:
                break
        swelling = self.lam * (grown + y)
        return self.mu * (a - 1 / a) + swelling / a, self.mu * (b - 1 / b) + swelling / b

    def shape(self, pressure: float, stretch: float) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
        """R, r, the height w above the edge [mm] and the volume V above w [mm^3], for a stretch at the centre.

        r at the edge may not fit it.
        """
        ratio = pressure / self.thickness

        def meridian(R: float, r: float, Q: float) -> tuple[float, float]:
            """a, and phi, where R P_a cos phi is Q."""
            across = ratio * r * r / 2
            target, b = float(np.hypot(Q, across)) / R, r / R
            a = brentq(lambda x: self.stresses(x, b)[0] - target, 0.05, 1e3, xtol=1e-12)
            return a, float(np.arctan2(across, Q))

        def slopes(R: float, y: np.ndarray) -> list[float]:
            r, Q, *_ = map(float, y)
            a, phi = meridian(R, r, Q)
            falls = a * np.sin(phi)
            return [a * np.cos(phi), self.stresses(a, r / R)[1] - ratio * r * falls, -falls, np.pi * r * r * falls]

        start = CENTRE * self.radius
        at = [stretch * start, start * self.stresses(stretch, stretch)[0], 0.0, 0.0]
        solution = solve_ivp(slopes, (start, self.radius), at, method="LSODA", rtol=TIGHT, atol=TIGHT)
        r, _, z, volume = solution.y
        return solution.t, r, z - z[-1], volume

    def pressure(self, stretch: float) -> float:
        """[MPa] at which the edge stays where it is."""
        scale = 4 * self.thickness * self.mu / self.radius

        def off(share: float) -> float:
            return float(self.shape(share * scale, stretch)[1][-1]) / self.radius - 1

        share = min(FIRST, (stretch - 1) ** 1.5)
        while off(GROWTH * share) > 0:
            share *= GROWTH
        return float(brentq(off, share, GROWTH * share, xtol=1e-9)) * scale

    def deflection(self, stretch: float) -> float:
        """w [mm] at the centre."""
        return float(self.shape(self.pressure(stretch), stretch)[2][0])

    def volume(self, stretch: float) -> float:
        """V [mm^3] between the membrane and the plane of its edge."""
        return float(self.shape(self.pressure(stretch), stretch)[3][-1])

    @cached_property
    def limit(self) -> tuple[float, float]:
        """The largest pressure [MPa], and the stretch at the centre there."""
        optimum = minimize_scalar(
            lambda x: -self.pressure(x), bounds=STRETCHES, method="bounded", options={"xatol": 1e-4}
        )
        return -float(optimum.fun), float(optimum.x)
