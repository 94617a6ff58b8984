"""Material laws: energy, second Piola-Kirchhoff stress and tangent of the Green strain, at points of a wall or a solid.

One convention for all: E (..., 6) and S (..., 6) [MPa] in Voigt order 11, 22, 12, 33, 13, 23 along the local axes, with
engineering shears in E; batch axes first. A law knows one ply; elements, nodes and supports do not enter here. C cannot
tell an inverted element from a sound one: det F > 0 is for who solves to see. Where an element is pressed so flat that
rounding leaves an eigenvalue of C that is not positive, stress and tangent are NaN but for St. Venant-Kirchhoff.

All have the same tangent at E = 0, so they differ by the order of the strain itself: under uniaxial stress
S_11 = E_0 (E_11 - k E_11^2 + ...) with Young's modulus E_0 and k = 0 (St. Venant-Kirchhoff), 3 (Hencky) and
2 + nu (1 + 2 nu^2)/(1 + nu) (neo-Hooke). Nothing is a difference of numbers far larger than itself: energy and stress
keep their digits down to strains of 1e-12 and below. A law of one's own is a class with the methods of :class:`Law` and
a line in :data:`LAWS`, from a file given with ``--use`` as well: what makes it of a ply, or raises ValueError where the
ply has none. Its tangent at rest is the stiffness of the ply. With the method of :class:`Divided` besides, a wall that
hardly changes its volume does not lock.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial
from typing import ClassVar, Protocol, runtime_checkable

import numpy as np

from formulations.section.laminate import Ply

LINEAR = "svk"  # the one of LAWS that is linear in the strain
VOIGT = ((0, 0), (1, 1), (0, 1), (2, 2), (0, 2), (1, 2))  # order of Ply.stiffness
_I, _J = np.array(VOIGT).T
_ONCE = np.where(_I == _J, 1.0, 2.0)  # how often a component stands in a symmetric tensor
_NORMAL, _SHEAR = np.flatnonzero(_I == _J), np.flatnonzero(_I != _J)
_A, _B = _I[_SHEAR], _J[_SHEAR]
_ALIKE = 1e-9  # of the largest entry: rounding of an isotropic stiffness
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
        return self.stored(_stretches(strain)[0])

    def response(self, strain: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Along the principal axes and back."""
        h, axes = _stretches(strain)
        c = np.exp(2 * h)
        T, slope = self.kirchhoff(h)
        stress, tangent = np.zeros(strain.shape), np.zeros((*strain.shape, 6))
        S = stress[..., _NORMAL] = T / c
        direct = slope / (c[..., :, None] * c[..., None, :])
        direct -= (2 * T / c**2)[..., None] * np.eye(3)
        tangent[..., _NORMAL[:, None], _NORMAL] = direct
        apart = c[..., _A] - c[..., _B]
        close = np.abs(apart) <= _CLOSE * c[..., _A]
        own = 0.25 * (direct[..., _A, _A] + direct[..., _B, _B] - direct[..., _A, _B] - direct[..., _B, _A])
        tangent[..., _SHEAR, _SHEAR] = np.where(close, own, (S[..., _A] - S[..., _B]) / np.where(close, 1.0, apart))
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
            sum(m / a * _beyond_linear(a * g).sum(axis=-1) for m, a in self.terms)
            + 0.25 * self.bulk * _beyond_linear(2 * volume)
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
        h, _ = _stretches(strain)
        return 0.5 * self.mu * _beyond_linear(2 * h).sum(axis=-1) + 0.5 * self.lam * h.sum(axis=-1) ** 2

    def response(self, strain: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Both in closed form: 1 - C^-1 = 2 E C^-1 and J^2 - 1 = 2 I_1 + 4 I_2 + 8 I_3 of E, without a difference."""
        E = tensor(strain / _ONCE)
        trace = np.trace(E, axis1=-2, axis2=-1)
        second = 0.5 * (trace**2 - np.einsum("...ij,...ij->...", E, E))
        swelling = (2 * trace + 4 * second + 8 * np.linalg.det(E))[..., None]  # J^2 - 1
        swelling = np.where(swelling > -1, swelling, np.nan)
        C = np.eye(3) + 2 * E
        regular = np.isfinite(swelling[..., 0]) & (np.linalg.det(C) != 0)  # strains of 1e8 round it to a singular one
        inverse = np.linalg.inv(np.where(regular[..., None, None], C, np.nan))
        pressure = 0.5 * self.lam * np.log1p(swelling)  # lam ln J
        flat = inverse[..., _I, _J]
        stress = 2 * self.mu * np.matmul(E, inverse)[..., _I, _J] + pressure * flat
        i, j, k, m = _I[:, None], _J[:, None], _I, _J
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
        mu, lam = B[_SHEAR, _SHEAR].min(), min(B[0, 1], B[0, 3], B[1, 3])
        bulk = lam + 2 / 3 * mu
        if not bulk > 0:
            raise ValueError(f"the rubber between the cords has a bulk modulus of {bulk:.4g} MPa: it must be positive")
        rubber = Ply.isotropic(3 * bulk * mu / (lam + mu), lam / (2 * (lam + mu)), ply.thickness)
        rest = ply.stiffness() - rubber.stiffness()
        if np.max(np.abs(rest)) <= _ALIKE * np.max(np.abs(B)):
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


LAWS: dict[str, Callable[[Ply], Law]] = {
    "svk": StVenantKirchhoff.of,
    "hencky": partial(Corded.of, Hencky.of),
    "neo-hooke": partial(Corded.of, NeoHooke.of),
    "mooney-rivlin": partial(Corded.of, Ogden.mooney_rivlin),
    "ogden": partial(Corded.of, Ogden.of),
}


def tensor(components: np.ndarray) -> np.ndarray:
    """Symmetric (..., 3, 3) of its components (..., 6); those of a strain are to be divided by two in shear."""
    full = np.empty((*components.shape[:-1], 3, 3))
    full[..., _I, _J] = full[..., _J, _I] = components
    return full


def lame_constants(ply: Ply) -> tuple[float, float]:
    """lam and mu [MPa] of an isotropic ply; raises ValueError for any other."""
    B = ply.stiffness()
    lam, mu = float(B[0, 1]), float(B[2, 2])
    isotropic = lam * np.outer(_I == _J, _I == _J) + mu * np.diag(2 / _ONCE)
    if np.max(np.abs(B - isotropic)) > _ALIKE * np.max(np.abs(B)):
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
    return lam * np.outer(_I == _J, _I == _J)


def _stretches(strain: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Logarithms (..., 3) of the principal stretches, NaN where there are none, and their axes (..., 3, 3)."""
    e, axes = np.linalg.eigh(tensor(strain / _ONCE))
    return 0.5 * np.log1p(2 * np.where(e > -0.5, e, np.nan)), axes


def _beyond_linear(x: np.ndarray) -> np.ndarray:
    """exp(x) - 1 - x, by its series where the difference would lose digits."""
    small = np.where(np.abs(x) < 1, x, 0.0)
    series = np.ones_like(small)
    for n in range(_SERIES, 2, -1):
        series = 1 + small / n * series
    return np.where(np.abs(x) < 1, 0.5 * small**2 * series, np.expm1(x) - x)


def _strain_turn(axes: np.ndarray) -> np.ndarray:
    """(..., 6, 6): strains along the columns of ``axes`` (..., 3, 3) from those along the axes that these are in."""
    i, j, a, b = _I, _J, _I[:, None], _J[:, None]
    return 0.5 * _ONCE[:, None] * (axes[..., i, a] * axes[..., j, b] + axes[..., j, a] * axes[..., i, b])
