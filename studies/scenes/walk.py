"""The one walk over the stages of a scene and their requested points; solving and every experiment go along it.

What is recorded of a point, judged or concluded does not enter here.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache, partial
from typing import TYPE_CHECKING

import numpy as np

from contact.algorithms.base import unsupported
from contact.continuation.candidates import Starts, none_known
from contact.continuation.load_stepping import SMALLEST, PathPoint, follow
from contact.events import Event, EventKind
from contact.problem import ContactAlgorithm, ContactProblem, ContactSolution, Outcome
from studies.ask.model import CurveStage, SceneModel, Stage, moved

if TYPE_CHECKING:
    from contact.continuation.arc_length import Trace
    from contact.swept import Crossing

ENDS = 2  # of a step: both its problems are needed repeatedly, to solve and to observe


@dataclass(frozen=True, eq=False)
class Visited:
    """A requested point of a stage, or the end of its path before it.

    before: the state that the path came from, in the stage's unknowns.  index: of the point among the targets of the
    stage, which may repeat a value.  trace: of a curve by arc length, of which ``point`` is the end.
    """

    stage: Stage
    problem_at: Callable[[float], ContactProblem]
    before: ContactSolution
    point: PathPoint
    index: int
    trace: Trace | None = None

    @cached_property
    def problem(self) -> ContactProblem:
        """The problem at the requested point."""
        return self.problem_at(self.point.requested)

    @cached_property
    def passed(self) -> list[Crossing]:
        """Candidates that come here from the point before through the foundation."""
        if self.problem.standing is None:
            return []
        from contact.swept import crossings_along  # loaded with a foundation alone

        return crossings_along((self.problem_at(t).standing, state.u) for t, state in self.point.way)

    @property
    def last_accepted(self) -> tuple[ContactProblem, ContactSolution]:
        """The state of the path before this one, and its problem: what friction counts its slip from.

        The state itself where nothing had to move: the requested point is where the path begins.
        """
        t, state = self.point.way[-2:][0]
        return self.problem_at(t), state

    @property
    def converged(self) -> bool:
        """Whether the point was reached."""
        return self.point.outcome.converged

    @property
    def state(self) -> ContactSolution:
        """The solution in the unknowns of the model."""
        return self.stage.lifted(self.point.solution)

    @property
    def ends_stage(self) -> bool:
        """Whether this is the last point of its stage."""
        return self.index == len(self.stage.targets) - 1

    @property
    def said(self) -> str:
        """The last event of the history: why the path ends where it does not converge."""
        history = self.point.solution.history
        return str(history[-1].get("event", "")) if history else ""


def no_starts(stage: Stage) -> Starts:
    """Every step of a stage sets out from the last state of the path."""
    return none_known


@dataclass(frozen=True, eq=False)
class Seen:
    """A state at a requested load, in the unknowns of the model: name and size of the load, t of its stage."""

    load: tuple[str, float]
    t: float
    problem_at: Callable[[float], ContactProblem]
    state: ContactSolution

    def gap(self) -> np.ndarray:
        """Of the candidates (m,) [mm]."""
        problem = self.problem_at(self.t)
        return problem.gap(self.state.u) if len(problem.weights) else np.zeros(0)


def shown(model: SceneModel, seen: Seen | None) -> SceneModel:
    """The model with its supports where they are in a state."""
    return model if seen is None else moved(model, seen.t)


def state_of(model: SceneModel, seen: Seen | None) -> ContactSolution:
    """A state, or that at rest."""
    return ContactSolution.at_rest(model.n_unknowns, 0) if seen is None else seen.state


def walk(
    stages: Iterable[Stage],
    algorithm: ContactAlgorithm,
    steps: int = 1,
    previous: ContactSolution | None = None,
    tell: Callable[[str, float], None] = lambda stage, reached: None,
    smallest: float = SMALLEST,
    starts: Callable[[Stage], Starts] = no_starts,
) -> Iterator[Visited]:
    """Every requested point of every stage, in order; the first that is not converged is the last.

    previous: the state before the first stage, in the unknowns of the model.  A stage whose problem the algorithm does
    not support is a point with the outcome REFUSED.  steps, smallest: as for :func:`follow`.  starts: of the steps
    of a stage, from elsewhere.  tell(stage, t): before every linearisation at t, of a curve at its points; what it
    raises ends the walk.
    """
    for stage in stages:
        made, before = stage.begin(previous)
        problem_at = lru_cache(ENDS)(made)
        if isinstance(stage, CurveStage):
            trace = stage.trace((problem_at, before), algorithm, partial(tell, stage.name))
            last, count = trace.points[-1], len(trace.points) - 1
            end = replace(last.state, counters=trace.counters, history=tuple(trace.history))
            point = PathPoint(stage.targets[-1], last.factor, trace.outcome, end, count)
            visited = Visited(stage, problem_at, before, point, len(stage.targets) - 1, trace)
            yield visited
        else:
            first = problem_at(stage.targets[0])
            refused = first.unfit_for_friction or unsupported(algorithm, first)
            if refused is not None:
                unchanged = replace(before, counters={}, history=({"event": Event(EventKind.FAILED, refused)},))
                point = PathPoint(stage.targets[0], 0.0, Outcome.REFUSED, unchanged, 0)
                yield Visited(stage, problem_at, before, point, 0)
                return
            watched = _watched(problem_at, partial(tell, stage.name))
            how = steps, smallest, starts(stage)
            for index, point in enumerate(follow(watched, 0.0, stage.targets, algorithm, before, *how)):
                visited = Visited(stage, problem_at, before, point, index)
                yield visited
                before = point.solution
        if not visited.converged:
            return
        previous = visited.state


def _watched(
    problem_at: Callable[[float], ContactProblem], tell: Callable[[float], None]
) -> Callable[[float], ContactProblem]:
    return lru_cache(ENDS)(lambda t: problem_at(t).watched(partial(tell, t)))
