"""What a change of any continuous setting does to every quantity of a solved path: derivatives, state by state.

The scene is built with the setting a little less and a little more, on the same grid; what that changes of residuals,
gaps and slips at the states of the path, while these are held, is the load of one linear solve each
(:mod:`contact.sensitivity`). No solution is differenced. What a stage takes from the one before, as the first touch of
an inflated body, and the anchors that friction remembers from step to step, move with it. Derivatives are of the answer
on its grid, the other settings held. That they are right is the business of :mod:`studies.solving.taylor`.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from itertools import pairwise
from typing import Any

import numpy as np

from contact.continuation.critical_points import State
from contact.problem import ContactProblem, ContactSolution
from contact.sensitivity import Change, Fold, Rates, Sensitivity
from contact.slip import anchors_left, stretched
from contact.solvers.lcp_pivoting import LcpError
from contact.solvers.sparse import SingularMatrixError
from studies.ask.request import Request, UsageError, Value
from studies.ask.scene import CurveStage, Scene, Setting, SettlingScene, Stage, settings_beside
from studies.ask.settings import TOLERANCE, configured
from studies.output.atomic import Table
from studies.output.terminal import columns
from studies.scenes.walk import Visited
from studies.solving.refinement.grids import AdaptedScene
from studies.solving.result import COUNTS, Result
from studies.solving.solve import stages_of

STEP = (
    2.0**-19
)  # of a setting, to each side: truncation 1e-11, rounding 1e-10 of the forces (measured: the least of both)
TURN = 30.0  # deg: an angle near zero is no small one
TABLE = "gradients"
CONTINUOUS = ("float", "floats", "path")
GROWS, SHRINKS = 0, 1  # the side of a setting that one-sided derivatives are of
Values = dict[tuple[int | None, str], float]  # {(load, or None of the whole path; quantity): value or derivative}


@dataclass(frozen=True)
class Derivative:
    """dJ/ds of a quantity J at a requested load, None for a headline of an earlier stage.

    below, above: of a setting that shrinks and grows; they differ where candidates touch without pressure.
    """

    load: int | None
    quantity: str
    setting: str
    value: float
    setting_value: float
    below: float
    above: float

    @property
    def relative(self) -> float | None:
        """(dJ/J)/(ds/s): per cent for a per cent; None where one of them is zero, or sides differ."""
        if self.value == 0 or self.setting_value == 0 or self.below != self.above:
            return None
        return self.above * self.setting_value / self.value

    @property
    def row(self) -> dict[str, Any]:
        """As plain data."""
        named = {"load": self.load, "quantity": self.quantity, "setting": self.setting, "value": self.value}
        return {**named, "below": self.below, "above": self.above, "relative": self.relative}


def parse_gradient(text: str, scene: Scene, request: Request) -> tuple[str, tuple[str, ...]]:
    """Quantity and settings of "QUANTITY:KEY,KEY", all continuous settings of the request for QUANTITY alone.

    Raises UsageError for a setting that the request does not have, or that is not continuous.
    """
    quantity, _, keys = text.partition(":")
    if not quantity:
        raise UsageError(f"--gradient {text!r} must be QUANTITY or QUANTITY:KEY,KEY")
    return quantity, differentiable(scene, request, [key for key in keys.split(",") if key])


def differentiable(scene: Scene, request: Request, keys: Sequence[str] = ()) -> tuple[str, ...]:
    """The keys, by default all settings of the request that have a derivative; raises UsageError for one without."""
    known = {each.key: each for each in (*scene.settings, *settings_beside(scene)) if each.key != TOLERANCE.key}
    every = tuple(key for key, each in known.items() if key in request.settings and _varies(each, request))
    for key in keys:
        if key not in known:
            raise UsageError(f"{key} is no setting of {scene.name} that could change; those are {', '.join(every)}")
        if key not in every:
            why = "has no value here" if key not in request.settings else "is not continuous"
            raise UsageError(f"{key} {why}: there is no derivative; there is for {', '.join(every)}")
    return tuple(keys) or every


def _varies(setting: Setting, request: Request) -> bool:
    return setting.kind in CONTINUOUS and all(map(math.isfinite, _numbers(request.settings[setting.key])))


def _numbers(value: Value) -> tuple[float, ...]:
    return value if isinstance(value, tuple) else (float(value),)


def width_of(scene: Scene, request: Request, key: str, share: float = STEP) -> float:
    """A small change of a setting: a share of its value, less where it is close to a limit that it cannot have."""
    values = _numbers(request.settings[key])
    size = max(map(abs, values))
    size = max(size, TURN) if key.endswith("_deg") else size or 1.0
    setting = next(each for each in (*scene.settings, *settings_beside(scene)) if each.key == key)
    limits = [end for end, is_open in ((setting.low, setting.open_low), (setting.high, setting.open_high)) if is_open]
    ways = [abs(value - end) for value in values for end in limits if math.isfinite(end)]
    return share * math.sqrt(size * min([size, *ways]))


def changed(scene: Scene, request: Request, key: str, by: float) -> Request:
    """The request with a setting changed, each of its values where it has several.

    Raises UsageError where its model is valid without the change alone, as a quarter of a tyre whose cords are not
    turned.
    """
    value = request.settings[key]
    moved: Value = tuple(each + by for each in value) if isinstance(value, tuple) else float(value) + by
    beside = replace(request, settings=request.settings.with_values(**{key: moved}))
    return scene.settle(beside) if isinstance(scene, SettlingScene) else beside


def frozen(scene: Scene, request: Request) -> Scene:
    """The scene with the grid of the request, whatever its settings come to."""
    if isinstance(scene, AdaptedScene) and request.settings.get("grading") == "adapted":
        return scene.adapted(request)
    return scene


def values_of(result: Result) -> Values:
    """What is differentiated."""
    steps, end = result.loads, result.end
    if end is not None and end.trace is not None:  # of a curve what was asked for, as many as it had points in between
        steps = [step for step in steps if next(iter(step.load.values())) in end.stage.targets]
    loads = ((i, step.quantities) for i, step in enumerate(steps))
    found: Values = {(i, name): value for i, seen in loads for name, value in seen.items()}
    return found | {(None, name): value for name, value in result.quantities.items()}


def of_quantities(
    scene: Scene,
    result: Result,
    asked: Sequence[tuple[str, Sequence[str]]],
    progress: Callable[[str], None] = lambda text: None,
) -> list[Derivative]:
    """Those of each quantity with its settings; raises UsageError for a quantity that is not there, too."""
    has = {name for _, name in values_of(result)}
    for quantity, _ in asked:
        if quantity not in has:
            raise UsageError(f"--gradient {quantity}: there is no such quantity; there are {', '.join(sorted(has))}")
    found = gradients(scene, result, list(dict.fromkeys(key for _, keys in asked for key in keys)), progress)
    wanted = {(quantity, key) for quantity, keys in asked for key in keys}
    return [each for each in found if (each.quantity, each.setting) in wanted]


def gradients(
    scene: Scene, result: Result, keys: Sequence[str], progress: Callable[[str], None] = lambda text: None
) -> list[Derivative]:
    """Of all quantities of a solved path with these settings.

    Where there is none, as at a limit point, or where the scene cannot be built beside the settings, the result has a
    remark. Raises UsageError where the path has not come to its end.
    """
    if not result.outcome.converged:
        raise UsageError(f"no derivatives without a converged answer: {result.reason or result.outcome.value}")
    scene, path, found = frozen(scene, result.request), Path(result), list[Derivative]()
    seen = values_of(result)
    for key in keys:
        progress(f"derivatives with {key}")
        try:
            above = path.derivatives(scene, key, GROWS)
            below = path.derivatives(scene, key, SHRINKS) if path.one_sided else above
        except (SingularMatrixError, LcpError, ValueError) as error:
            result.remarks.append(f"no derivative with {key}: {error}")
            continue
        at = _numbers(result.request.settings[key])[-1]
        found += [Derivative(*name, key, seen[name], at, below[name], above[name]) for name in above if name in seen]
    return found


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
        low, high = (Side(scene, changed(scene, request, key, sign * by)) for sign in (-1, 1))
        found: Values = {}
        for passed, sensitivity in zip(self.states, self.sensitivities, strict=True):
            change = Change.between(low.posed(passed), high.posed(passed), passed.state, 2 * by)
            rates = sensitivity.rates(change)[side]
            seen = [each.seen(passed, rates, move) for each, move in ((low, -by), (high, by))]
            found |= {name: (value - seen[0][name]) / (2 * by) for name, value in seen[1].items()}
        return found | self._of_limits(low, high, 2 * by)

    @cached_property
    def _folds(self) -> dict[int, Fold]:
        """Of the limit points of a traced curve, by their place in it."""
        end = self.result.end
        if end is None or end.trace is None:
            return {}
        limits = {k: each for k, each in enumerate(end.trace.points) if each.limit}
        eps = self.result.epsilon
        return {k: Fold(end.problem_at, each.factor, each.state, eps) for k, each in limits.items()}

    def _of_limits(self, low: Side, high: Side, width: float) -> Values:
        """Of the headline values of a curve that are told by its limit points' loads alone."""
        end = self.result.end
        if not self._folds or end is None or end.trace is None:
            return {}
        stage, points = end.stage, list(end.trace.points)
        assert isinstance(stage, CurveStage)
        before = _measured(stage.summarise(points))
        moved, turned = list(points), list(points)
        for k, fold in self._folds.items():
            at = points[k]
            sides = low.at(at.factor), high.at(at.factor)
            changes = [Change.between(*sides, mode.state, width) for mode in fold.modes]
            moved[k] = replace(at, factor=at.factor + width * fold.rate(changes))
            turned[k] = replace(at, u=1.5 * at.u)
        by_state = _measured(stage.summarise(turned))
        after = _measured(stage.summarise(moved))
        return {
            (None, name): (after[name] - value) / width for name, value in before.items() if by_state[name] == value
        }


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


