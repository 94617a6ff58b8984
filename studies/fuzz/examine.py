"""One case from its number to a line of a table, and a campaign of many, kept in the store.

What breaks a law is made smaller while it breaks the same one. In a campaign (``footprint run fuzz``) each case has the
child process of the pool. A case that is in the store is not solved again, as long as the sources are the same. A child
that is killed, or dies, is a finding like any other: a hang, or a death.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any

import pandas as pd

from studies.ask.scene import UsageError
from studies.fuzz import posed, scenes
from studies.fuzz.attempt import Asked, Broken, Passed, quiet
from studies.fuzz.cases import FRICTION, SCENE, kind_of, request_of
from studies.fuzz.comparing import AGREES
from studies.output.atomic import SCHEMA, as_text, write_table
from studies.run.archive import Archive, DamagedError
from studies.run.children import keeping_what_is_finished
from studies.run.running import engine_of
from studies.run.source_hash import sources_hash
from studies.run.task import Limits, Task
from studies.scenes.plugins import use_options
from studies.solving.result import CONVERGED, CRASH, MEMORY, TIME, WRONG

NAME = "fuzz"  # how the names of cases in a store begin
PASSED, EXPLAINED, UNCOMPARED, BROKEN = "agrees", "explained", "not compared", "broken"
HARDEST = 100
REQUESTS = (SCENE, FRICTION)
MADE = {  # of the other kinds: in words, and the check
    "posed": (posed.about_panel, posed.check_panel),
    "matrices": (posed.about_matrices, posed.check_matrices),
}


@dataclass(frozen=True)
class Report:
    """A line: what was asked, what it came to, the law that was drawn or broken, and what is said of it.

    verdict: PASSED, EXPLAINED why two answers differ, UNCOMPARED where there are not two, or BROKEN.
    hard: how near a request has come to breaking a law, or to no end, see :func:`studies.fuzz.attempt.hardness`.
    """

    seed: int
    kind: str
    about: str
    word: str
    law: str
    verdict: str
    said: str
    hard: int = 0

    @property
    def row(self) -> dict[str, Any]:
        """As plain data."""
        return asdict(self)


def command_of(seed: int, kind: str) -> str:
    """The command that replays a case."""
    return " ".join([f"footprint fuzz --seed {seed} --kind {kind}", *use_options()])


def examine(seed: int, kind: str = "", *, smaller: bool = False) -> Report:
    """The report of a case of a kind, by default of that which is drawn from its number.

    smaller: of a broken request with as few settings as break the same law.
    """
    kind = kind or kind_of(seed)
    if kind not in REQUESTS:
        about, check = MADE[kind]
        return _report(seed, kind, about(seed), lambda: check(seed))
    with quiet():
        asked = request_of(seed, kind)
    report = _report(seed, kind, asked.command, lambda: scenes.check(seed, asked))
    if smaller and report.verdict == BROKEN:
        return replace(report, about=minimised(seed, asked, report.law).command)
    return report


def _report(seed: int, kind: str, about: str, check: Callable[[], Passed]) -> Report:
    try:
        passed = check()
    except Broken as broken:
        return Report(seed, kind, about, "", broken.law, BROKEN, str(broken), HARDEST)
    return Report(seed, kind, about, passed.word, passed.law, _verdict(passed), passed.said, passed.hard)


def _verdict(passed: Passed) -> str:
    if not passed.law or passed.said.startswith("not compared"):
        return UNCOMPARED
    return PASSED if passed.said == AGREES else EXPLAINED


def minimised(seed: int, asked: Asked, law: str) -> Asked:
    """The request with options and settings given back one by one, as long as it breaks the same law."""
    before = None
    while before != asked:
        before = asked
        for fewer in _fewer(asked):
            if _breaks(seed, fewer, law):
                asked = fewer
                break
    return asked


def _fewer(asked: Asked) -> Iterator[Asked]:
    """One thing less of each."""
    if asked.refined:
        yield replace(asked, refined=False)
    for name in ("settings", "options"):
        for key in getattr(asked, name):
            kept: dict[str, Any] = {name: {k: v for k, v in getattr(asked, name).items() if k != key}}
            if key != "mesh":
                yield replace(asked, **kept)


def _breaks(seed: int, asked: Asked, law: str) -> bool:
    try:
        scenes.check(seed, asked)
    except Broken as broken:
        return broken.law == law
    except Exception:  # a request that the laws themselves cannot take is not the same finding
        return False
    return False


def task_id(seed: int, kind: str) -> str:
    """Name of a case in the store: its kind, its number and the sources that decide it."""
    return f"{NAME}-{sources_hash([__name__])[:12]}-{kind}-{seed}"


def record_of(name: str) -> str:
    """Examine the case of a name; the text of its record, which has what every record of the store has."""
    _, kind, seed = name.rsplit("-", 2)
    report = examine(int(seed), kind, smaller=True)
    header = {"schema": SCHEMA, "id": name, "class": WRONG if report.verdict == BROKEN else CONVERGED}
    empty: dict[str, Any] = {"settings": {}, "quantities": {}, "steps": [], "counters": {}, "timing_s": {}, "files": []}
    return as_text({**header, **empty, "scene": report.kind, "reason": report.said, "case": report.row})


SEEDS, MOST = "0:5000", 1_000_000
LIMITS = Limits(time_s=120.0, memory_MB=2048.0)  # most take well under a second, the longest of 5,000 takes 54 s
STOPPED = {TIME: "time", MEMORY: "memory", CRASH: "the process lives"}  # the law that a failure of the child breaks
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
        verdicts = ", ".join(f"{counts[name]} {name}" for name in VERDICTS if counts[name])
        return f"{len(self.rows)} cases: {verdicts or 'none'}; {self.solved} solved now"

    @property
    def lines(self) -> list[str]:
        """What the cases came to, and how many broke each of the laws that nothing may break."""
        words = Counter(row["word"] for row in self.rows if row["word"])
        laws = Counter(row["law"] for row in self.rows if row["verdict"] == BROKEN)
        broken = dict.fromkeys(WORST, 0) | dict(laws.most_common())
        return [
            "came to: " + (", ".join(f"{count} {word}" for word, count in words.most_common()) or "nothing"),
            "broken: " + ", ".join(f"{count} {WORST.get(law, law)}" for law, count in broken.items()),
        ]


def run(
    store: Path,
    seeds: range,
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
        tasks = [Task(NAME, name, f"{NAME} {name}") for name in names if not _there(archive, name)]
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
