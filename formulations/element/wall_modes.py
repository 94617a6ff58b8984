"""The modes of an element with surfaces inside its wall, and the law from their strains to resultants.

The strains of every surface lie on the modes xi1^r1 xi2^r2 of :mod:`formulations.element.modes`, mode by mode, then
surface by surface. Resultants are weighted: H dE is the work an area of the reference surface::

    H^r_t = sum over g, k of w_k zeta_1 zeta_2 xi_g^r/4 L^t(d_k) S(E(xi_g, d_k))

over the four Gauss points g and the points k through the wall. A linear law gives this in closed form, each mode by
itself; any other is met at the points and couples the modes. No measure, no displacement and no load may enter here.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from typing import Protocol

import numpy as np

from formulations.element.strain_operator import GAUSS, N_GAUSS
from formulations.geometry.grid import CORNERS
from formulations.operations import product, spend
from formulations.section.laws import LAWS, Law
from formulations.section.sampling import IN_VOIGT, Sampling

ROWS_OF_MODE = {(0, 0): (0, 1, 2, 3, 4, 5), (0, 1): (0, 3, 5), (1, 0): (1, 4, 5), (1, 1): (5,)}
POWERS, ROWS = list(ROWS_OF_MODE), list(ROWS_OF_MODE.values())
N_ROWS, N_OF_SURFACE = len(IN_VOIGT), sum(map(len, ROWS))
FACTORS = np.array([3.0 ** (r1 + r2) for r1, r2 in POWERS])
ON_GAUSS, ON_CORNERS = (np.array([at[:, 0] ** r1 * at[:, 1] ** r2 for r1, r2 in POWERS]) for at in (GAUSS, CORNERS))
ALL = slice(None)  # elements
LINEAR = "linear"


def mode_slices(T: int) -> list[slice]:
    """Where the modes of T surfaces lie among 13 T."""
    ends = np.cumsum([0, *(T * len(rows) for rows in ROWS)]).tolist()
    return [slice(start, end) for start, end in pairwise(ends)]


def strains_at(strains: np.ndarray, at: np.ndarray) -> np.ndarray:
    """Strains (e, p, T, 6) of mode strains (e, 13 T) at p points where the modes have the values ``at`` (4, p)."""
    T = strains.shape[1] // N_OF_SURFACE
    found = np.zeros((len(strains), at.shape[1], T, N_ROWS))
    for rows, values, block in zip(ROWS, at, mode_slices(T), strict=True):
        of_mode = strains[:, None, block].reshape(len(strains), 1, T, len(rows))
        for column, row in enumerate(rows):
            found[..., row] += values[:, None] * of_mode[..., column]
    return found


@dataclass(frozen=True, eq=False)
class Stiffness:
    """Derivative of resultants by strains: blocks (1 or e, n, n), a mode each, or one of all modes, (e, 13 T, 13 T)."""

    blocks: tuple[np.ndarray, ...]

    def times(self, strains: np.ndarray) -> np.ndarray:
        """(e, 13 T, j) of (e, 13 T, j)."""
        found, start = np.empty_like(strains), 0
        for block in self.blocks:
            rows = slice(start, start + block.shape[-1])
            np.matmul(block, strains[:, rows], out=found[:, rows])
            start = rows.stop
        return found


class WallLaw(Protocol):
    """From the strains of elements on their modes to resultants; the elements are those of a part."""

    def resultants(self, strains: np.ndarray, part: slice = ALL) -> np.ndarray:
        """H (e, 13 T) [N/mm] of E (e, 13 T)."""

    def response(self, strains: np.ndarray, part: slice = ALL) -> tuple[np.ndarray, Stiffness]:
        """H and dH/dE."""

    def energy(self, strains: np.ndarray, part: slice = ALL) -> np.ndarray:
        """(e,) an area [N/mm]."""

    def stresses(self, strains: np.ndarray) -> np.ndarray:
        """S (e, plies, ..., 6) [MPa] of strains (e, plies, ..., 6), E11, E22, 2E12, 2E13, 2E23, E33, in the plies."""


@dataclass(frozen=True, eq=False)
class LinearLaw:
    """S = b E.  moments: of each mode, (3, n, n), by 1, d and d^2.  growth (1 or E, 3): of volumes by these."""

    sampling: Sampling
    moments: tuple[np.ndarray, ...]
    growth: np.ndarray

    @classmethod
    def of(cls, sampling: Sampling, growth: np.ndarray) -> LinearLaw:
        """In every ply its own stiffness."""
        blocks = []
        for rows, factor in zip(ROWS, FACTORS, strict=True):
            D = sampling.moments[:, :, rows][..., rows] / factor
            blocks.append(D.reshape(3, D.shape[1] * len(rows), -1))
        alike = np.allclose(growth, growth[0], rtol=1e-13, atol=0)
        return cls(sampling, tuple(blocks), growth[:1] if alike else growth)

    def resultants(self, strains: np.ndarray, part: slice = ALL) -> np.ndarray:
        """D E."""
        return self.response(strains, part)[0]

    def response(self, strains: np.ndarray, part: slice = ALL) -> tuple[np.ndarray, Stiffness]:
        """D E and D."""
        growth = self.growth if len(self.growth) == 1 else self.growth[part]
        D = Stiffness(tuple(np.tensordot(growth, block, 1) for block in self.moments))
        return D.times(strains[..., None])[..., 0], D

    def energy(self, strains: np.ndarray, part: slice = ALL) -> np.ndarray:
        """1/2 E.D E."""
        return np.asarray(0.5 * np.sum(strains * self.resultants(strains, part), axis=-1))

    def stresses(self, strains: np.ndarray) -> np.ndarray:
        """b E."""
        return np.asarray(np.einsum("pij,ep...j->ep...i", self.sampling.stiffness, strains))


@dataclass(frozen=True, eq=False)
class PointLaw:
    """Any law of each ply, at the Gauss points and at the points through the wall.  growth (E, 3): of volumes."""

    sampling: Sampling
    laws: tuple[Law, ...]
    growth: np.ndarray

    def resultants(self, strains: np.ndarray, part: slice = ALL) -> np.ndarray:
        """Of the stresses."""
        return self._work(self._at_points(strains, part)[0])

    def response(self, strains: np.ndarray, part: slice = ALL) -> tuple[np.ndarray, Stiffness]:
        """All modes coupled; products of modes are modes, for xi^2 is 1/3 at every Gauss point."""
        S, C = self._at_points(strains, part, tangent=True)
        n, T = len(S), len(self.sampling.strained)
        value = self.sampling.value
        mean = np.einsum("rg,kt,ks->rtsgk", ON_GAUSS / N_GAUSS, value, value).reshape(len(POWERS) * T * T, -1)
        spend(n * product(*mean.shape, N_ROWS**2))
        sums = np.matmul(mean, C.reshape(n, -1, N_ROWS**2)).reshape(n, len(POWERS), T, T, N_ROWS, N_ROWS)
        whole = np.empty((n, N_OF_SURFACE * T, N_OF_SURFACE * T))
        blocks = list(zip(POWERS, ROWS, mode_slices(T), strict=True))
        for one, rows, down in blocks:
            for other, columns, across in blocks:
                both = (one[0] + other[0]) % 2, (one[1] + other[1]) % 2
                share = 3.0 ** -sum(a * b for a, b in zip(one, other, strict=True))
                block = sums[:, POWERS.index(both)][..., rows, :][..., columns].swapaxes(2, 3)
                whole[:, down, across] = share * block.reshape(n, T * len(rows), -1)
        return self._work(S), Stiffness((whole,))

    def energy(self, strains: np.ndarray, part: slice = ALL) -> np.ndarray:
        """Sum of W."""
        E, weights, found = self._strains(strains), self._weights(part), np.zeros(len(strains))
        for law, own in self._plies:
            found += np.einsum("egk,ek->e", law.energy(E[:, :, own]), weights[:, own]) / N_GAUSS
        return found

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
        """E (e, 4, K, 6) in the order of a ply's stiffness."""
        found = np.empty((len(strains), N_GAUSS, len(self.sampling.points), N_ROWS))
        found[..., IN_VOIGT] = np.matmul(self.sampling.value, strains_at(strains, ON_GAUSS))
        return found

    def _at_points(self, strains: np.ndarray, part: slice, *, tangent: bool = False) -> tuple[np.ndarray, np.ndarray]:
        """Weighted S (e, 4, K, 6) and dS/dE (e, 4, K, 6, 6), the latter empty unless wanted."""
        E, weights = self._strains(strains), self._weights(part)[:, None, :, None]
        S, C = np.empty_like(E), np.empty((*E.shape, N_ROWS) if tangent else 0)
        for law, own in self._plies:
            stress, slope = law.response(E[:, :, own])
            S[:, :, own] = weights[:, :, own] * stress[..., IN_VOIGT]
            if tangent:
                C[:, :, own] = weights[:, :, own, :, None] * slope[..., IN_VOIGT, :][..., IN_VOIGT]
        return S, C

    def _work(self, S: np.ndarray) -> np.ndarray:
        """H (e, 13 T) of weighted S (e, 4, K, 6)."""
        on_surfaces = np.matmul(self.sampling.value.T, S).swapaxes(1, 2)  # (e, T, 4, 6)
        means = [
            np.matmul(at, on_surfaces[..., rows]).reshape(len(S), -1)
            for rows, at in zip(ROWS, ON_GAUSS / N_GAUSS, strict=True)
        ]
        return np.hstack(means)


def wall_law(sampling: Sampling, growth: np.ndarray, name: str) -> WallLaw:
    """Of "linear", or one of :data:`LAWS` for every ply; raises ValueError for another, and where a ply has none."""
    if name == LINEAR:
        return LinearLaw.of(sampling, growth)
    if name not in LAWS:
        raise ValueError(f"law {name!r} is not one of {', '.join((LINEAR, *LAWS))}")
    return PointLaw(sampling, tuple(LAWS[name](ply) for ply in sampling.laminate.plies), growth)
