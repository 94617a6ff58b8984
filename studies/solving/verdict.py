"""When a variant is enough: its error in the limit of the grids, and the first grid from which on all errors are small.

The reference is the exact measure, whose limit L is known to within u. A variant has the values v_k on the grids k::

    f = (M - L)/|L|,          M: the limit of the variant;  its error in the limit of the grids
    e_k = |v_k - L|/|L| + u,  the largest error that its value on a grid may have

A grid is enough where e_k and those of all finer grids are within the error, and |f| with its uncertainty is, too:
where the error of a mesh and that of a formulation cancel on one grid, finer grids lose that again.

f is known from both limits, and from the limit of the differences of both on the same grids, in which the jumps of a
rim of contact cancel. Both intervals contain f, so f lies in what they share; where they share nothing, one of
them is wrong, and f is taken to lie anywhere in both.

A variant that has fewer grids than the reference is extrapolated from coarse ones. The reference shows how far such
grids can be trusted: from the same grids its own limit is L', which corrects the last value by c' and misses L by
|L' - L|. The correction c of the variant is then uncertain by at least the same part of it::

    SAFETY |L' - L|/|c'| |c|

Where a wall with more surfaces has been followed the truth is not L but what that wall has, L (1 + w), and all
errors count from there. Still more surfaces are taken to change it by no more than LEFT of the last change and BEFORE
of the one before: of twelve cases of walls beside solids (``shell_limits.csv``) the last of three walls leaves at most
0.29 of its change, in one case 0.38. But one more power of the distance may change nothing and the next one much: the
force of a crushed ring by 1.2 % from two surfaces to three and by 3.9 % to five, an interlaminar stress of Pagano's
plate by 12, 1.8 and 12 % from two faces to four a ply. So a single change counts ALONE times.

Of 98 intervals from 3 to 7 grids, of measures, elements and models on seven scenes that also have one to five finer
grids, all contain the limit of the finer grids, 95 without this. Nothing is solved here.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from studies.solving.refinement.limits import FEW, SAFETY, Estimate, Seen, estimate_of
from studies.solving.refinement.nested import Sketch, touches
from studies.solving.variants import SURFACES, Ladder

LEFT, BEFORE, ALONE = 0.5, 0.3, 4.0  # of the last change, of the one before, and of one that is alone
KNOWN = 0.5  # of the error that is asked for: what may not be known of a wall that errors count from
SETTLED = 0.15  # of the error that is asked for: no more surfaces are tried where they may change less
NOISE = 1e-5  # of the value: what the iteration on a grid may leave
WORDS = ("enough", "no mesh yet", "not enough", "not settled", "not known", "failed", "does not apply", "not tried")
ENOUGH, NO_MESH, NOT_ENOUGH, NOT_SETTLED, NOT_KNOWN, FAILED, REFUSED, NOT_TRIED = WORDS


@dataclass(frozen=True)
class Difference:
    """f, the limit of a variant over that of the reference, less one; within +-``within``."""

    value: float
    within: float

    @property
    def settled(self) -> bool:
        """Whether it is known to be there, and of which sign: the interval is no wider than the difference."""
        return self.within <= abs(self.value)

    @property
    def most(self) -> float:
        """The largest error that the limit may have."""
        return abs(self.value) + self.within

    @property
    def least(self) -> float:
        """The smallest error that it may have."""
        return max(abs(self.value) - self.within, 0.0)


NONE = Difference(0.0, 0.0)  # of the reference from itself


@dataclass(frozen=True)
class Wall:
    """The wall with the most surfaces whose limit is known.

    name: its surfaces, "" those of the reference.  beyond: w, the relative difference of its limit from that of the
    reference.  left: what more surfaces may still change, over the limit of the reference.
    """

    name: str = ""
    beyond: Difference = NONE
    left: float = 0.0

    @classmethod
    def of(cls, verdicts: Sequence[Verdict]) -> Wall:
        """Of the verdicts on walls with more and more surfaces, beside the reference alone."""
        wall, changes = cls(), list[float]()
        for verdict in verdicts:
            if isinstance(verdict.limit, Difference):
                changes.append(abs(verdict.limit.value - wall.beyond.value))
                left = max(LEFT * changes[-1], BEFORE * changes[-2]) if len(changes) > 1 else ALONE * changes[0]
                wall = cls(verdict.ladder.variant.name, verdict.limit, left)
        return wall

    def tells(self, error: float) -> bool:
        """Whether it is known to half an error, or surely differs by more than that: else it is not a reference."""
        width = self.beyond.within + self.left
        return width <= KNOWN * error or abs(self.beyond.value) - width > error

    def truth(self, reference: Estimate) -> Estimate:
        """The limit of this wall, and what is not known of it."""
        width = reference.uncertainty + self.beyond.within + self.left
        return Estimate(reference.limit * self._ratio, width / abs(self._ratio), reference.error)

    def seen_from(self, apart: Difference, name: str = "") -> Difference:
        """f of what is ``apart`` from the reference, from here; name: of the surfaces that are all that differ."""
        same_surfaces = name != "" and name == self.name
        within = self.left + (0.0 if same_surfaces else apart.within + self.beyond.within)
        return Difference((apart.value - self.beyond.value) / self._ratio, within / abs(self._ratio))

    @property
    def _ratio(self) -> float:
        """1 + w."""
        return (1 + self.beyond.value) or math.ulp(0.0)


def difference(
    own: Sequence[Seen], beside: Sequence[Seen], reference: Estimate, *, touching: bool = False
) -> Difference | str:
    """f from the values of a variant and of the reference on the same grids, or why it is not known.

    reference: the limit of the reference, from all its grids.  touching: as for :func:`estimate_of`.
    """
    pairs = [Seen(a.size, a.value - b.value) for a, b in zip(own, beside, strict=True)]
    limit, apart = estimate_of(own, touching=touching), estimate_of(pairs, touching=touching)
    part = SAFETY * _missed(estimate_of(beside, touching=touching), beside[-1].value, reference)
    intervals = list[tuple[float, float, float]]()  # value, its uncertainty, and that which the reference shows
    if isinstance(limit, Estimate):
        width, shown = _width(limit), part * abs(limit.limit - own[-1].value)
        intervals.append((limit.limit - reference.limit, width + _width(reference), shown + _width(reference)))
    if isinstance(apart, Estimate):
        width = max(_width(apart), NOISE * abs(own[-1].value))
        intervals.append((apart.limit, width, part * abs(apart.limit - pairs[-1].value)))
    if not intervals:
        return str(limit)
    meet = max(value - width for value, width, _ in intervals) <= min(value + width for value, width, _ in intervals)
    lows, highs = zip(*((value - max(w, s), value + max(w, s)) for value, w, s in intervals), strict=True)
    low, high = (max(lows), min(highs)) if meet else (min(lows), max(highs))
    scale = reference.limit or math.ulp(0.0)
    return Difference((low + high) / 2 / scale, (high - low) / 2 / abs(scale))


def errors(values: Sequence[float], reference: Estimate) -> list[float]:
    """e_k of the values on grids; NaN where a grid has none."""
    scale = abs(reference.limit) or math.ulp(0.0)
    return [abs(value - reference.limit) / scale + reference.uncertainty for value in values]


def first_enough(most: Sequence[float], limit: Difference | str, error: float) -> int | None:
    """The coarsest grid from which on all errors e_k, coarse to fine, are within ``error``; None where none is.

    limit: f; where it is not known, or not surely within the error, no grid is enough.
    """
    if isinstance(limit, str) or limit.most > error:
        return None
    first = len(most)
    while first > 0 and most[first - 1] <= error:
        first -= 1
    return first if first < len(most) else None


def _missed(from_these: Estimate | str, last: float, reference: Estimate) -> float:
    """The part of its correction by which the reference's limit from some grids misses that from all of them."""
    if isinstance(from_these, str):
        return 1.0
    return abs(from_these.limit - reference.limit) / (abs(from_these.limit - last) or math.ulp(0.0))


