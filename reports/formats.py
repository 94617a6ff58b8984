"""Numbers and names as text: without negative zeros, and with a dash for what does not exist."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping

NOTHING = "–"  # for a number that does not exist: None or NaN


def fixed(value: float | None, decimals: int = 0, sign: bool = False) -> str:
    """``decimals`` places; a value that rounds to zero has no sign."""
    if value is None or math.isnan(value):
        return NOTHING
    text = f"{value:+.{decimals}f}" if sign else f"{value:.{decimals}f}"
    return text.lstrip("+-") if float(text) == 0.0 else text


def percent(fraction: float | None, decimals: int = 2, sign: bool = True) -> str:
    """A fraction in per cent: a change with its sign, a size without."""
    return NOTHING if fraction is None or math.isnan(fraction) else fixed(100 * fraction, decimals, sign) + " %"


def share(fraction: float | None, decimals: int = 2) -> str:
    """A fraction in per cent that is a size, without a sign."""
    return percent(fraction, decimals, sign=False)


def digits(value: float, count: int) -> str:
    """``count`` significant digits, trailing zeros kept."""
    return NOTHING if math.isnan(value) else f"{value + 0.0:#.{count}g}"


def number(value: float) -> str:
    """Six significant digits at most."""
    return NOTHING if math.isnan(value) else f"{value:g}"


def scientific(value: float | None, decimals: int = 1) -> str:
    """Mantissa and exponent; exact zero is 0."""
    if value is None or math.isnan(value):
        return NOTHING
    return "0" if value == 0.0 else f"{value:.{decimals}e}"


def code(name: object) -> str:
    """A name as it is typed; a dash for none."""
    return NOTHING if name == "" else f"`{name}`"


def interval(ends: Iterable[float], decimals: int = 2) -> str:
    """Two ends in brackets."""
    return f"[{', '.join(fixed(end, decimals) for end in ends)}]"


def residual(judged: Mapping[str, float], name: str) -> str:
    """One of the residuals that the judge has recomputed."""
    return scientific(judged[name])
