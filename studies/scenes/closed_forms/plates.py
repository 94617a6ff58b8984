"""Closed forms of plates that bend; no element enters."""

import math

import numpy as np

TERMS = 100  # waves along each side, of which the odd ones bend the middle; what is left out is 1e-4 of a point load's


def navier_deflection(
    sides: tuple[float, float], stiffness: float, x: np.ndarray, y: np.ndarray, forces: np.ndarray
) -> float:
    """Deflection [mm] of the middle of a simply supported Kirchhoff plate under forces (k,) [N] at x, y (k,) from it.

    sides a, b [mm] along x and y; stiffness D [N mm].  Navier's series of a point load (Timoshenko, Woinowsky-Krieger,
    Theory of Plates and Shells (1959), art. 34, recalled), summed over m, n = 1, 3, 5, ... ::

        w = 4/(pi^4 D a b) sum_mn cos(m pi x/a) cos(n pi y/b)/((m/a)^2 + (n/b)^2)^2

    In the middle of a square one F is 0.0116 F a^2/D.
    """
    a, b = sides
    m = np.arange(1, TERMS, 2)
    along, across = np.cos(np.outer(x, m) * (math.pi / a)), np.cos(np.outer(y, m) * (math.pi / b))
    waves = np.einsum("i,im,in->mn", forces, along, across)
    return float(4 / (math.pi**4 * stiffness * a * b) * np.sum(waves / np.add.outer((m / a) ** 2, (m / b) ** 2) ** 2))
