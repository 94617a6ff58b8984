"""What a material law is, stresses and strains in Voigt order, what of a ply is isotropic, and laws of stretches.

One convention for all: E (..., 6) and S (..., 6) [MPa] in Voigt order 11, 22, 12, 33, 13, 23 along the local axes, with
engineering shears in E; batch axes first. All laws are in :mod:`formulations.section.laws`.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import ClassVar, Protocol, runtime_checkable

import numpy as np

from formulations.section.laminate import Ply

VOIGT = ((0, 0), (1, 1), (0, 1), (2, 2), (0, 2), (1, 2))  # order of Ply.stiffness
ROW, COLUMN = np.array(VOIGT).T
ONCE = np.where(ROW == COLUMN, 1.0, 2.0)  # how often a component stands in a symmetric tensor
NORMAL, SHEAR = np.flatnonzero(ROW == COLUMN), np.flatnonzero(ROW != COLUMN)
ALIKE = 1e-9  # of the largest entry: rounding of an isotropic stiffness
_A, _B = ROW[SHEAR], COLUMN[SHEAR]
_CLOSE = 1e-5  # eigenvalues of C whose difference quotient is taken as a derivative: both lose 1e-10
_SERIES = 18  # terms of exp(x) - 1 - x for |x| < 1


class Law(Protocol):
    """A frozen record of the constants of one ply."""

    def energy(self, strain: np.ndarray) -> np.ndarray:
        """W (...) [MPa] at E (..., 6), per reference volume."""

    def response(self, strain: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """S (..., 6) = dW/dE [MPa] at E (..., 6), and dS/dE (6, 6) or (..., 6, 6), symmetric."""


@runtime_checkable
class Divided(Law, Protocol):
    """A law that knows what volume costs apart from what shape does."""

    def divided(self) -> tuple[Law, Law]:
        """Two laws whose sum it is; the second has what grows without bound as nu goes to 1/2."""


def tensor(components: np.ndarray) -> np.ndarray:
    """Symmetric (..., 3, 3) of its components (..., 6); those of a strain are to be divided by two in shear."""
    full = np.empty((*components.shape[:-1], 3, 3))
    full[..., ROW, COLUMN] = full[..., COLUMN, ROW] = components
    return full


def lame_constants(ply: Ply) -> tuple[float, float]:
    """lam and mu [MPa] of an isotropic ply; raises ValueError for any other."""
    B = ply.stiffness()
    lam, mu = float(B[0, 1]), float(B[2, 2])
    isotropic = lam * np.outer(ROW == COLUMN, ROW == COLUMN) + mu * np.diag(2 / ONCE)
    if np.max(np.abs(B - isotropic)) > ALIKE * np.max(np.abs(B)):
        raise ValueError("this law is isotropic: the ply must be, too")
    return lam, mu


def isotropic(ply: Ply) -> bool:
    """Whether it has Lamé's constants."""
    try:
        lame_constants(ply)
    except ValueError:
        return False
    return True


def bulk_stiffness(ply: Ply) -> np.ndarray:
    """lam of the normal strains (6, 6) [MPa] of an isotropic ply; 0 of any other, which no one constant makes stiff."""
    lam = lame_constants(ply)[0] if isotropic(ply) else 0.0
    return lam * np.outer(ROW == COLUMN, ROW == COLUMN)


