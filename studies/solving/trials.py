"""Judged solves from rest in a budget of wall time: what an algorithm, or a recommendation, really costs.

They are asked for as a command line has them, by a :class:`Question`. The budget is handed on in shares: no work begins
that is foreseen not to fit.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from typing import Any

from contact.catalogue import ALGORITHMS
from studies.ask.request import PartError, Request, UsageError, text_of
from studies.ask.scene import EPSILON, Scene
from studies.scenes.complete import complete
from studies.scenes.plugins import use_options
from studies.solving.result import SOLVED, Result
from studies.solving.solve import Interrupted, Late, solve
from studies.solving.variants import REFERENCE

AGREE = 1e-6  # relative, of values of one problem: all algorithms are judged to the same tolerance
REFUSED, SLOWER, NOT_TRIED = "refused", "slower", "not tried"
PATIENCE = 2.0  # times the seconds of the algorithm asked for, after which another is stopped
FROM_REST = 2.0  # seconds of a judged solve over those of a path from a coarser grid
DEFAULTS = {"contact": Request.contact, "newton": Request.newton, "model": Request.model, "steps": Request.steps}


@dataclass
class Clock:
    """Seconds of wall time from when it is made; ``until``: what may be spent for now.

    now, work: wall time and CPU time [s]. What is foreseen is CPU time; a machine that others use takes longer.
    """

    budget: float
    now: Callable[[], float] = time.perf_counter
    work: Callable[[], float] = time.process_time

    def __post_init__(self) -> None:
        self._start, self._worked = self.now(), self.work()
        self.until = self.budget

    @property
    def spent(self) -> float:
        """Seconds so far."""
        return self.now() - self._start

    @property
    def left(self) -> float:
        """Seconds that may be spent for now."""
        return self.until - self.spent

    @property
    def wait(self) -> float:
        """Wall time over CPU time so far, at least 1."""
        return max(1.0, self.spent / max(self.work() - self._worked, 0.1))

    @contextmanager
    def share(self, part: float, kept: float = 0.0) -> Iterator[None]:
        """Inside, a part of what is left of the budget may be spent, ``kept`` seconds of it aside."""
        before, self.until = self.until, self.spent + part * max(self.budget - kept - self.spent, 0.0)
        try:
            yield
        finally:
            self.until = before

    def fits(self, foreseen: float) -> bool:
        """Whether there is time for so many CPU seconds."""
        return foreseen * self.wait <= self.left


def until(seconds: float, solve: Callable[[Callable[[str], None]], Result]) -> Result | None:
    """What is solved, given a ``progress`` to call; None where it takes longer than so many seconds."""
    end, late = time.perf_counter() + seconds, False

    def check(text: str) -> None:
        nonlocal late
        if time.perf_counter() > end:
            late = True
            raise Late

    try:
        return solve(check)
    except Interrupted:
        if not late:
            raise
        return None


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
        arguments = [f"--{key} {value}" for key, value in self._options(options).items() if DEFAULTS.get(key) != value]
        arguments += [f"--set {key}={text_of(value)}" for key, value in {**self.given, **settings}.items()]
        return " ".join(["footprint solve", self.name, f"--mesh {mesh}", *arguments, *use_options(), "--out DIR"])

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
    epsilon: float | None = None  # of its contact condition, if it has one
    contact: str = ""
    mesh: str = ""

    @property
    def solved(self) -> bool:
        """Whether the judge certifies the answer."""
        return self.ended in SOLVED and self.value is not None

    def against(self, other: Trial | None) -> str:
        """What was said of it, or that its contact condition is another one, where that is why it does not agree."""
        if self.said or other is None or self.agrees(other) is not False or self.epsilon == other.epsilon:
            return self.said
        return f"its epsilon is {self.epsilon:g}, that of {other.contact} {other.epsilon:g}"

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
    why = "" if result.verdict == SOLVED[0] else str(result.as_json()["reason"])
    iterations = int(result.counters.get("newton_iterations", 0))
    value, epsilon = result.quantities.get(quantity), result.request.settings.get(EPSILON.key)
    known = epsilon if isinstance(epsilon, float) else None
    return Trial(result.verdict, why, spent, iterations, value, result.notes, known)


def race(
    question: Question,
    quantity: str,
    meshes: Sequence[str],
    foreseen: float,
    clock: Clock,
    progress: Callable[[str], None],
) -> list[Trial]:
    """Every algorithm from rest on the first mesh, a coarse one, and then on the second, in the order of their seconds.

    One that takes PATIENCE times as long as the one asked for is stopped, for it is not what is looked for; where there
    is no time for so long none begins, for nobody would know which is slower. The grid lines are those of the
    reference.  foreseen: seconds of the algorithm asked for on the second mesh.
    """
    requested, (coarse, mesh) = question.contact, meshes

    def trial(name: str, mesh: str, seconds: float) -> Trial:
        progress(f"algorithm {name} {mesh}")
        ask = lambda: (question.scene, question.asked(mesh, {"contact": name}, {})[1])  # noqa: E731
        found = tried(ask, quantity, seconds, progress)
        late = found.ended == SLOWER and name == requested  # nothing is slower than itself: the time is over
        return replace(found, ended=NOT_TRIED if late else found.ended, contact=name, mesh=mesh)

    def waits(name: str, mesh: str) -> Trial:
        return Trial(NOT_TRIED, "no time", contact=name, mesh=mesh)

    if not clock.fits(foreseen * min(1.0, len(ALGORITHMS) / 4)):
        return [waits(name, mesh) for name in ALGORITHMS]
    heats = {requested: trial(requested, coarse, clock.left)}
    base = max(heats[requested].seconds, 1e-9)
    for name in ALGORITHMS:
        if name != requested:
            patient = clock.fits(PATIENCE * base)
            heats[name] = trial(name, coarse, PATIENCE * base * clock.wait) if patient else waits(name, coarse)
    finals = {}
    pace = {name: PATIENCE if each.ended == NOT_TRIED else each.seconds / base for name, each in heats.items()}
    for name in sorted(heats, key=lambda name: (name != requested, pace[name], name)):
        if coarse == mesh or heats[name].ended == REFUSED:
            continue
        if not clock.fits(foreseen * min(pace[name], PATIENCE)):
            finals[name] = waits(name, mesh)
            continue
        finals[name] = trial(name, mesh, clock.left if name == requested else PATIENCE * foreseen * clock.wait)
        if name == requested:
            foreseen = finals[name].seconds
    return [*heats.values(), *finals.values()]