def record(result: Result, found: Sequence[Derivative]) -> None:
    """Into the result: of its headline values, and a table of all loads."""
    result.tables[TABLE] = [Table.of_rows([each.row for each in found])]
    for each in found:
        if each.quantity in result.quantities and each.load in (None, len(result.loads) - 1):
            sides = {"value": each.above} if each.above == each.below else {"below": each.below, "above": each.above}
            of_settings = result.gradients.setdefault(each.quantity, {})
            of_settings[each.setting] = {**sides, "relative": each.relative}


def lines(found: Sequence[Derivative], quantity: str) -> list[str]:
    """For people: a line a setting of this quantity at the last load, the strongest first."""
    mine = [each for each in found if each.quantity == quantity]
    loads = [each.load for each in mine if each.load is not None]
    last = [each for each in mine if each.load == max(loads, default=None)]
    rows = [["setting", "value", f"d {quantity} / d setting", "% for 1 %"]]
    for each in sorted(last, key=lambda each: -abs(each.relative or 0.0)):
        sides = f"{each.above:.6g}" if each.above == each.below else f"{each.below:.6g} below, {each.above:.6g} above"
        relative = "-" if each.relative is None else f"{each.relative:.4g}"
        rows.append([each.setting, f"{each.setting_value:.6g}", sides, relative])
    return list(columns(rows, right=range(4)))
