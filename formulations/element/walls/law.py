"""The law of an element with surfaces inside its wall, from mode strains to resultants.

Resultants are weighted: H dE is the work an area of the reference surface. On 00 they are those of the law, met in the
middle of the element at points k through the wall::

    H_t = sum over k of w_k zeta_1 zeta_2 L^t(d_k) S(E(d_k))

The other modes (:mod:`formulations.element.walls.modes`) vanish with the square of the element. There H = D E with D of
the law at rest, as of stresses that have no other components on that mode: E33 does not vary against strains that
cannot vary with it, and nearly incompressible walls do not lock. A law thus costs a quarter of its points.

Where a law is not linear, such strains count by the lengths that are left, see
:mod:`formulations.element.walls.modes`.

No measure, no displacement and no load may enter here.
"""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import ClassVar, Protocol

import numpy as np

from formulations.element.modal import ALL, Stiffness
from formulations.element.walls.modes import FACTORS, N_OF_SURFACE, N_ROWS, ROWS, Counted, CountedStiffness
from formulations.operations import product, spend
from formulations.section.laminate import LAWS, LINEAR, strain_rotation
from formulations.section.material import Divided, Law, isotropic
from formulations.section.sampling import IN_VOIGT, Points, Sampling, lagrange


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


@dataclass(frozen=True, eq=False)
class WallLaw:
    """uniform: the law on the mode 00; linear: stiffness (n, n) or (E, n, n) of each other mode."""

    sampling: Sampling
    laws: tuple[Law, ...]
    uniform: PointsThrough
    linear: tuple[np.ndarray, ...]

    @classmethod
    def of(
        cls, sampling: Sampling, growth: np.ndarray, name: str = LINEAR, angles: np.ndarray | None = None
    ) -> WallLaw:
        """Of one of :data:`LAWS` for every ply; growth (E, 3): of volumes by 1, d and d^2.

        angles (2, E) [rad]: from axis 1 of the plies to that of the modes 01 and 10, 0 unless given. Raises ValueError
        for another name, and where a ply has no such law.
        """
        if name not in LAWS:
            raise ValueError(f"law {name!r} is not one of {', '.join(LAWS)}")
        laws, linear = tuple(LAWS[name](ply) for ply in sampling.laminate.plies), _linear_modes(sampling, angles)
        if name == LINEAR:
            return cls(sampling, laws, LinearLaw.of(sampling, growth), linear)
        return ThinningLaw(sampling, laws, PointLaw.of(sampling, laws, growth), linear)

    def _linear(self, part: slice) -> tuple[np.ndarray, ...]:
        """Of the elements of a part."""
        return tuple(block if block.ndim == 2 else block[part] for block in self.linear)

    def stresses(self, strains: np.ndarray, taken: np.ndarray) -> np.ndarray:
        """S (e, plies, k, 6) [MPa] of strains (e, T, 6), E11, E22, 2E12, 2E13, 2E23, E33, of the surfaces.

        taken (plies, k, T): the places, see :meth:`Sampling.taken`. What volume costs is a polynomial through its own
        points: elsewhere its strain is not met.
        """
        stress = np.empty((len(strains), *taken.shape[:2], N_ROWS))
        for ply, (law, to_places) in enumerate(zip(self.laws, taken, strict=True)):
            shape, *volume = _divided(law)
            stress[:, ply] = _stresses(shape, np.matmul(to_places, strains))
            for part in volume:
                points = self.sampling.of_volume.of_ply(ply)
                onwards, _ = lagrange(points.d, to_places @ self.sampling.strained)
                stress[:, ply] += np.matmul(onwards, _stresses(part, np.matmul(points.value, strains)))
        return stress

    def resultants(self, strains: np.ndarray, part: slice = ALL) -> np.ndarray:
        """H (e, 15 T) [N/mm] of E (e, 15 T)."""
        n = strains.shape[1] // N_OF_SURFACE * N_ROWS
        rest = Stiffness(self._linear(part)).times(strains[:, n:, None])[..., 0]
        return np.hstack([self.uniform.resultants(strains[:, :n], part), rest])

    def response(self, strains: np.ndarray, part: slice = ALL) -> tuple[np.ndarray, Stiffness]:
        """H and dH/dE."""
        n = strains.shape[1] // N_OF_SURFACE * N_ROWS
        H, slope = self.uniform.response(strains[:, :n], part)
        linear = self._linear(part)
        rest = Stiffness(linear).times(strains[:, n:, None])[..., 0]
        return np.hstack([H, rest]), Stiffness((slope, *linear))

    def energy(self, strains: np.ndarray, part: slice = ALL) -> np.ndarray:
        """(e,) an area [N/mm]."""
        n = strains.shape[1] // N_OF_SURFACE * N_ROWS
        rest = strains[:, n:]
        work = np.sum(rest * Stiffness(self._linear(part)).times(rest[..., None])[..., 0], axis=1)
        return np.asarray(self.uniform.energy(strains[:, :n], part) + 0.5 * work)


@dataclass(frozen=True, eq=False)
class ThinningLaw(WallLaw):
    """Strains of the modes but 00 count by the lengths that are left."""

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


def _divided(law: Law) -> tuple[Law, ...]:
    """What shape costs and what volume does, or the law as it is."""
    return law.divided() if isinstance(law, Divided) else (law,)


def _stresses(law: Law, strains: np.ndarray) -> np.ndarray:
    """S (..., 6) of E (..., 6), both in the order of the strains of a surface."""
    E = np.empty_like(strains)
    E[..., IN_VOIGT] = strains
    return law.response(E)[0][..., IN_VOIGT]


