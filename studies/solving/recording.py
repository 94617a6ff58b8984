"""What is kept of the points of a path: each one judged, what is read off it, and why the path ends."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from itertools import pairwise
from typing import TYPE_CHECKING

from contact.events import PathEnd
from contact.problem import ContactProblem, ContactSolution, Outcome
from studies.ask.model import CurveStage, Observation, ShellSceneModel
from studies.ask.request import Request, UsageError
from studies.output.atomic import Table, plain
from studies.scenes.walk import Seen, Visited
from studies.solving.certificate import certificate, refusal
from studies.solving.result import UNSTABLE, Frozen, Result, Step

if TYPE_CHECKING:
    from contact.continuation.arc_length import Trace
    from contact.swept import Crossing

DRAWN = 8  # points of a curve that every piece of it has in its table
ON_THE_WAY = "the path continues from it; another path may reach other states at later loads"


@dataclass(frozen=True, eq=False)
class Reached:
    """A state of a path at the parameter ``at`` of its stage.

    passed: what went through the foundation on the way to it.  before: with friction, the last accepted problem and
    state.  spent: counts of its solution.  where: in words, for a state that no step shows.
    """

    problem: ContactProblem
    state: ContactSolution
    at: float
    passed: Sequence[Crossing]
    spent: Mapping[str, int]
    before: tuple[ContactProblem, ContactSolution] | None = None
    where: str = ""


def record(visited: Visited, result: Result) -> None:
    """What was reached, or why it was not; a state that the judge refuses ends the path, and is the last one."""
    point, stage = visited.point, visited.stage
    result.visits.append(visited)
    result.ways.append((stage.name, tuple(t for t, _ in point.way[1:])))
    for key, value in point.solution.counters.items():
        result.counters[key] = result.counters.get(key, 0) + value
    result.history += [{"stage": stage.name, **row} for row in point.solution.history]
    if visited.converged or point.reached != 0.0:
        result.last = visited.state
    if visited.trace is None:
        result.frozen = partial(_freeze, visited, result)
    if not visited.converged:
        _record_end(visited, result)
    for reached in _reached(visited):
        _judge(reached, visited, result)
        if result.outcome is Outcome.WRONG:
            result.last = stage.lifted(reached.state)
            break
    if visited.trace is not None:
        assert isinstance(stage, CurveStage)
        if result.outcome is not Outcome.WRONG:
            result.quantities |= stage.summarise(visited.trace.points)
        result.tables["curve"] = [_curve(visited, visited.trace, result)]


def _reached(visited: Visited) -> Iterator[Reached]:
    """The requested load, or all points of a traced curve."""
    point, stage = visited.point, visited.stage
    if visited.trace is not None:
        for before, at in pairwise(visited.trace.points):
            state = at.state
            problem = replace(visited.problem_at(at.factor), energy=None)  # costs as much again
            spent = {"newton_iterations": at.iterations, "substeps": 1, "limit_point": int(at.limit)}
            standing = visited.problem_at(before.factor).standing  # led there in steps
            passed: Sequence[Crossing] = ()
            if before.factor and problem.standing is not None:
                from contact.swept import crossings  # loaded with a foundation alone

                passed = crossings(standing, before.u, problem.standing, state.u)
            yield Reached(problem, state, at.factor, passed, spent)
    elif visited.converged:
        spent = {k: int(v) for k, v in point.solution.counters.items() if not k.endswith("_s")}
        accepted = visited.last_accepted if visited.problem.coulomb is not None else None
        where = f"{stage.name} at {point.requested:g}"
        spent["substeps"] = point.substeps
        yield Reached(visited.problem, point.solution, point.requested, visited.passed, spent, accepted, where)


def _judge(reached: Reached, visited: Visited, result: Result) -> None:
    """What is read off a state and what the judge says of it, into the result."""
    problem, state = reached.problem, reached.state
    observation = visited.stage.observe(problem, state, reached.at)
    tolerance = result.request.number("tolerance")
    judged = certificate(problem, state, result.epsilon, tolerance, reached.passed, reached.before)
    if reached.where and judged["stability"]["word"] == UNSTABLE:
        sentence = f"{reached.where}: {judged['stability']['sentence']}"
        if observation.step is None:
            result.on_the_way.append(f"{sentence}; {ON_THE_WAY}")
        else:
            result.unstable.append(sentence)
    where = f"in {reached.where}"
    if observation.step is not None:
        result.loads.append(Step(observation.step, judged, reached.spent, frozenset(observation.quantities)))
        load, value = next(iter(observation.step.items()))
        if visited.stage.whole is None:
            result.states.append(Seen((load, float(value)), reached.at, visited.problem_at, state))
        where = f"at {load} {value:g}"
    _keep(observation, result)
    if judged["failures"]:
        result.outcome = result.cause = Outcome.WRONG
        result.reason = f"{refusal(judged)} {where}"


def _keep(observation: Observation, result: Result) -> None:
    for name, table in observation.tables().items():
        result.tables.setdefault(name, []).append(table)
    result.quantities |= observation.quantities


def _record_end(visited: Visited, result: Result) -> None:
    """Why the path ends before its last point."""
    point, stage = visited.point, visited.stage.name
    result.outcome, result.cause = point.outcome, point.cause
    if point.outcome is Outcome.REFUSED:  # at once, or known only once the tangent is
        result.unsupported = f"{result.request.contact} does not apply: {visited.said}"
        return
    message = visited.said
    if point.end is not None and point.end.limit is not None:
        result.quantities[f"{stage}_limit_point"] = point.end.limit  # in the unit of the path
    if point.end is not None and point.end.mode is not None and visited.stage.see_mode is not None:
        observation = visited.stage.see_mode(point.solution, point.end.mode)
        _keep(observation, result)
        message += f"; {observation.said}"
    if point.end is not None and point.end.kind is not PathEnd.NEITHER and isinstance(result.model, ShellSceneModel):
        message += f"; this is the path on the grid {_grid(result.request)}, on another it may end elsewhere"
    if visited.trace is None:
        where = f"{stage} at {point.requested:g}: {message}"
    else:
        where = f"{stage}: {visited.trace.reason}"
    result.reason = f"{where}; last converged at {point.reached:g}"


def _grid(request: Request) -> str:
    return f"{request.mesh_text}, refined" if request.leaves else request.mesh_text


def _freeze(visited: Visited, result: Result) -> Frozen:
    """The contact problem at the end of the path, linearised: at its solution, or where the last step set out from.

    Raises UsageError when it has no contact candidates.
    """
    from contact.interchange.linearised_step import freeze  # a solve that keeps no problem does not load it

    point, stage = visited.point, visited.stage.name
    parameter = point.requested if visited.converged else float(result.history[-1]["parameter"])
    problem, state = visited.problem_at(parameter), point.solution
    if not len(problem.weights):
        raise UsageError(f"{result.request.scene} has no contact to freeze in its stage {stage!r}")
    record = result.as_json()
    origin = {key: record[key] for key in ("scene", "measure", "contact", "newton", "mesh", "model", "settings")}
    origin |= {"stage": stage, "parameter": parameter, "from": point.reached, "outcome": result.outcome.value}
    commit = {key: record["provenance"][key] for key in ("version", "commit")}
    meta = plain({**origin, **commit})
    if problem.coulomb is not None:
        from contact.slip import anchors_left  # no solve without friction loads it

        # at a solution the slip is that of its own step, else that which the failed step begins with
        before = visited.last_accepted if visited.converged else (visited.problem_at(point.reached), state)
        problem = problem.since(anchors_left(problem, *before, result.epsilon))
    return freeze(problem, state.u, state.pressure, meta)


def _curve(visited: Visited, trace: Trace, result: Result) -> Table:
    """The judged points of the curve with what they have cost; of one that is known itself, points all along it."""
    if trace.curve is None:
        rows = [{**step.seen, "rounding": step.certificate["rounding"], **step.counters} for step in result.loads]
        return Table.of_rows(rows)
    judged = trace.points[1 : 1 + len(result.loads)]
    lengths, problem = [point.along for point in judged], visited.problem  # without contact only u is read off
    others = [point for point in trace.curve.sampled(DRAWN) if point.along not in lengths]
    rows = []
    for point in sorted([*judged, *others], key=lambda each: each.along):
        if point.along <= max(lengths, default=0.0):
            readings = visited.stage.observe(problem, point.state, point.factor).step or {}
            rows.append({**readings, "newton_iterations": point.iterations, "limit_point": int(point.limit)})
    return Table.of_rows(rows)
