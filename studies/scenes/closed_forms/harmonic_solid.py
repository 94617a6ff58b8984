"""A thick shell of revolution under a pressure p cos(n a2) as a solid: linear elasticity without any shell assumption.

Displacements v_i(a1, z) cos or sin(n a2) in integrated Legendre polynomials along the meridian and through the wall,
the same letters as in :mod:`studies.scenes.closed_forms.naghdi`::

    E_aa = lam_a/(1 + k_a z),  2E_12 = om_1/(1 + k_1 z) + om_2/(1 + k_2 z),  E_33 = v3,z,
    2E_a3 = v_a,z - th_a/(1 + k_a z)

It says which of two shells is nearer to the truth where they differ. Isotropic, symmetric about a1 = 0, free elsewhere.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.polynomial import legendre

from formulations.geometry.surfaces import Geometry, Surface
from studies.scenes.closed_forms.harmonic import integrated_legendre, solved
from studies.scenes.closed_forms.naghdi import EVEN, ODD, gradients


@dataclass(frozen=True)
class HarmonicSolid:
    """The body 0 <= a1 <= ``end``, -t/2 <= z <= t/2.

    E, pressure p [MPa] along e3 per area of the middle surface, half of it on each face; t: thickness [mm].
    degree, through: of the polynomials along the meridian and through the wall.
    """

    surface: Surface
    E: float
    nu: float
    t: float
    harmonic: int
    pressure: float
    end: float
    degree: int = 24
    through: int = 6

    def deflection(self) -> float:
        """Displacement [mm] along e3, the mean of both faces, at a1 = a2 = 0."""
        points, weights = legendre.leggauss(self.degree + 10)
        a1 = 0.5 * self.end * (1.0 + points)
        geometry = self.surface.geometry(a1, np.zeros_like(a1))
        value, slope = integrated_legendre(points, self.degree)
        middle = np.prod(geometry.A, axis=-1) * weights * (0.5 * self.end * np.pi / 4)
        layers, thickness = legendre.leggauss(self.through + 4)
        stretch = 1.0 + geometry.k * (0.5 * self.t * layers)[:, None, None]  # (layers, g, 2)
        area = middle * stretch.prod(axis=-1) * (0.5 * self.t * thickness)[:, None]
        strains = (
            self._strains(geometry, value, slope * (2.0 / self.end), layers, stretch, *parity)
            for parity in ((EVEN, self.harmonic * ODD), (ODD, -self.harmonic * EVEN))
        )
        shape = value.shape[1], self.through + 1, 3
        load, free = np.zeros(shape), np.ones(shape, bool)
        # the first two functions through the wall are 1 on one face and 0 on the other, all others 0 on both
        load[:, :2, 2] = 0.5 * self.pressure * (middle @ value)[:, None]
        free[0, :, 0] = False
        flat = -1, 3
        amplitudes = solved(strains, self._stiffness(), area.ravel(), load.reshape(flat), free.reshape(flat))
        return float(amplitudes.reshape(shape)[0, :2, 2].mean())

    def _stiffness(self) -> np.ndarray:
        """(6, 6) of 11, 22, 33, 12, 13, 23 [MPa]."""
        shear = self.E / (2 * (1 + self.nu))
        D = shear * np.eye(6)
        D[:3, :3] += shear * np.eye(3) + 2 * shear * self.nu / (1 - 2 * self.nu)
        return D

    def _strains(
        self,
        geometry: Geometry,
        value: np.ndarray,
        slope: np.ndarray,
        layers: np.ndarray,
        stretch: np.ndarray,
        present: np.ndarray,
        turned: np.ndarray,
    ) -> np.ndarray:
        """(points, 6, functions, 3 amplitudes), the points of a layer together."""
        across, across_slope = integrated_legendre(layers, self.through)
        on_middle = gradients(geometry, value, slope, present, turned)
        lam, om, th = (np.einsum("gamv,yga,yk->aygmkv", each, 1 / stretch, across, optimize=True) for each in on_middle)
        rise = np.einsum("gm,yk,vi->iygmkv", value, across_slope * (2.0 / self.t), np.diag(present))
        rows = lam[0], lam[1], rise[2], om[0] + om[1], rise[0] - th[0], rise[1] - th[1]
        return np.stack(rows, axis=2).reshape(len(layers) * len(value), 6, -1, 3)
