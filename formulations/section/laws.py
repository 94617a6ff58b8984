"""Material laws: energy, second Piola-Kirchhoff stress and tangent of the Green strain, at points of a wall or a solid.

One convention for all: E (..., 6) and S (..., 6) [MPa] in Voigt order 11, 22, 12, 33, 13, 23 along the local axes, with
engineering shears in E; batch axes first. A law knows one ply; elements, nodes and supports do not enter here. C cannot
tell an inverted element from a sound one: det F > 0 is for who solves to see. Where an element is pressed so flat that
rounding leaves an eigenvalue of C that is not positive, stress and tangent are NaN but for St. Venant-Kirchhoff.

All have the same tangent at E = 0, so they differ by the order of the strain itself: under uniaxial stress
S_11 = E_0 (E_11 - k E_11^2 + ...) with Young's modulus E_0 and k = 0 (St. Venant-Kirchhoff), 3 (Hencky) and
2 + nu (1 + 2 nu^2)/(1 + nu) (neo-Hooke). Nothing is a difference of numbers far larger than itself: energy and stress
keep their digits down to strains of 1e-12 and below. A law of one's own is a class with the methods of
:class:`formulations.section.material.Law` and a line in :data:`LAWS`, from a file given with ``--use`` as well: what
makes it of a ply, or raises ValueError where the ply has none. Its tangent at rest is the stiffness of the ply. With
the method of :class:`formulations.section.material.Divided` besides, a wall that hardly changes its volume does not
lock.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from formulations.section.laminate import LAWS as LAWS  # where a law of one's own goes
from formulations.section.laminate import LINEAR, Ply
from formulations.section.material import (
    ALIKE,
    COLUMN,
    ONCE,
    ROW,
    SHEAR,
    Divided,
    Hencky,
    Law,
    Ogden,
    beyond_linear,
    bulk_stiffness,
    lame_constants,
    stretches,
    tensor,
)


@dataclass(frozen=True, eq=False)
class StVenantKirchhoff:
    """W = 1/2 E.B E, S = B E with any stiffness B (6, 6) [MPa]: linear, whatever the angle and the kind of the ply.

    It softens in compression: the force F_11 S_11 of a bar is largest at the stretch 1/sqrt(3).
    """

    B: np.ndarray
    bulk: np.ndarray

    @classmethod
    def of(cls, ply: Ply) -> StVenantKirchhoff:
        """The ply's own stiffness in the shell axes; of an isotropic one, lam of the normal strains apart."""
        return cls(ply.stiffness(), bulk_stiffness(ply))

    def divided(self) -> tuple[Law, Law]:
        """B less the part of lam, and that."""
        none = np.zeros_like(self.B)
        return StVenantKirchhoff(self.B - self.bulk, none), StVenantKirchhoff(self.bulk, none)

    def energy(self, strain: np.ndarray) -> np.ndarray:
        """1/2 E.B E."""
        return np.asarray(0.5 * np.sum(strain * (strain @ self.B.T), axis=-1))

    def response(self, strain: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """B E and B."""
        return strain @ self.B.T, self.B


@dataclass(frozen=True)
class NeoHooke:
    """W = mu/2 (tr C - 3) - mu ln J + lam/2 (ln J)^2, J = sqrt(det C); Lamé's constants in MPa.

    S = mu (1 - C^-1) + lam ln J C^-1;  dS_ij/dE_kl = lam D_ij D_kl + (mu - lam ln J) (D_ik D_jl + D_il D_jk), D = C^-1.
    Source: Simo, Pister, Comput. Methods Appl. Mech. Eng. 46 (1984) 201; Bonet, Wood, Nonlinear Continuum Mechanics for
    Finite Element Analysis (2008), eqs 6.27, 6.28, 6.30 (recalled).
    """

    lam: float
    mu: float

    @classmethod
    def of(cls, ply: Ply) -> NeoHooke:
        """Of an isotropic ply."""
        return cls(*lame_constants(ply))

    def divided(self) -> tuple[Law, Law]:
        """The parts of mu and of lam."""
        return NeoHooke(0.0, self.mu), NeoHooke(self.lam, 0.0)

    def energy(self, strain: np.ndarray) -> np.ndarray:
        """By the principal stretches."""
        h, _ = stretches(strain)
        return 0.5 * self.mu * beyond_linear(2 * h).sum(axis=-1) + 0.5 * self.lam * h.sum(axis=-1) ** 2

    def response(self, strain: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Both in closed form: 1 - C^-1 = 2 E C^-1 and J^2 - 1 = 2 I_1 + 4 I_2 + 8 I_3 of E, without a difference."""
        E = tensor(strain / ONCE)
        trace = np.trace(E, axis1=-2, axis2=-1)
        second = 0.5 * (trace**2 - np.einsum("...ij,...ij->...", E, E))
        swelling = (2 * trace + 4 * second + 8 * np.linalg.det(E))[..., None]  # J^2 - 1
        swelling = np.where(swelling > -1, swelling, np.nan)
        C = np.eye(3) + 2 * E
        regular = np.isfinite(swelling[..., 0]) & (np.linalg.det(C) != 0)  # strains of 1e8 round it to a singular one
        inverse = np.linalg.inv(np.where(regular[..., None, None], C, np.nan))
        pressure = 0.5 * self.lam * np.log1p(swelling)  # lam ln J
        flat = inverse[..., ROW, COLUMN]
        stress = 2 * self.mu * np.matmul(E, inverse)[..., ROW, COLUMN] + pressure * flat
        i, j, k, m = ROW[:, None], COLUMN[:, None], ROW, COLUMN
        pairs = inverse[..., i, k] * inverse[..., j, m] + inverse[..., i, m] * inverse[..., j, k]
        tangent = self.lam * flat[..., :, None] * flat[..., None, :] + (self.mu - pressure)[..., None] * pairs
        return stress, tangent


@dataclass(frozen=True, eq=False)
class Corded:
    """W = W_m(E) + 1/2 E.R E: cords in rubber, with the law W_m of the rubber and R (6, 6) [MPa] what is left of B.

    The rubber has the least shear modulus mu of the ply and lam = min(B_1122, B_1133, B_2233), along the fibre: all
    that the ply shares with an isotropic one. R = B - B_m, so that the tangent at rest is the stiffness B of the ply,
    with all its constants. In general R is that of stiff cords, S = E_c E_LL a x a, and small and of either sign on
    other strains. The ply of the 2004 paper is of rubber with mu = 1.77 and lam = 71.8 MPa (nu = 0.488), and of cords
    with E_c = 501.2 MPa; of R there is left 0.56 MPa against shear along the cords, and 4.5 MPa against E_TT + E_33.
    Cords are linear, in compression as well.
    """

    rubber: Law
    cords: StVenantKirchhoff

    @classmethod
    def of(cls, law: Callable[[Ply], Law], ply: Ply) -> Law:
        """That of an isotropic ply itself; raises ValueError where the rubber has no bulk modulus above zero."""
        B = replace(ply, angle=0.0).stiffness()
        mu, lam = B[SHEAR, SHEAR].min(), min(B[0, 1], B[0, 3], B[1, 3])
        bulk = lam + 2 / 3 * mu
        if not bulk > 0:
            raise ValueError(f"the rubber between the cords has a bulk modulus of {bulk:.4g} MPa: it must be positive")
        rubber = Ply.isotropic(3 * bulk * mu / (lam + mu), lam / (2 * (lam + mu)), ply.thickness)
        rest = ply.stiffness() - rubber.stiffness()
        if np.max(np.abs(rest)) <= ALIKE * np.max(np.abs(B)):
            return law(ply)
        between, cords = law(rubber), StVenantKirchhoff(rest, np.zeros_like(rest))
        return DividedCorded(between, cords) if isinstance(between, Divided) else Corded(between, cords)

    def energy(self, strain: np.ndarray) -> np.ndarray:
        """Of both."""
        return self.rubber.energy(strain) + self.cords.energy(strain)

    def response(self, strain: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Of both."""
        (S, C), (S_c, C_c) = self.rubber.response(strain), self.cords.response(strain)
        return S + S_c, C + C_c


class DividedCorded(Corded):
    """With rubber whose law knows what volume costs."""

    def divided(self) -> tuple[Law, Law]:
        """The rubber's volume apart."""
        assert isinstance(self.rubber, Divided)
        shape, volume = self.rubber.divided()
        return Corded(shape, self.cords), volume


OURS: dict[str, Callable[[Ply], Law]] = {
    LINEAR: StVenantKirchhoff.of,
    "hencky": partial(Corded.of, Hencky.of),
    "neo-hooke": partial(Corded.of, NeoHooke.of),
    "mooney-rivlin": partial(Corded.of, Ogden.mooney_rivlin),
    "ogden": partial(Corded.of, Ogden.of),
}
