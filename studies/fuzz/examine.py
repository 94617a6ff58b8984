"""One case from its number to a line of a table; what breaks a law is made smaller while it breaks the same one."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import asdict, dataclass, replace
from typing import Any

from studies.fuzz import matrices, posed, scenes
from studies.fuzz.attempt import Broken, Passed, place, quiet
from studies.fuzz.cases import FRICTION, SCENE, Asked, kind_of
from studies.fuzz.comparing import AGREES
from studies.fuzz.near import request_of
from studies.output.atomic import SCHEMA, as_text
from studies.run.store.source_hash import sources_hash
from studies.solving.result import CONVERGED, WRONG

NAME = "fuzz"  # how the names of cases in a store begin
PASSED, EXPLAINED, UNCOMPARED, BROKEN = "agrees", "explained", "not compared", "broken"
HARDEST = 100
TRIES = 40  # requests that are tried to make one smaller
REQUESTS = (SCENE, FRICTION)
MADE: dict[str, Any] = {"posed": posed, "matrices": matrices}  # the other kinds


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
    return f"footprint fuzz --seed {seed} --kind {kind}"


def examine(seed: int, kind: str = "", *, smaller: bool = False) -> Report:
    """The report of a case of a kind, by default of that which is drawn from its number.

    smaller: of a broken request with as few settings as break the same law.
    """
    kind = kind or kind_of(seed)
    if kind not in REQUESTS:
        return _report(seed, kind, MADE[kind].about(seed), lambda: MADE[kind].check(seed))
    with quiet():
        asked = request_of(seed, kind)
    found = _report(seed, kind, asked.command, lambda: scenes.check(seed, asked))
    if smaller and found.verdict == BROKEN:
        return replace(found, about=minimised(seed, asked, found.law).command)
    return found


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
    tries, shrinking = TRIES, True
    while shrinking:
        shrinking = False
        for fewer in _fewer(asked):
            tries -= 1
            if tries >= 0 and _breaks(seed, fewer, law):
                asked, shrinking = fewer, True
                break
    return asked


def _fewer(asked: Asked) -> list[Asked]:
    """One thing less of each."""
    found = [replace(asked, refined=False)] if asked.refined else []
    for key in asked.settings:
        found.append(replace(asked, settings={k: v for k, v in asked.settings.items() if k != key}))
    for key in asked.options:
        if key != "mesh":
            found.append(replace(asked, options={k: v for k, v in asked.options.items() if k != key}))
    return found


def _breaks(seed: int, asked: Asked, law: str) -> bool:
    try:
        scenes.check(seed, asked)
    except Broken as broken:
        return broken.law == law
    except Exception as error:  # a request that the laws themselves cannot take is not the same finding
        return bool(place(error)) and False
    return False


def task_id(seed: int, kind: str) -> str:
    """Name of a case in the store: its kind, its number and the sources that decide it."""
    return f"{NAME}-{sources_hash([__name__])[:12]}-{kind}-{seed}"


def record_of(name: str) -> str:
    """Examine the case of a name; the text of its record, which has what every record of the store has."""
    _, kind, seed = name.rsplit("-", 2)
    report = examine(int(seed), kind, smaller=True)
    told = {"schema": SCHEMA, "id": name, "class": WRONG if report.verdict == BROKEN else CONVERGED}
    empty: dict[str, Any] = {"settings": {}, "quantities": {}, "steps": [], "counters": {}, "timing_s": {}, "files": []}
    return as_text({**told, **empty, "scene": report.kind, "reason": report.said, "case": report.row})
