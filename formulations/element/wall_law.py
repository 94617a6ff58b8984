"""The law of an element with surfaces inside its wall, from mode strains to resultants.

Resultants are weighted: H dE is the work an area of the reference surface. On 00 they are those of the law, met in the
middle of the element at points k through the wall::

    H_t = sum over k of w_k zeta_1 zeta_2 L^t(d_k) S(E(d_k))

The other modes (:mod:`formulations.element.wall_modes`) vanish with the square of the element. There H = D E with D of
the law at rest, as of stresses that have no other components on that mode: E33 does not vary against strains that
cannot vary with it, and nearly incompressible walls do not lock. A law thus costs a quarter of its points.

Where a law is not linear, such strains count by the thickness that is left: with e of E33 on 00 of the same surface,
E33 / (1 + 2e) and 2E_a3 / sqrt(1 + 2e), in the energy. S33 of a wall that thins grows with 1 / (1 + 2e), and would let
directors alternate from node to node: a rubber sphere at twice its radius, 2 x 2 elements, had eight negative
eigenvalues, none of which is one of the wall.

No measure, no displacement and no load may enter here.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import ClassVar, Protocol

import numpy as np

from formulations.element.modal import ALL, Stiffness
from formulations.element.wall_modes import E33, FACTORS, N_OF_SURFACE, N_ROWS, ROWS
from formulations.operations import product, spend
from formulations.section.laws import LAWS, LINEAR, Law
from formulations.section.sampling import IN_VOIGT, Sampling

BY_THICKNESS = np.array([0, 0, 0, 1, 1, 2])  # a of strains that count by (1 + 2e)^(-a/2)


class PointsThrough(Protocol):
    """H (e, 6 T) of uniform strains (e, 6 T), their derivative, and the energy an area, of the elements of a part."""

    @property
    def linear(self) -> bool:
        """Whether the derivative is the same at all strains."""

    def resultants(self, strains: np.ndarray, part: slice) -> np.ndarray:
        """H [N/mm]."""

    def response(self, strains: np.ndarray, part: slice) -> tuple[np.ndarray, np.ndarray]:
        """H and dH/dE (1 or e, 6 T, 6 T)."""

    def energy(self, strains: np.ndarray, part: slice) -> np.ndarray:
        """(e,) [N/mm]."""

    def stresses(self, strains: np.ndarray) -> np.ndarray:
        """S (e, plies, ..., 6) [MPa] of strains (e, plies, ..., 6), E11, E22, 2E12, 2E13, 2E23, E33, in the plies."""


@dataclass(frozen=True, eq=False)
class WallLaw:
    """uniform: the law on the mode 00; linear: stiffness (n, n) of each other mode."""

    uniform: PointsThrough
    linear: tuple[np.ndarray, ...]

    @classmethod
    def of(cls, sampling: Sampling, growth: np.ndarray, name: str = LINEAR) -> WallLaw:
        """Of one of :data:`LAWS` for every ply; growth (E, 3): of volumes by 1, d and d^2.

        Raises ValueError for another name, and where a ply has no such law.
        """
        if name == LINEAR:
            return cls(LinearLaw.of(sampling, growth), _linear_modes(sampling))
        if name not in LAWS:
            raise ValueError(f"law {name!r} is not one of {', '.join(LAWS)}")
        laws = tuple(LAWS[name](ply) for ply in sampling.laminate.plies)
        return ThinningLaw(PointLaw(sampling, laws, growth), _linear_modes(sampling))

    def resultants(self, strains: np.ndarray, part: slice = ALL) -> np.ndarray:
        """H (e, 15 T) [N/mm] of E (e, 15 T)."""
        n = strains.shape[1] // N_OF_SURFACE * N_ROWS
        rest = Stiffness(self.linear).times(strains[:, n:, None])[..., 0]
        return np.hstack([self.uniform.resultants(strains[:, :n], part), rest])

    def response(self, strains: np.ndarray, part: slice = ALL) -> tuple[np.ndarray, Stiffness]:
        """H and dH/dE."""
        n = strains.shape[1] // N_OF_SURFACE * N_ROWS
        H, slope = self.uniform.response(strains[:, :n], part)
        rest = Stiffness(self.linear).times(strains[:, n:, None])[..., 0]
        return np.hstack([H, rest]), Stiffness((slope, *self.linear))

    def energy(self, strains: np.ndarray, part: slice = ALL) -> np.ndarray:
        """(e,) an area [N/mm]."""
        n = strains.shape[1] // N_OF_SURFACE * N_ROWS
        rest = strains[:, n:]
        work = np.sum(rest * Stiffness(self.linear).times(rest[..., None])[..., 0], axis=1)
        return np.asarray(self.uniform.energy(strains[:, :n], part) + 0.5 * work)


@dataclass(frozen=True, eq=False)
class ThinningLaw(WallLaw):
    """Strains of the modes but 00 count by the thickness that is left."""

    def resultants(self, strains: np.ndarray, part: slice = ALL) -> np.ndarray:
        """H (e, 15 T) [N/mm] of E (e, 15 T)."""
        counted = Counted.of(strains)
        return counted.back(super().resultants(counted.strains, part)[..., None])[..., 0]

    def response(self, strains: np.ndarray, part: slice = ALL) -> tuple[np.ndarray, Stiffness]:
        """H and dH/dE."""
        counted = Counted.of(strains)
        H, stiffness = super().response(counted.strains, part)
        return counted.back(H[..., None])[..., 0], CountedStiffness(stiffness.blocks, counted, H[..., None])

    def energy(self, strains: np.ndarray, part: slice = ALL) -> np.ndarray:
        """(e,) an area [N/mm]."""
        return super().energy(Counted.of(strains).strains, part)


@dataclass(frozen=True, eq=False)
class Counted:
    """x = s E with s = (1 + 2e)^(-a/2) on the modes but 00; e is E33 on 00 of the same surface.

    strains (e, 15 T): E on 00, x on the rest.  scale (e, 9 T, 1): s.  slope, bend (e, 9 T, 1): -dx/de and d2x/de2.
    turn (e, 9 T, 1): -ds/de.  onto (T, 9 T): 1 where a row is of a surface.
    """

    strains: np.ndarray
    scale: np.ndarray
    slope: np.ndarray
    turn: np.ndarray
    bend: np.ndarray
    onto: np.ndarray

    @classmethod
    def of(cls, strains: np.ndarray) -> Counted:
        """Of E (e, 15 T); NaN where nothing of the thickness is left."""
        T = strains.shape[1] // N_OF_SURFACE
        a = np.concatenate([np.tile(BY_THICKNESS[list(rows)], T) for rows in ROWS[1:]])
        onto = np.hstack([np.repeat(np.eye(T), len(rows), axis=1) for rows in ROWS[1:]])
        e = strains[:, E33 : N_ROWS * T : N_ROWS]
        thin = (1.0 / (1.0 + 2.0 * np.where(e > -0.5, e, np.nan))) @ onto
        counted, scale = strains.copy(), thin ** (a / 2)
        counted[:, N_ROWS * T :] *= scale
        slope, turn = a * thin * counted[:, N_ROWS * T :], a * thin * scale
        bend = (a + 2) * thin * slope
        return cls(counted, scale[..., None], slope[..., None], turn[..., None], bend[..., None], onto)

    def split(self, rows: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Views of (e, 15 T, j): on 00, E33 among them, and on the rest."""
        n = N_ROWS * len(self.onto)
        return rows[:, :n], rows[:, E33:n:N_ROWS], rows[:, n:]

    def ahead(self, change: np.ndarray) -> np.ndarray:
        """Change of E on 00 and x (e, 15 T, j) with that of E."""
        found = change.copy()
        _, e, rest = self.split(found)
        rest *= self.scale
        rest -= self.slope * np.matmul(self.onto.T, e)
        return found

    def back(self, resultants: np.ndarray) -> np.ndarray:
        """dW/dE (e, 15 T, j) of those by E on 00 and x: the transpose."""
        found = resultants.copy()
        _, e, rest = self.split(found)
        e -= np.matmul(self.onto, self.slope * rest)
        rest *= self.scale
        return found


