"""Judged solves from rest, as a command line asks for them: what an algorithm, or a recommendation, really costs."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass

from contact.catalogue import ALGORITHMS
from studies.choosing.clock import Clock, until
from studies.choosing.question import Question
from studies.request import PartError, Request, UsageError
from studies.result import SOLVED, Result
from studies.scene import Scene
from studies.solving import solve

AGREE = 1e-6  # relative, of values of one problem: all algorithms are judged to the same tolerance
REFUSED, SLOWER, NOT_TRIED = "refused", "slower", "not tried"
PATIENCE = 2.0  # times the seconds of the algorithm asked for, after which another is stopped
FROM_REST = 2.5  # seconds of a judged solve over those of a path from a coarser grid


@dataclass(frozen=True)
class Trial:
    """How a solve went: the class of its result, "refused", "slower" or "not tried"; CPU seconds, until stopped."""

    ended: str
    said: str = ""
    seconds: float = 0.0
    iterations: int = 0
    value: float | None = None
    notes: Sequence[str] = ()

    @property
    def solved(self) -> bool:
        """Whether the judge certifies what was found."""
        return self.ended in SOLVED and self.value is not None

    def agrees(self, other: Trial) -> bool | None:
        """Whether both have the same value, to the judge; None where one has none."""
        if self.value is None or other.value is None:
            return None
        return abs(self.value - other.value) <= AGREE * max(abs(self.value), abs(other.value))


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
    meshes: tuple[str, str],
    foreseen: float,
    clock: Clock,
    progress: Callable[[str], None],
) -> dict[str, Trial]:
    """Every algorithm from rest on the second mesh, in the order of what they take on the first, a coarse one.

    The one asked for comes first; one that takes PATIENCE times as long is stopped, for it is not what is looked for.
    The grid lines are those of the reference.  foreseen: seconds of the algorithm asked for.
    """

    def trial(name: str, mesh: str, seconds: float) -> Trial:
        progress(f"algorithm {name} {mesh}")
        ask = lambda: (question.scene, question.asked(mesh, {"contact": name}, {})[1])  # noqa: E731
        return tried(ask, quantity, seconds, progress)

    coarse, mesh = meshes
    own = question.contact
    if not clock.fits(foreseen):
        return {name: Trial(NOT_TRIED, f"no time on {mesh}") for name in ALGORITHMS}
    found = {own: trial(own, mesh, clock.left)}
    if not found[own].solved:
        return found
    base = found[own].seconds
    heats = {name: trial(name, coarse, min(base * clock.wait, clock.left)) for name in ALGORITHMS}
    for name in sorted(heats.keys() - {own}, key=lambda name: (heats[name].seconds, name)):
        if heats[name].ended == REFUSED:
            found[name] = heats[name]
            continue
        times = min(heats[name].seconds / max(heats[own].seconds, 1e-9), PATIENCE)
        if not clock.fits(base * times):
            found[name] = Trial(NOT_TRIED, f"no time on {mesh}")
        else:
            found[name] = trial(name, mesh, min(clock.left, PATIENCE * base * clock.wait))
    return found
