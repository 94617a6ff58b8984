"""Surfaces inside a wall: at which distances displacements are unknown and strains are taken, and the law between them.

Displacements are polynomials L^I(d) through the wall, or through each ply, of those of the surfaces I; strains are
polynomials of those taken on the same surfaces, on both sides of one that two plies share, where the slope of the
displacements jumps. Both faces are among the surfaces; those inside lie at Chebyshev points, which keep polynomials
of any order well conditioned.

What the change of volume costs an isotropic ply is met at one point fewer. E33 is the slope of a polynomial of degree
n - 1, so that n surfaces have n - 1 ways to let a wall keep its volume, whatever its other strains are: asked for at n
points it would lock, and no pressure balance it. Two surfaces have one way, in which bending has no share: they lock.
No surface geometry and no element may enter here.
Source: sampling surfaces, Kulikov, Plotnikova, ZAMM 92 (2012) 910-920 (recalled).
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise

import numpy as np

from formulations.section.laminate import SURFACES, Laminate
from formulations.section.material import bulk_stiffness

IN_VOIGT = (0, 1, 2, 4, 5, 3)  # E11, E22, 2E12, 2E13, 2E23, E33 among 11, 22, 12, 33, 13, 23


@dataclass(frozen=True, eq=False)
class Points:
    """Of integrals through the wall: at distances d (K,) [mm], with weights (K,) [mm].

    ply (K,): of each.  value (K, T): the strain there from those taken.
    """

    d: np.ndarray
    weights: np.ndarray
    ply: np.ndarray
    value: np.ndarray

    def moments(self, stiffness: np.ndarray) -> np.ndarray:
        """(3, T, 6, T, 6): sums of w d^m L^t L^t' b, m = 0, 1, 2, b (plies, 6, 6) the stiffness of their ply [N/mm]."""
        weights = self.weights * self.d ** np.arange(3)[:, None]
        return np.einsum("mk,kt,ks,kij->mtisj", weights, self.value, self.value, stiffness[self.ply], optimize=True)

    def of_ply(self, ply: int) -> Points:
        """Those inside one ply."""
        own = self.ply == ply
        return Points(self.d[own], self.weights[own], self.ply[own], self.value[own])


