"""Observed orders and limits of a quantity on meshes that are refined; NaN where they have no meaning.

f(h) = f0 + c h^p through three meshes (Roache, J. Fluids Eng. 116 (1994) 405). The uncertainty of the limit is 1.25
times its distance from the finest mesh where the sequence is in its asymptotic range, 3 times elsewhere.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.optimize import brentq

LOWEST, HIGHEST = 0.3, 12.0  # of an order that is extrapolated with
FORMAL, SAME_ORDER = 2.0, 0.3  # of a bilinear element; successive orders this close count as one
SAME_VALUE = 1e-6  # relative spread below which no mesh error is left to fit, only what Newton leaves
SAFE, UNSAFE = 1.25, 3.0


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


def order_of(sizes: Sequence[float], values: Sequence[float]) -> float:
    """The p of three meshes of any sizes h, coarse to fine; NaN unless monotone and in [LOWEST, HIGHEST].

    (f1 - f2)/(f2 - f3) = (h1^p - h2^p)/(h2^p - h3^p), whose right side grows with p.
    """
    (h1, h2, h3), (f1, f2, f3) = sizes, values
    if not (f1 - f2) * (f2 - f3) > 0 or abs(f1 - f3) <= SAME_VALUE * abs(f3):  # NaN is not above zero either
        return math.nan
    ratio = (f1 - f2) / (f2 - f3)

    def excess(p: float) -> float:
        return ((h1 / h2) ** p - 1) / (1 - (h3 / h2) ** p) - ratio

    return float(brentq(excess, LOWEST, HIGHEST)) if excess(LOWEST) <= 0 <= excess(HIGHEST) else math.nan


def limit_of(sizes: Sequence[float], values: Sequence[float]) -> Limit:
    """Richardson's limit of three or more meshes, coarse to fine.

    Without an order the finest value stands for the limit, known to no better than what the meshes are apart, and is
    not asymptotic. Raises ValueError for fewer than three meshes.
    """
    if len(sizes) < 3:
        raise ValueError(f"{len(sizes)} meshes; a limit takes three")
    known = np.asarray(values, float)
    spread = float(np.ptp(known[-3:]))
    if spread <= SAME_VALUE * abs(known[-1]):
        return Limit(float(known[-1]), spread, math.nan, True)
    order = order_of(sizes[-3:], values[-3:])
    if math.isnan(order):
        return Limit(float(known[-1]), UNSAFE * spread, math.nan, False)
    value = values[-1] + (values[-1] - values[-2]) / ((sizes[-2] / sizes[-1]) ** order - 1)
    before = order_of(sizes[-4:-1], values[-4:-1]) if len(sizes) > 3 else FORMAL
    asymptotic = abs(order - before) <= SAME_ORDER
    return Limit(value, (SAFE if asymptotic else UNSAFE) * abs(value - values[-1]), order, asymptotic)
