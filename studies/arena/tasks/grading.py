"""A submission graded: each claim is held to the open configuration and to those that a secret draws.

It is a TOML file that nobody vouches for, a table a task: ``claim`` is "met", with what is chosen beside it, or
"cannot", alone. Whatever is wrong with the file ends in a UsageError of one line.

+1 for a claim that holds on all of them, -1 for one that does not, 0 for none. That a task is met is said by the judge
of the solve (the class, equilibrium and penetration recomputed from the problem), by quantities read off the certified
states, held against closed forms and references, and by the counts of unknowns and operations, which are made where
they are done. That it cannot be met is said by
the bounds of :mod:`studies.arena.tasks.catalogue`, and nothing is solved.
"""

from __future__ import annotations

import json
import math
import time
from collections.abc import Callable, Mapping, Sequence
from contextlib import closing
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

from contact.interchange.untrusted import read_toml
from studies.arena.tasks.catalogue import HIDDEN, GradedTask, Text, tasks
from studies.ask.request import UsageError, text_of
from studies.run.children import Child
from studies.run.task import Limits, Task
from studies.solving.result import SOLVED, seen_in

MET, CANNOT, NONE = "met", "cannot", ""
CLAIMS = (MET, CANNOT)
LONGEST = 80  # characters of a value


@dataclass(frozen=True)
class Claim:
    """What is said of a task, and what is chosen for it."""

    said: str = NONE
    chosen: Text = field(default_factory=dict)


def read_submission(path: Path) -> dict[str, Claim]:
    """The claims by task; raises UsageError, and OSError where the file cannot be opened."""
    try:
        tables = read_toml(path)
    except ValueError as error:
        raise UsageError(f"{path} is not a submission: {str(error).splitlines()[0].partition(';')[0][:200]}") from None
    submission = {}
    for name, table in tables.items():
        task = tasks().get(name)
        if task is None:
            raise UsageError(f"{path}: {name[:40]!r} is none of the {len(tasks())} tasks, see footprint tasks")
        try:
            submission[name] = _claim(task, table)
        except UsageError as error:
            raise UsageError(f"{path}: {name}: {error}") from None
    return submission


def _claim(task: GradedTask, table: Any) -> Claim:
    if not isinstance(table, Mapping):
        raise UsageError(f"{str(table)[:40]!r} must be a table")
    chosen = {key: _text(key, value) for key, value in table.items() if key != "claim"}
    task.check(chosen)
    if "claim" not in table:
        raise UsageError(f"claim is missing: it must be {' or '.join(CLAIMS)}")
    said = table["claim"]
    if said not in CLAIMS:
        raise UsageError(f"claim = {str(said)[:40]!r} must be {' or '.join(CLAIMS)}")
    if said == CANNOT and chosen:
        raise UsageError(f"claim = {CANNOT!r} stands alone, without {next(iter(chosen))}")
    return Claim(said, chosen)


def _text(key: str, value: Any) -> str:
    """A value as it is written after KEY=; raises UsageError for what is not a text, number or list of numbers."""
    values = value if isinstance(value, list) else [value]
    kinds: tuple[type, ...] = (int, float) if isinstance(value, list) else (int, float, str)
    if not values or len(values) > LONGEST or any(isinstance(v, bool) or not isinstance(v, kinds) for v in values):
        raise UsageError(f"{key[:40]!r} must be a text, a number or a list of numbers")
    if any(isinstance(v, int) and abs(v) > 10**LONGEST for v in values) or len(text := text_of(value)) > LONGEST:
        raise UsageError(f"{key[:40]!r} has more than {LONGEST} characters")
    return text


LIMIT_S, MEMORY_MB = 60.0, 2048.0  # of a task: wall time of all its configurations, and memory of the process
COSTS = ("dofs", "operations")  # counted by the solve, not by the algorithm
Tell = Callable[[int, int, str], None]


