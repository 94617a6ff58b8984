"""A claim, and what a campaign says of it: confirmed, qualified, refuted, or untested where a table is missing.

A verdict rests on an interval, of one number with its uncertainty or of one number over many problems. Inside the band
that the claim allows it is confirmed, outside refuted, and else qualified: true of some, or not decided.
"""

from __future__ import annotations

from dataclasses import dataclass

CONFIRMED, QUALIFIED, REFUTED, UNTESTED = "confirmed", "qualified", "refuted", "untested"


@dataclass(frozen=True)
class Verdict:
    """What was measured: a sentence, the interval low to high of its number in a unit, and how many problems it is of.

    number: of a share, low = high.
    """

    status: str
    measured: str
    low: float
    high: float
    unit: str
    problems: int


def banded(
    interval: tuple[float, float], band: tuple[float, float], unit: str, measured: str, problems: int
) -> Verdict:
    """By where the interval lies to the band."""
    low, high = interval
    if band[0] <= low and high <= band[1]:
        status = CONFIRMED
    elif high < band[0] or low > band[1]:
        status = REFUTED
    else:
        status = QUALIFIED
    return Verdict(status, measured, low, high, unit, problems)


def counted(right: int, of: int, measured: str) -> Verdict:
    """Of a tendency: confirmed where it is true of all problems, refuted where of fewer than half."""
    status = CONFIRMED if right == of else QUALIFIED if 2 * right >= of else REFUTED
    return Verdict(status, measured, right / of, right / of, "share of problems", of)


def always(exceptions: int, of: int, measured: str) -> Verdict:
    """Of a law without exception, which one exception refutes."""
    return Verdict(REFUTED if exceptions else CONFIRMED, measured, exceptions / of, exceptions / of, "exceptions", of)
