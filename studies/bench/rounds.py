"""Lines of work timed in rounds, each in units of one work that is timed beside it: what the machine does meanwhile,
other programs and a slower clock, meets both, and their ratio is left.
"""

import resource
import statistics
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import pandas as pd

from studies.output.stopwatch import CPU, Clock, timed

COLUMNS = ("group", "line", "what", "median", "low", "high", "at_most", "holds")
NO_BAR = float("nan")
HOLDS, VARIES, BROKEN = "holds", "varies", "BROKEN"


def cpu() -> float:
    """Processor time [s], user and system, of this process and of its children that have ended."""
    children = resource.getrusage(resource.RUSAGE_CHILDREN)
    return CPU() + children.ru_utime + children.ru_stime


@dataclass(frozen=True, eq=False)
class Line:
    """A work that is timed, and bars on its time; NO_BAR where it is only shown.

    over: over that of other lines of the group, by their names.  most: in units.
    cold: the work keeps nothing that makes it faster next time; any other is done once before it counts.
    """

    name: str
    work: Callable[[], Any]
    over: Mapping[str, float] = field(default_factory=dict)
    most: float = NO_BAR
    cold: bool = False


@dataclass(frozen=True, eq=False)
class Group:
    """Lines that are timed in turns."""

    name: str
    lines: Sequence[Line]


def in_rounds(
    groups: Iterable[Group],
    unit: Callable[[], object],
    rounds: int,
    progress: Callable[[int, int, str], None] = lambda done, planned, label: None,
    clock: Clock = cpu,
) -> pd.DataFrame:
    """One row a ratio: group, line, what it is, median, low and high over the rounds, its bar, and whether it holds.

    The unit of a round is the median of those beside its lines. A bar holds where the median does; it is broken where
    every round is beyond it, and where rounds lie on both sides a busy machine has not decided. Groups are asked for
    one after another, so that what they need is made, and freed, in time.
    """
    rows = [row for group in groups for row in _readings(group, unit, rounds, progress, clock)]
    return pd.DataFrame(rows, columns=list(COLUMNS))


def _readings(
    group: Group,
    unit: Callable[[], object],
    rounds: int,
    progress: Callable[[int, int, str], None],
    clock: Clock,
) -> Iterator[tuple[object, ...]]:
    spent: dict[str, list[float]] = {line.name: [] for line in group.lines}
    units: list[float] = []
    for line in group.lines:
        if not line.cold:
            line.work()
    for turn in range(rounds):
        beside = []
        for place, line in enumerate(group.lines):
            progress(turn * len(group.lines) + place, rounds * len(group.lines), f"{group.name}: {line.name}")
            beside.append(timed(unit, clock)[0])
            spent[line.name].append(timed(line.work, clock)[0])
        units.append(statistics.median(beside))
    for line in group.lines:
        ratios = {"units": (units, line.most)} | {f"x {name}": (spent[name], bar) for name, bar in line.over.items()}
        for what, (others, bar) in ratios.items():
            values = [own / other for own, other in zip(spent[line.name], others, strict=True)]
            median = statistics.median(values)
            yield group.name, line.name, what, median, min(values), max(values), bar, _verdict(values, median, bar)


def _verdict(values: Sequence[float], median: float, bar: float) -> str:
    if bar != bar:
        return ""
    return HOLDS if median <= bar else VARIES if any(value <= bar for value in values) else BROKEN


def shown(table: pd.DataFrame) -> str:
    """The table for a terminal."""
    return table.to_string(index=False, float_format="{:.3g}".format, na_rep="")