@dataclass(frozen=True, eq=False)
class CountedStiffness(Stiffness):
    """By E, of blocks by E on 00 and x; resultants (e, 15 T, 1) are of these."""

    counted: Counted
    resultants: np.ndarray

    def times(self, strains: np.ndarray) -> np.ndarray:
        """(e, 15 T, j) of (e, 15 T, j)."""
        counted = self.counted
        found = counted.back(super().times(counted.ahead(strains)))
        _, e, rest = counted.split(strains)
        _, found_e, found_rest = counted.split(found)
        _, _, G = counted.split(self.resultants)
        by_surface, turned = np.matmul(counted.onto.T, e), G * counted.turn
        found_rest -= turned * by_surface
        found_e += np.matmul(counted.onto, G * counted.bend * by_surface - turned * rest)
        return found


def _linear_modes(sampling: Sampling) -> tuple[np.ndarray, ...]:
    """D of the modes but 00, weighted: what is not of a mode is left free there, (C^-1 on its rows)^-1."""
    T, moments, blocks = len(sampling.strained), sampling.moments[0], []
    for rows, factor in zip(ROWS[1:], FACTORS[1:], strict=True):
        free = [row for row in range(N_ROWS) if row not in rows]
        pairs = ((rows, rows), (free, rows), (free, free))
        own, coupled, other = (moments[:, list(i)][..., list(j)].reshape(T * len(i), -1) for i, j in pairs)
        blocks.append((own - coupled.T @ np.linalg.solve(other, coupled)) / factor)
    return tuple(blocks)


