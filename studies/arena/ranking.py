"""The leaderboard as rows: entries by rank, their results on each machine, and which results are stale.

An entry is ranked by the machine where it solves fewest problems: by the problems of the split ``test`` that it solves
with the accuracy required, most first; then by the fewest false claims; then by the cost, the geometric mean over those
that it solves, in factorisations of K on the same machine, so that seconds of different machines are not compared.
Equal in all three is an equal rank. A stale result is listed, but not ranked.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any

from studies.arena.collected.collection import TEST, split_of
from studies.arena.results import ANOMALOUS, EXCLUDED, FAILED, MISSING, OK, STALE, Asked, Result, mean_cost, statuses
from studies.ask.request import UsageError

LEAD = 1e-6  # the accuracy that is ranked by, or else the strictest tolerance that all results have in common
Split = Callable[[str], str]
Row = dict[str, Any]


@dataclass(frozen=True)
class Board:
    """The tolerance of the ranking, rows of entries, of results by machine, and of machines."""

    tolerance: float
    ranked: list[Row]
    runs: list[Row]
    machines: list[Row]
    stale: int
    secrets: int


def board(results: Sequence[Result], split: Split = split_of) -> Board:
    """Of all results; raises UsageError where those that are not stale have no tolerance in common."""
    fresh, old = ([each for each in results if each.stale is stale] for stale in (False, True))
    tolerance = _tolerance(fresh) if fresh else math.nan
    runs = [_run(each, _at(each, tolerance), split) for each in fresh]
    runs += [{**_nothing(each), "status": STALE} for each in old]
    machines = {each.place: {"place": each.place, **each.machine} for each in results}
    secrets = {at.held_out.secret for each in fresh if (at := _at(each, tolerance)).held_out is not None}
    own = [run for run in runs if run["status"] != STALE]
    return Board(tolerance, list(_ranked(own)), runs, list(machines.values()), len(old), len(secrets))


def _tolerance(results: Sequence[Result]) -> float:
    common = set.intersection(*({at.tolerance for at in each.tolerances} for each in results))
    if not common:
        raise UsageError("the results were asked for no tolerance in common")
    return LEAD if LEAD in common else min(common)


def _at(result: Result, tolerance: float) -> Asked:
    return next(at for at in result.tolerances if at.tolerance == tolerance)


def _run(result: Result, at: Asked, split: Split) -> Row:
    """Counts by status on the split TEST, beside it all that are OK, and the held-out tier."""
    tested = [each for each in at.public if split(each.problem) == TEST]
    held, counts = at.held_out, statuses(tested)
    private = {} if held is None else {"drawn": sum(held.statuses.values()), "drawn_ok": held.statuses[OK]}
    private |= {} if held is None else {"drawn_false": held.statuses[ANOMALOUS]}
    return {**_nothing(result), **counts, **private, "asked": len(tested), "cost": mean_cost(tested), "status": OK}


def _nothing(result: Result) -> Row:
    blank = dict.fromkeys((OK, ANOMALOUS, FAILED, EXCLUDED, MISSING, "asked", "drawn", "drawn_ok", "drawn_false"))
    return {"entry": result.entry, "place": result.place, **blank, "cost": math.nan}


def _ranked(runs: Iterable[Row]) -> Iterator[Row]:
    """One row per entry, by its worst machine; entries with equal figures share a rank."""
    groups: dict[str, list[Row]] = {}
    for run in runs:
        groups.setdefault(run["entry"], []).append(run)
    worst = [{**sorted(own, key=_order)[-1], "machines": len(own)} for own in groups.values()]
    worst.sort(key=lambda row: (_order(row), row["entry"]))
    rank, before = 0, None
    for at, row in enumerate(worst, 1):
        rank, before = (rank if _order(row) == before else at), _order(row)
        yield {"rank": rank, **row}


def _order(row: Row) -> tuple[float, float, float]:
    """Smallest first: the best."""
    return -row[OK], row[ANOMALOUS], row["cost"] if row["cost"] == row["cost"] else math.inf