@dataclass(frozen=True)
class Grade:
    """Of a task.

    open: whether the claim holds on the open configuration; hidden: on how many of the others, None where they were not
    asked.  said: why it fails on the open one, or on how many others.
    """

    task: str
    claim: str
    score: int
    open: bool | None = None
    hidden: int | None = None
    said: str = ""
    seconds: float = 0.0


def grade(
    claims: Mapping[str, Claim],
    key: bytes | None = None,
    *,
    limit_s: float = LIMIT_S,
    tell: Tell = lambda done, planned, label: None,
    use: Sequence[str] = (),
) -> list[Grade]:
    """One for each task, in their order.

    key: the secret; without one the open configurations alone count.  use: files of parts, for the process that solves.
    """
    grades = []
    with closing(_Solving(tuple(use))) as solving:
        for count, task in enumerate(tasks().values()):
            tell(count, len(tasks()), task.id)
            start = time.monotonic()
            solving.until = start + limit_s
            graded = _graded(task, claims.get(task.id, Claim()), [] if key is None else task.drawn(key), solving)
            grades.append(replace(graded, seconds=time.monotonic() - start))
    return grades


class _Solving:
    """A process that solves, and that is killed where a task has spent its time."""

    def __init__(self, use: tuple[str, ...]) -> None:
        self._child, self._use, self.until = Child(), use, 0.0

    def close(self) -> None:
        """End the process."""
        self._child.end()

    def missed(self, task: GradedTask, chosen: Text, drawn: Text) -> str:
        """Why a configuration is not met; empty where it is."""
        beyond = task.beyond(drawn)
        if beyond:
            return beyond
        try:
            _, request = task.cell(chosen, drawn).resolved()
        except UsageError as error:
            return f"refused: {error}"
        left = max(self.until - time.monotonic(), 0.0)
        answer = self._child.ask(Task("cell", task.id, task.id, request, use=self._use), Limits(left, MEMORY_MB))
        if answer["class"]:
            return f"{answer['class']}: {answer['reason']}"
        record = json.loads(answer["text"])
        if record["class"] not in SOLVED:
            return f"{record['class']}: {record['reason']}"
        return task.missed(values_of(record), request)


def _graded(task: GradedTask, claim: Claim, drawn: Sequence[Text], solving: _Solving) -> Grade:
    """The open configuration first; those that are hidden only where the claim holds on it."""
    if claim.said == NONE:
        return Grade(task.id, NONE, 0)
    if claim.said == CANNOT:
        impossible = [bool(task.beyond(each)) for each in ({}, *drawn)]
        said = "" if any(impossible) else "nothing forbids it"
        hidden = sum(impossible[1:]) if drawn else None
        return Grade(task.id, CANNOT, 1 if any(impossible) else -1, impossible[0], hidden, said)
    said = solving.missed(task, claim.chosen, {})
    if said:
        return Grade(task.id, MET, -1, False, None, said)
    held = sum(not solving.missed(task, claim.chosen, each) for each in drawn)
    if held < len(drawn):
        return Grade(task.id, MET, -1, True, held, f"not met on {len(drawn) - held} of {HIDDEN} hidden configurations")
    return Grade(task.id, MET, 1, True, held if drawn else None)


def values_of(record: Mapping[str, Any]) -> dict[str, float]:
    """Quantities of the last load and of the whole, COSTS, and the residuals of the judge, the worst of all loads.

    A residual that is not finite is infinite. Other counters are those of the algorithm, which may be one of the
    submission: none of them is read.
    """
    steps = record["steps"] or [{}]
    costs = {name: record["counters"][name] for name in COSTS}
    values = {**seen_in(steps[-1], record["counters"]), **record["quantities"], **costs}
    numbers = {name: float(value) for name, value in values.items() if isinstance(value, int | float)}
    for step in steps:
        for name, value in step.get("kkt", {}).items():
            numbers[name] = max(numbers.get(name, 0.0), math.inf if value is None else float(value))
    return numbers
