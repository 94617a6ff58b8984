"""The modes of an element with surfaces inside its wall, and the law from their strains to resultants.

The strains of every surface lie on modes xi1^r1 xi2^r2, mode by mode, then surface by surface::

    00: all six     01: E11, 2E13, 2E23, E33     10: E22, 2E13, 2E23, E33     11: E33

Those are the modes of :mod:`formulations.element.modes` and, of 2E23 on 01 and 2E13 on 10, what differs from the mean
through the wall. The mean would lock in bending; without the rest nothing but E_aa, which costs little where elements
are long and surfaces close, would resist directors that alternate from node to node and from surface to surface.

Resultants are weighted: H dE is the work an area of the reference surface. On 00 they are those of the law, met in the
middle of the element at points k through the wall::

    H_t = sum over k of w_k zeta_1 zeta_2 L^t(d_k) S(E(d_k))

On the other modes, which vanish with the square of the element, H = D E with D of the law at rest, as of stresses that
have no other components on that mode: E33 does not vary against strains that cannot vary with it, and nearly
incompressible walls do not lock. A law thus costs a quarter of its points, and the modes are not coupled.

No measure, no displacement and no load may enter here.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from typing import ClassVar, Protocol

import numpy as np

from formulations.element.modal import ALL, Stiffness
from formulations.element.strain_operator import GAUSS
from formulations.geometry.grid import CORNERS
from formulations.operations import product, spend
from formulations.section.laws import LAWS, Law
from formulations.section.sampling import IN_VOIGT, Sampling

ROWS_OF_MODE = {(0, 0): (0, 1, 2, 3, 4, 5), (0, 1): (0, 3, 4, 5), (1, 0): (1, 3, 4, 5), (1, 1): (5,)}
POWERS, ROWS = list(ROWS_OF_MODE), list(ROWS_OF_MODE.values())
N_ROWS, N_OF_SURFACE = len(IN_VOIGT), sum(map(len, ROWS))
FACTORS = np.array([3.0 ** (r1 + r2) for r1, r2 in POWERS])
ON_GAUSS, ON_CORNERS = (np.array([at[:, 0] ** r1 * at[:, 1] ** r2 for r1, r2 in POWERS]) for at in (GAUSS, CORNERS))
E33 = N_ROWS - 1  # the last row of every mode
OF_E33 = np.cumsum([len(rows) for rows in ROWS]) - 1
LINEAR = "svk"  # in closed form: it is linear in the strain


def mode_slices(T: int) -> list[slice]:
    """Where the modes of T surfaces lie among 15 T."""
    ends = np.cumsum([0, *(T * len(rows) for rows in ROWS)]).tolist()
    return [slice(start, end) for start, end in pairwise(ends)]


def strains_at(strains: np.ndarray, at: np.ndarray) -> np.ndarray:
    """Strains (e, p, T, 6) of mode strains (e, 15 T) at p points where the modes have the values ``at`` (4, p)."""
    T = strains.shape[1] // N_OF_SURFACE
    found = np.zeros((len(strains), at.shape[1], T, N_ROWS))
    for rows, values, block in zip(ROWS, at, mode_slices(T), strict=True):
        of_mode = strains[:, None, block].reshape(len(strains), 1, T, len(rows))
        for column, row in enumerate(rows):
            found[..., row] += values[:, None] * of_mode[..., column]
    return found


def by_mode(of_surfaces: np.ndarray) -> np.ndarray:
    """(e, 15 T, ...) of (e, T, 15, ...)."""
    n, _, _, *rest = of_surfaces.shape
    parts = np.split(of_surfaces, OF_E33[:-1] + 1, axis=2)
    return np.concatenate([part.reshape(n, -1, *rest) for part in parts], axis=1)


def by_surface(modes: np.ndarray, T: int) -> np.ndarray:
    """(e, T, 15) of (e, 15 T)."""
    return np.concatenate([modes[:, block].reshape(len(modes), T, -1) for block in mode_slices(T)], axis=2)


def on_every_surface(block: slice, mode: int, column: int) -> slice:
    """One row of a mode."""
    return slice(block.start + column, block.stop, len(ROWS[mode]))


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
        return cls(PointLaw(sampling, laws, growth), _linear_modes(sampling))

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
