"""Lines of work timed in rounds, each in units of one work that is timed beside it: what the machine does meanwhile,
other programs and a slower clock, meets both, and their ratio is left.
"""

import resource
import statistics
from collections.abc import Callable, Hashable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import pandas as pd

from studies.output.stopwatch import CPU, Clock, timed
from studies.output.terminal import columns

COLUMNS = ("group", "line", "what", "median", "low", "high", "at_most", "holds")
NO_BAR = float("nan")
HOLDS, VARIES, BROKEN = "holds", "varies", "BROKEN"
PART = "part "  # of the time of a line, by its name


def cpu() -> float:
    """Processor time [s], user and system, of this process and of its children that have ended."""
    children = resource.getrusage(resource.RUSAGE_CHILDREN)
    return CPU() + children.ru_utime + children.ru_stime


@dataclass(frozen=True, eq=False)
class Line:
    """A work that is timed, and bars on it; NO_BAR where a number is only shown.

    see(what work() has returned, its seconds) -> numbers by name, not timed; seconds where the name ends in _s.
    over: of the time over that of other lines of the group, by their names.  most: of "units" and of what is seen.
    cold: the work keeps nothing that makes it faster next time; any other is done once before it counts.
    """

    name: str
    work: Callable[[], Any]
    see: Callable[[Any, float], Mapping[str, float]] = lambda done, seconds: {}
    over: Mapping[str, float] = field(default_factory=dict)
    most: Mapping[str, float] = field(default_factory=dict)
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
    """One row a number: group, line, what it is, median, low and high over the rounds, its bar, and whether it holds.

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
    seen: dict[str, list[Mapping[str, float]]] = {line.name: [] for line in group.lines}
    units: list[float] = []
    for line in group.lines:
        if not line.cold:
            line.work()
    for turn in range(rounds):
        beside = []
        for place, line in enumerate(group.lines):
            progress(turn * len(group.lines) + place, rounds * len(group.lines), f"{group.name}: {line.name}")
            beside.append(timed(unit, clock)[0])
            seconds, numbers = _seen(line, clock)
            spent[line.name].append(seconds)
            seen[line.name].append(numbers)
        units.append(statistics.median(beside))
    for line in group.lines:
        own = spent[line.name]
        found = {"units": _ratios(own, units)}
        found |= {f"x {other}": _ratios(own, spent[other]) for other in line.over}
        for name in seen[line.name][0]:
            values = [each[name] for each in seen[line.name]]
            found[name.removesuffix("_s")] = _ratios(values, units) if name.endswith("_s") else values
        bars = {**{f"x {other}": bar for other, bar in line.over.items()}, **line.most}
        for what, values in found.items():
            median, bar = statistics.median(values), bars.get(what, NO_BAR)
            yield group.name, line.name, what, median, min(values), max(values), bar, _verdict(values, median, bar)


def _verdict(values: Sequence[float], median: float, bar: float) -> str:
    if bar != bar:
        return ""
    return HOLDS if median <= bar else VARIES if any(value <= bar for value in values) else BROKEN


def _seen(line: Line, clock: Clock) -> tuple[float, Mapping[str, float]]:
    """Seconds and numbers; what the work has made, large factors, is gone then."""
    seconds, done = timed(line.work, clock)
    return seconds, line.see(done, seconds)


def _ratios(seconds: Sequence[float], of: Sequence[float]) -> list[float]:
    return [a / b for a, b in zip(seconds, of, strict=True)]


def shown(table: pd.DataFrame) -> Iterator[str]:
    """The table for a terminal: a block a group, the parts of its lines' times, and at the end all bars."""
    for group, own in table.groupby("group", sort=False):
        parts = own["what"].str.startswith(PART)
        yield from ("", str(group), *_block(own[~parts & (own["holds"] == "") | (own["what"] == "units")]))
        if parts.any():
            yield from _block(own[parts], "of these")
    rows, before = [], ("", "")
    for row in table[table["holds"] != ""].to_dict("records"):
        names = str(row["group"]), str(row["line"])
        said = (name if names != before else "" for name in names)
        rows.append((*said, str(row["what"]), _with_ends(row), _number(row["at_most"]), str(row["holds"])))
        before = names
    yield from ("", *columns([("bars", "", "", "is", "at most", ""), *rows], right=range(3, 5)))


def _block(table: pd.DataFrame, head: str = "") -> Iterator[str]:
    """Lines below one another, their numbers side by side, with the lowest and highest of their units."""
    whats = list(dict.fromkeys(table["what"]))
    rows = [[head, *(what.removeprefix(PART) for what in whats)]]
    for line, own in table.groupby("line", sort=False):
        each = {row["what"]: _with_ends(row) for row in own.to_dict("records")}
        rows.append([str(line), *(each.get(what, "") for what in whats)])
    yield from columns(rows, right=range(1, len(whats) + 1))


def _with_ends(row: Mapping[Hashable, Any]) -> str:
    """The median; of what is timed beside another work its lowest and highest, too."""
    beside = row["what"] == "units" or str(row["what"]).startswith("x ")
    ends = f" [{_number(row['low'])}, {_number(row['high'])}]" if beside and row["low"] < row["high"] else ""
    return _number(row["median"]) + ends


def _number(value: float) -> str:
    """A count, or three digits of a time or a ratio."""
    return f"{value:.6g}" if value == round(value) or abs(value) >= 1000 else f"{value:.3g}"
