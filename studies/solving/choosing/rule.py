"""When a variant is enough: its error in the limit of the grids, and the first grid from which on all errors are small.

The reference is the exact measure, whose limit L is known to within u. A variant has the values v_k on the grids k::

    f = (M - L)/|L|,          M: the limit of the variant;  what it is off on no grid, but in their limit
    e_k = |v_k - L|/|L| + u,  the most that its value on a grid may be off

A grid is enough where e_k and those of all finer grids are within the error, and |f| with its uncertainty is, too:
where the error of a mesh and that of a formulation cancel on one grid, finer grids lose that again.

f is known from both limits, and from the limit of the differences of both on the same grids, in which the jumps of a
rim of contact cancel. Both intervals hold, so f is in what they share; where they share nothing, one of them does not
hold, and f is taken to be anywhere in both.

A variant that has fewer grids than the reference is extrapolated from coarse ones. How far such grids can be trusted
the reference shows: from the same grids its own limit is L', which corrects the last value by c' and misses L by
|L' - L|. The correction c of the variant is then uncertain by at least the same part of it::

    SAFETY |L' - L|/|c'| |c|

Of 98 intervals from 3 to 7 grids, of measures, elements and models on seven scenes that also have one to five finer
grids, all contain the limit of the finer grids, 95 without this. Nothing is solved here.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

from studies.solving.refinement.limits import SAFETY, Estimate, Seen, limit_of

NOISE = 1e-5  # of the value: what the iteration on a grid may leave


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
        """The most that the limit may be off."""
        return abs(self.value) + self.within

    @property
    def least(self) -> float:
        """The least that it may be off."""
        return max(abs(self.value) - self.within, 0.0)


NONE = Difference(0.0, 0.0)  # of the reference from itself


def difference(
    own: Sequence[Seen], beside: Sequence[Seen], reference: Estimate, *, touching: bool = False
) -> Difference | str:
    """f from the values of a variant and of the reference on the same grids, or why it is not known.

    reference: the limit of the reference, from all its grids.  touching: as for :func:`limit_of`.
    """
    pairs = [Seen(a.size, a.value - b.value) for a, b in zip(own, beside, strict=True)]
    limit, apart = limit_of(own, touching=touching), limit_of(pairs, touching=touching)
    part = SAFETY * _missed(limit_of(beside, touching=touching), beside[-1].value, reference)
    found = list[tuple[float, float, float]]()  # value, its uncertainty, and that which the reference shows
    if isinstance(limit, Estimate):
        width, shown = _width(limit), part * abs(limit.limit - own[-1].value)
        found.append((limit.limit - reference.limit, width + _width(reference), shown + _width(reference)))
    if isinstance(apart, Estimate):
        width = max(_width(apart), NOISE * abs(own[-1].value))
        found.append((apart.limit, width, part * abs(apart.limit - pairs[-1].value)))
    if not found:
        return str(limit)
    meet = max(value - width for value, width, _ in found) <= min(value + width for value, width, _ in found)
    lows, highs = zip(*((value - max(w, s), value + max(w, s)) for value, w, s in found), strict=True)
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


def _width(found: Estimate) -> float:
    """The uncertainty of a limit in its own unit."""
    return found.uncertainty * (abs(found.limit) or math.ulp(0.0))
