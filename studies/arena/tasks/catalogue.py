"""The graded tasks as data: the run that fails, what may be chosen, what is required, and what a secret draws.

A configuration is a task with the settings that are drawn; the open one has those of its run. Nothing is solved here.
"""

from __future__ import annotations

import math
import tomllib
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

from studies.arena.held_out import generator
from studies.arena.tasks.exact import EXACT
from studies.ask.request import Request, UsageError
from studies.scenes.complete import Cell

OPTIONS = ("measure", "contact", "newton", "mesh", "model", "steps")  # of a run; all else is a setting
HIDDEN = 2  # configurations that a secret draws of each task
DIGITS = 4  # of a number that is drawn
FILE = Path(__file__).with_name("tasks.toml")
Text = Mapping[str, str]


@dataclass(frozen=True)
class Need:
    """A value by name, and what it must be: in [least, most], and within so much of the reference ``of``, relative.

    bound: the reference that no value passes: none is above it where a least one is asked for, none below it where a
    largest one is.
    """

    name: str
    least: float = -math.inf
    most: float = math.inf
    of: str = ""
    within: float = 0.0
    bound: str = ""

    @property
    def text(self) -> str:
        """What is required, in words."""
        ends = (("at least", self.least), ("at most", self.most))
        words = [f"{word} {end:g}" for word, end in ends if math.isfinite(end)]
        words += [f"within {100 * self.within:g} % of {self.of}"] if self.of else []
        return f"{self.name} {' and '.join(words)}"

    @property
    def limited(self) -> bool:
        """Whether what is known bounds it."""
        return bool(self.bound or self.of) and (math.isfinite(self.least) or math.isfinite(self.most))

    def beyond(self, request: Request) -> str:
        """Why no answer to the request can have it; empty where one may."""
        name = self.bound or self.of
        if not name:
            return ""
        limit = EXACT[name](request, self.name)
        room = self.within * abs(limit)
        if limit + room < self.least:
            return f"{self.name} is at most {limit + room:.4g}, by {name}"
        return f"{self.name} is at least {limit - room:.4g}, by {name}" if limit - room > self.most else ""

    def missed(self, values: Mapping[str, float], request: Request) -> str:
        """How the values of an answer miss it; empty where they have it."""
        value = values.get(self.name, math.nan)
        if math.isnan(value):
            return f"{self.name} is not known"
        if not self.least <= value <= self.most:
            return f"{self.name} is {value:.4g}"
        off = value / EXACT[self.of](request, self.name) - 1 if self.of else 0.0
        return "" if abs(off) <= self.within else f"{self.name} is {value:.4g}, {100 * off:+.2g} % off"


@dataclass(frozen=True)
class GradedTask:
    """A task; see ``tasks.toml`` for its parts.  says: what is at stake, in one sentence."""

    id: str
    says: str
    scene: str
    run: Text
    choose: Mapping[str, Sequence[float]]
    hidden: Mapping[str, Sequence[Any]]
    needs: tuple[Need, ...]

    def cell(self, chosen: Text, drawn: Text) -> Cell:
        """The run with what is chosen and drawn instead; raises UsageError."""
        settings = {**self.run, **chosen, **drawn}
        options: dict[str, Any] = {key: settings.pop(key) for key in OPTIONS if key in settings}
        if "steps" in options:
            if not options["steps"].isdecimal():
                raise UsageError(f"steps = {options['steps']!r} must be a whole number")
            options["steps"] = int(options["steps"])
        return Cell(self.id, self.scene, options, settings)

    def check(self, chosen: Text) -> None:
        """Raise UsageError for what may not be chosen, or what the scene does not admit."""
        for key, value in chosen.items():
            if key not in self.choose:
                raise UsageError(f"{key[:40]!r} may not be chosen; {', '.join(self.choose)} may")
            among = self.choose[key]
            if among and not all(among[0] <= each <= among[1] for each in _numbers(value)):
                raise UsageError(f"{key} = {value!r} must be in [{among[0]:g}, {among[1]:g}]")
        self.cell(chosen, {}).resolved()

    def beyond(self, drawn: Text) -> str:
        """Why no choice can meet it, at the upper end of each range that may be chosen; empty where one may."""
        if not any(need.limited for need in self.needs):
            return ""
        ends = {key: f"{among[1]:g}" for key, among in self.choose.items() if among}
        _, request = self.cell(ends, drawn).resolved()
        return next(filter(None, (need.beyond(request) for need in self.needs)), "")

    def missed(self, values: Mapping[str, float], request: Request) -> str:
        """What an answer misses; empty where it has all."""
        return next(filter(None, (need.missed(values, request) for need in self.needs)), "")

    def drawn(self, key: bytes) -> list[Text]:
        """The settings of the hidden configurations of a secret."""
        return [self._draw(generator(key, f"task {self.id} {k}")) for k in range(HIDDEN)]

    def _draw(self, rng: np.random.Generator) -> Text:
        def one(among: Sequence[Any]) -> str:
            if isinstance(among[0], str):
                return str(rng.choice(np.array(among)))
            return f"{math.exp(rng.uniform(*np.log(among))):.{DIGITS}g}"

        return {key: one(among) for key, among in self.hidden.items()}

    @property
    def lines(self) -> Iterator[str]:
        """The task for a terminal."""
        yield f"{self.id}: {self.says}"
        yield f"  {self.cell({}, {}).command}"
        choices, hidden = (
            "; ".join(f"{key} {_among(among)}".rstrip() for key, among in each.items())
            for each in (self.choose, self.hidden)
        )
        yield f"  choose {choices}"
        yield f"  hidden {hidden}"
        yield f"  needs {'; '.join(need.text for need in self.needs)}"


def _among(among: Sequence[Any]) -> str:
    """A range or a list of words; empty for all that the scene admits."""
    if among and isinstance(among[0], str):
        return f"of {', '.join(among)}"
    return f"in [{among[0]:g}, {among[1]:g}]" if among else ""


def _numbers(text: str) -> list[float]:
    """The numbers of a text; NaN, which is in no range, for text that is not a number."""
    try:
        return [float(each) for each in text.split(",")]
    except ValueError:
        return [math.nan]


@cache
def tasks() -> Mapping[str, GradedTask]:
    """All tasks by their id."""
    tables = tomllib.loads(FILE.read_text(encoding="utf-8"))
    return {
        name: GradedTask(id=name, needs=tuple(Need(**need) for need in task.pop("needs")), **task)
        for name, task in tables.items()
    }
