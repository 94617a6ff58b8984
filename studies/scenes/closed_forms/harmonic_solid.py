"""A thick shell of revolution under a pressure p cos(n a2) as a solid: linear elasticity without any shell assumption.

Displacements v_i(a1, z) cos or sin(n a2) in integrated Legendre polynomials along the meridian and through the wall,
with the gradients of :mod:`formulations.strains.quantities`, the same letters, at z = 0::

    E_aa = lam_a/(1 + k_a z),  2E_12 = om_1/(1 + k_1 z) + om_2/(1 + k_2 z),  E_33 = v3,z,
    2E_a3 = v_a,z - th_a/(1 + k_a z)

It says which of two shells is nearer to the truth where they differ. Isotropic, symmetric about a1 = 0, free elsewhere.
"""

from dataclasses import dataclass

import numpy as np
from numpy.polynomial import legendre

from formulations.geometry.surfaces import Geometry, Surface
from studies.scenes.closed_forms.harmonic import integrated_legendre, solved

EVEN, ODD = np.array([1.0, 0.0, 1.0]), np.array([0.0, 1.0, 0.0])  # of (v1, v2, v3): ~ cos(n a2), ~ sin(n a2)


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


def gradients(
    geometry: Geometry, value: np.ndarray, slope: np.ndarray, present: np.ndarray, turned: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """lam, om, th of a vector, each (g, 2 directions, n, 3 amplitudes); B_2 = 0.

    present (3,): which components are not zero at this a2; turned (3,): their derivatives by a2.
    """
    lam, om, th = (np.zeros((len(value), 2, value.shape[1], 3)) for _ in range(3))
    along, across = slope / geometry.A[:, :1], value / geometry.A[:, 1:]
    k1, k2, B1 = geometry.k[:, :1], geometry.k[:, 1:], geometry.B[:, :1]
    lam[:, 0, :, 0], lam[:, 0, :, 2] = along * present[0], k1 * value * present[2]
    lam[:, 1, :, 1], lam[:, 1, :, 2] = across * turned[1], k2 * value * present[2]
    lam[:, 1, :, 0] = B1 * value * present[0]
    om[:, 0, :, 1] = along * present[1]
    om[:, 1, :, 0], om[:, 1, :, 1] = across * turned[0], -B1 * value * present[1]
    th[:, 0, :, 2], th[:, 0, :, 0] = -along * present[2], k1 * value * present[0]
    th[:, 1, :, 2], th[:, 1, :, 1] = -across * turned[2], k2 * value * present[1]
    return lam, om, th
