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

from contact.continuation.candidates import State
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

Values = dict[str, float]  # {quantity: value or derivative} at the end of a path


@dataclass(frozen=True, eq=False)
class Passed:
    """A state of a path that is differentiated: at the parameter t, with the state before it and its parameter.

    share: of the way from target to target, by which t moves with them.  ends: whether its stage ends here.
    """

    stage: Stage
    problem: ContactProblem
    state: ContactSolution
    t: float
    before: State
    index: int
    share: float
    ends: bool


@dataclass(frozen=True, eq=False)
class Path:
    """The states of a result: where its stages end; with friction, which remembers, those on the way, too."""

    result: Result

    @cached_property
    def states(self) -> list[Passed]:
        """In their order."""
        return [each for visited in self.result.visits for each in _states(visited, self.result.epsilon)]

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
        slopes: Values = {}
        for passed, sensitivity in zip(self.states, self.sensitivities, strict=True):
            change = Change.between([each.posed(passed) for each in sides], passed.state, by)
            rates = sensitivity.rates(change)[side]
            readings = [each.seen(passed, rates, k * by) for k, each in zip(OFFSETS, sides, strict=True)]
            slopes |= {name: slope([each[name] for each in readings], by) for name in readings[0]}
        return slopes | self._of_limits(sides, by)

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
        return {name: (after[name] - value) / step for name, value in before.items() if by_state[name] == value}


def _states(visited: Visited, epsilon: float) -> Iterator[Passed]:
    """Those of a visit that matter to the end of the path."""
    stage, targets = visited.stage, visited.stage.targets
    if visited.trace is not None:
        last = min(visited.trace.points[1:], key=lambda point: abs(point.factor - targets[-1]))
        here = visited.problem_at(targets[-1]), last.state, targets[-1], (0.0, visited.before)
        yield Passed(stage, *here, len(targets) - 1, 1.0, ends=True)
        return
    rubs = visited.problem.coulomb is not None
    if not (rubs or visited.ends_stage):
        return
    index, substeps = visited.index, visited.point.way
    begun, end = targets[index - 1] if index else 0.0, targets[index]
    pairs = list(pairwise(substeps)) or [(substeps[0], substeps[0])]
    for (t0, before), (t, state) in pairs if rubs else pairs[-1:]:
        problem = visited.problem_at(t)
        if problem.coulomb is not None:
            problem = problem.since(anchors_left(problem, visited.problem_at(t0), before, epsilon))
        share = (t - begun) / (end - begun) if end != begun else 1.0
        yield Passed(stage, problem, state, t, (t0, before), index, share, visited.ends_stage and t == end)


@dataclass
class Side:
    """The path of the same scene a little aside: its states are those of the path, moved by their rates.

    last: the state before the next one, in the unknowns of its stage, and the problem that it solves.  headlines: of
    the stages so far.
    """

    scene: Scene
    request: Request
    stage: Stage | None = None
    problem_at: Callable[[float], ContactProblem] | None = None
    last: ContactSolution | None = None
    problem: ContactProblem | None = None
    of: Stage | None = None
    headlines: Values = field(default_factory=dict)
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
        if not passed.ends:
            return {}
        observation = stage.observe(problem, state, self._parameter(passed))
        self.headlines |= _measured(observation.quantities)
        return self.headlines | _measured(dict(list((observation.step or {}).items())[1:]))

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


def _measured(values: Mapping[str, Any]) -> dict[str, float]:
    return {name: value for name, value in values.items() if isinstance(value, float) and name not in COUNTS}
