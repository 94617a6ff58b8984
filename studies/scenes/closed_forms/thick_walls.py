"""Thick isotropic walls in linear elasticity: Lamé's, Golovin's and Michell's closed forms; no element enters here.

Radii a (inner) and b (outer), E and nu; tube, bar and ring in plane strain, per unit width. All fields are exact, so
they judge a solid as well as a shell.
"""

from __future__ import annotations

import math

import numpy as np

FEW = 30  # terms of a series in s < 2


def lame_growth(r: float, a: float, b: float, E: float, nu: float, *, sphere: bool = False) -> float:
    """Radial displacement at r per unit pressure inside [mm/MPa] of a tube of fixed length, or of a sphere.

    Tube: (1 + nu)/E a^2/(b^2 - a^2) ((1 - 2 nu) r + b^2/r); sphere: 1/E a^3/(b^3 - a^3) ((1 - 2 nu) r + (1 + nu)
    b^3/(2 r^2)). Source: Timoshenko, Goodier, Theory of Elasticity (1970), sections 28 and 136 (recalled).
    """
    if sphere:
        return a**3 / (b**3 - a**3) / E * ((1 - 2 * nu) * r + (1 + nu) * b**3 / (2 * r**2))
    return (1 + nu) / E * a**2 / (b**2 - a**2) * ((1 - 2 * nu) * r + b**2 / r)


def golovin_turn(a: float, b: float, E: float, nu: float) -> float:
    """Rotation of one end of a curved bar against the other, per unit moment and unit angle of the arc [1/(N mm)].

    8 (b^2 - a^2)/(E' N) with N = (b^2 - a^2)^2 - 4 a^2 b^2 ln^2(b/a) and E' = E/(1 - nu^2); sections remain plane.
    With s = ln(b/a), N = 4 a^2 b^2 (sinh^2 s - s^2), whose series has no cancellation in thin bars.
    Source: Timoshenko, Goodier, Theory of Elasticity (1970), section 29 (recalled).
    """
    s = math.log(b / a)
    excess = sum((2 * s) ** (2 * k) / (2 * math.factorial(2 * k)) for k in range(2, FEW))
    return 8 * (b**2 - a**2) * (1 - nu**2) / (E * 4 * (a * b) ** 2 * excess)


def ovalised(r: float, a: float, b: float, E: float, nu: float) -> float:
    """Radial displacement at (r, theta = 0) of a ring under the traction cos 2 theta [MPa], outwards, on r = b.

    Michell's stress function (A r^2 + B r^4 + C/r^2 + D) cos 2 theta, no traction on r = a.
    Source: Barber, Elasticity (2010), tables 8.1 and 9.1 (recalled); the tests differentiate it.
    """
    kappa, G = 3 - 4 * nu, E / (2 * (1 + nu))

    def normal(x: float) -> list[float]:
        return [-2.0, 0.0, -6 / x**4, -4 / x**2]

    def shear(x: float) -> list[float]:
        return [2.0, 6 * x**2, -6 / x**4, -2 / x**2]

    m = 0.5 * (a + b)  # the unit of length
    rows = np.array([normal(a / m), shear(a / m), normal(b / m), shear(b / m)])
    amplitudes = np.linalg.solve(rows, [0.0, 0.0, 1.0, 0.0])
    x = r / m
    return float(amplitudes @ [-2 * x, (kappa - 3) * x**3, 2 / x**3, (kappa + 1) / x]) * m / (2 * G)
