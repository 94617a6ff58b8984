"""A shell of revolution of Reissner and Mindlin under a pressure p cos(n a2): what a code with five parameters gives.

The linear shell of Naghdi, plane stress, with displacements u_i and the changes b_a of a director that stays in the
tangent plane, gradients as in :mod:`formulations.strains.quantities` (the same letters, here on the middle surface)::

    membrane    lam_1, lam_2, om_1 + om_2                                              of u, times E t/(1 - nu^2)
    bending     lam_a(b) + k_a lam_a(u),  om_1(b) + om_2(b) + k_2 om_1(u) + k_1 om_2(u),  times E t^3/(12 (1 - nu^2))
    shear       b_a - th_a(u),                                                            times kappa G t

The bending strains are the second fundamental form's change in covariant components; 1 + k z is 1 in every integral
through the thickness. Both differ from a shell of two faces by O(t/R). It shares no gradient, measure, section or
thickness integral with the suite's shell, only the basis along the meridian.
Source: Bischoff, Wall, Bletzinger, Ramm, Encyclopedia of Computational Mechanics (2004), vol. 2 ch. 3 (recalled).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.polynomial import legendre

from formulations.geometry.surfaces import Geometry, Surface
from studies.scenes.closed_forms.harmonic import EVEN, ODD, gradients, integrated_legendre, solved


@dataclass(frozen=True)
class NaghdiShell:
    """Half a shell of revolution, 0 <= a1 <= ``end``, symmetric about a1 = 0 and free at ``end``.

    E, pressure p [MPa], along e3 per area of the middle surface; t: thickness [mm]; kappa: shear correction.
    """

    surface: Surface
    E: float
    nu: float
    t: float
    harmonic: int
    pressure: float
    end: float
    kappa: float = 5 / 6
    degree: int = 100

    def deflection(self) -> float:
        """Normal displacement [mm], outwards, at a1 = a2 = 0."""
        points, weights = legendre.leggauss(self.degree + 20)
        value, slope = integrated_legendre(points, self.degree)
        a1 = 0.5 * self.end * (1.0 + points)
        geometry = self.surface.geometry(a1, np.zeros_like(a1))
        area = np.prod(geometry.A, axis=-1) * weights * (0.5 * self.end * np.pi / 4)
        load, free = np.zeros((value.shape[1], 5)), np.ones((value.shape[1], 5), bool)
        load[:, 2] = self.pressure * (area @ value)
        free[0, [0, 3]] = False  # u_1 = b_1 = 0 on the plane of symmetry
        slope, n = slope * (2.0 / self.end), self.harmonic
        strains = (  # on a2 = 0, where cos = 1, and on a2 = pi/(2n), where sin = 1
            _strains(geometry, *gradients(geometry, value, slope, EVEN, n * ODD), value[..., None] * EVEN[:2]),
            _strains(geometry, *gradients(geometry, value, slope, ODD, -n * EVEN), value[..., None] * ODD[:2]),
        )
        return float(solved(strains, self._stiffness(), area, load, free)[0, 2])

    def _stiffness(self) -> np.ndarray:
        """(8, 8): membrane, bending, shear [N/mm, N mm, N/mm]."""
        plane = np.array([[1, self.nu, 0], [self.nu, 1, 0], [0, 0, (1 - self.nu) / 2]]) * self.E / (1 - self.nu**2)
        D = np.zeros((8, 8))
        D[:3, :3], D[3:6, 3:6] = self.t * plane, self.t**3 / 12 * plane
        D[6:, 6:] = self.kappa * self.E / (2 * (1 + self.nu)) * self.t * np.eye(2)
        return D


def _strains(geometry: Geometry, lam: np.ndarray, om: np.ndarray, th: np.ndarray, director: np.ndarray) -> np.ndarray:
    """The eight strains (g, 8, n, 5) by u_1, u_2, u_3, b_1, b_2; director (g, n, 2): values of b_1, b_2."""
    strains = np.zeros((len(lam), 8, lam.shape[2], 5))
    u, b = strains[..., :3], strains[..., 3:]
    k = geometry.k[:, :, None, None]
    u[:, :2], u[:, 2] = lam, om.sum(axis=1)
    u[:, 3:5], u[:, 5] = k * lam, (k[:, ::-1] * om).sum(axis=1)
    b[:, 3:5], b[:, 5] = lam[..., :2], om[..., :2].sum(axis=1)
    u[:, 6:] = -th
    for a in (0, 1):
        b[:, 6 + a, :, a] = director[..., a]
    return strains
