"""The way of the candidates between two states, and whether one of them passes through the foundation on it.

Two equilibria say nothing of what lies between them: a point that moves by more than an obstacle is thick may be in
front of it in one and behind it in the other, open in both. In the frame of the foundation the way is taken to be
straight, as if displacements and travel grew together. It may well dip into the foundation: a point slides along a
curved surface, and the chord cuts it off. It passes through where it comes out on a side that faces away from the one
where it went in::

    y(s) = y0 + s (y1 - y0),    g(y) < 0 from s = a to s = b,    grad g(y(a)) . grad g(y(b)) < 0

Through a ball that is a chord longer than sqrt(2) times its radius. No algorithm and no mechanics enter here.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass, field
from itertools import pairwise
from typing import Any, Protocol

import numpy as np
from scipy import sparse

FREE = 0.9  # least cosine of the normals at both ends of a dip, of a point that is open at the start
SLID = -0.1  # of one that touches there and may slide, by a right angle at an edge
TOUCHING = 1e-6  # of the way
LEVELS = 30  # bisections: a surface is found to 1e-9 of the way
GLIDES, ENOUGH = 16, 8  # open intervals of a point that glides along the surface, and the bisections that it gets


@dataclass(frozen=True, eq=False)
class Standing:
    """A foundation in a frame of its own, in which it is the same at every instant.

    positions(u) -> (m, 3): the candidates there [mm].  gap(y) -> (m,): the signed distance [mm], which never differs
    more between two points than they are apart.  gradient(y) -> (m, 3): its gradient, unit vectors.  least_radius: of
    the parts of its surface that bulge [mm], infinite where none does.
    """

    positions: Callable[[np.ndarray], np.ndarray]
    gap: Callable[[np.ndarray], np.ndarray]
    gradient: Callable[[np.ndarray], np.ndarray]
    least_radius: float = np.inf

    def passed(self, u0: np.ndarray, after: Standing, u1: np.ndarray) -> list[Crossing]:
        """Of candidates from u0 (n,) to u1, the foundation where it is after."""
        start = self.positions(u0)
        way = after.positions(u1) - start
        whose, enters, leaves = dips(after.gap, start, way)
        begin, way = start[whose], way[whose]
        slides = after.gap(begin) <= TOUCHING * np.linalg.norm(way, axis=1)
        cosine = np.einsum("ij,ij->i", *(after.gradient(begin + s[:, None] * way) for s in (enters, leaves)))
        passes = np.flatnonzero(cosine < np.where(slides, SLID, FREE))
        return [Crossing(int(whose[i]), float(enters[i]), float(leaves[i])) for i in passes]


@dataclass(frozen=True, eq=False)
class Surface(Standing):
    """The surface of a rigid foundation and the candidates before it, in a frame that is shifted with the foundation.

    operator (3m, n): d positions/du, rows 3i to 3i + 2 of candidate i.  size [mm]: of what a position is a difference.
    """

    operator: sparse.csr_matrix = field(kw_only=True)
    size: float = field(kw_only=True)


class Passable(Protocol):
    """What may be passed through on the way from one state to the next: :class:`Standing`, or faces that both move."""

    def passed(self, u0: np.ndarray, after: Any, u1: np.ndarray) -> list[Crossing]:
        """All passages from u0 (n,), the bodies where they were, to u1, where they are after."""


@dataclass(frozen=True)
class Crossing:
    """A point, and the shares of its way at which it goes into what it passes through and comes out of it, or ends."""

    candidate: int
    enters: float
    leaves: float
    kind: str = "candidate"
    through: str = "the foundation"

    def __str__(self) -> str:
        return f"{self.kind} {self.candidate} passes through {self.through}"


def crossings(before: Passable | None, u0: np.ndarray, after: Passable | None, u1: np.ndarray) -> list[Crossing]:
    """All passages from u0 (n,), the bodies where they were before, to u1, where they are after; none without them."""
    return [] if before is None or after is None else before.passed(u0, after, u1)


def crossings_along(way: Iterable[tuple[Passable | None, np.ndarray]]) -> list[Crossing]:
    """Those of all steps of a path of states (what may be passed through, u)."""
    return [each for before, after in pairwise(way) for each in crossings(*before, *after)]


def dips(
    gap: Callable[[np.ndarray], np.ndarray], start: np.ndarray, way: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Where the segments start + s way, both (m, 3), lie in the foundation: whose, from which s, to which s, each (k,).

    A point at the distance g from the surface has a ball of that radius about it on its own side. Two of them that meet
    cover what lies between; any other interval is cut in half, down to 1e-9 of the way. Points that glide along the
    surface would be cut up all along: there what is shorter than 1/256 of the way may be missed.
    """
    length = np.linalg.norm(way, axis=1)
    ends = gap(start), gap(start + way)
    whose = np.flatnonzero(length > np.maximum(ends[0], 0.0) + np.maximum(ends[1], 0.0))
    low, high, g_low, g_high = np.zeros(len(whose)), np.ones(len(whose)), ends[0][whose], ends[1][whose]
    seen = [(whose, low, g_low), (whose, high, g_high)]
    for level in range(LEVELS):
        covered = (g_low < 0) == (g_high < 0)
        covered &= np.abs(g_low) + np.abs(g_high) >= (high - low) * length[whose]
        if level >= ENOUGH:
            covered |= np.bincount(whose[~covered], minlength=len(way))[whose] > GLIDES
        whose, low, high, g_low, g_high = (each[~covered] for each in (whose, low, high, g_low, g_high))
        middle = (low + high) / 2
        g = gap(start[whose] + middle[:, None] * way[whose])
        seen.append((whose, middle, g))
        whose, low, high = np.tile(whose, 2), np.append(low, middle), np.append(middle, high)
        g_low, g_high = np.append(g_low, g), np.append(g, g_high)
    whose, share, g = (np.concatenate(each) for each in zip(*seen, strict=True))
    order = np.lexsort((share, whose))
    whose, share, inside = whose[order], share[order], g[order] < 0
    apart = whose[1:] != whose[:-1]
    first = inside & np.append(True, apart | ~inside[:-1])
    last = inside & np.append(apart | ~inside[1:], True)
    return whose[first], share[first], share[last]


def between_nodes(standing: Passable | None, weights: np.ndarray, touching: np.ndarray) -> str:
    """What no candidate sees: a foundation with a radius below the size of an element passes between nodes.

    The size is the side of a square of the largest share of area, weights (m,) [mm^2], of those ``touching`` (m,) bool,
    of all where none does. Empty where that is no matter.
    """
    shares = weights[touching] if touching.any() else weights
    size = float(np.sqrt(np.max(shares, initial=0.0)))
    if not isinstance(standing, Standing) or standing.least_radius >= size:
        return ""
    sizes = f"the least radius of the foundation, {standing.least_radius:.3g} mm, is below the size of an element"
    return f"{sizes} there, {size:.3g} mm: only nodes are checked, between them it may penetrate the wall"
