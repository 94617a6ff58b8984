"""What a quantity on a ladder of grids says of its limit, and how well. Nothing is solved here.

Bilinear elements converge with the square of their size h. Of two grids with sizes r h and h that says::

    c = (J - J_coarser)/(r^2 - 1),    L = J + c

and of three grids, each about half as coarse as the one before, how well: L is within ::

    u = max(SAFETY |L - L_before|, s |c|, guard, rim)

of the limit; s = 1, or SURE where more than three grids have corrections c that fall as the order 2 has them fall, and
SAFETY times what their limits have moved since the middle one is no more than SURE |c|: one ratio may be luck.
Where they fall faster and all differences have one sign, as with elements that lock on coarse grids, L_before says
little. The first term is then no more than what the correction of the order 1 differs from c by, or FAST of the
difference before the last one.
guard: where differences change their sign, the last one; where they grow, SAFETY times the larger one. Where they grow
and are large there is no statement, in contact or not. In contact, where they fall by an order p < 1, what the
correction of that order, of SLOWEST at the least, differs from c by.
rim: what the rim of contact leaves unknown (:mod:`studies.solving.refinement.rim`), on any number of grids. On more
than three a limit has to lie where the grids without the finest have stated it: otherwise there is none, or in contact
one that is known no better than the difference between the two.

The rim of a patch of contact jumps from node to node: errors scatter about an order of 1 to 2. There L is the mean of
two limits by least squares on the last four or five grids, J = L_p + c h^p for p = 1 and 2, and ::

    u = max(|L_1 - L_2|/2 + SPREAD s, |J - L|/2),    s: the larger standard error of the two

with weights 1/h of four grids, and 1/h^2 of five, which lean on the finest. On three grids, which are no sample, u is
that of above with both differences as guard.

The constants were chosen on tyres at 5 to 20 mm and on scenes
without contact under their whole loads. On others they were tried (limits of grids two to four times finer, of five
grids in contact): on 32 tyres at 7, 11, 17 and 19 mm, with dead and follower pressure, two pressures, three cord angles
and isotropic, on grids 1.3 times as fine as the one before up to 28,516 unknowns, four grids contain the limit of the
force 32 times of 32, five 72 of 72; of the mean pressure, which jumps with the area, 29 of 32 and 60 of 61; of the
pressure in the centre always. Without contact 340 of 341 intervals of 106 quantities at a quarter of their loads, or
at 5, 40 and 80 %, contain it, half of them narrower than 2.6 times the error of the last grid.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from studies.solving.refinement.richardson import correction

SAFETY = 1.5
SURE = 0.25  # of the last correction, where two of them have shown the order
SHOWN = (0.7, 1.4)  # of the factor by which the order 2 has corrections fall
FAST = 0.05  # of the difference before the last one, where corrections fall faster
LARGE = 0.1  # of the value, above which growing differences say nothing
SLOWEST = 0.3  # of an order that a limit in contact is bound by
LEAST = 1e-9  # of the value: what the iteration leaves
FITTED, SPREAD = {4: 1, 5: 2}, 3.0  # grids: power of 1/h in their weights
ORDERS = (1, 2)  # that errors scatter about in contact
FEWEST = 3  # grids that state a limit; whose first has often no order yet
FEW = "fewer than three grids"
GROWING = "it does not converge on these grids"
NARROW = "a patch of contact shorter by one element does not have it"


@dataclass(frozen=True)
class Seen:
    """A quantity on a grid whose elements have the size [any unit]."""

    size: float
    value: float


@dataclass(frozen=True)
class Estimate:
    """limit: within +-uncertainty; error: of the last grid's value, in [low, high]. All but the limit are relative."""

    limit: float
    uncertainty: float
    error: float

    def __str__(self) -> str:
        return f"{self.limit:.6g} +- {100 * self.uncertainty:.2g} %"

    @property
    def interval(self) -> dict[str, float]:
        """low and high: what the limit lies between."""
        width = self.uncertainty * abs(self.limit)
        return {"low": self.limit - width, "high": self.limit + width}

    @property
    def low(self) -> float:
        """The least that the error of the last grid's value may be."""
        return max(self.error - self.uncertainty, 0.0)

    @property
    def high(self) -> float:
        """The most that it may be."""
        return self.error + self.uncertainty


def three_of(grids: Sequence[Seen]) -> tuple[Seen, Seen, Seen] | None:
    """The finest, the one nearest to twice its size, and the one nearest to twice that; None without three."""
    last = len(grids) - 1
    middle = _twice(grids, last)
    first = None if middle is None else _twice(grids, middle)
    return None if middle is None or first is None else (grids[first], grids[middle], grids[last])


def _twice(grids: Sequence[Seen], k: int) -> int | None:
    """The grid before the k-th whose elements are most nearly twice as large."""
    return min(range(k), key=lambda i: abs(math.log2(grids[i].size / grids[k].size) - 1), default=None)


