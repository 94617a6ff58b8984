"""Observed orders from a sequence of meshes; None where an order has no meaning.

Roache's recommendations for a sequence (J. Fluids Eng. 116 (1994) 405): the uncertainty of the extrapolated value is
1.25 times its distance from the finest mesh where the sequence is in its asymptotic range, 3 times elsewhere.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

from scipy.optimize import brentq

FORMAL = 2.0  # of displacements and of the mean stresses of a bilinear element
SAME_ORDER = 0.3  # successive orders this close count as one
SAME_VALUE = 1e-5  # relative spread below which no mesh error is left to fit
LOWEST, HIGHEST = 0.3, 12.0  # of an order that is extrapolated with
SAFE, UNSAFE = 1.25, 3.0


def order_against(coarse: float, fine: float, reference: float, noise: float = 0.0) -> float | None:
    """log2 of the ratio of two errors; None when the sign changes, or an error is within the reference's own one."""
    e1, e2 = coarse - reference, fine - reference
    return math.log2(e1 / e2) if e1 * e2 > 0 and min(abs(e1), abs(e2)) > noise else None


def self_order(coarse: float, medium: float, fine: float) -> float | None:
    """log2((f1 - f2)/(f2 - f3)); None when the sequence is not monotone."""
    return order_against(coarse - medium, medium - fine, 0.0)


def extrapolated(coarse: float, medium: float, fine: float) -> float | None:
    """Richardson's limit f3 + (f3 - f2)/(2^p - 1) with the self-convergence order p; None unless p > 0."""
    order = self_order(coarse, medium, fine)
    if order is None or order <= 0:
        return None
    return fine + (fine - medium) / (2.0**order - 1)


def fitted_order(sizes: Sequence[float], values: Sequence[float]) -> float | None:
    """The p of f = f0 + c h^p through three meshes of any sizes h, coarse to fine.

    (f1 - f2)/(f2 - f3) = (h1^p - h2^p)/(h2^p - h3^p), whose right side grows with p. None when the values are not
    monotone or not all there, or when the order is outside [LOWEST, HIGHEST].
    """
    (h1, h2, h3), (f1, f2, f3) = sizes, values
    if not (f1 - f2) * (f2 - f3) > 0:  # NaN is not above zero either
        return None
    ratio = (f1 - f2) / (f2 - f3)

    def excess(p: float) -> float:
        return ((h1 / h2) ** p - 1) / (1 - (h3 / h2) ** p) - ratio

    return float(brentq(excess, LOWEST, HIGHEST)) if excess(LOWEST) <= 0 <= excess(HIGHEST) else None


@dataclass(frozen=True)
class MeshSequence:
    """A quantity on three or more meshes, coarse to fine; sizes: of the elements, in any unit."""

    sizes: tuple[float, ...]
    values: tuple[float, ...]

    @property
    def same(self) -> bool:
        """Is the value the same on every mesh?"""
        known = not any(math.isnan(value) for value in self.values)
        return known and max(self.values) - min(self.values) <= SAME_VALUE * abs(self.values[-1])

    @property
    def orders(self) -> tuple[float | None, ...]:
        """The order of each three successive meshes."""
        if self.same:
            return (None,) * (len(self.values) - 2)
        windows = range(len(self.values) - 2)
        return tuple(fitted_order(self.sizes[i : i + 3], self.values[i : i + 3]) for i in windows)

    @property
    def verdict(self) -> str:
        """Whether the last meshes are in the asymptotic range, and if not, why."""
        if any(math.isnan(value) for value in self.values):
            return "not solved on every mesh"
        if self.same:
            return "same on every mesh"
        last = self.orders[-1]
        if last is None:
            return "not asymptotic: no order"
        if len(self.orders) == 1:
            close = abs(last - FORMAL) <= SAME_ORDER
            return "asymptotic" if close else f"not asymptotic: one order, not {FORMAL:g}"
        before = self.orders[-2]
        if before is None:
            return "not asymptotic: no order before the last"
        return "asymptotic" if abs(last - before) <= SAME_ORDER else "not asymptotic: the orders differ"

    @property
    def asymptotic(self) -> bool:
        """Is the extrapolated value to be trusted?"""
        return self.verdict in ("asymptotic", "same on every mesh")

    @property
    def limit(self) -> float | None:
        """Richardson's limit of the last three meshes; the value itself where all are the same."""
        if self.same:
            return self.values[-1]
        order, (medium, fine) = self.orders[-1], self.values[-2:]
        if order is None:
            return None
        return fine + (fine - medium) / ((self.sizes[-2] / self.sizes[-1]) ** order - 1)

    @property
    def uncertainty(self) -> float | None:
        """How far off the limit may be."""
        if self.limit is None:
            return None
        if self.same:
            return max(self.values) - min(self.values)
        return (SAFE if self.asymptotic else UNSAFE) * abs(self.limit - self.values[-1])
