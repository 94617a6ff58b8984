"""From a request to a result: build, follow the stages, judge.

Nothing here knows a particular scene; no picture is drawn here.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import replace
from functools import partial
from itertools import pairwise
from typing import Any

from contact.continuation.arc_length import Trace
from contact.continuation.critical_points import PathEnd
from contact.continuation.starts import Starts
from contact.friction.slip import anchors_left
from contact.interchange.linearised_step import freeze
from contact.problem import ContactAlgorithm, Outcome
from contact.swept import crossings
from studies.ask.request import Request
from studies.ask.scene import CurveStage, Observation, Scene, SceneModel, ShellSceneModel, Stage, UsageError
from studies.ask.settings import configured, rubbing
from studies.output.atomic import Table, plain
from studies.scenes.complete import complete
from studies.scenes.plugins import blamed
from studies.scenes.walk import Visited, no_starts, walk
from studies.solving.certificate import certificate, refusal
from studies.solving.operations import counted
from studies.solving.result import UNSTABLE, Frozen, Result
from studies.solving.step import Step

resolve = complete
DRAWN = 8  # points of a curve that every piece of it has in its table
ON_THE_WAY = "the path goes on from it, and another one may reach the loads after it in other states"


class Interrupted(KeyboardInterrupt):
    """An interruption of a solve; result: what was finished before it."""

    def __init__(self, result: Result) -> None:
        super().__init__(result.reason)
        self.result = result


def cold(model: SceneModel) -> Callable[[Stage], Starts]:
    """Every step sets out from the last state of the path."""
    return no_starts


def solve(
    scene: Scene,
    request: Request,
    progress: Callable[[str], None] = lambda text: None,
    starts: Callable[[SceneModel], Callable[[Stage], Starts]] = cold,
) -> Result:
    """Run the stages of the scene until done or until one fails; failure and refusal are recorded, not raised.

    starts: of the model, where its steps set out from.
    Raises Interrupted, and PartError where a part from outside breaks.
    """
    start, spent = time.perf_counter(), time.process_time()
    with counted() as work, blamed(request.contact, request.measure, scene):
        model = scene.build(request)
        result = Result(request, model, work=work)
        built = time.perf_counter()
        result.counters["dofs"] = model.n_unknowns
        try:
            algorithm = configured(request.contact, request.settings)
        except ValueError as error:  # a parameter that it cannot have
            result.outcome, result.unsupported = Outcome.REFUSED, f"{request.contact} does not apply: {error}"
        else:
            try:
                _run_stages(model, algorithm, starts(model), result, progress)
            except KeyboardInterrupt:
                result.outcome = result.cause = Outcome.INTERRUPTED
                result.reason = f"interrupted with {len(result.loads)} loads finished"
    result.counters["operations"] = sum(work.values())
    times = {key[:-2]: result.counters.pop(key) for key in list(result.counters) if key.endswith("_s")}
    clocks = {"total": time.perf_counter() - start, "cpu": time.process_time() - spent}
    result.timing = {**clocks, "build": built - start, **times}
    result.counters = {key: int(value) for key, value in result.counters.items()}
    if result.outcome is Outcome.INTERRUPTED:
        raise Interrupted(result)
    return result


def _run_stages(
    model: SceneModel,
    algorithm: ContactAlgorithm,
    starts: Callable[[Stage], Starts],
    result: Result,
    progress: Callable[[str], None],
) -> None:
    steps = result.request.steps
    tell, stages = (lambda stage, at: progress(f"{stage} {at:g}")), stages_of(model, result.request)
    for visited in walk(stages, algorithm, steps, tell=tell, starts=starts):
        _record_visit(visited, result, algorithm.epsilon)
        if result.outcome is Outcome.WRONG:
            return  # what follows would start from no equilibrium


def _record_visit(visited: Visited, result: Result, epsilon: float) -> None:
    """What was reached, or why it was not."""
    point, stage = visited.point, visited.stage
    result.visits.append(visited)
    result.ways.append((stage.name, tuple(t for t, _ in point.way[1:])))
    _account(result, stage.name, point.solution.counters, point.solution.history)
    if visited.converged or point.reached != 0.0:
        result.last = visited.state
    if visited.trace is not None:
        _record_curve(visited, visited.trace, result, epsilon)
    else:
        result.frozen = partial(_freeze, visited, result, epsilon)
    if result.outcome is Outcome.WRONG:
        return
    if not visited.converged:
        _record_end(visited, result)
    elif visited.trace is None:
        _record_point(visited, result, epsilon)


def _record_point(visited: Visited, result: Result, epsilon: float) -> None:
    """A requested load, judged."""
    point, stage, problem = visited.point, visited.stage, visited.problem
    seen = stage.observe(problem, point.solution, point.requested)
    counts = {k: int(v) for k, v in point.solution.counters.items() if not k.endswith("_s")}
    tolerance = result.request.number("tolerance")
    before = visited.last_accepted if problem.coulomb is not None else None
    judged = certificate(problem, point.solution, epsilon, tolerance, visited.passed, before)
    where = f"{stage.name} at {point.requested:g}"
    if judged["stability"]["word"] == UNSTABLE:
        sentence = f"{where}: {judged['stability']['sentence']}"
        if seen.step is None:
            result.on_the_way.append(f"{sentence}; {ON_THE_WAY}")
        else:
            result.unstable.append(sentence)
    _record(result, seen, judged, {**counts, "substeps": point.substeps}, f"in {where}")


def stages_of(model: SceneModel, request: Request) -> Iterable[Stage]:
    """Those of the model; with friction, if it is asked for."""
    if not rubbing(request.settings):
        return model.stages()
    from studies.solving.friction.stages import Stages  # loaded with friction alone

    return Stages(model.stages(), request.settings)


def _record_end(visited: Visited, result: Result) -> None:
    """Why the path ends before its last point."""
    point, stage = visited.point, visited.stage.name
    result.outcome, result.cause = point.outcome, point.cause
    if point.outcome is Outcome.REFUSED:  # at once, or known only once the tangent is
        result.unsupported = f"{result.request.contact} does not apply: {visited.said}"
        return
    said = visited.said
    if point.end is not None and point.end.limit is not None:
        result.quantities[f"{stage}_limit_point"] = point.end.limit  # in the unit of the path
    if point.end is not None and point.end.mode is not None and visited.stage.see_mode is not None:
        seen = visited.stage.see_mode(point.solution, point.end.mode)
        _record(result, seen, {}, {})
        said += f"; {seen.said}"
    if point.end is not None and point.end.kind is not PathEnd.NEITHER and isinstance(result.model, ShellSceneModel):
        said += f"; that is the path of this grid, {_grid(result.request)}: another may end elsewhere"
    where = f"{stage} at {point.requested:g}: {said}" if visited.trace is None else f"{stage}: {visited.trace.reason}"
    result.reason = f"{where}; last converged at {point.reached:g}"


def _grid(request: Request) -> str:
    return f"{request.mesh_text}, refined" if request.leaves else request.mesh_text


def _freeze(visited: Visited, result: Result, epsilon: float) -> Frozen:
    """The contact problem at the end of the path, linearised: at its solution, or where the last step set out from.

    Raises UsageError when it has no contact candidates.
    """
    point, stage = visited.point, visited.stage.name
    parameter = point.requested if visited.converged else float(result.history[-1]["parameter"])
    problem, state = visited.problem_at(parameter), point.solution
    if not len(problem.weights):
        raise UsageError(f"{result.request.scene} has no contact to freeze in its stage {stage!r}")
    told = result.as_json()
    origin = {key: told[key] for key in ("scene", "measure", "contact", "newton", "mesh", "model", "settings")}
    origin |= {"stage": stage, "parameter": parameter, "from": point.reached, "outcome": result.outcome.value}
    commit = {key: told["provenance"][key] for key in ("version", "commit")}
    meta = plain({**origin, **commit})
    if problem.coulomb is not None:
        # at a solution the slip is that of its own step, else that which the failed step begins with
        before = visited.last_accepted if visited.converged else (visited.problem_at(point.reached), state)
        problem = problem.since(anchors_left(problem, *before, epsilon))
    return freeze(problem, state.u, state.pressure, meta)


def _record_curve(visited: Visited, trace: Trace, result: Result, epsilon: float) -> None:
    """The points of a traced curve, each judged, and the table ``curve``; it ends with the first that is wrong."""
    stage, tolerance = visited.stage, result.request.number("tolerance")
    assert isinstance(stage, CurveStage)
    for before, point in pairwise(trace.points):
        state = point.state
        problem = replace(visited.problem_at(point.factor), energy=None)  # costs as much again
        seen = stage.observe(problem, state, point.factor)
        spent = {"newton_iterations": point.iterations, "substeps": 1, "limit_point": int(point.limit)}
        standing = visited.problem_at(before.factor).standing
        passed = crossings(standing, before.u, problem.standing, state.u) if before.factor else []  # led there in steps
        _record(result, seen, certificate(problem, state, epsilon, tolerance, passed), spent)
        if result.outcome is Outcome.WRONG:
            result.last = stage.lifted(state)
            break
    else:
        result.quantities |= stage.summarise(trace.points)
    result.tables["curve"] = [Table.of_rows(_curve_rows(visited, trace, result))]


def _curve_rows(visited: Visited, trace: Trace, result: Result) -> list[dict[str, Any]]:
    """The judged points of the curve with what they have cost; of one that is known itself, points all along it."""
    if trace.curve is None:
        return [{**step.seen, "rounding": step.certificate["rounding"], **step.counters} for step in result.loads]
    judged = trace.points[1 : 1 + len(result.loads)]
    lengths, problem = [point.along for point in judged], visited.problem  # without contact only u is read off
    others = [point for point in trace.curve.sampled(DRAWN) if point.along not in lengths]
    rows = []
    for point in sorted([*judged, *others], key=lambda each: each.along):
        if point.along <= max(lengths, default=0.0):
            seen = visited.stage.observe(problem, point.state, point.factor).step or {}
            rows.append({**seen, "newton_iterations": point.iterations, "limit_point": int(point.limit)})
    return rows


def _record(
    result: Result, seen: Observation, judged: Mapping[str, Any], spent: Mapping[str, int], where: str = ""
) -> None:
    """What was seen of a state; one that the judge refuses is wrong, here and wherever an outcome is asked for.

    where: stage and load, of a state that no step shows.
    """
    for name, table in seen.tables().items():
        result.tables.setdefault(name, []).append(table)
    result.quantities |= seen.quantities
    if seen.step is not None:
        result.loads.append(Step(seen.step, judged, spent))
        load, value = next(iter(seen.step.items()))
        where = f"at {load} {value:g}"
    if judged.get("failures"):
        result.outcome = result.cause = Outcome.WRONG
        result.reason = f"{refusal(judged)} {where}"


def _account(result: Result, stage: str, counters: Mapping[str, float], history: Sequence[Mapping[str, Any]]) -> None:
    for key, value in counters.items():
        result.counters[key] = result.counters.get(key, 0) + value
    result.history += [{"stage": stage, **row} for row in history]
