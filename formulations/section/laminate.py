"""Plies and laminates: from the elastic constants of the layers to the 11 x 11 stiffness D of the section.

No geometry of the surface and no element may enter here. Stresses are second Piola-Kirchhoff, strains Green-Lagrange
(or whatever the measure calls a strain), the law is linear between them.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cached_property, partial
from importlib import import_module
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from formulations.section.material import Law

KNOWN = 1e-3  # part of the smallest modulus of an isotropic ply that rounding of the largest may take

SECTIONS = ("constant-s33", "nonsymmetric", "full-3d")
BETWEEN_FACES = "2"
SURFACES = (BETWEEN_FACES, "3", "5", "7", "2/ply", "3/ply", "4/ply")  # through a wall, or through each of its plies
LINEAR = "svk"  # the one of LAWS that is linear in the strain

# Voigt order of a ply: 11, 22, 12 in the plane; 33; then 13, 23.
PLANE, NORMAL, SHEAR = slice(0, 3), 3, slice(4, 6)


@dataclass(frozen=True)
class Ply:
    """Orthotropic layer; L along the fibre, T across it, N along the normal; ``angle`` [rad] of L from a1 towards a2.

    Moduli in MPa, thickness in mm. nu_LT: contraction along T under tension along L; G_TT and nu_TT: between T and N.
    E_N, G_LN and nu_LN are E_T, G_LT and nu_LT unless given: then N is one more direction across the fibre.
    Raises ValueError naming the violated inequality when the stiffness is not positive definite.
    """

    E_L: float
    E_T: float
    G_LT: float
    G_TT: float
    nu_LT: float
    nu_TT: float
    angle: float
    thickness: float
    E_N: float | None = None
    G_LN: float | None = None
    nu_LN: float | None = None

    def __post_init__(self) -> None:
        given = {"E_N": self.E_N, "G_LN": self.G_LN}
        check_positive(thickness=self.thickness, E_L=self.E_L, E_T=self.E_T, G_LT=self.G_LT, G_TT=self.G_TT)
        check_positive(**{name: value for name, value in given.items() if value is not None})
        (E_L, E_T, E_N), (LT, LN, TN) = self.moduli, self.poisson
        limit = math.sqrt(E_T / E_N)
        if not abs(TN) < limit:
            raise ValueError(f"ply nu_TT = {TN:g} must lie in (-{limit:g}, {limit:g})")
        if (E_N, LN) == (E_T, LT):  # in factors, whose digits do not cancel as nu comes to -1
            determinant = (1 + TN) * (1 - TN - 2 * LT * LT * E_T / E_L)
        else:
            determinant = 1 - (LT * LT * E_T + LN * LN * E_N + 2 * LT * LN * TN * E_N) / E_L - TN * TN * E_N / E_T
        if not determinant > 0:
            raise ValueError(
                "ply is not positive definite: 1 - (nu_LT^2 E_T + nu_LN^2 E_N + 2 nu_LT nu_LN nu_TT E_N)/E_L "
                f"- nu_TT^2 E_N/E_T = {determinant:.4g} must be > 0 (nu_TT = {TN:g}, nu_LT = {LT:g}, nu_LN = {LN:g})"
            )

    @classmethod
    def isotropic(cls, E: float, nu: float, thickness: float) -> Ply:
        """Isotropic layer; raises ValueError unless E > 0 and -1 < nu < 0.5, by more than rounding can tell."""
        if not -1 < nu < 0.5:
            raise ValueError(f"nu = {nu:g} must lie in (-1, 0.5)")
        apart = np.finfo(float).eps / KNOWN
        if min(1 + nu, 0.5 - nu) < apart:
            raise ValueError(f"nu = {nu!r} must be at least {apart:.1g} inside (-1, 0.5)")
        G = E / (2 * (1 + nu))
        return cls(E, E, G, G, nu, nu, 0.0, thickness)

    @property
    def moduli(self) -> tuple[float, float, float]:
        """E along L, T and N [MPa]."""
        return self.E_L, self.E_T, self.E_T if self.E_N is None else self.E_N

    @property
    def shears(self) -> tuple[float, float, float]:
        """G of LT, LN and TN [MPa]."""
        return self.G_LT, self.G_LT if self.G_LN is None else self.G_LN, self.G_TT

    @property
    def poisson(self) -> tuple[float, float, float]:
        """nu of LT, LN and TN, the contraction along the second direction under tension along the first."""
        return self.nu_LT, self.nu_LT if self.nu_LN is None else self.nu_LN, self.nu_TT

    def stiffness(self) -> np.ndarray:
        """B (6, 6) [MPa] in the shell axes, Voigt order 11, 22, 12, 33, 13, 23 with engineering shears."""
        (E_L, E_T, E_N), (G_LT, G_LN, G_TN), (LT, LN, TN) = self.moduli, self.shears, self.poisson
        compliance = np.diag([1 / E_L, 1 / E_T, 1 / G_LT, 1 / E_N, 1 / G_LN, 1 / G_TN])
        for i, j, coupling in ((0, 1, -LT / E_L), (0, NORMAL, -LN / E_L), (1, NORMAL, -TN / E_T)):
            compliance[i, j] = compliance[j, i] = coupling
        turn = strain_rotation(self.angle)
        return turn.T @ np.linalg.inv(compliance) @ turn


def check_positive(**values: float) -> None:
    """Raise ValueError naming the constant of a ply that is not a positive number."""
    for name, value in values.items():
        if not (value > 0 and math.isfinite(value)):
            raise ValueError(f"ply {name} = {value:g} must be a positive number")


def strain_rotation(angle: float) -> np.ndarray:
    """Strains in fibre axes from strains in shell axes, Voigt order 11, 22, 12, 33, 13, 23, engineering shears."""
    c, s = math.cos(angle), math.sin(angle)
    turn = np.eye(6)
    turn[PLANE, PLANE] = [[c * c, s * s, c * s], [s * s, c * c, -c * s], [-2 * c * s, 2 * c * s, c * c - s * s]]
    turn[SHEAR, SHEAR] = [[c, s], [-s, c]]
    return turn


@dataclass(frozen=True)
class Laminate:
    """Plies stacked from d_minus outwards; d_minus [mm] is the offset of the inner face from the reference surface."""

    plies: tuple[Ply, ...]
    d_minus: float

    @classmethod
    def single(cls, ply: Ply) -> Laminate:
        """One ply about its middle surface."""
        return cls((ply,), -0.5 * ply.thickness)

    @property
    def thickness(self) -> float:
        """h [mm]."""
        return math.fsum(ply.thickness for ply in self.plies)

    @property
    def d_plus(self) -> float:
        """Offset of the outer face [mm]."""
        return self.d_minus + self.thickness

    def stiffness(self, section: str = "constant-s33") -> np.ndarray:
        """D (11, 11) [N/mm], H = D E in the strain order of :data:`formulations.strains.quantities.STRAINS`.

        D^{pq} = sum_k int b (N-)^{2-p-q} (N+)^{p+q} da3, exact per ply. Options for the thickness stretch:

        - ``constant-s33``: S33 constant through the thickness, s = (h E33 + int c:E da3)/int(1/b3333) with
          c_ij = b_ij33/b3333; the energy is 1/2 int E Q E + 1/2 s^2 int(1/b3333), Q the plane-stress stiffness.
        - ``nonsymmetric``: Q in the tangential rows, the full b_33ij in the E33 row only (the paper's kind).
        - ``full-3d``: the plain law with constant E33; locks in bending by (1-nu)^2/(1-2nu).

        Raises ValueError for another name. Source: Grigolyuk et al. (2004), eq. 9.
        """
        if section not in SECTIONS:
            raise ValueError(f"section {section!r} is not one of {', '.join(SECTIONS)}")
        if section not in self._known:
            self._known[section] = self._integrated(section)
        return self._known[section].copy()

    @cached_property
    def _known(self) -> dict[str, np.ndarray]:
        return {}  # by section: every load of a path asks for it again

    def _integrated(self, section: str) -> np.ndarray:
        D = np.zeros((11, 11))
        coupling = np.zeros(6)  # int b_33I N^p, or int c_I N^p for constant-s33
        through = 0.0  # int b_3333, or int 1/b_3333
        for ply, one, two in self._thickness_moments():
            b = ply.stiffness()
            reduced = b[PLANE, PLANE] - np.outer(b[PLANE, NORMAL], b[NORMAL, PLANE]) / b[NORMAL, NORMAL]
            plane = b[PLANE, PLANE] if section == "full-3d" else reduced
            D[:6, :6] += np.kron(plane, two)
            D[6:10, 6:10] += np.kron(b[SHEAR, SHEAR], two)
            if section == "constant-s33":
                coupling += np.kron(b[NORMAL, PLANE] / b[NORMAL, NORMAL], one)
                through += ply.thickness / b[NORMAL, NORMAL]
            else:
                coupling += np.kron(b[NORMAL, PLANE], one)
                through += ply.thickness * b[NORMAL, NORMAL]
        if section == "constant-s33":
            row = np.append(coupling, self.thickness)
            in_plane_and_normal = [*range(6), 10]
            D[np.ix_(in_plane_and_normal, in_plane_and_normal)] += np.outer(row, row) / through
        else:
            D[10, :6] = coupling
            D[10, 10] = through
            if section == "full-3d":
                D[:6, 10] = coupling
        return D

    def stresses(self, strains: np.ndarray, section: str = "constant-s33") -> np.ndarray:
        """S_LL, S_TT, S_LT [MPa] of the plies along and across their fibres, (..., plies, 2, 3), of E (..., 11).

        At the inner and the outer side of each ply, by the law whose resultants :meth:`stiffness` has: S = b E in the
        plane, b that of plane stress plus c s with the constant s = S33, or that of the solid. Second Piola-Kirchhoff's
        stresses, those of the reference state left out.
        """
        faces, E33 = strains[..., :6].reshape(*strains.shape[:-1], 3, 2), strains[..., 10, None]
        ends = np.cumsum([0.0, *(ply.thickness for ply in self.plies)]) / self.thickness
        constant, of_plies = section == "constant-s33", []
        along_n = self.stiffness(section)[10] @ strains[..., None] if constant else 0.0  # int S33 = h s
        for ply, low, high in zip(self.plies, ends[:-1], ends[1:], strict=True):
            b = ply.stiffness()
            c = b[PLANE, NORMAL] / b[NORMAL, NORMAL]
            plane = b[PLANE, PLANE] - (0.0 if section == "full-3d" else np.outer(c, b[NORMAL, PLANE]))
            across = along_n / self.thickness * c if constant else E33 * (b[PLANE, NORMAL] * (section == "full-3d"))
            to_fibres = np.linalg.inv(strain_rotation(ply.angle)[PLANE, PLANE])
            sides = [(faces @ [1 - at, at]) @ plane.T + across for at in (low, high)]
            of_plies.append(np.stack(sides, axis=-2) @ to_fibres)
        return np.stack(of_plies, axis=-3)

    def _thickness_moments(self) -> Iterator[tuple[Ply, np.ndarray, np.ndarray]]:
        """Per ply: (ply, int N^p (2,), int N^p N^q (2, 2)); two Gauss points are exact for the quadratic products."""
        h, bottom = self.thickness, 0.0
        for ply in self.plies:
            middle, half = bottom + 0.5 * ply.thickness, 0.5 * ply.thickness
            upper = (middle + half * np.array([-1, 1]) / math.sqrt(3)) / h
            shape = np.stack([1 - upper, upper])
            yield ply, half * shape.sum(axis=1), half * shape @ shape.T
            bottom += ply.thickness


def _law_of(name: str, ply: Ply) -> Law:
    """By the law of ours of that name, which is loaded with surfaces inside a wall, and with solids."""
    laws = import_module("formulations.section.laws")
    law: Law = laws.OURS[name](ply)
    return law


LAWS: dict[str, Callable[[Ply], Law]] = {  # of a ply: see :mod:`formulations.section.laws`
    name: partial(_law_of, name) for name in (LINEAR, "hencky", "neo-hooke", "mooney-rivlin", "ogden")
}
