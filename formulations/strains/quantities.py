"""The displacement-gradient quantities q: their names, order and signs, in this ONE place.

Every strain measure is a table of constants over q, so nothing about a particular measure may enter here.

On each face (superscript - or +, at a3 = d-, d+) the displacement u = v_i e_i has the surface gradient::

    du/(A_a da_a) = lam_a e_a + om_a e_g - th_a e3                      (g != a)
    lam_a = v_a,a/A_a + B_g v_g + k_a v_3
    om_a  = v_g,a/A_a - B_g v_a
    th_a  = -v_3,a/A_a + k_a v_a
    beta_i = (v_i+ - v_i-)/h

Divided once by zeta_a = 1 + k_a d (the stretch of the face): l = lam/zeta, w = om/zeta, t = th/zeta.
Source: Grigolyuk, Kulikov, Plotnikova (2004), eq. 3.
"""

from dataclasses import dataclass

import numpy as np

from formulations.geometry.surfaces import Geometry

FACES = ("-", "+")
QUANTITIES = (
    *("l1-", "l1+", "w1-", "w1+", "t1-", "t1+"),
    *("l2-", "l2+", "w2-", "w2+", "t2-", "t2+"),
    *("beta1", "beta2", "beta3"),
)
STRAINS = ("E11-", "E11+", "E22-", "E22+", "2E12-", "2E12+", "2E13-", "2E13+", "2E23-", "2E23+", "E33")
DISPLACEMENTS = ("v1-", "v1+", "v2-", "v2+", "v3-", "v3+")

N_Q, N_E, N_V = len(QUANTITIES), len(STRAINS), len(DISPLACEMENTS)
N_BETA = 3
BETA = slice(N_Q - N_BETA, N_Q)  # beta1, beta2, beta3 in q
E33 = STRAINS.index("E33")
OF_SURFACE = tuple(range(0, BETA.start, 2))  # the quantities of one surface: those of the inner face
STRAINS_OF_SURFACE = tuple(range(0, N_E, 2))  # E11, E22, 2E12, 2E13, 2E23, E33


@dataclass(frozen=True)
class Kinematics:
    """What a measure may leave out of the gradients themselves, because no table of constants over q can.

    shallow: th_a = -v_3,a/A_a, the turning k_a v_a of the frame dropped (Donnell).
    thin: zeta_a = zbar_a = 1, the stretch of the faces by the curvature dropped.
    """

    shallow: bool = False
    thin: bool = False


FULL = Kinematics()


def displacement_index(component: int, face: int) -> int:
    """Position of v_component (0, 1, 2) on the face (0 inner, 1 outer) among the six displacements of a node."""
    return 2 * component + face


def gradient_coefficients(
    geometry: Geometry, d_minus: float, d_plus: float, kinematics: Kinematics = FULL
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Coefficients C0, C1, C2, each (..., 15, 6), with q = C0 v + C1 v,1 + C2 v,2.

    ``v`` holds the six face displacements (v1-, v1+, v2-, v2+, v3-, v3+); ``v,a`` their derivatives by the surface
    coordinates. Length units cancel: q is dimensionless.
    """
    batch = geometry.A.shape[:-1]
    c0, c1, c2 = (np.zeros((*batch, N_Q, N_V)) for _ in range(3))
    for face, d in enumerate((d_minus, d_plus)):
        for whole, own in zip((c0, c1, c2), surface_coefficients(geometry, d, kinematics), strict=True):
            whole[..., face : BETA.start : 2, face::2] = own
    for i in range(3):
        for face, sign in enumerate((-1.0, 1.0)):
            c0[..., 12 + i, displacement_index(i, face)] = sign / (d_plus - d_minus)
    return c0, c1, c2


def surface_coefficients(
    geometry: Geometry, d: float, kinematics: Kinematics = FULL
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """C0, C1, C2 (..., 6, 3) of l1, w1, t1, l2, w2, t2 on the surface at the distance d, from its displacement v."""
    c0, c1, c2 = (np.zeros((*geometry.A.shape[:-1], len(OF_SURFACE), 3)) for _ in range(3))
    for a, derivative in ((0, c1), (1, c2)):
        g = 1 - a
        zeta = 1.0 + geometry.k[..., a] * (0.0 if kinematics.thin else d)
        slope = 1.0 / (geometry.A[..., a] * zeta)
        curvature = geometry.k[..., a] / zeta
        bend = geometry.B[..., g] / zeta
        lam, om, th = range(3 * a, 3 * a + 3)
        derivative[..., lam, a] = slope
        c0[..., lam, g] = bend
        c0[..., lam, 2] = curvature
        derivative[..., om, g] = slope
        c0[..., om, a] = -bend
        derivative[..., th, 2] = -slope
        c0[..., th, a] = 0.0 if kinematics.shallow else curvature
    return c0, c1, c2


def shear_row_factors(geometry: Geometry, d_minus: float, d_plus: float, kinematics: Kinematics = FULL) -> np.ndarray:
    """Factors (..., 11) of the strain rows: zeta_a/zbar_a for 2E_a3 on each face, 1 elsewhere.

    They belong to the geometry (the shear is measured on the mid-surface base vectors), not to any measure.
    """
    factors = np.ones((*geometry.A.shape[:-1], N_E))
    if kinematics.thin:
        return factors
    d_bar = 0.5 * (d_minus + d_plus)
    for a, first in ((0, 6), (1, 8)):
        for face, d in enumerate((d_minus, d_plus)):
            factors[..., first + face] = (1.0 + geometry.k[..., a] * d) / (1.0 + geometry.k[..., a] * d_bar)
    return factors
