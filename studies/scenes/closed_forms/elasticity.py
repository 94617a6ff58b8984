"""Walls of any thickness in three-dimensional linear elasticity: exact fields, which judge a solid as well as a shell.

Isotropic tube, sphere, curved bar and ring by Lamé's, Golovin's and Michell's closed forms: radii a (inner) and b
(outer), E and nu; tube, bar and ring in plane strain, per unit width. Simply supported plates (Pagano) and cylinders
(Varadan, Bhaskar) of cross-plies from ply to ply. Under inner pressure a tube of orthotropic layers, and tubes and
spheres of incompressible rubber at large strains. No element and no law of the shell enters here.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.integrate import quad
from scipy.linalg import expm

from formulations.section.laminate import Ply

FEW = 30  # terms of a series in s < 2
STEEP, CURVED = 2.0, 8  # exponent of a part of a ply at most; parts of half a curved ply at least


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

    Of any thickness; raises ValueError for an even number of plies. Source: see :func:`through_wall`.
    """
    if len(plies) % 2 == 0:
        raise ValueError(f"the middle surface must lie inside a ply, not between {len(plies)}")
    return float(through_wall(plies, math.pi / a, math.pi / b, (0.0, q0))[len(plies) // 2, 1, 2])


def through_wall(
    plies: Sequence[Ply], a: float, b: float, normal: tuple[float, float], curvature: float = 0.0
) -> np.ndarray:
    """(plies, 3, 9): amplitudes on the inner side, in the middle and on the outer side of each ply of a cross-ply wall.

    Of u, v, w [mm], s33, s13, s23, s11, s22, s12 [MPa] in a mode of the wave numbers a along x and b along y [1/mm] of
    the middle surface, which may be curved along y [1/mm]: w, s33, s11, s22 ~ sin(a x) sin(b y), u, s13 ~ cos sin,
    v, s23 ~ sin cos, s12 ~ cos cos. normal [MPa]: s33 on the inner and on the outer face; no shears act on them.
    Sources: Pagano, J. Compos. Mater. 4 (1970) 20; Varadan, Bhaskar, Compos. Struct. 17 (1991) 141 (recalled).
    """

    def law(ply: Ply, d: float) -> tuple[np.ndarray, np.ndarray]:
        return ply_equations(ply, a, b / (1 + curvature * d), curvature / (1 + curvature * d))

    start = -0.5 * math.fsum(ply.thickness for ply in plies)
    transfers: list[np.ndarray] = []
    places, rows = [], []
    for ply in plies:
        h = ply.thickness
        steepest = np.abs(np.linalg.eigvals(law(ply, start)[0])).max()
        n = math.ceil(max(h * steepest / (2 * STEEP), CURVED if curvature else 1))
        places.append([len(transfers) + part for part in (0, n, 2 * n)])
        rows.append([law(ply, start + share * h)[1] for share in (0.0, 0.5, 1.0)])
        step = h / (2 * n)
        apart = step / math.sqrt(12)  # Magnus' exponent of the fourth order
        for middle in start + step * (np.arange(2 * n) + 0.5):
            lower, upper = (law(ply, middle + sign * apart)[0] for sign in (-1, 1))
            transfers.append(expm(step / 2 * (lower + upper) + step * apart / 2 * (upper @ lower - lower @ upper)))
        start += h
    states = _states(transfers, normal)[places]
    return np.concatenate([states, np.einsum("pkij,pkj->pki", rows, states)], axis=-1)


def _states(transfers: Sequence[np.ndarray], normal: tuple[float, float]) -> np.ndarray:
    """(parts + 1, 6): u, v, w, s33, s13, s23 between the parts of a wall with these transfer matrices.

    The stiffness of all that lies below, (s33, s13, s23) = Z (u, v, w) + g, is carried outwards and the displacements
    back: products of transfer matrices lose all digits in walls thicker than a wave.
    """
    Z, g, below = np.zeros((3, 3)), np.array([normal[0], 0.0, 0.0]), []
    for T in transfers:
        back, moved = np.linalg.inv(T[:3, :3] + T[:3, 3:] @ Z), T[:3, 3:] @ g
        below.append((Z, g, back, moved))
        Z = (T[3:, :3] + T[3:, 3:] @ Z) @ back
        g = T[3:, 3:] @ g - Z @ moved
    u = np.linalg.solve(Z, np.array([normal[1], 0.0, 0.0]) - g)
    states = [np.append(u, Z @ u + g)]
    for Z, g, back, moved in reversed(below):
        u = back @ (u - moved)
        states.append(np.append(u, Z @ u + g))
    return np.array(states[::-1])


def ply_equations(ply: Ply, a: float, b: float, k: float = 0.0) -> tuple[np.ndarray, np.ndarray]:
    """A (6, 6) and S (3, 6) of a ply whose stiffness has no 12 coupling: y' = A y and (s11, s22, s12) = S y.

    y = (u, v, w, s33, s13, s23); a, b: wave numbers, k: curvature along the second direction, at this place [1/mm].
    From Hooke's law, E11 = -a u, E22 = -b v + k w, 2E12 = b u + a v, 2E13 = u' + a w, 2E23 = v' + b w - k v, and
    equilibrium.
    """
    C = ply.stiffness()
    A, strains = np.zeros((6, 6)), np.zeros((3, 6))
    strains[0, 0], strains[1, 1:3], strains[2, :2] = -a, (-b, k), (b, a)
    A[0, [2, 4]] = -a, 1 / C[4, 4]
    A[1, [1, 2, 5]] = k, -b, 1 / C[5, 5]
    A[2] = -C[3, :3] @ strains / C[3, 3]
    A[2, 3] += 1 / C[3, 3]
    S = C[:3, :3] @ strains + np.outer(C[:3, 3], A[2])
    A[3] = k * S[1]
    A[3, 3:] += -k, a, b
    A[4] = -a * S[0] + b * S[2]
    A[4, 4] -= k
    A[5] = -b * S[1] + a * S[2]
    A[5, 5] -= 2 * k
    return A, S


@dataclass(frozen=True, eq=False)
class Layer:
    """stiffness (6, 6) [MPa] along axis, circumference and radius: 11, 22, 12, 33, 13, 23.  outer: its radius [mm]."""

    stiffness: np.ndarray
    outer: float


def layered_tube(layers: Sequence[Layer], inner: float, pressure: float) -> list[tuple[float, float]]:
    """Hoop stresses [MPa] at the inner and the outer side of each layer, of a tube whose length is fixed.

    u = A r^k + B r^-k with k^2 = C_tt/C_rr in each layer; S_rr = -p inside, 0 outside, u and S_rr go through.
    Source: Lekhnitskii, Anisotropic Plates (1968), for one layer (recalled).
    """
    radii = [inner, *(layer.outer for layer in layers)]
    exponents = [float(np.sqrt(layer.stiffness[1, 1] / layer.stiffness[3, 3])) for layer in layers]

    def rows(layer: int, r: float) -> np.ndarray:
        """u, S_rr and S_tt by the amplitudes of both powers."""
        C, powers = layers[layer].stiffness, np.array([1.0, -1.0]) * exponents[layer]
        u, slope = (r / inner) ** powers, powers * (r / inner) ** powers / r
        return np.array([u, C[3, 1] * u / r + C[3, 3] * slope, C[1, 1] * u / r + C[1, 3] * slope])

    n = len(layers)
    A, b = np.zeros((2 * n, 2 * n)), np.zeros(2 * n)
    A[0, :2], b[0] = rows(0, inner)[1], -pressure
    for i in range(n - 1):
        A[2 * i + 1 : 2 * i + 3, 2 * i : 2 * i + 2] = rows(i, radii[i + 1])[:2]
        A[2 * i + 1 : 2 * i + 3, 2 * i + 2 : 2 * i + 4] = -rows(i + 1, radii[i + 1])[:2]
    A[-1, -2:] = rows(n - 1, radii[-1])[1]
    amplitudes = np.linalg.solve(A, b).reshape(n, 2)
    return [
        (float(rows(i, radii[i])[2] @ amplitudes[i]), float(rows(i, radii[i + 1])[2] @ amplitudes[i])) for i in range(n)
    ]


def inflation_pressure(
    terms: Sequence[tuple[float, float]], stretch: float, inner: float, outer: float, *, sphere: bool
) -> float:
    """Pressure [MPa] inside an incompressible tube of fixed length, or a sphere, whose inner radius has this stretch.

    W = sum m/a (sum of stretches^a - 3) by ``terms`` (m, a). With the hoop stretch x of a fibre and n = 2 (tube) or 3::

        p = int from x_b to x_a of W'(x)/(x^n - 1) dx,    x_b^n = 1 + (x_a^n - 1) (inner/outer)^n

    of the tube W(x) = W(x, 1/x, 1), of the sphere W(x, x, x^-2). Neo-Hooke's: m (ln(x_a/x_b) + (x_b^-2 - x_a^-2)/2)
    and m (2/x_b + x_b^-4/2 - 2/x_a - x_a^-4/2). Source: Ogden, Non-linear Elastic Deformations (1984), 5.3 (recalled).
    """
    n = 3 if sphere else 2
    at_outer = (1 + (stretch**n - 1) * (inner / outer) ** n) ** (1 / n)

    def slope(x: float) -> float:
        return sum(m * ((n - 1) * x ** (a - 1) - (n - 1) * x ** (-(n - 1) * a - 1)) for m, a in terms)

    return float(quad(lambda x: slope(x) / (x**n - 1), at_outer, stretch, epsabs=0, epsrel=1e-12)[0])