class Principal(ABC):
    """Laws W(h) of the logarithms h_a of the principal stretches, with T_a = dW/dh_a (the Kirchhoff stresses).

    Along the principal axes of C = 1 + 2 E, with its eigenvalues c_a = exp(2 h_a): S_a = T_a/c_a,
    dS_a/dE_b = (dT_a/dh_b - 2 d_ab T_a)/(c_a c_b) and dS_ab/d(2E_ab) = (S_a - S_b)/(c_a - c_b).
    Source: Ogden, Non-linear Elastic Deformations (1984), 6.1 (recalled).
    """

    @abstractmethod
    def stored(self, h: np.ndarray) -> np.ndarray:
        """W (...) of h (..., 3)."""

    @abstractmethod
    def kirchhoff(self, h: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """T (..., 3) and dT/dh (..., 3, 3), of h (..., 3)."""

    def energy(self, strain: np.ndarray) -> np.ndarray:
        """W of the principal stretches."""
        return self.stored(stretches(strain)[0])

    def response(self, strain: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Along the principal axes and back."""
        h, axes = stretches(strain)
        c = np.exp(2 * h)
        T, slope = self.kirchhoff(h)
        stress, tangent = np.zeros(strain.shape), np.zeros((*strain.shape, 6))
        S = stress[..., NORMAL] = T / c
        direct = slope / (c[..., :, None] * c[..., None, :])
        direct -= (2 * T / c**2)[..., None] * np.eye(3)
        tangent[..., NORMAL[:, None], NORMAL] = direct
        apart = c[..., _A] - c[..., _B]
        close = np.abs(apart) <= _CLOSE * c[..., _A]
        own = 0.25 * (direct[..., _A, _A] + direct[..., _B, _B] - direct[..., _A, _B] - direct[..., _B, _A])
        tangent[..., SHEAR, SHEAR] = np.where(close, own, (S[..., _A] - S[..., _B]) / np.where(close, 1.0, apart))
        turn = _strain_turn(axes)
        back = turn.swapaxes(-1, -2)
        return np.einsum("...qp,...p->...q", back, stress), back @ tangent @ turn


@dataclass(frozen=True)
class Hencky(Principal):
    """W = lam/2 (tr h)^2 + mu tr h^2; Lamé's constants in MPa: T_a = lam tr h + 2 mu h_a.

    Source: Hencky, Z. Techn. Phys. 9 (1928) 215 (recalled).
    """

    lam: float
    mu: float

    @classmethod
    def of(cls, ply: Ply) -> Hencky:
        """Of an isotropic ply."""
        return cls(*lame_constants(ply))

    def divided(self) -> tuple[Law, Law]:
        """The parts of mu and of lam."""
        return Hencky(0.0, self.mu), Hencky(self.lam, 0.0)

    def stored(self, h: np.ndarray) -> np.ndarray:
        """Quadratic."""
        return np.asarray(0.5 * self.lam * h.sum(axis=-1) ** 2 + self.mu * np.sum(h * h, axis=-1))

    def kirchhoff(self, h: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Linear."""
        slope = np.broadcast_to(self.lam + 2 * self.mu * np.eye(3), (*h.shape, 3))
        return self.lam * h.sum(axis=-1, keepdims=True) + 2 * self.mu * h, slope


@dataclass(frozen=True)
class Ogden(Principal):
    """W = sum_p m_p/a_p (sum_a exp(a_p g_a) - 3) + K/4 (J^2 - 1 - 2 ln J), g_a = h_a - ln(J)/3, J the change of volume.

    terms: pairs (m_p [MPa], a_p), whose sum of m_p a_p is twice the shear modulus; K [MPa] the bulk modulus. The
    exponents 2 and -2 are Mooney and Rivlin's law.
    Source: Ogden, Proc. R. Soc. A 326 (1972) 565 and 328 (1972) 567; the volumetric part is that of Simo and Taylor,
    Comput. Methods Appl. Mech. Eng. 85 (1991) 273 (recalled).
    """

    terms: tuple[tuple[float, float], ...]
    bulk: float

    RUBBER: ClassVar = ((6.3, 1.3), (0.012, 5.0), (-0.1, -2.0))  # Treloar's, fitted by Ogden (1972), 1e5 Pa (recalled)
    MOONEY: ClassVar = ((0.8, 2.0), (-0.2, -2.0))  # a fifth of the modulus from the second invariant

    @classmethod
    def scaled(cls, ply: Ply, terms: tuple[tuple[float, float], ...]) -> Ogden:
        """Of an isotropic ply: the terms in the ratio given, with its shear and its bulk modulus."""
        lam, mu = lame_constants(ply)
        share = 2 * mu / sum(m * a for m, a in terms)
        return cls(tuple((share * m, a) for m, a in terms), lam + 2 / 3 * mu)

    @classmethod
    def of(cls, ply: Ply) -> Ogden:
        """Treloar's rubber."""
        return cls.scaled(ply, cls.RUBBER)

    @classmethod
    def mooney_rivlin(cls, ply: Ply) -> Ogden:
        """c_1 (I_1 - 3) + c_2 (I_2 - 3) of the invariants without the change of volume, c_2 = c_1/4."""
        return cls.scaled(ply, cls.MOONEY)

    def divided(self) -> tuple[Law, Law]:
        """The terms, and the part of K."""
        return Ogden(self.terms, 0.0), Ogden((), self.bulk)

    def stored(self, h: np.ndarray) -> np.ndarray:
        """Sums of exp(x) - 1 - x, for the g_a add up to nothing."""
        volume = h.sum(axis=-1)
        g = h - volume[..., None] / 3
        return np.asarray(
            sum(m / a * beyond_linear(a * g).sum(axis=-1) for m, a in self.terms)
            + 0.25 * self.bulk * beyond_linear(2 * volume)
        )

    def kirchhoff(self, h: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """T_a = sum_p m_p (exp(a_p g_a) - their mean) + K/2 (J^2 - 1)."""
        volume = h.sum(axis=-1, keepdims=True)
        g = h - volume / 3
        T = 0.5 * self.bulk * np.expm1(2 * volume) + np.zeros_like(h)
        slope = np.tile((self.bulk * np.exp(2 * volume))[..., None], (3, 3))
        for m, a in self.terms:
            grown = np.expm1(a * g)
            T += m * (grown - grown.mean(axis=-1, keepdims=True))
            e = 1.0 + grown
            slope += m * a / 3 * (e.mean(axis=-1)[..., None, None] - e[..., :, None] - e[..., None, :])
            slope += m * a * e[..., None] * np.eye(3)
        return T, slope


def stretches(strain: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Logarithms (..., 3) of the principal stretches, NaN where there are none, and their axes (..., 3, 3)."""
    e, axes = np.linalg.eigh(tensor(strain / ONCE))
    return 0.5 * np.log1p(2 * np.where(e > -0.5, e, np.nan)), axes


def beyond_linear(x: np.ndarray) -> np.ndarray:
    """exp(x) - 1 - x, by its series where the difference would lose digits."""
    small = np.where(np.abs(x) < 1, x, 0.0)
    series = np.ones_like(small)
    for n in range(_SERIES, 2, -1):
        series = 1 + small / n * series
    return np.where(np.abs(x) < 1, 0.5 * small**2 * series, np.expm1(x) - x)


def _strain_turn(axes: np.ndarray) -> np.ndarray:
    """(..., 6, 6): strains along the columns of ``axes`` (..., 3, 3) from those along the axes that these are in."""
    i, j, a, b = ROW, COLUMN, ROW[:, None], COLUMN[:, None]
    return 0.5 * ONCE[:, None] * (axes[..., i, a] * axes[..., j, b] + axes[..., j, a] * axes[..., i, b])
