"""Thick walls under inner pressure: a tube of orthotropic layers, and tubes and spheres of incompressible rubber.

No element and no law of the shell enters here.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.integrate import quad


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
