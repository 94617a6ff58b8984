"""One case from its number to a line of a table; what breaks a law is made smaller while it breaks the same one."""

from __future__ import annotations

from dataclasses import asdict, dataclass, replace
from typing import Any

from studies.fuzz import matrices, posed, scenes
from studies.fuzz.attempt import Broken, Passed, place, quiet
from studies.fuzz.cases import Asked, asked_of, kind_of
from studies.fuzz.comparing import AGREES

PASSED, EXPLAINED, UNCOMPARED, BROKEN = "agrees", "explained", "not compared", "broken"
TRIES = 40  # requests that are tried to make one smaller


@dataclass(frozen=True)
class Report:
    """A line: what was asked, what it came to, the law that was drawn or broken, and what is said of it.

    verdict: PASSED, EXPLAINED why two answers differ, UNCOMPARED where there are not two, or BROKEN.
    """

    seed: int
    kind: str
    about: str
    word: str
    law: str
    verdict: str
    said: str

    @property
    def row(self) -> dict[str, Any]:
        """As plain data."""
        return asdict(self)

    @property
    def command(self) -> str:
        """The command that replays it."""
        return f"footprint fuzz --seed {self.seed}"


def examine(seed: int, *, smaller: bool = False) -> Report:
    """The report of a case; smaller: of a broken request with as few settings as break the same law."""
    kind = kind_of(seed)
    try:
        passed = {"scene": scenes.check, "posed": posed.check, "matrices": matrices.check}[kind](seed)
    except Broken as broken:
        about = _about(kind, seed)
        if smaller and kind == "scene":
            about = minimised(seed, broken.law).command
        return Report(seed, kind, about, "", broken.law, BROKEN, str(broken))
    return Report(seed, kind, _about(kind, seed), passed.word, passed.law, _verdict(passed), passed.said)


def _about(kind: str, seed: int) -> str:
    if kind != "scene":
        return {"posed": posed.about, "matrices": matrices.about}[kind](seed)
    with quiet():
        return asked_of(seed).command


def _verdict(passed: Passed) -> str:
    if not passed.law or passed.said.startswith("not compared"):
        return UNCOMPARED
    return PASSED if passed.said == AGREES else EXPLAINED


def minimised(seed: int, law: str) -> Asked:
    """The request with options and settings given back one by one, as long as it breaks the same law."""
    with quiet():
        asked, tries = asked_of(seed), TRIES
    shrinking = True
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
