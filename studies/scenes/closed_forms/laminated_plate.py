"""A simply supported cross-ply plate under a sinusoidal pressure in three-dimensional elasticity (Pagano 1970).

Transfer matrices through the plies; any thickness, any number of cross-plies. No element enters here.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from scipy.linalg import expm

from formulations.section.laminate import Ply


def middle_deflection(plies: Sequence[Ply], a: float, b: float, q0: float) -> float:
    """w [mm] at the centre of the middle surface under q0 sin(pi x/a) sin(pi y/b) [MPa] on the top face.

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
        lower = expm(_system(ply, p, q) * ply.thickness) @ lower
    half = expm(_system(plies[middle], p, q) * unit / 2)
    at_middle = half @ lower
    whole = half @ at_middle
    for ply in plies[middle + 1 :]:
        whole = expm(_system(ply, p, q) * ply.thickness) @ whole
    bottom = np.linalg.solve(whole[3:, :3], [q0, 0.0, 0.0])
    return float(at_middle[2, :3] @ bottom)


def _system(ply: Ply, a: float, b: float) -> np.ndarray:
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
