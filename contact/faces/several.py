"""Several pairs of faces in one problem: candidates and points of one pair after those of the other.

Each pair is one by itself, with a gap and forces of its own; a body may be the slave of one and the master of the next.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise

import numpy as np
from scipy import sparse

from contact.faces.pair import Pair, Paired
from contact.swept import Crossing, Passable


@dataclass(frozen=True, eq=False)
class Several:
    """Pairs in the same unknowns u (n,), as :class:`contact.faces.pair.Pair` is one; m and k are sums over them."""

    pairs: tuple[Pair, ...]

    @cached_property
    def operator(self) -> sparse.csr_matrix:
        """d positions/du (3k, n)."""
        return sparse.csr_matrix(sparse.vstack([each.operator for each in self.pairs]))

    @cached_property
    def weights(self) -> np.ndarray:
        """Reference areas of the candidates (m,) [mm^2]."""
        return np.concatenate([each.weights for each in self.pairs])

    @cached_property
    def candidates(self) -> tuple[slice, ...]:
        """Those of each pair."""
        ends = np.cumsum([0, *(len(each.weights) for each in self.pairs)]).tolist()
        return tuple(slice(low, high) for low, high in pairwise(ends))

    @property
    def parts(self) -> tuple[tuple[Pair, slice], ...]:
        """Each pair and its candidates."""
        return tuple(zip(self.pairs, self.candidates, strict=True))

    def positions(self, u: np.ndarray) -> np.ndarray:
        """x (k, 3)."""
        return np.concatenate([each.positions(u) for each in self.pairs])

    def at(self, u: np.ndarray) -> Together:
        """What is closest to what at u (n,)."""
        return Together(self, tuple(each.at(u) for each in self.pairs))

    def forces(self, u: np.ndarray, nodal: np.ndarray) -> np.ndarray:
        """Forces (k, 3) [N] on all points by the candidates' forces (m,)."""
        return np.concatenate([each.forces(u, nodal[own]) for each, own in self.parts])

    def measured(self, u: np.ndarray) -> np.ndarray:
        """Gaps (m,) [mm] by distances that are measured anew."""
        return np.concatenate([each.measured(u) for each in self.pairs])

    @property
    def standing(self) -> Passable:
        """What the points of no face may pass through."""
        return Passages(tuple(way for each in self.pairs if (way := each.standing) is not None))

    @property
    def mirrors(self) -> np.ndarray:
        """Unit normals (r, 3) of the planes of symmetry of all."""
        return np.concatenate([each.mirrors for each in self.pairs])

    @property
    def size(self) -> float:
        """Largest coordinate [mm]."""
        return max(each.size for each in self.pairs)


@dataclass(frozen=True, eq=False)
class Together:
    """The closest points of all pairs at one u."""

    of: Several
    each: tuple[Paired, ...]

    @property
    def gap(self) -> np.ndarray:
        """g (m,)."""
        return np.concatenate([one.gap for one in self.each])

    @property
    def rows(self) -> sparse.csr_matrix:
        """dg (m, 3k) by the positions of the points."""
        return sparse.csr_matrix(sparse.block_diag([one.rows for one in self.each], format="csr"))

    def curvature(self, force: np.ndarray) -> sparse.csr_matrix:
        """sum_i f_i d2g_i (3k, 3k) by the positions, of candidates' forces (m,)."""
        blocks = [one.curvature(force[own]) for one, own in zip(self.each, self.of.candidates, strict=True)]
        return sparse.csr_matrix(sparse.block_diag(blocks, format="csr"))


@dataclass(frozen=True, eq=False)
class Passages:
    """What may be passed through, of all pairs."""

    each: tuple[Passable, ...]

    def passed(self, u0: np.ndarray, after: Passages, u1: np.ndarray) -> list[Crossing]:
        """All passages from u0 (n,) here to u1 there."""
        ends = zip(self.each, after.each, strict=True)
        return [crossing for was, now in ends for crossing in was.passed(u0, now, u1)]
