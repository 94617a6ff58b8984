"""An inextensible ring under an outside pressure that follows, collapsed onto itself: by shooting, for no thickness.

Units: radius R = 1, bending stiffness EI = 1 a unit of length. Only a quarter is solved, from the crown (s = 0, tangent
along x, height y above the plane of contact) to the side (s = pi/2, tangent downwards, y = 0), where no shear force is.
The tangent is (cos t, sin t), k = t' its curvature (-1 at rest), and M = k + 1. With the force P of the other half on
the crown and N = -p y(0) there, the force on a cut is F = (-p y, p x - P/2) and::

    x' = cos t,    y' = sin t,    t' = k,    k' = F_x sin t - F_y cos t,    a' = y cos t

From buckling (p = 3) to touch P = 0 and y(0) > 0; then y(0) = 0 and P grows, until the crown is straight, k(0) = 0.
From there on a part of half length c lies flat under the pressure p of both sides, and the rest is the ring that has
just become straight, made smaller by s = (p_line/p)^(1/3): c = (pi/2)(1 - s), and at each end of the flat part half of
P_line/s^2. Source: Flaherty, Keller, Rubinow, SIAM J. Appl. Math. 23 (1972) 446 (recalled). No shell enters here.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.integrate import solve_ivp
from scipy.optimize import root

BUCKLING = 3.0
TIGHT, CLOSED = 3e-14, 1e-11  # of the integration, and of the side
SIDE = math.pi / 2
Start = tuple[float, float, float, float]  # p, P, k and y at the crown


@dataclass(frozen=True)
class Shape:
    """A ring: p, the half ``gap`` y(0) at the crown, the ``force`` P there, the curvature there, and the area inside.

    half_width: x of the side.  flat: half length c of the flat part.  force: all of the contact, 2 p c of it spread.
    """

    pressure: float
    gap: float
    force: float
    curvature: float
    half_width: float
    area: float
    flat: float = 0.0


def free(pressure: float) -> Shape:
    """Between buckling and touch; raises ValueError elsewhere."""
    return _solved(lambda k, y: (pressure, 0.0, k, y), (0.3, 0.5), f"free under {pressure:g}")


def touch() -> Shape:
    """Where the crown has just come down."""
    return _solved(lambda p, k: (p, 0.0, k, 0.0), (5.2, 1.0), "at touch")


def straight() -> Shape:
    """Where the crown has just become straight: p_line, P_line."""
    return _solved(lambda p, P: (p, P, 0.0, 0.0), (10.0, 6.0), "straight at its crown")


def pressed(pressure: float) -> Shape:
    """In contact; raises ValueError below the pressure of touch."""
    line = straight()
    if pressure <= line.pressure:
        return _solved(lambda P, k: (pressure, P, k, 0.0), (pressure - 5, 0.5), f"in contact under {pressure:g}")
    s = (line.pressure / pressure) ** (1 / 3)
    flat = SIDE * (1 - s)
    force = line.force / s**2 + 2 * pressure * flat
    return Shape(pressure, 0.0, force, 0.0, flat + s * line.half_width, s**2 * line.area, flat)


def _solved(start: Callable[[float, float], Start], guess: tuple[float, float], what: str) -> Shape:
    """The shape whose two unknowns at the crown bring its side where it has to be."""

    def missed(unknown: np.ndarray) -> tuple[float, float]:
        _, y, t, _, _ = _side(start(*unknown))
        return y, t + SIDE

    solution = root(missed, guess, tol=1e-14)
    p, P, k, y = (float(each) for each in start(*solution.x))
    if max(map(abs, solution.fun)) > CLOSED or not (0 <= y < 1 and P >= 0 and p > BUCKLING):
        raise ValueError(f"no ring is {what}")
    x, _, _, _, a = _side((p, P, k, y))
    return Shape(p, y, P, k, float(x), float(4 * a))


def _side(start: Start) -> np.ndarray:
    """x, y, t, k, a at the side."""
    p, P, curvature, height = start

    def along(s: float, state: np.ndarray) -> tuple[float, ...]:
        x, y, t, k, _ = state
        cos, sin = math.cos(t), math.sin(t)
        return cos, sin, k, -p * y * sin - (p * x - P / 2) * cos, y * cos

    begin = (0.0, height, 0.0, curvature, 0.0)
    return np.asarray(solve_ivp(along, (0.0, SIDE), begin, method="DOP853", rtol=TIGHT, atol=TIGHT).y[:, -1])