def _linear_modes(sampling: Sampling, angles: np.ndarray | None) -> tuple[np.ndarray, ...]:
    """D of the modes but 00, weighted: what is not of a mode is left free there, (C^-1 on its rows)^-1."""
    T, moments, blocks = len(sampling.strained), sampling.points.moments(sampling.stiffness)[0], []
    turns: list[np.ndarray | None] = [None, None, None]  # E33 alone does not turn
    if angles is not None and not all(map(isotropic, sampling.laminate.plies)):
        turns[:2] = (_turned(each) for each in angles)
    for rows, factor, turn in zip(ROWS[1:], FACTORS[1:], turns, strict=True):
        D = moments if turn is None else np.einsum("eik,tisj,ejl->etksl", turn, moments, turn, optimize=True)
        free = [row for row in range(N_ROWS) if row not in rows]
        pairs = ((rows, rows), (free, rows), (free, free))
        own, coupled, other = (
            D[..., list(i), :, :][..., list(j)].reshape(*D.shape[:-4], T * len(i), -1) for i, j in pairs
        )
        blocks.append((own - np.matmul(coupled.swapaxes(-1, -2), np.linalg.solve(other, coupled))) / factor)
    return tuple(blocks)


def _turned(angles: np.ndarray) -> np.ndarray:
    """(E, 6, 6): strains along the axes of the plies from those along axes at an angle (E,) to them."""
    return np.array([strain_rotation(-angle) for angle in angles])[:, IN_VOIGT][:, :, IN_VOIGT]


@dataclass(frozen=True, eq=False)
class LinearLaw:
    """S = b E.  moments (3, 6 T, 6 T): by 1, d and d^2.  growth (1 or E, 3): of volumes by these."""

    moments: np.ndarray
    growth: np.ndarray
    linear: ClassVar[bool] = True

    @classmethod
    def of(cls, sampling: Sampling, growth: np.ndarray) -> LinearLaw:
        """In every ply its own stiffness."""
        alike = np.allclose(growth, growth[0], rtol=1e-13, atol=0)
        n = N_ROWS * len(sampling.strained)
        return cls(sampling.moments.reshape(3, n, n), growth[:1] if alike else growth)

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


@dataclass(frozen=True, eq=False)
class PointLaw:
    """Any law of each ply, at points through the wall; what volume costs has its own, where the law can be divided.

    parts: laws and the points at which they are met.  growth (E, 3): of volumes by 1, d and d^2.
    """

    parts: tuple[tuple[Law, slice], ...]
    points: Points
    growth: np.ndarray
    linear: ClassVar[bool] = False

    @classmethod
    def of(cls, sampling: Sampling, laws: tuple[Law, ...], growth: np.ndarray) -> PointLaw:
        """Point by point, ply by ply."""
        places, parts, end = [], [], 0
        for ply, law in enumerate(laws):
            for part, points in zip(_divided(law), (sampling.points, sampling.of_volume), strict=False):
                places.append(points.of_ply(ply))
                parts.append((part, slice(end, end := end + len(places[-1].d))))
        joined = (np.concatenate([getattr(each, f.name) for each in places]) for f in fields(Points))
        return cls(tuple(parts), Points(*joined), growth)

    def resultants(self, strains: np.ndarray, part: slice) -> np.ndarray:
        """Of the stresses."""
        return self._work(self._at_points(strains, part)[0])

    def response(self, strains: np.ndarray, part: slice) -> tuple[np.ndarray, np.ndarray]:
        """Of the stresses and of dS/dE."""
        S, C = self._at_points(strains, part, tangent=True)
        value, T = self.points.value, self.points.value.shape[1]
        pairs = np.einsum("kt,ks->tsk", value, value).reshape(T * T, -1)
        spend(len(S) * product(*pairs.shape, N_ROWS**2))
        sums = np.matmul(pairs, C.reshape(len(S), -1, N_ROWS**2)).reshape(len(S), T, T, N_ROWS, N_ROWS)
        return self._work(S), sums.swapaxes(2, 3).reshape(len(S), T * N_ROWS, -1)

    def energy(self, strains: np.ndarray, part: slice) -> np.ndarray:
        """Sum of W."""
        E, weights = self._strains(strains), self._weights(part)
        return np.asarray(sum(np.sum(law.energy(E[:, own]) * weights[:, own], axis=1) for law, own in self.parts))

    def _weights(self, part: slice) -> np.ndarray:
        """(e, K) [mm]."""
        return np.asarray(self.growth[part] @ (self.points.weights * self.points.d ** np.arange(3)[:, None]))

    def _strains(self, strains: np.ndarray) -> np.ndarray:
        """E (e, K, 6) in the order of a ply's stiffness."""
        strain = np.empty((len(strains), len(self.points.d), N_ROWS))
        strain[..., IN_VOIGT] = np.matmul(self.points.value, strains.reshape(len(strains), -1, N_ROWS))
        return strain

    def _at_points(self, strains: np.ndarray, part: slice, *, tangent: bool = False) -> tuple[np.ndarray, np.ndarray]:
        """Weighted S (e, K, 6) and dS/dE (e, K, 6, 6), the latter empty unless wanted."""
        E, weights = self._strains(strains), self._weights(part)[..., None]
        S, C = np.empty_like(E), np.empty((*E.shape, N_ROWS) if tangent else 0)
        for law, own in self.parts:
            stress, slope = law.response(E[:, own])
            S[:, own] = weights[:, own] * stress[..., IN_VOIGT]
            if tangent:
                C[:, own] = weights[:, own, :, None] * slope[..., IN_VOIGT, :][..., IN_VOIGT]
        return S, C

    def _work(self, S: np.ndarray) -> np.ndarray:
        """H (e, 6 T) of weighted S (e, K, 6)."""
        return np.matmul(self.points.value.T, S).reshape(len(S), -1)
