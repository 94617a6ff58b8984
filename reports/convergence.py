"""Observed orders from a sequence of meshes, each halving the one before; None where an order has no meaning."""

from __future__ import annotations

import math


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
