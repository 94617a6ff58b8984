"""A shell of revolution under a pressure p cos(n a2): its strain energy and deflection without any element.

With v1, v3 ~ cos(n a2) and v2 ~ sin(n a2) the linear shell becomes ordinary differential equations along the meridian.
They are solved with integrated Legendre polynomials over the whole meridian (Babuska and Szabo's hierarchic basis),
whose error falls faster than any power of the degree. The reference shares with the element the gradients q, the
measure and the section, but no interpolation, no mode and no sampling: what differs is the discretisation alone.

A thick shell of revolution under a pressure p cos(n a2) as a solid: linear elasticity without any shell assumption.

Displacements v_i(a1, z) cos or sin(n a2) in integrated Legendre polynomials along the meridian and through the wall,
with the gradients of :mod:`formulations.strains.quantities`, the same letters, at z = 0::

    E_aa = lam_a/(1 + k_a z),  2E_12 = om_1/(1 + k_1 z) + om_2/(1 + k_2 z),  E_33 = v3,z,
    2E_a3 = v_a,z - th_a/(1 + k_a z)

It says which of two shells is nearer to the truth where they differ. Isotropic, symmetric about a1 = 0, free elsewhere.
"""

from collections.abc import Iterable
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.polynomial import legendre
from scipy.linalg import cho_factor, cho_solve

from formulations.geometry.surfaces import Geometry, Surface
from formulations.section.laminate import Laminate
from formulations.strains.catalogue import LINEAR
from formulations.strains.quantities import displacement_index, gradient_coefficients, shear_row_factors

FIRST, SECOND, NORMAL = ([displacement_index(i, face) for face in (0, 1)] for i in range(3))


@dataclass(frozen=True, eq=False)
class HarmonicShell:
    """Half a shell of revolution, 0 <= a1 <= ``end``, symmetric about a1 = 0, ``clamped`` or free at ``end``.

    pressure: p [MPa] along e3 per area of mubar, half on each face.  degree: of the polynomials; a boundary layer of
    width w at the end needs about 4 sqrt(end/w).
    """

    surface: Surface
    laminate: Laminate
    harmonic: int
    pressure: float
    end: float
    clamped: bool
    degree: int = 100

    def energy(self) -> float:
        """Strain energy 1/2 f.u [N mm] of the piece 0 <= a1 <= end, 0 <= a2 <= pi/2."""
        amplitudes, load = self._solution
        return float(0.5 * np.sum(load * amplitudes))

    def deflection(self) -> float:
        """Normal displacement [mm], outwards, of the mean of both faces at a1 = a2 = 0."""
        return float(self._solution[0][0, NORMAL[0]])

    @cached_property
    def _solution(self) -> tuple[np.ndarray, np.ndarray]:
        """Amplitudes and their loads, both (n, 6); the first function alone is not zero at a1 = 0."""
        points, weights = legendre.leggauss(self.degree + 20)
        value, slope = integrated_legendre(points, self.degree)
        a1 = 0.5 * self.end * (1.0 + points)
        geometry = self.surface.geometry(a1, np.zeros_like(a1))
        d_bar = 0.5 * (self.laminate.d_minus + self.laminate.d_plus)
        area = np.prod(geometry.A * (1.0 + d_bar * geometry.k), axis=-1) * weights * (0.5 * self.end * np.pi / 4)
        strains = self._strains(a1, value, slope * (2.0 / self.end))
        load = np.zeros((value.shape[1], 6))
        load[:, NORMAL[0]] = self.pressure * (area @ value)  # on the mean of the faces, see _strains
        return solved(strains, self.laminate.stiffness(), area, load, self._free(value.shape[1])), load

    def _free(self, n: int) -> np.ndarray:
        """Which of the (n, 6) amplitudes are unknown; the first two functions are 1 at the middle and the end."""
        free = np.ones((n, 6), bool)
        free[0, FIRST] = False  # symmetry
        free[1] = not self.clamped
        return free

    def _strains(self, a1: np.ndarray, value: np.ndarray, slope: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Strains (g, 11, n, 6) by the amplitudes on a2 = 0, where cos = 1, and on a2 = pi/(2n), where sin = 1.

        The amplitudes of a pair of faces are those of the mean and of half the difference: no cancellation in thin
        shells.
        """
        geometry = self.surface.geometry(a1, np.zeros_like(a1))
        thickness = (self.laminate.d_minus, self.laminate.d_plus)
        pairs = np.kron(np.eye(3), [[1.0, -1.0], [1.0, 1.0]])
        rows = shear_row_factors(geometry, *thickness)
        c0, c1, c2 = (
            np.einsum("gi,ij,gjk,kl->gil", rows, LINEAR.linear, c, pairs, optimize=True)
            for c in gradient_coefficients(geometry, *thickness)
        )
        even, odd = np.zeros(6), np.zeros(6)
        even[[*FIRST, *NORMAL]], odd[SECOND] = 1.0, 1.0
        n = self.harmonic

        def at(present: np.ndarray, turned: np.ndarray) -> np.ndarray:
            constant = c0 * present + c2 * turned
            return np.einsum("gij,gm->gimj", constant, value) + np.einsum("gij,gm->gimj", c1 * present, slope)

        return at(even, n * odd), at(odd, -n * even)


def solved(
    strains: Iterable[np.ndarray], D: np.ndarray, area: np.ndarray, load: np.ndarray, free: np.ndarray
) -> np.ndarray:
    """Amplitudes (n, k) under the load (n, k), zero where not free (n, k).

    strains: (g, i, n, k) each, at points of the area (g,); D (i, i): stiffness.
    """
    known = free.ravel()
    K = np.zeros((known.sum(), known.sum()))
    for B in strains:
        B = B.reshape(*B.shape[:2], -1)[..., known]
        K += np.einsum("gim,gin->mn", B, np.einsum("g,ij,gjn->gin", area, D, B), optimize=True)
    scale = 1.0 / np.sqrt(np.diag(K))
    amplitudes = np.zeros(load.size)
    amplitudes[known] = scale * cho_solve(cho_factor(K * scale * scale[:, None]), load.ravel()[known] * scale)
    return amplitudes.reshape(load.shape)


def integrated_legendre(points: np.ndarray, degree: int) -> tuple[np.ndarray, np.ndarray]:
    """Values and slopes (g, degree + 1) on [-1, 1]: (1 - x)/2, (1 + x)/2, (P_k - P_{k-2})/sqrt(4k - 2), k = 2.. ."""
    P = legendre.legvander(points, degree)
    k = np.arange(2, degree + 1)
    norm = np.sqrt(4.0 * k - 2.0)
    ends = np.stack([0.5 - 0.5 * points, 0.5 + 0.5 * points], axis=-1)
    end_slopes = np.broadcast_to([-0.5, 0.5], ends.shape)
    inner, inner_slopes = (P[:, 2:] - P[:, :-2]) / norm, (2.0 * k - 1.0) * P[:, 1:-1] / norm
    return np.hstack([ends, inner]), np.hstack([end_slopes, inner_slopes])


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