@dataclass(frozen=True, eq=False)
class Sampling:
    """at (S,): distances of the surfaces with unknown displacements from the reference surface [mm], inner face first.

    strained (T,): where strains are taken; on (T,): the surface that lies there; slope (T, S): dL^I/dd there [1/mm].
    points: as many a ply as surfaces, exact for the square of a strain.  of_volume: one fewer a ply, from three on.
    """

    laminate: Laminate
    at: np.ndarray
    strained: np.ndarray
    on: np.ndarray
    slope: np.ndarray
    points: Points
    of_volume: Points

    @classmethod
    def of(cls, laminate: Laminate, surfaces: str) -> Sampling:
        """``surfaces``: of SURFACES, how many there are, or how many a ply; raises ValueError for others."""
        if surfaces not in SURFACES:
            raise ValueError(f"surfaces {surfaces!r} is not one of {', '.join(SURFACES)}")
        count, _, each = surfaces.partition("/")
        n = int(count)
        ends = _ends(laminate)
        blocks = ends if each else ends[[0, -1]]
        fraction = 0.5 * (1 - np.cos(np.pi * np.arange(n) / (n - 1)))
        own = [low + (high - low) * fraction for low, high in pairwise(blocks)]
        T, S = n * len(own), (n - 1) * len(own) + 1
        on = np.concatenate([(n - 1) * b + np.arange(n) for b in range(len(own))])
        slope = np.zeros((T, S))
        for b, d in enumerate(own):
            slope[n * b : n * (b + 1), (n - 1) * b : (n - 1) * (b + 1) + 1] = lagrange(d, d)[1]
        at = np.empty(S)
        at[on] = np.concatenate(own)
        points, of_volume = (_points(ends, own, k) for k in (n, max(n - 1, 2)))
        return cls(laminate, at, np.concatenate(own), on, slope, points, of_volume)

    @property
    def inside(self) -> tuple[float, ...]:
        """Fractions of the wall at which the surfaces between the faces lie."""
        return tuple((self.at[1:-1] - self.laminate.d_minus) / self.laminate.thickness)

    @property
    def ends(self) -> list[tuple[float, float]]:
        """Distances of both sides of each ply."""
        return list(pairwise(_ends(self.laminate).tolist()))

    @property
    def over_all(self) -> bool:
        """Whether one polynomial goes through all plies, or there is one."""
        return len(self.at) == len(self.strained)

    def taken(self, ply: int, d: np.ndarray) -> np.ndarray:
        """(k, T): the strain at distances d (k,) in a ply from those taken."""
        T, plies = len(self.strained), len(self.laminate.plies)
        own = slice(None) if self.over_all else slice(ply * T // plies, (ply + 1) * T // plies)
        shares = np.zeros((len(d), T))
        shares[:, own] = lagrange(self.strained[own], d)[0]
        return shares

    def displaced(self, d: float) -> np.ndarray:
        """(S,): the displacement at the distance d from those of the surfaces."""
        shares = np.zeros(len(self.at))
        inside = np.array([low <= d for low, _ in self.ends])
        ply = int(np.flatnonzero(inside)[-1]) if inside.any() else 0
        n = len(self.strained) // len(self.laminate.plies)
        own = slice(None) if self.over_all else slice(ply * (n - 1), (ply + 1) * (n - 1) + 1)
        shares[own] = lagrange(self.at[own], np.array([d]))[0][0]
        return shares

    @cached_property
    def means(self) -> np.ndarray:
        """(T,) weights of the mean through the wall of what is taken on the surfaces."""
        return np.asarray(self.points.weights @ self.points.value / self.laminate.thickness)

    @cached_property
    def to_faces(self) -> np.ndarray:
        """(2, T): N^-(d) and N^+(d), linear from face to face, at the surfaces where strains are taken."""
        outer = (self.strained - self.laminate.d_minus) / self.laminate.thickness
        return np.stack([1 - outer, outer])

    @cached_property
    def stiffness(self) -> np.ndarray:
        """b (plies, 6, 6) [MPa] of the plies, in the order E11, E22, 2E12, 2E13, 2E23, E33."""
        return _in_order([each.stiffness() for each in self.laminate.plies])

    @cached_property
    def moments(self) -> np.ndarray:
        """(3, T, 6, T, 6) of the plies, with what volume costs at its own points; see :meth:`Points.moments`."""
        of_volume = _in_order([bulk_stiffness(each) for each in self.laminate.plies])
        return self.points.moments(self.stiffness - of_volume) + self.of_volume.moments(of_volume)

    def linear_stress(self, resultants: np.ndarray) -> np.ndarray:
        """Work (T, 6) of a stress that is linear through the wall on the strains taken, of its resultants (11,).

        As of two faces: H^-+ of the strains of both faces, H33 of the mean of E33.
        """
        h = self.laminate.thickness
        at_faces = np.linalg.solve(h / 6 * np.array([[2.0, 1.0], [1.0, 2.0]]), resultants[:10].reshape(5, 2).T)
        outer = (self.points.d - self.laminate.d_minus) / h
        stress = np.stack([1 - outer, outer], axis=-1) @ at_faces
        stress = np.hstack([stress, np.full((len(outer), 1), resultants[10] / h)])
        return np.asarray(self.points.value.T @ (self.points.weights[:, None] * stress))


def _points(ends: np.ndarray, blocks: list[np.ndarray], n: int) -> Points:
    """n Gauss points in each ply, of strains taken on the surfaces of the blocks, the plies or the whole wall."""
    unit, share = np.polynomial.legendre.leggauss(n)
    d = np.concatenate([0.5 * (a + b) + 0.5 * (b - a) * unit for a, b in pairwise(ends)])
    plies, each = len(ends) - 1, len(blocks[0])
    ply = np.repeat(np.arange(plies), n)
    value = np.zeros((len(d), each * len(blocks)))
    for b, at in enumerate(blocks):
        inside = ply == b if len(blocks) == plies else slice(None)
        value[inside, each * b : each * (b + 1)] = lagrange(at, d[inside])[0]
    return Points(d, np.repeat(0.5 * np.diff(ends), n) * np.tile(share, plies), ply, value)


def _in_order(stiffness: list[np.ndarray]) -> np.ndarray:
    """(plies, 6, 6) in the order E11, E22, 2E12, 2E13, 2E23, E33, of plies in Voigt's."""
    return np.array(stiffness)[:, IN_VOIGT][:, :, IN_VOIGT]


def _ends(laminate: Laminate) -> np.ndarray:
    """Distances (plies + 1,) of the sides of the plies."""
    ends = laminate.d_minus + np.append(0.0, np.cumsum([ply.thickness for ply in laminate.plies]))
    ends[-1] = laminate.d_plus
    return ends


def lagrange(nodes: np.ndarray, at: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Values and derivatives (k, n) of the polynomials that are 1 on one of the nodes (n,) and 0 on the others."""
    n = len(nodes)
    value, slope = np.ones((len(at), n)), np.zeros((len(at), n))
    for i in range(n):
        for j in range(n):
            if j != i:
                step = 1 / (nodes[i] - nodes[j])
                slope[:, i] = slope[:, i] * (at - nodes[j]) * step + value[:, i] * step
                value[:, i] *= (at - nodes[j]) * step
    return value, slope
