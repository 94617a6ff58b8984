"""Judged solves from rest, as a command line asks for them: what an algorithm, or a recommendation, really costs.

What is asked in all of them is a :class:`Question`.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

from contact.catalogue import ALGORITHMS
from studies.ask.request import PartError, Request, UsageError, text_of
from studies.ask.scene import Scene
from studies.scenes.complete import complete
from studies.solving.choosing.clock import Clock, until
from studies.solving.choosing.variants import REFERENCE
from studies.solving.result import SOLVED, Result
from studies.solving.solve import solve

AGREE = 1e-6  # relative, of values of one problem: all algorithms are judged to the same tolerance
REFUSED, SLOWER, NOT_TRIED = "refused", "slower", "not tried"
PATIENCE = 2.0  # times the seconds of the algorithm asked for, after which another is stopped
FROM_REST = 2.0  # seconds of a judged solve over those of a path from a coarser grid
DEFAULTS = {"contact": Request.contact, "newton": Request.newton, "model": Request.model, "steps": Request.steps}


@dataclass(frozen=True, eq=False)
class Question:
    """The scene by its name and with the lines of the reference; given: settings; options: of a request, typed."""

    name: str
    scene: Scene
    given: Mapping[str, object]
    options: Mapping[str, Any]
    error: float

    @property
    def contact(self) -> str:
        """The algorithm asked for."""
        return str(self.options.get("contact", Request.contact))

    def asked(self, mesh: str, options: Mapping[str, Any], settings: Mapping[str, str]) -> tuple[Scene, Request]:
        """The scene and the request as a command line has them, some things changed; raises UsageError."""
        return complete(self.name, {**self.given, **settings}, mesh, **self._options(options))

    def command(self, mesh: str, options: Mapping[str, Any], settings: Mapping[str, str]) -> str:
        """That command line."""
        words = [f"--{key} {value}" for key, value in self._options(options).items() if DEFAULTS.get(key) != value]
        words += [f"--set {key}={text_of(value)}" for key, value in {**self.given, **settings}.items()]
        return " ".join(["footprint solve", self.name, f"--mesh {mesh}", *words, "--out DIR"])

    def _options(self, changed: Mapping[str, Any]) -> dict[str, Any]:
        return {"measure": REFERENCE, **self.options, **changed}


@dataclass(frozen=True)
class Trial:
    """How a solve went: the class of its result, "refused", "slower" or "not tried"; CPU seconds, until stopped."""

    ended: str
    said: str = ""
    seconds: float = 0.0
    iterations: int = 0
    value: float | None = None
    notes: Sequence[str] = ()
    contact: str = ""
    mesh: str = ""

    @property
    def solved(self) -> bool:
        """Whether the judge certifies what was found."""
        return self.ended in SOLVED and self.value is not None

    def agrees(self, other: Trial | None) -> bool | None:
        """Whether both have the same value, to the judge; None where one has none."""
        if other is None or self.value is None or other.value is None:
            return None
        return abs(self.value - other.value) <= AGREE * max(abs(self.value), abs(other.value))


def beside(trial: Trial, trials: Sequence[Trial], contact: str) -> Trial | None:
    """The trial of an algorithm on the mesh of another trial."""
    return next((each for each in trials if (each.contact, each.mesh) == (contact, trial.mesh)), None)


def tried(
    ask: Callable[[], tuple[Scene, Request]], quantity: str, seconds: float, progress: Callable[[str], None]
) -> Trial:
    """The trial of a request, stopped where it takes longer than so many seconds of wall time.

    ask: the scene and the request, whose making counts; its UsageError is a refusal.
    """
    start = time.process_time()

    def run(check: Callable[[str], None]) -> Result:
        def tell(text: str) -> None:
            progress(text)
            check(text)

        return solve(*ask(), tell)

    try:
        result = until(seconds, run)
    except (UsageError, PartError) as error:
        return Trial(REFUSED, str(error))
    spent = time.process_time() - start
    if result is None:
        return Trial(SLOWER, f"stopped after {spent:.2g} s", spent)
    if result.unsupported:
        return Trial(REFUSED, result.unsupported)
    said = "" if result.verdict == SOLVED[0] else str(result.as_json()["reason"])
    iterations = int(result.counters.get("newton_iterations", 0))
    return Trial(result.verdict, said, spent, iterations, result.quantities.get(quantity), result.notes)


def race(
    question: Question,
    quantity: str,
    meshes: Sequence[str],
    foreseen: float,
    clock: Clock,
    progress: Callable[[str], None],
) -> list[Trial]:
    """Every algorithm from rest on the first mesh, a coarse one, and then on the second, in the order of their seconds.

    One that takes PATIENCE times as long as the one asked for is stopped, for it is not what is looked for. The grid
    lines are those of the reference.  foreseen: seconds of the algorithm asked for on the second mesh.
    """
    own, (coarse, mesh) = question.contact, meshes

    def trial(name: str, mesh: str, seconds: float) -> Trial:
        progress(f"algorithm {name} {mesh}")
        ask = lambda: (question.scene, question.asked(mesh, {"contact": name}, {})[1])  # noqa: E731
        return replace(tried(ask, quantity, seconds, progress), contact=name, mesh=mesh)

    if not clock.fits(foreseen * min(1.0, len(ALGORITHMS) / 4)):
        return [Trial(NOT_TRIED, "no time", contact=name, mesh=mesh) for name in ALGORITHMS]
    heats = {own: trial(own, coarse, clock.left)}
    base = max(heats[own].seconds, 1e-9)
    for name in ALGORITHMS:
        heats[name] = heats.get(name) or trial(name, coarse, min(PATIENCE * base * clock.wait, clock.left))
    found = {}
    for name in sorted(heats, key=lambda name: (name != own, heats[name].seconds, name)):
        if coarse == mesh or heats[name].ended == REFUSED:
            continue
        expected = foreseen * min(heats[name].seconds / base, PATIENCE)
        if not clock.fits(expected):
            found[name] = Trial(NOT_TRIED, "no time", contact=name, mesh=mesh)
            continue
        found[name] = trial(name, mesh, clock.left if name == own else PATIENCE * foreseen * clock.wait)
        if name == own:
            foreseen = found[name].seconds
    return [*heats.values(), *found.values()]
