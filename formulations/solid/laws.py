"""Material laws of the solid: from the Green strain to the second Piola-Kirchhoff stress and its tangent.

One convention for all: E (..., 6) and S (..., 6) [MPa] in Voigt order 11, 22, 12, 33, 13, 23 along the local axes, with
engineering shears in E; batch axes first. A law knows one ply; elements, nodes and supports do not enter here. C cannot
tell an inverted element from a sound one: det F > 0 is for who solves to see. Where an element is pressed so flat that
rounding leaves an eigenvalue of C that is not positive, stress and tangent are NaN but for St. Venant-Kirchhoff.

All three have the same tangent at E = 0, so they differ by the order of the strain itself: under uniaxial stress
S_11 = E_0 (E_11 - k E_11^2 + ...) with Young's modulus E_0 and k = 0 (St. Venant-Kirchhoff), 3 (Hencky) and
2 + nu (1 + 2 nu^2)/(1 + nu) (neo-Hooke). A shell has the first alone: its energy is 1/2 E.D E with D integrated through
the thickness once, on strains that are linear between the faces. Any other law is nonlinear through the thickness, so
H and dH/dE would be integrals over points through it in every element and iteration, and the mixed element, whose modes
ask for one D, would have to solve for the resultants. What that small strain costs is measured with the solid instead.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Protocol, Self

import numpy as np

from formulations.section.laminate import Ply

VOIGT = ((0, 0), (1, 1), (0, 1), (2, 2), (0, 2), (1, 2))  # order of Ply.stiffness
_I, _J = np.array(VOIGT).T
_ONCE = np.where(_I == _J, 1.0, 2.0)  # how often a component stands in a symmetric tensor
_NORMAL, _SHEAR = np.flatnonzero(_I == _J), np.flatnonzero(_I != _J)
_UNIT = (_I == _J).astype(float)
_ALIKE = 1e-9  # of the largest entry: rounding of an isotropic stiffness


class Law(Protocol):
    """A frozen record of the constants of one ply."""

    @classmethod
    def of(cls, ply: Ply) -> Self:
        """The law whose tangent at rest is the stiffness of the ply; raises ValueError where it has none."""

    def response(self, strain: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """S (..., 6) = dW/dE [MPa] at E (..., 6), and dS/dE (6, 6) or (..., 6, 6), symmetric."""


@dataclass(frozen=True, eq=False)
class StVenantKirchhoff:
    """W = 1/2 E.B E, S = B E with any stiffness B (6, 6) [MPa]: linear, whatever the angle and the kind of the ply.

    It softens in compression: the force F_11 S_11 of a bar is largest at the stretch 1/sqrt(3).
    """

    B: np.ndarray

    @classmethod
    def of(cls, ply: Ply) -> StVenantKirchhoff:
        """The ply's own stiffness in the shell axes."""
        return cls(ply.stiffness())

    def response(self, strain: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """B E and B."""
        return strain @ self.B.T, self.B


@dataclass(frozen=True)
class Hencky:
    """W = lam/2 (tr H)^2 + mu tr H^2 with the logarithmic strain H = 1/2 ln C; Lamé's constants in MPa.

    Along the principal axes of C = 1 + 2 E, with its eigenvalues c_a = exp(2 H_a) and T_a = lam tr H + 2 mu H_a (the
    principal Kirchhoff stresses): S_a = T_a/c_a, dS_a/dE_b = (lam + 2 mu d_ab)/(c_a c_b) - 2 d_ab T_a/c_a^2 and
    dS_ab/d(2E_ab) = (S_a - S_b)/(c_a - c_b).
    Source: Hencky, Z. Techn. Phys. 9 (1928) 215; its tangent as in Ogden, Non-linear Elastic Deformations (1984), 6.1
    (recalled).
    """

    lam: float
    mu: float

    @classmethod
    def of(cls, ply: Ply) -> Hencky:
        """Of an isotropic ply."""
        return cls(*lame_constants(ply))

    def response(self, strain: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Along the principal axes and back."""
        c, axes = np.linalg.eigh(np.eye(3) + 2 * tensor(strain / _ONCE))
        c = np.where(c > 0, c, np.nan)
        log_c = np.log(c)
        spherical = 0.5 * self.lam * log_c.sum(axis=-1)[..., None]
        T = spherical + self.mu * log_c
        stress, tangent = np.zeros(strain.shape), np.zeros((*strain.shape, 6))
        stress[..., _NORMAL] = T / c
        direct = (self.lam + 2 * self.mu * np.eye(3)) / (c[..., :, None] * c[..., None, :])
        direct -= (2 * T / c**2)[..., None] * np.eye(3)
        tangent[..., _NORMAL[:, None], _NORMAL] = direct
        # (S_a - S_b)/(c_a - c_b) without a difference, for eigenvalues may coincide: ln c_b - ln c_a = log1p(d), d >= 0
        a, b = c[..., _I[_SHEAR]], c[..., _J[_SHEAR]]
        d = b / a - 1
        quotient = np.divide(np.log1p(d), d, out=np.ones_like(d), where=d != 0)
        tangent[..., _SHEAR, _SHEAR] = (self.mu * (quotient - log_c[..., _I[_SHEAR]]) - spherical) / (a * b)
        turn = _strain_turn(axes)
        back = turn.swapaxes(-1, -2)
        return np.einsum("...qp,...p->...q", back, stress), back @ tangent @ turn


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

    def response(self, strain: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Both in closed form."""
        C = np.eye(3) + 2 * tensor(strain / _ONCE)
        squared = np.linalg.det(C)[..., None]  # J^2
        squared = np.where(squared > 0, squared, np.nan)
        inverse = np.linalg.inv(np.where(squared[..., None] > 0, C, np.nan))
        pressure = 0.5 * self.lam * np.log(squared)  # lam ln J
        flat = inverse[..., _I, _J]
        stress = self.mu * (_UNIT - flat) + pressure * flat
        i, j, k, m = _I[:, None], _J[:, None], _I, _J
        pairs = inverse[..., i, k] * inverse[..., j, m] + inverse[..., i, m] * inverse[..., j, k]
        tangent = self.lam * flat[..., :, None] * flat[..., None, :] + (self.mu - pressure)[..., None] * pairs
        return stress, tangent


LAWS: Mapping[str, Callable[[Ply], Law]] = {
    "svk": StVenantKirchhoff.of,
    "hencky": Hencky.of,
    "neo-hooke": NeoHooke.of,
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
    isotropic = lam * np.outer(_UNIT, _UNIT) + mu * np.diag(2 / _ONCE)
    if np.max(np.abs(B - isotropic)) > _ALIKE * np.max(np.abs(B)):
        raise ValueError("this law is isotropic: the ply must be, too")
    return lam, mu


def _strain_turn(axes: np.ndarray) -> np.ndarray:
    """(..., 6, 6): strains along the columns of ``axes`` (..., 3, 3) from those along the axes that these are in."""
    i, j, a, b = _I, _J, _I[:, None], _J[:, None]
    return 0.5 * _ONCE[:, None] * (axes[..., i, a] * axes[..., j, b] + axes[..., j, a] * axes[..., i, b])