def estimate_of(grids: Sequence[Seen], *, touching: bool = False, rim: float = 0.0) -> Estimate | str:
    """What grids, coarse to fine, say of the limit, or why they do not.

    touching: the quantity depends on the rim of a patch of contact.  rim: what its place within an element leaves
    unknown, in the unit of the quantity; infinite where a patch one element shorter has no such quantity.
    """
    if math.isinf(rim):
        return NARROW
    now = _stated(grids, touching, rim)
    if len(grids) <= FEWEST or isinstance(now, str):
        return now
    before = _stated(grids[:-1], touching, rim)
    if isinstance(before, str):
        return now if before == FEW else before
    if before.interval["low"] <= now.limit <= before.interval["high"]:
        return now
    if not touching:
        return GROWING
    return _estimate(grids[-1].value, now.limit, max(now.uncertainty * abs(now.limit), abs(now.limit - before.limit)))


def _stated(grids: Sequence[Seen], touching: bool, rim: float) -> Estimate | str:
    """What they say, whatever those without the finest would."""
    last_three, fitted = three_of(grids), touching and len(grids) >= min(FITTED)
    if last_three is None:
        return _fitted(grids[-max(FITTED) :], rim) if fitted else FEW
    first, middle, last = last_three
    before, now = middle.value - first.value, last.value - middle.value
    if not (math.isfinite(before) and math.isfinite(now)) or abs(now) > max(abs(before), LARGE * abs(last.value)):
        return GROWING
    if fitted:
        return _fitted(grids[-max(FITTED) :], rim)
    corrections = [
        correction((coarse.size, fine.size), (coarse.value, fine.value))
        for coarse, fine in ((first, middle), (middle, last))
    ]
    limit, known_before = last.value + corrections[1], middle.value + corrections[0]
    falls = corrections[0] / (corrections[1] or math.inf) / (middle.size / last.size) ** 2
    shown = len(grids) > FEWEST and not touching
    fast = shown and falls > SHOWN[1] and _one_way(grids)
    sure = (
        shown and SHOWN[0] <= falls <= SHOWN[1] and SAFETY * _moved(grids, middle, limit) <= SURE * abs(corrections[1])
    )
    guard = max(abs(before), abs(now)) if touching else 0.0
    if before * now <= 0:
        guard = max(guard, abs(now))
    if touching and 0 < now / (before or math.inf) < 1:  # below the order 1 most of the error is still to come
        slow = max(math.log(before / now) / math.log(first.size / middle.size), SLOWEST)
        if slow < 1:
            rest = correction((middle.size, last.size), (middle.value, last.value), slow)
            guard = max(guard, abs(rest - corrections[1]))
    if abs(now) > abs(before):
        guard = max(guard, SAFETY * abs(now))
    moved = SAFETY * abs(limit - known_before)
    if fast:
        slow = correction((middle.size, last.size), (middle.value, last.value), 1.0)
        moved = min(moved, max(abs(slow - corrections[1]), FAST * abs(before)))
    within = max(moved, (SURE if sure else 1.0) * abs(corrections[1]), guard, rim)
    return _estimate(last.value, limit, within)


def _moved(grids: Sequence[Seen], since: Seen, limit: float) -> float:
    """How far the limits that all grids since this one had stated are from the last one."""
    limits = list[float]()
    for k in range(grids.index(since), len(grids) - 1):
        coarse = _twice(grids, k)
        if coarse is not None:
            sizes, values = zip(*((g.size, g.value) for g in (grids[coarse], grids[k])), strict=True)
            limits.append(grids[k].value + correction(sizes, values))
    return max((abs(limit - before) for before in limits), default=math.inf)


def _one_way(grids: Sequence[Seen]) -> bool:
    """Whether values only grow from grid to grid, or only fall."""
    steps = [after.value - before.value for before, after in pairwise(grids)]
    return all(step > 0 for step in steps) or all(step < 0 for step in steps)


def of_judged(known: Estimate, sketched: float, value: float) -> Estimate:
    """The same once the last grid is solved to the end, not to forces that are nearly in balance, as all have been.

    That moves its value. It would move those of the other grids, and the limit, by about as much.
    """
    if value == sketched:
        return known
    within = max(known.uncertainty * abs(known.limit), abs(value - sketched))
    return _estimate(value, known.limit + value - sketched, within)


def _fitted(grids: Sequence[Seen], rim: float) -> Estimate | str:
    sizes, values = (np.array(each, float) for each in zip(*((g.size, g.value) for g in grids), strict=True))
    if not np.isfinite(values).all():
        return GROWING
    h = sizes / sizes[-1]
    limits, errors = np.transpose([_least_squares(h**order, values, h ** -FITTED[len(grids)]) for order in ORDERS])
    limit = float(limits.mean())
    within = float(np.ptp(limits)) / 2 + SPREAD * float(errors.max())
    return _estimate(float(values[-1]), limit, max(within, abs(values[-1] - limit) / 2, rim))


def _least_squares(x: np.ndarray, y: np.ndarray, weight: np.ndarray) -> tuple[float, float]:
    """a of y = a + b x, and its standard error."""
    A = np.stack([np.ones_like(x), x], axis=1) * weight[:, None]
    (a, b), *_ = np.linalg.lstsq(A, weight * y, rcond=None)
    scatter = np.sum((weight * (a + b * x - y)) ** 2) / (len(x) - 2)
    return float(a), float(np.sqrt(scatter * np.linalg.inv(A.T @ A)[0, 0]))


def _estimate(value: float, limit: float, within: float) -> Estimate:
    scale = abs(limit) or math.ulp(0.0)
    return Estimate(limit, max(within, LEAST * abs(value)) / scale, abs(value - limit) / scale)
