"""Closed forms of beams, plates and rings against a rigid plane, and of a membrane over a sphere; no element enters.

D [N mm] is the bending stiffness and S [N/mm] the shear stiffness, both per width; lam = sqrt(D/S) [mm], 0 for
Euler-Bernoulli. The derivations are the project's own; tables computed by a beam program stand beside them.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

SPHERICAL = 0.9  # share of its radius up to which the obstacle is the sphere
QUARTER_1 = math.sqrt(math.pi) * math.gamma(0.25) / (2 * math.gamma(0.75))  # int_0^{pi/2} dt/sqrt(sin t) = 2.62205755
QUARTER_2 = math.sqrt(math.pi) * math.gamma(0.75) / (2 * math.gamma(1.25))  # int_0^{pi/2} sqrt(sin t) dt = 1.19814023


@dataclass(frozen=True)
class StripContact:
    """Per half of a clamped-clamped strip, half span 1, D = 1, gap 1: units a [mm], D g/a^3 [N/mm], D g/a^4 [MPa].

    free_length l/a.  half_force: all contact forces.  edge_pressure: where contact begins; infinite for lam = 0, where
    an edge force q l/3 takes its place.
    """

    free_length: float
    half_force: float
    edge_pressure: float


def strip_contact(q: float, lam: float) -> StripContact:
    """The strip under the pressure q [D g/a^4]; Timoshenko's for lam > 0, else Euler and Bernoulli's from 3 q0 on.

    In contact the pressure is q + (S phi/lam) cosh((c - x)/lam)/sinh(c/lam), x from its edge, c = 1 - l, with the
    rotation phi there; with T = coth(c/lam) the free length l solves::

        phi = (q l^3/6)/(1 + T l/lam + l^2/(2 lam^2)),
        1 = phi (T l^2/(2 lam) + l^3/(6 lam^2)) - q l^4/24 + q l^2 lam^2/2.

    Raises ValueError when there is no contact zone.
    """
    first = 72.0 if lam == 0 else 1 / (1 / 24 + lam**2 / 2)
    if q <= first:
        raise ValueError(f"q = {q:g} does not exceed {first:g}, at which a contact zone opens")
    if lam == 0:
        length = (72 / q) ** 0.25
        return StripContact(length, q * (1 - length / 3 * 2), float("inf"))

    def edge(length: float) -> tuple[float, float]:
        T = 1 / np.tanh((1 - length) / lam)
        return q * length**3 / 6 / (1 + T * length / lam + length**2 / (2 * lam**2)), T

    def missing(length: float) -> float:
        phi, T = edge(length)
        raised = phi * (T * length**2 / (2 * lam) + length**3 / (6 * lam**2))
        return float(raised - q * length**4 / 24 + q * length**2 * lam**2 / 2 - 1)

    length = _root(missing, 1e-3, 1 - 1e-12)
    phi, T = edge(length)
    return StripContact(length, float(q * (1 - length) + phi / lam**2), float(q + phi / lam**3 * T))


def lifted_strip(lam: float) -> tuple[float, float]:
    """Free length and lifting force of a long heavy strip on a plane, one end lifted by 1 and free to turn.

    Units (D delta/q)^(1/4) [mm] and q times that [N/mm]. phi = l^2 lam^2/(2 (lam + l)) and
    1 = phi l^2/(2 lam) + phi l^3/(6 lam^2) - l^4/24 + l^2 lam^2/2; the force is l - S phi, in the limit l/2.
    """
    if lam == 0:
        return 24**0.25, 24**0.25 / 2

    def edge(length: float) -> float:
        return length**2 * lam**2 / (2 * (lam + length))

    def missing(length: float) -> float:
        phi = edge(length)
        raised = phi * length**2 / (2 * lam) + phi * length**3 / (6 * lam**2)
        return raised - length**4 / 24 + length**2 * lam**2 / 2 - 1

    length = _root(missing, 1e-3, 10.0)
    return length, length - edge(length) / lam**2


def plate_contact(load: float) -> tuple[float, float]:
    """Radius c/a of the contact disc and its force [D g/a^2] of a clamped circular Kirchhoff plate above a plane.

    load: q a^4/(D g), above 64. Outside c: w = q r^4/64 + C1 + C2 r^2 + C3 ln r + C4 r^2 ln r, clamped at r = 1, with
    w(c) = 1 and w'(c) = w''(c) = 0. The force is all that the clamp does not carry.
    """
    if load <= 64:
        raise ValueError(f"load = {load:g} does not exceed 64, at which the plate touches")

    def constants(c: float) -> np.ndarray:
        """Load and C1..C4 of a disc of radius c: linear."""
        ln = float(np.log(c))
        A = [
            [1 / 64, 1, 1, 0, 0],
            [1 / 16, 0, 2, 1, 1],
            [c**4 / 64, 1, c**2, ln, c**2 * ln],
            [c**3 / 16, 0, 2 * c, 1 / c, 2 * c * ln + c],
            [3 * c**2 / 16, 0, 2, -1 / c**2, 2 * ln + 3],
        ]
        return np.linalg.solve(A, [0.0, 0.0, 1.0, 0.0, 0.0])

    c = _root(lambda c: float(constants(c)[0]) - load, 1e-5, 0.95)
    # the shear force at the clamp is (lap w)' = q/2 + 4 C4
    clamp = 2 * np.pi * (load / 2 + 4 * constants(c)[4])
    return c, float(np.pi * load - clamp)


def pinched_ring(travel: float) -> float:
    """Load P R^2/(EI) of a thin ring between two plates, each moved by ``travel`` R, while displacements are small.

    The plates touch along one line each: 2 delta = (pi/4 - 2/pi) P R^3/(EI). Timoshenko, Strength of Materials I, on
    the thin ring under two opposite forces.
    """
    return 2 * travel / (np.pi / 4 - 2 / np.pi)


def pressed_cylinders(approach: float, radius: float, moduli: tuple[float, float]) -> tuple[float, float]:
    """Force per length F [N/mm] and half width a [mm] of two long cylinders of one radius whose axes approach [mm].

    Hertz between halves of discs with E*_i = E_i/(1 - nu_i^2) [MPa], 1/E* = sum 1/E*_i, R* = R/2::

        a^2 = 4 F R*/(pi E*),    approach = F/(pi E*) (2 ln(4 R/a) - 1) = a^2/(2 R) (2 ln(4 R/a) - 1)

    Source: Johnson, Contact Mechanics (1985), 4.2(c) and (5.57) (recalled); up to the order of a/R. Raises ValueError
    unless 0 < approach < R/10.
    """
    if not 0 < approach < 0.1 * radius:
        raise ValueError(f"approach = {approach:g} must be in (0, {0.1 * radius:g}): Hertz's contact is small")
    a = _root(lambda a: a**2 / (2 * radius) * (2 * math.log(4 * radius / a) - 1) - approach, 1e-9 * radius, radius)
    return math.pi * a**2 / (2 * radius * sum(1 / each for each in moduli)), a


def hertz_pressure(force: float, radius: float, modulus: float) -> tuple[float, float]:
    """Half width a [mm] and largest pressure p0 [MPa] under F [N/mm] for R* [mm], E* [MPa]: p0 = 2 F/(pi a)."""
    a = math.sqrt(4 * force * radius / (math.pi * modulus))
    return a, 2 * force / (math.pi * a)


def flattened_ring(height: float) -> tuple[float, float]:
    """Load P R^2/(EI) and half length c/R of the flat part of a ring between plates H/2R = ``height`` apart.

    The inextensible elastica: P H^2/(EI) = 4 I2^2 and c = pi R/2 - I1 H/(2 I2), once it is flat (height <= 0.717770).
    P/2 acts at each end of the flat part, nothing between. Raises ValueError before that.
    """
    flat = np.pi / 2 - QUARTER_1 / QUARTER_2 * height
    if flat < 0:
        raise ValueError(f"H/2R = {height:g}: the ring is not flat before {np.pi / 2 * QUARTER_2 / QUARTER_1:.6f}")
    return (QUARTER_2 / height) ** 2, float(flat)


def _root(f: Callable[[float], float], low: float, high: float) -> float:
    """The zero between two arguments of different sign, halved down to neighbouring numbers.

    scipy.optimize would take longer to load than all references to compute.
    """
    positive = f(low) > 0
    while low < (middle := 0.5 * (low + high)) < high:
        if (f(middle) > 0) == positive:
            low = middle
        else:
            high = middle
    return middle


@dataclass(frozen=True)
class SphereObstacle:
    """A membrane over half a sphere: deflection, contact radius and force.

    On the unit disc, u = 0 on its edge, the tension 1 and no load: u >= phi, the sphere phi = sqrt(r0^2 - r^2), beyond
    r = 0.9 r0 continued by its tangent. In contact u = phi; beyond, -lap u = 0 gives u = A ln r. Value and slope are
    continuous at the contact radius a::

        A ln a = sqrt(r0^2 - a^2),    A/a = -a/sqrt(r0^2 - a^2)    =>    a^2 (1 - ln a) = r0^2,    A = -a^2/phi(a)

    The pressure is p = -lap phi = 2/phi + r^2/phi^3 and its resultant -2 pi A. For r0 = 1/2 the numbers of MFEM's
    example 36 (Keith, Surowiec, Found. Comput. Math. (2024), arXiv:2307.12444): a = 0.348982574111686,
    A = -0.340129705945858. Raises ValueError unless 0 < r0 and the rim of contact lies on the sphere (r0 < 0.879).
    """

    r0: float = 0.5
    contact_radius: float = field(init=False)
    factor: float = field(init=False)

    def __post_init__(self) -> None:
        from scipy.optimize import brentq  # slow to load: strips, plates and rings do without

        limit = SPHERICAL * self.r0
        if not 0 < self.r0 < 1 or _excess(limit, self.r0) <= 0:
            raise ValueError(f"r0 = {self.r0:g} must lie in (0, 0.879): the contact would leave the sphere")
        a = brentq(_excess, 1e-3 * self.r0**2, limit, args=(self.r0,), xtol=1e-16, rtol=1e-15)
        object.__setattr__(self, "contact_radius", float(a))
        object.__setattr__(self, "factor", float(-(a**2) / np.sqrt(self.r0**2 - a**2)))

    @property
    def force(self) -> float:
        """Resultant of the pressure."""
        return float(-2 * np.pi * self.factor)

    def height(self, r: np.ndarray) -> np.ndarray:
        """phi(r)."""
        b = SPHERICAL * self.r0
        top = np.sqrt(self.r0**2 - b**2)
        return np.where(r <= b, np.sqrt(self.r0**2 - np.minimum(r, b) ** 2), top - b / top * (r - b))

    def deflection(self, r: np.ndarray) -> np.ndarray:
        """u(r)."""
        outside = self.factor * np.log(np.maximum(r, self.contact_radius))
        return np.where(r <= self.contact_radius, self.height(r), outside)

    def slope(self, r: np.ndarray) -> np.ndarray:
        """u'(r)."""
        inside = np.minimum(r, self.contact_radius)
        on_sphere = -inside / np.sqrt(self.r0**2 - inside**2)
        return np.where(r <= self.contact_radius, on_sphere, self.factor / np.maximum(r, self.contact_radius))

    def radius_under(self, force: float) -> float:
        """The contact radius a at which the resultant is the force: 2 pi a^2/sqrt(r0^2 - a^2)."""
        squared = (force / (2 * np.pi)) ** 2
        return float(np.sqrt(0.5 * (np.sqrt(squared**2 + 4 * squared * self.r0**2) - squared)))


def _excess(a: float, r0: float) -> float:
    """a^2 (1 - ln a) - r0^2; grows with a < 1."""
    return float(a**2 * (1 - np.log(a)) - r0**2)
