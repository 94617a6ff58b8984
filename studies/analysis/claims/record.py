"""A claim, and what a campaign says of it: confirmed, qualified, refuted, or untested where a table is missing.

A verdict rests on an interval, of one number with its uncertainty or of one number over many problems. Inside the band
that the claim allows it is confirmed, outside refuted, and else qualified: true of some, or not decided.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

import pandas as pd

CONFIRMED, QUALIFIED, REFUTED, UNTESTED = "confirmed", "qualified", "refuted", "untested"
CAMPAIGN = "footprint run standard"  # that makes the tables of experiments
COLUMNS = (
    *("claim", "subject", "sentence", "source", "regime", "status", "measured", "low", "high", "unit", "problems"),
    *("machine", "command"),
)


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


Judge = Callable[..., Verdict | None]


@dataclass(frozen=True)
class Claim:
    """A sentence with its source; ``judge`` reads tables by the names of its parameters, None where none can test it.

    regime: what it is tested on, and the band that it allows.  command: that reproduces the measurement, or the table
    it rests on.  machine: the number is of times, or of rounding, so that another machine has another one.
    """

    name: str
    subject: str
    sentence: str
    source: str
    regime: str
    command: str
    judge: Judge | None
    machine: bool = False


@dataclass
class Claims:
    """The claims of a subject, each declared above the function that judges it."""

    subject: str
    made: list[Claim] = field(default_factory=list)

    def __call__(
        self, name: str, sentence: str, source: str, regime: str, command: str, machine: bool = False
    ) -> Callable[[Judge], Judge]:
        """A claim that the decorated function judges."""

        def declared(judge: Judge) -> Judge:
            self.made.append(Claim(name, self.subject, sentence, source, regime, command, judge, machine))
            return judge

        return declared

    def untested(self, name: str, sentence: str, source: str, regime: str) -> None:
        """A claim that the suite cannot test; regime: what it lacks."""
        self.made.append(Claim(name, self.subject, sentence, source, regime, "", None))


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


def values_of(statement_values: pd.DataFrame, name: str) -> dict[str, float]:
    """The numbers of a sentence of conclusion by their names; none where the campaign does not make it."""
    own = statement_values[statement_values["statement"] == name]
    return dict(zip(own["field"], own["number"].astype(float), strict=True))
