"""The states of a solved path and of the same path with a setting a little less and more, side by side.

A side is never solved: its states are those of the path, moved by their rates (:mod:`contact.sensitivity`). What a
stage takes from the one before, as the first touch of an inflated body, and the anchors that friction remembers from
step to step, move with them. What is differentiated, and how it is reported, does not enter here.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from itertools import pairwise
from typing import Any

import numpy as np

from contact.continuation.critical_points import State
from contact.problem import ContactProblem, ContactSolution
from contact.sensitivity import OFFSETS, Change, Fold, Rates, Sensitivity, slope
from contact.slip import anchors_left, stretched
from studies.ask.request import Request
from studies.ask.scene import CurveStage, Scene, Stage
from studies.ask.settings import configured
from studies.scenes.walk import Visited
from studies.solving.derivatives.beside import changed, width_of
from studies.solving.result import COUNTS, Result
from studies.solving.solve import stages_of

Values = dict[tuple[int | None, str], float]  # {(load, or None of the whole path; quantity): value or derivative}


@dataclass(frozen=True, eq=False)
class Passed:
    """A state of a path that is differentiated: at the parameter t, with the state before it and its parameter.

    load: the requested load that it is, None on the way to one.  share: of the way from target to target, by which t
    moves with them.
    """

    stage: Stage
    problem: ContactProblem
    state: ContactSolution
    t: float
    before: State
    index: int
    share: float
    load: int | None


@dataclass(frozen=True, eq=False)
class Path:
    """The states of a result: of every requested point; with friction those on the way, too."""

    result: Result

    @cached_property
    def states(self) -> list[Passed]:
        """In their order."""
        found, count, index = list[Passed](), 0, 0
        for visited in self.result.visits:
            index = index + 1 if found and found[-1].stage is visited.stage else 0
            there = list(_states(visited, index, count, self.result.epsilon))
            found += there
            if visited.trace is not None:
                count += len(visited.stage.targets)
            elif visited.stage.observe(there[-1].problem, there[-1].state, there[-1].t).step is not None:
                count += 1
        return found

    @cached_property
    def sensitivities(self) -> list[Sensitivity]:
        """Of the states: one factorisation each, for all settings."""
        return [Sensitivity(each.problem, each.state, self.result.epsilon) for each in self.states]

    @property
    def one_sided(self) -> bool:
        """Whether candidates touch without pressure, so that settings that grow and shrink have other derivatives."""
        return any(each.one_sided for each in self.sensitivities)

    def derivatives(self, scene: Scene, key: str, side: int) -> Values:
        """Of all that is read off with a setting, of rates on this side of it."""
        request = self.result.request
        by = width_of(scene, request, key)
        sides = [Side(scene, changed(scene, request, key, k * by)) for k in OFFSETS]
        found: Values = {}
        for passed, sensitivity in zip(self.states, self.sensitivities, strict=True):
            change = Change.between([each.posed(passed) for each in sides], passed.state, by)
            rates = sensitivity.rates(change)[side]
            seen = [each.seen(passed, rates, k * by) for k, each in zip(OFFSETS, sides, strict=True)]
            found |= {name: slope([each[name] for each in seen], by) for name in seen[0]}
        return found | self._of_limits(sides, by)

    @cached_property
    def _folds(self) -> dict[int, Fold]:
        """Of the limit points of a traced curve, by their place in it."""
        end = self.result.end
        if end is None or end.trace is None:
            return {}
        limits = {k: each for k, each in enumerate(end.trace.points) if each.limit}
        eps = self.result.epsilon
        return {k: Fold(end.problem_at, each.factor, each.state, eps) for k, each in limits.items()}

    def _of_limits(self, sides: Sequence[Side], step: float) -> Values:
        """Of the headline values of a curve that depend on the loads of its limit points alone."""
        end = self.result.end
        if not self._folds or end is None or end.trace is None:
            return {}
        stage, points = end.stage, list(end.trace.points)
        assert isinstance(stage, CurveStage)
        before = _measured(stage.summarise(points))
        moved, turned = list(points), list(points)
        for k, fold in self._folds.items():
            at = points[k]
            beside = [each.at(at.factor) for each in sides]
            changes = [Change.between(beside, mode.state, step) for mode in fold.modes]
            moved[k] = replace(at, factor=at.factor + step * fold.rate(changes))
            turned[k] = replace(at, u=2 * at.u)  # a value that changes with the state is not of the load alone
        by_state = _measured(stage.summarise(turned))
        after = _measured(stage.summarise(moved))
        return {(None, name): (after[name] - value) / step for name, value in before.items() if by_state[name] == value}


def _states(visited: Visited, index: int, load: int, epsilon: float) -> Iterator[Passed]:
    """Those of a visit, whose first requested load this is; the targets of a traced curve are all in one."""
    stage, targets = visited.stage, visited.stage.targets
    if visited.trace is not None:
        points = visited.trace.points
        for k, target in enumerate(targets):
            at = min(range(1, len(points)), key=lambda i: abs(points[i].factor - target))
            here = points[at].state, target, (0.0, visited.before), k, 1.0, load + k
            yield Passed(stage, visited.problem_at(target), *here)
        return
    way, begun, end = visited.point.way, targets[index - 1] if index else 0.0, targets[index]
    pairs = list(pairwise(way)) or [(way[0], way[0])]
    if visited.problem.coulomb is None:
        pairs = pairs[-1:]
    for (t0, before), (t, state) in pairs:
        problem, last = visited.problem_at(t), t == end
        if problem.coulomb is not None:
            problem = problem.since(anchors_left(problem, visited.problem_at(t0), before, epsilon))
        share = (t - begun) / (end - begun) if end != begun else 1.0
        yield Passed(stage, problem, state, t, (t0, before), index, share, load if last else None)


@dataclass
class Side:
    """The path of the same scene a little aside: its states are those of the path, moved by their rates.

    last: the state before the next one, in the unknowns of its stage, and the problem that it solves.
    """

    scene: Scene
    request: Request
    stage: Stage | None = None
    problem_at: Callable[[float], ContactProblem] | None = None
    last: ContactSolution | None = None
    problem: ContactProblem | None = None
    of: Stage | None = None
    _stages: Iterator[Stage] = field(init=False, repr=False)

    def __post_init__(self) -> None:
        self.epsilon = configured(self.request.contact, self.request.settings).epsilon
        self._stages = iter(stages_of(self.scene.build(self.request), self.request))

    def posed(self, passed: Passed) -> tuple[ContactProblem, float]:
        """The problem of a state here, its slips counted from the state before it as it is here."""
        if passed.stage is not self.of:
            previous = None if self.stage is None or self.last is None else self.stage.lifted(self.last)
            self.of, self.stage = passed.stage, next(self._stages)
            self.problem_at, self.last = self.stage.begin(previous)
            self.problem = self.problem_at(passed.before[0])
        assert self.problem_at is not None
        assert self.last is not None
        assert self.problem is not None
        problem = self.problem_at(self._parameter(passed))
        if problem.coulomb is not None:
            problem = problem.since(anchors_left(problem, self.problem, self.last, self.epsilon))
        self.problem = problem
        return problem, self.epsilon

    def at(self, t: float) -> tuple[ContactProblem, float]:
        """The problem of its stage at a parameter."""
        assert self.problem_at is not None
        return self.problem_at(t), self.epsilon

    def seen(self, passed: Passed, rates: Rates, by: float) -> Values:
        """What is read off the state here, once it has moved."""
        state, problem, stage = rates.moved(passed.state, by), self.problem, self.stage
        assert problem is not None
        assert stage is not None
        self.last = state = self._remembered(problem, state)
        if passed.share != 1.0:
            return {}
        seen = stage.observe(problem, state, self._parameter(passed))
        found: Values = {(None, name): value for name, value in _measured(seen.quantities).items()}
        step = dict(list((seen.step or {}).items())[1:])
        return found | {(passed.load, name): value for name, value in _measured(step).items()}

    def _remembered(self, problem: ContactProblem, state: ContactSolution) -> ContactSolution:
        """With the anchors and the dissipation of the path here."""
        law, friction = problem.coulomb, state.friction
        if law is None or law.sliding is None or friction is None or self.last is None:
            return state
        before = 0.0 if self.last.friction is None else self.last.friction.dissipation
        lost = -np.sum(friction.force * (law.slip(state.u) - stretched(problem, friction.force, self.epsilon)))
        return replace(state, friction=replace(friction, since=law.sliding.anchors, dissipation=before + float(lost)))

    def _parameter(self, passed: Passed) -> float:
        assert self.stage is not None
        targets = self.stage.targets
        begun = targets[passed.index - 1] if passed.index else 0.0
        return begun + passed.share * (targets[passed.index] - begun)


def _measured(seen: Mapping[str, Any]) -> dict[str, float]:
    return {name: value for name, value in seen.items() if isinstance(value, float) and name not in COUNTS}
