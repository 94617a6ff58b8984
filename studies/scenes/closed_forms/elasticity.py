"""Walls of any thickness in three-dimensional linear elasticity: exact fields, which judge a solid as well as a shell.

Isotropic tube, sphere, curved bar and ring by Lamé's, Golovin's and Michell's closed forms: radii a (inner) and b
(outer), E and nu; tube, bar and ring in plane strain, per unit width. Pagano's simply supported plate of cross-plies by
transfer matrices. No element enters here.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from scipy.linalg import expm

from formulations.section.laminate import Ply

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


def middle_deflection(plies: Sequence[Ply], a: float, b: float, q0: float) -> float:
    """w [mm] at the centre of the middle surface of a cross-ply plate under q0 sin(pi x/a) sin(pi y/b) [MPa] on top.

    Any thickness, any odd number of plies (Pagano, J. Compos. Mater. 4 (1970) 20).
    y = (u, v, w, sigma_z, tau_xz, tau_yz), the amplitudes of its sines and cosines, obeys y' = A y in each ply, with
    A from Hooke's law and equilibrium; the bottom face is free. An odd number of plies, whose middle one holds the
    middle surface. Raises ValueError for an even number.
    """
    if len(plies) % 2 == 0:
        raise ValueError(f"the middle surface must lie inside a ply, not between {len(plies)}")
    p, q, middle = math.pi / a, math.pi / b, len(plies) // 2
    unit = plies[middle].thickness  # in units of which nothing overflows or is lost
    lower = np.eye(6)
    for ply in plies[:middle]:
        lower = expm(ply_equations(ply, p, q) * ply.thickness) @ lower
    half = expm(ply_equations(plies[middle], p, q) * unit / 2)
    at_middle = half @ lower
    whole = half @ at_middle
    for ply in plies[middle + 1 :]:
        whole = expm(ply_equations(ply, p, q) * ply.thickness) @ whole
    bottom = np.linalg.solve(whole[3:, :3], [q0, 0.0, 0.0])
    return float(at_middle[2, :3] @ bottom)


def ply_equations(ply: Ply, a: float, b: float) -> np.ndarray:
    """A (6, 6) of a ply whose stiffness has no 12 coupling; a, b: wave numbers [1/mm]."""
    C = ply.stiffness()
    A = np.zeros((6, 6))
    A[0, [2, 4]] = -a, 1 / C[4, 4]
    A[1, [2, 5]] = -b, 1 / C[5, 5]
    A[2, [0, 1, 3]] = np.array([C[0, 3] * a, C[1, 3] * b, 1.0]) / C[3, 3]
    A[3, [4, 5]] = a, b
    in_plane = np.array([[-C[0, 0] * a, -C[0, 1] * b, 0, 0, 0, 0], [-C[0, 1] * a, -C[1, 1] * b, 0, 0, 0, 0]])
    sigma_x, sigma_y = in_plane + np.outer(C[:2, 3], A[2])
    tau_xy = C[2, 2] * np.array([b, a, 0, 0, 0, 0])
    A[4], A[5] = -a * sigma_x + b * tau_xy, -b * sigma_y + a * tau_xy
    return A
