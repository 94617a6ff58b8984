"""Observed orders from a sequence of meshes; None where an order has no meaning."""

from __future__ import annotations

import math
from collections.abc import Sequence

from scipy.optimize import brentq

LOWEST, HIGHEST = 0.3, 12.0  # of an order that is extrapolated with


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
