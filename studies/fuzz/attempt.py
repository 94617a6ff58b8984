"""A request as plain data, and one solve of it: within a number of evaluations, and what became of it in a word.

Whatever a solve raises is a finding, and so is an end that does not say in one line why.
"""

from __future__ import annotations

import traceback
import warnings
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np

from contact.events import EventKind, PathEnd, events
from contact.problem import Outcome
from contact.verify import EQUILIBRIUM
from contact.verify_friction import CHORD
from studies.ask.request import Request
from studies.ask.scene import Scene, UsageError
from studies.fuzz.values import generator
from studies.scenes.complete import Cell, complete
from studies.solving.certificate import INVERTED
from studies.solving.refinement.adaptive_grids import Family
from studies.solving.result import UNSTABLE, WRONG, Result
from studies.solving.solve import solve

MOST = 8_000  # linearisations of one solve
BARELY, BOUNDS = 0.1, {"equilibrium": EQUILIBRIUM, "direction": CHORD}  # of what the judge allows
CONVERGED, REFUSED, ENDED = "converged", "refused", "ended"


@dataclass(frozen=True)
class Asked:
    """A request as it is asked for; refined: its grid is cut in places, by a choice of the case's number."""

    scene: str
    options: Mapping[str, str] = field(default_factory=dict)
    settings: Mapping[str, str] = field(default_factory=dict)
    refined: bool = False

    @property
    def command(self) -> str:
        """The command that solves it; a grid that is refined by hand has none."""
        cell = Cell("", self.scene, dict(self.options), dict(self.settings))
        return cell.command + (" (refined in places)" if self.refined else "")

    def with_options(self, **options: str) -> Asked:
        """Other options."""
        return replace(self, options={**self.options, **options})

    def with_settings(self, **settings: str) -> Asked:
        """Other settings."""
        return replace(self, settings={**self.settings, **settings})

    def request(self, seed: int) -> tuple[Scene, Request]:
        """Resolved; raises UsageError."""
        options: dict[str, Any] = {**self.options}
        if "steps" in options:
            options["steps"] = int(options["steps"])
        scene, request = complete(self.scene, self.settings, **options)
        return scene, _refined(scene, request, seed) if self.refined else request


def _refined(scene: Scene, request: Request, seed: int) -> Request:
    """The request with a tree over its mesh, where its grid takes one."""
    family, rng = Family.of(scene, request), generator(seed, "leaves")
    if family.tree is None:
        return request
    return family.refined(rng.random(len(family.tree.leaves)) ** 4).asked


class Broken(Exception):  # noqa: N818  it is not an error of the solve, but its verdict
    """A law is broken; law: its name."""

    def __init__(self, law: str, text: str) -> None:
        super().__init__(" ".join(text.split()))
        self.law = law


@dataclass(frozen=True)
class Passed:
    """A case that keeps its laws: what it came to, what it was compared with, and what came of that.

    hard: see :func:`hardness`.
    """

    word: str
    law: str = ""
    said: str = ""
    hard: int = 0


def counter() -> Callable[..., None]:
    """To be called at every linearisation; raises Broken where they do not come to an end."""
    left = MOST

    def count(*_: object) -> None:
        nonlocal left
        left -= 1
        if left < 0:
            raise Broken("ends", f"no end after {MOST} linearisations")

    return count


@dataclass(frozen=True, eq=False)
class Attempt:
    """What one request came to: kind is CONVERGED, REFUSED or ENDED, reason why it is not the first."""

    asked: Asked
    kind: str
    reason: str = ""
    result: Result | None = None

    @property
    def found(self) -> Result:
        """The result of what was solved."""
        assert self.result is not None
        return self.result

    @cached_property
    def word(self) -> str:
        """Kind and, of an end, its cause in a word."""
        if self.kind == CONVERGED:
            return f"{CONVERGED}, {UNSTABLE}" if self.found.verdict == UNSTABLE else CONVERGED
        return self.kind if self.kind != ENDED else f"{ENDED}: {cause(self.found)}"


def cause(result: Result) -> str:
    """Why a path ended before its last point, by what it says of itself and not by its sentence."""
    point = None if result.end is None else result.end.point
    if point is not None and point.end is not None and point.end.kind is not PathEnd.NEITHER:
        return point.end.kind.value
    if any(EventKind.PASSED & event.kind for event in events(result.history[-1:], EventKind.PATH_END)):
        return "through the foundation"
    if result.outcome is Outcome.WRONG:
        return INVERTED
    last = result.cause if result.outcome is Outcome.STEP_LIMIT else result.outcome
    return "beyond the path" if last.converged else last.word  # every step finds a state, but none of the path


def hardness(result: Result | None) -> int:
    """How unusual a way a solve has taken: steps cut, sets that came back, substitutes, an end, a barely kept bound."""
    if result is None or result.unsupported:
        return 0
    unusual = EventKind.STEP_CUT | EventKind.CYCLE | EventKind.SUBSTITUTE
    near = [
        step.certificate["kkt"][name] > BARELY * bound
        for step in result.loads
        for name, bound in BOUNDS.items()
        if name in step.certificate.get("kkt", {})
    ]
    return len(events(result.history, unusual)) + 5 * (result.verdict != CONVERGED) + 5 * any(near)


@contextmanager
def quiet() -> Iterator[None]:
    """Overflows on the way to an end are no news."""
    with warnings.catch_warnings(), np.errstate(all="ignore"):
        warnings.simplefilter("ignore")
        yield


@contextmanager
def no_traceback() -> Iterator[None]:
    """Whatever is raised inside breaks a law: raises Broken."""
    with quiet():
        try:
            yield
        except Broken:
            raise
        except Exception as error:
            raise Broken("no traceback", place(error)) from error


def attempt(asked: Asked, seed: int) -> Attempt:
    """Solve and judge; raises Broken where a law for one solve is broken."""
    with no_traceback():
        try:
            scene, request = asked.request(seed)
            result = solve(scene, request, counter())
        except UsageError as error:
            return Attempt(asked, REFUSED, one_line(str(error)))
        result.as_json()
        for name in result.tables:
            result.table(name)
    if result.unsupported:
        return Attempt(asked, REFUSED, one_line(result.unsupported), result)
    if result.verdict == WRONG and _failures(result) != {INVERTED}:  # no algorithm has lied
        raise Broken("certified", _failed(result))
    if not result.outcome.converged:
        return Attempt(asked, ENDED, one_line(result.reason), result)
    return Attempt(asked, CONVERGED, "", result)


def _failed(result: Result) -> str:
    """The failed conditions, and the numbers of the first load that has any; of a stage without loads the reason."""
    failed = _failures(result)
    if not failed:
        return result.reason
    certificate = next(step.certificate for step in result.loads if step.certificate["failures"])
    numbers = {**certificate["kkt"], **certificate["balances"], "rounding": certificate["rounding"]}
    return f"{', '.join(sorted(failed))}: " + ", ".join(f"{k} {v:.2e}" for k, v in numbers.items())


def _failures(result: Result) -> set[str]:
    """Conditions that fail at any load."""
    return {name for step in result.loads for name in step.certificate["failures"]}


def one_line(text: str) -> str:
    """The reason; raises Broken unless it is one line that says something."""
    if not text.strip() or "\n" in text:
        raise Broken("one clear line", f"an end says {text!r}")
    return text


def place(error: Exception) -> str:
    """The exception, and where in our own sources it was raised."""
    frames = [f for f in traceback.extract_tb(error.__traceback__) if "site-packages" not in f.filename]
    return f"{type(error).__name__} at {Path(frames[-1].filename).name}:{frames[-1].lineno}: {error}"
