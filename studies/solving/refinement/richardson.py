"""Observed orders and limits of a quantity on meshes that are refined; NaN where they have no meaning.

f(h) = f0 + c h^p through three meshes (Roache, J. Fluids Eng. 116 (1994) 405). The uncertainty of the limit is 1.25
times its distance from the finest mesh where the sequence is in its asymptotic range, 3 times elsewhere. Whatever is
said of an order, a limit or a verdict anywhere is computed here; where the values come from is not known here.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:  # slow to load: a solve needs corrections alone
    import pandas as pd

LOWEST, HIGHEST = 0.3, 12.0  # of an order that is extrapolated with
FORMAL, SAME_ORDER = 2.0, 0.3  # of a bilinear element; successive orders this close count as one
# Relative spread below which no mesh error is left to fit. What Newton's iteration leaves at the floor of rounding
# wanders by 5e-6 from mesh to mesh on a thin cylinder with free ends, whatever its tolerance; the smallest sequence
# with an order, the resultants of the torus, is 1.3e-5 apart on its last three meshes.
SAME_VALUE = 1e-5
SAFE, UNSAFE = 1.25, 3.0
ASYMPTOTIC, SAME, SAME_LAST = "asymptotic", "same on every mesh", "same on the last three meshes"


@dataclass(frozen=True)
class Limit:
    """What a ladder says of the value at h = 0; ``order`` of the last three meshes.

    uncertainty: of the limit, in the unit of the quantity.  asymptotic: whether two successive orders agree, or the
    only one is the formal one, or nothing changes at all.
    """

    value: float
    uncertainty: float
    order: float
    asymptotic: bool


@dataclass(frozen=True)
class MeshSequence:
    """A quantity on three or more meshes, coarse to fine; sizes: of the elements, in any unit; NaN: not solved."""

    sizes: tuple[float, ...]
    values: tuple[float, ...]

    @cached_property
    def orders(self) -> tuple[float, ...]:
        """The order of each three successive meshes."""
        windows = range(len(self.values) - 2)
        if self.verdict == SAME:
            return (math.nan,) * len(windows)
        return tuple(order_of(self.sizes[i : i + 3], self.values[i : i + 3]) for i in windows)

    @cached_property
    def verdict(self) -> str:
        """Whether the last meshes are in the asymptotic range, and if not, why."""
        if any(map(math.isnan, self.values)):
            return "not solved on every mesh"
        if spread(self.values) <= SAME_VALUE:
            return SAME
        if spread(self.values[-3:]) <= SAME_VALUE:
            return SAME_LAST
        last = order_of(self.sizes[-3:], self.values[-3:])
        if math.isnan(last):
            return "not asymptotic: no order"
        if len(self.values) == 3:
            return ASYMPTOTIC if abs(last - FORMAL) <= SAME_ORDER else f"not asymptotic: one order, not {FORMAL:g}"
        before = order_of(self.sizes[-4:-1], self.values[-4:-1])
        if math.isnan(before):
            return "not asymptotic: no order before the last"
        return ASYMPTOTIC if abs(last - before) <= SAME_ORDER else "not asymptotic: the orders differ"

    @cached_property
    def asymptotic(self) -> bool:
        """Is the extrapolated value to be trusted?"""
        return self.verdict in (ASYMPTOTIC, SAME, SAME_LAST)

    @cached_property
    def limit(self) -> float:
        """Richardson's limit of the last three meshes; the value itself where all are the same."""
        if self.verdict in (SAME, SAME_LAST):
            return self.values[-1]
        return self.values[-1] + correction(self.sizes, self.values, self.orders[-1])

    @cached_property
    def uncertainty(self) -> float:
        """The uncertainty of the limit."""
        if self.verdict in (SAME, SAME_LAST):
            return float(np.ptp(self.values if self.verdict == SAME else self.values[-3:]))
        return (SAFE if self.asymptotic else UNSAFE) * abs(self.limit - self.values[-1])


def spread(values: Sequence[float]) -> float:
    """Largest less smallest value over the size of the last one."""
    apart, last = float(np.ptp(np.asarray(values, float))), abs(values[-1])
    return apart / last if last else math.inf if apart else 0.0


def correction(sizes: Sequence[float], values: Sequence[float], order: float = FORMAL) -> float:
    """Limit less finest value, from the last two meshes and the order: (f2 - f1)/((h1/h2)^p - 1)."""
    (h1, h2), (f1, f2) = sizes[-2:], values[-2:]
    return float((f2 - f1) / ((h1 / h2) ** order - 1))


def formal_limit(sizes: Sequence[float], values: Sequence[float]) -> tuple[float, float]:
    """The limit by the formal order from the two finer of three meshes, and how far it has moved since the coarser."""
    before, limit = (values[k] + correction(sizes[: k + 1], values[: k + 1]) for k in (1, 2))
    return limit, abs(limit - before)


def power_of(x: Sequence[float] | np.ndarray | pd.Series, y: Sequence[float] | np.ndarray | pd.Series) -> float:
    """The p of |y| ~ x^p, by least squares of the logarithms."""
    return float(np.polyfit(np.log(np.asarray(x, float)), np.log(np.abs(np.asarray(y, float))), 1)[0])


def order_of(sizes: Sequence[float], values: Sequence[float]) -> float:
    """The p of three meshes of any sizes h, coarse to fine; NaN unless monotone and in [LOWEST, HIGHEST].

    (f1 - f2)/(f2 - f3) = (h1^p - h2^p)/(h2^p - h3^p), whose right side grows with p.
    """
    (h1, h2, h3), (f1, f2, f3) = sizes, values
    if not (f1 - f2) * (f2 - f3) > 0 or spread(values) <= SAME_VALUE:  # NaN is not above zero either
        return math.nan
    ratio = (f1 - f2) / (f2 - f3)

    def excess(p: float) -> float:
        return ((h1 / h2) ** p - 1) / (1 - (h3 / h2) ** p) - ratio

    low, high = LOWEST, HIGHEST
    if not excess(low) <= 0 <= excess(high):
        return math.nan
    while low < (middle := (low + high) / 2) < high:  # scipy.optimize is as slow to load as a small solve
        low, high = (middle, high) if excess(middle) <= 0 else (low, middle)
    return low


def holds_from(holds: Sequence[bool] | np.ndarray | pd.Series) -> int:
    """The index of the first from which on all are true; their number where the last is not.

    The one rule of what reaches an accuracy: a mesh that is within it counts with all finer ones, one may be by luck.
    """
    broken = np.flatnonzero(~np.asarray(holds, bool))
    return int(broken[-1]) + 1 if len(broken) else 0


def limit_of(sizes: Sequence[float], values: Sequence[float]) -> Limit:
    """What three or more solved meshes say of the limit, in every case.

    Without an order the finest value stands for the limit, known to no better than what the last three meshes are
    apart. Raises ValueError for fewer than three meshes.
    """
    if len(sizes) < 3:
        raise ValueError(f"{len(sizes)} meshes; a limit takes three")
    sequence = MeshSequence(tuple(sizes), tuple(values))
    order = sequence.orders[-1]
    if math.isnan(sequence.limit):
        return Limit(float(values[-1]), UNSAFE * float(np.ptp(values[-3:])), math.nan, False)
    return Limit(sequence.limit, sequence.uncertainty, order, sequence.asymptotic)
