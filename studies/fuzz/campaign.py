"""``footprint run fuzz``: cases by number, each in the child process of the pool, kept in the store, and their tables.

A case that is in the store is not solved again, as long as the sources are the same. A child that is killed, or dies,
is a finding like any other: a hang, or a death.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pandas as pd

from studies.ask.scene import UsageError
from studies.fuzz.cases import kind_of
from studies.fuzz.examine import BROKEN, EXPLAINED, PASSED, UNCOMPARED, Report, command_of, task_id
from studies.fuzz.examine import NAME as NAME
from studies.output.atomic import write_table
from studies.run.pool.engine import engine as engine_of
from studies.run.pool.process import keeping_what_is_finished
from studies.run.pool.task import Limits, Task
from studies.run.store.layout import Archive, DamagedError
from studies.solving.result import CRASH, MEMORY, TIME

CASES, MOST = 5000, 1_000_000
LIMITS = Limits(time_s=120.0, memory_MB=2048.0)  # most take well under a second, the longest of 5,000 takes 54 s
STOPPED = {TIME: "ends", MEMORY: "memory", CRASH: "the process lives"}  # the law that a failure of the child breaks
WORST = {"no traceback": "tracebacks", "certified": "judged wrong", "one answer": "silent disagreements"}
VERDICTS = (PASSED, EXPLAINED, UNCOMPARED, BROKEN)
Progress = Callable[[int, int, str], None]


@dataclass
class Summary:
    """How a run has ended: the lines of all cases, and how many were solved now."""

    rows: Sequence[Mapping[str, Any]]
    solved: int

    @property
    def broken(self) -> int:
        """How many cases break a law."""
        return sum(row["verdict"] == BROKEN for row in self.rows)

    @property
    def line(self) -> str:
        """One line."""
        counts = Counter(row["verdict"] for row in self.rows)
        told = ", ".join(f"{counts[name]} {name}" for name in VERDICTS if counts[name])
        return f"{len(self.rows)} cases: {told or 'none'}; {self.solved} solved now"

    @property
    def lines(self) -> list[str]:
        """What the cases came to, and how many broke each of the laws that nothing may break."""
        words = Counter(row["word"] for row in self.rows if row["word"])
        laws = Counter(row["law"] for row in self.rows if row["verdict"] == BROKEN)
        found = dict.fromkeys(WORST, 0) | dict(laws.most_common())
        return [
            "came to: " + (", ".join(f"{count} {word}" for word, count in words.most_common()) or "nothing"),
            "broken: " + ", ".join(f"{count} {WORST.get(law, law)}" for law, count in found.items()),
        ]


def run(
    store: Path,
    seeds: range = range(CASES),
    kind: str = "",
    engine: str = "serial",
    limits: Limits = LIMITS,
    progress: Progress = lambda done, planned, label: None,
    *,
    resume: bool = False,
) -> Summary:
    """The cases of these numbers that are missing, and the table fuzz.

    kind: of all cases, by default of each what is drawn from its number.  resume: refuse to begin.
    Raises UsageError, and StoreFullError with everything finished kept.
    """
    if not 1 <= len(seeds) <= MOST:
        raise UsageError(f"cases = {len(seeds)} must be a whole number in [1, {MOST}]")
    archive, work, cases = Archive(store), engine_of(engine), len(seeds)
    kinds = [kind or kind_of(seed) for seed in seeds]
    names = [task_id(seed, each) for seed, each in zip(seeds, kinds, strict=True)]
    if resume and not any(archive.record_path(name).exists() for name in names):
        raise UsageError(f"--resume: {store} has no case of {NAME!r} of these sources yet; leave --resume out")
    with archive.claimed(), keeping_what_is_finished(store):
        tasks = [Task(NAME, name) for name in names if not _there(archive, name)]
        progress(cases - len(tasks), cases, NAME)
        for count, (task, _) in enumerate(work(tasks, store, limits), start=cases - len(tasks) + 1):
            progress(count, cases, task.label)
        rows = [_row(archive, *case) for case in zip(names, seeds, kinds, strict=True)]
        write_table(archive.tables / "fuzz.csv", table_of(rows))
    return Summary(rows, len(tasks))


def _there(archive: Archive, name: str) -> bool:
    try:
        return archive.record(name) is not None
    except DamagedError:
        archive.set_aside(name)
        return False


def _row(archive: Archive, name: str, seed: int, kind: str) -> dict[str, Any]:
    """The line of a case; of one whose child was killed or died, what is known."""
    record = archive.record(name)
    if record is not None:
        return {**record["case"]}
    failure = archive.failure(name) or {"class": "missing", "reason": "not solved yet"}
    law = STOPPED.get(failure["class"], failure["class"])
    return Report(seed, kind, "", "", law, BROKEN, failure["reason"]).row


def table_of(rows: Sequence[Mapping[str, Any]]) -> pd.DataFrame:
    """A row a case, with the command that replays it."""
    commands = [command_of(row["seed"], row["kind"]) for row in rows]
    return pd.DataFrame(rows).assign(command=commands)