def _width(estimate: Estimate) -> float:
    """The uncertainty of a limit in its own unit."""
    return estimate.uncertainty * (abs(estimate.limit) or math.ulp(0.0))


@dataclass(frozen=True, eq=False)
class Verdict:
    """On a ladder, for an error.

    limit: f, or why it is not known.  values, most: by grid, what was read off and the bound of its error.
    first: the grid from which on all are enough, if there is one.
    """

    ladder: Ladder
    error: float
    limit: Difference | str
    values: Sequence[float]
    most: Sequence[float]
    first: int | None

    @property
    def enough(self) -> Sketch | None:
        """The path on the cheapest mesh that is enough."""
        return None if self.first is None else self.ladder.paths[self.first]

    @property
    def word(self) -> str:
        """Of :data:`WORDS`: whether the limit is surely within the error, surely not, or neither, and why."""
        limit, ladder = self.limit, self.ladder
        if ladder.variant.refused:
            return REFUSED
        if not ladder.paths:
            return FAILED if ladder.lost else NOT_TRIED
        if isinstance(limit, str):
            return NOT_KNOWN
        if limit.least > self.error:
            return NOT_ENOUGH
        if limit.most > self.error:
            return NOT_SETTLED
        return NO_MESH if self.first is None else ENOUGH

    @property
    def said(self) -> str:
        """Why it does not apply, goes no further, or has no limit."""
        ladder = self.ladder
        unknown = self.limit if isinstance(self.limit, str) and ladder.paths else ""
        waits = f"no time for {ladder.waits}" if ladder.waits else ""
        return ladder.variant.refused or "; ".join(filter(None, (unknown, ladder.said, waits)))

    @property
    def row(self) -> dict[str, Any]:
        """As the row of a table; None where a thing is not known."""
        known = self.limit if isinstance(self.limit, Difference) and self.ladder.paths else None
        path = self.enough
        return {
            "axis": self.ladder.variant.axis,
            "name": self.ladder.variant.name,
            "surfaces": self.ladder.variant.wall,
            "formulation_error": None if known is None else known.value,
            "within": None if known is None else known.within,
            "settled": None if known is None else known.settled,
            "verdict": self.word,
            "mesh": None if path is None else path.mesh,
            "unknowns": None if path is None else path.unknowns,
            "error_at_most": None if self.first is None else self.most[self.first],
            "path_seconds": None if path is None else path.seconds,
            "grids": len(self.ladder.paths),
            "said": self.said,
        }

    @property
    def grids(self) -> list[dict[str, Any]]:
        """A row a grid: what was read off, the bound of its error, the CPU seconds of its path from the one before."""
        return [
            {
                "axis": self.ladder.variant.axis,
                "name": self.ladder.variant.name,
                "mesh": path.mesh,
                "unknowns": path.unknowns,
                "value": value,
                "error_at_most": most,
                "enough": self.first is not None and k >= self.first,
                "path_seconds": path.seconds,
            }
            for k, (path, value, most) in enumerate(zip(self.ladder.paths, self.values, self.most, strict=True))
        ]


def judged(
    ladder: Ladder, reference: Ladder, limit: Estimate, quantity: str, error: float, wall: Wall = Wall()
) -> Verdict:
    """The verdict on a ladder; the reference has the errors of its grids and of its ``wall``."""
    values, apart = ladder.values(quantity), NONE if ladder is reference else _apart(ladder, reference, limit, quantity)
    if isinstance(apart, Difference):
        apart = wall.seen_from(apart, ladder.variant.name if ladder.variant.axis == SURFACES else "")
    most = errors(values, wall.truth(limit))
    return Verdict(ladder, error, apart, values, most, first_enough(most, apart, error))


def _apart(ladder: Ladder, reference: Ladder, limit: Estimate, quantity: str) -> Difference | str:
    """f, from the grids that both have."""
    if not ladder.paths:
        return FEW
    known = {path.request.mesh: value for path, value in zip(reference.paths, reference.values(quantity), strict=True)}
    values = [Seen(path.size, value) for path, value in zip(ladder.paths, ladder.values(quantity), strict=True)]
    beside = [Seen(path.size, known[path.request.mesh]) for path in ladder.paths]
    return difference(values, beside, limit, touching=touches(reference.paths[-1].end))