@dataclass(frozen=True, eq=False)
class LinearLaw:
    """S = b E.  moments (3, 6 T, 6 T): by 1, d and d^2.  growth (1 or E, 3): of volumes by these."""

    sampling: Sampling
    moments: np.ndarray
    growth: np.ndarray
    linear: ClassVar[bool] = True

    @classmethod
    def of(cls, sampling: Sampling, growth: np.ndarray) -> LinearLaw:
        """In every ply its own stiffness."""
        alike = np.allclose(growth, growth[0], rtol=1e-13, atol=0)
        n = N_ROWS * len(sampling.strained)
        return cls(sampling, sampling.moments.reshape(3, n, n), growth[:1] if alike else growth)

    def resultants(self, strains: np.ndarray, part: slice) -> np.ndarray:
        """D E."""
        return self.response(strains, part)[0]

    def response(self, strains: np.ndarray, part: slice) -> tuple[np.ndarray, np.ndarray]:
        """D E and D."""
        D = np.tensordot(self.growth if len(self.growth) == 1 else self.growth[part], self.moments, 1)
        return np.matmul(D, strains[..., None])[..., 0], D

    def energy(self, strains: np.ndarray, part: slice) -> np.ndarray:
        """1/2 E.D E."""
        return np.asarray(0.5 * np.sum(strains * self.resultants(strains, part), axis=-1))

    def stresses(self, strains: np.ndarray) -> np.ndarray:
        """b E."""
        return np.asarray(np.einsum("pij,ep...j->ep...i", self.sampling.stiffness, strains))


@dataclass(frozen=True, eq=False)
class PointLaw:
    """Any law of each ply, at the points through the wall.  growth (E, 3): of volumes by 1, d and d^2."""

    sampling: Sampling
    laws: tuple[Law, ...]
    growth: np.ndarray
    linear: ClassVar[bool] = False

    def resultants(self, strains: np.ndarray, part: slice) -> np.ndarray:
        """Of the stresses."""
        return self._work(self._at_points(strains, part)[0])

    def response(self, strains: np.ndarray, part: slice) -> tuple[np.ndarray, np.ndarray]:
        """Of the stresses and of dS/dE."""
        S, C = self._at_points(strains, part, tangent=True)
        value, T = self.sampling.value, len(self.sampling.strained)
        pairs = np.einsum("kt,ks->tsk", value, value).reshape(T * T, -1)
        spend(len(S) * product(*pairs.shape, N_ROWS**2))
        sums = np.matmul(pairs, C.reshape(len(S), -1, N_ROWS**2)).reshape(len(S), T, T, N_ROWS, N_ROWS)
        return self._work(S), sums.swapaxes(2, 3).reshape(len(S), T * N_ROWS, -1)

    def energy(self, strains: np.ndarray, part: slice) -> np.ndarray:
        """Sum of W."""
        E, weights = self._strains(strains), self._weights(part)
        parts = (np.sum(law.energy(E[:, own]) * weights[:, own], axis=1) for law, own in self._plies)
        return np.asarray(sum(parts))

    def stresses(self, strains: np.ndarray) -> np.ndarray:
        """Of the strains there."""
        E = np.empty_like(strains)
        E[..., IN_VOIGT] = strains
        S = [law.response(E[:, ply])[0][..., IN_VOIGT] for ply, law in enumerate(self.laws)]
        return np.stack(S, axis=1)

    @cached_property
    def _plies(self) -> list[tuple[Law, np.ndarray]]:
        """The law of each ply and its points."""
        return [(law, np.flatnonzero(self.sampling.ply == k)) for k, law in enumerate(self.laws)]

    def _weights(self, part: slice) -> np.ndarray:
        """(e, K) [mm]."""
        return np.asarray(self.growth[part] @ (self.sampling.weights * self.sampling.points ** np.arange(3)[:, None]))

    def _strains(self, strains: np.ndarray) -> np.ndarray:
        """E (e, K, 6) in the order of a ply's stiffness."""
        found = np.empty((len(strains), len(self.sampling.points), N_ROWS))
        found[..., IN_VOIGT] = np.matmul(self.sampling.value, strains.reshape(len(strains), -1, N_ROWS))
        return found

    def _at_points(self, strains: np.ndarray, part: slice, *, tangent: bool = False) -> tuple[np.ndarray, np.ndarray]:
        """Weighted S (e, K, 6) and dS/dE (e, K, 6, 6), the latter empty unless wanted."""
        E, weights = self._strains(strains), self._weights(part)[..., None]
        S, C = np.empty_like(E), np.empty((*E.shape, N_ROWS) if tangent else 0)
        for law, own in self._plies:
            stress, slope = law.response(E[:, own])
            S[:, own] = weights[:, own] * stress[..., IN_VOIGT]
            if tangent:
                C[:, own] = weights[:, own, :, None] * slope[..., IN_VOIGT, :][..., IN_VOIGT]
        return S, C

    def _work(self, S: np.ndarray) -> np.ndarray:
        """H (e, 6 T) of weighted S (e, K, 6)."""
        return np.matmul(self.sampling.value.T, S).reshape(len(S), -1)
