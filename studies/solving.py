"""From a request to a result: build, follow the stages, judge, write.

Nothing here knows a particular scene; no picture is drawn here.
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from itertools import pairwise
from pathlib import Path
from typing import Any

from contact.continuation.arc_length import Trace
from contact.continuation.branches import Branch
from contact.continuation.critical_points import PathEnd
from contact.continuation.stability import UNSTABLE as UNSTABLE  # also a class of results
from contact.continuation.stability import stability
from contact.diagnosis import diagnose
from contact.events import EventKind, events
from contact.interchange.linearised_step import FrozenStep, freeze
from contact.newton.step import RESIDUAL_TOLERANCE
from contact.problem import ContactAlgorithm, ContactProblem, ContactSolution, Outcome
from contact.swept import Crossing, between_nodes, crossings
from contact.verify import claim, gap_residuals, judge
from studies.algorithm_settings import configured
from studies.complete import complete
from studies.operations import counted
from studies.request import Request
from studies.scene import CurveStage, Observation, Scene, SceneModel, UsageError
from studies.step import Step
from studies.store.atomic import plain, write_by, write_json
from studies.store.provenance import provenance
from studies.store.tables import Table
from studies.walk import Visited, walk

HISTORY = ("stage", "parameter", "iteration", "residual", "contact_nodes", "added", "removed")  # at the least
UNSUPPORTED = "unsupported"  # the outcome of a request that the algorithm refuses
CONVERGED, WRONG, NOT_CONVERGED, CAP_HIT = "converged", "wrong", "not-converged", "cap-hit"
TIME, MEMORY, CRASH = "time", "memory", "crash"  # of a process that was killed, or died
CLASSES = (CONVERGED, UNSTABLE, WRONG, NOT_CONVERGED, CAP_HIT, TIME, MEMORY, CRASH, UNSUPPORTED)
SOLVED = (CONVERGED, UNSTABLE)  # an equilibrium that the judge certifies, whether one can stand on it or not
SWEPT = "swept"  # the failure of a state that a candidate has reached through the foundation
resolve = complete


@dataclass
class Result:
    """What a solve has found; ``last`` is the last converged state, from which the fields are written.

    model: None where the scene refuses to be built.  unsupported: why the algorithm does not apply to this problem, or
    the scene cannot be; nothing was solved beyond that.  unstable: a sentence on each requested load whose equilibrium
    is not stable, but for the points of a traced curve, which is followed through such states on purpose.
    work: floating-point operations by kind, those of the judge included; their sum is counters["operations"].
    branches, beside: rows and states of the stable branches at the last load, where they were asked for.
    """

    request: Request
    model: SceneModel | None = None
    outcome: Outcome = Outcome.CONVERGED
    cause: Outcome = Outcome.CONVERGED
    reason: str = ""
    unsupported: str = ""
    unstable: list[str] = field(default_factory=list)
    branches: list[dict[str, Any]] = field(default_factory=list)
    beside: list[Branch] = field(default_factory=list)
    quantities: dict[str, float] = field(default_factory=dict)
    loads: list[Step] = field(default_factory=list)
    counters: dict[str, float] = field(default_factory=dict)
    work: dict[str, int] = field(default_factory=dict)
    timing: dict[str, float] = field(default_factory=dict)
    history: list[dict[str, Any]] = field(default_factory=list)
    tables: dict[str, list[Table]] = field(default_factory=dict)
    last: ContactSolution | None = None
    frozen: Callable[[], FrozenStep] | None = None
    end: Visited | None = None

    def as_json(self) -> dict[str, Any]:
        """The content of result.json."""
        request = self.request
        asked = ("scene", "measure", "contact", "newton", "mesh", "model", "model_reason")
        return {
            **{name: getattr(request, name) for name in asked},
            "mesh": f"{request.mesh[0]}x{request.mesh[1]}",
            "settings": {**request.settings, "steps": request.steps},
            "outcome": UNSUPPORTED if self.unsupported else self.outcome.word,
            "class": self.verdict,
            "path_end": self.path_end,
            "reason": self.unsupported or self.reason or "; ".join(self.unstable[:1]) or self.outcome.value,
            "notes": self.notes,
            "quantities": self.quantities,
            "steps": self.steps,
            **({"branches": self.branches} if self.branches else {}),
            "cuts": [str(event) for event in events(self.history, EventKind.STEP_CUT)],
            "counters": self.counters,
            "work": self.work,
            "timing_s": self.timing,
            "provenance": provenance(),
        }

    @property
    def notes(self) -> list[str]:
        """What an answer does not show by itself: that the foundation is finer than the elements on it."""
        if self.end is None:
            return []
        problem, state = self.end.problem, self.end.point.solution
        told = between_nodes(problem.standing, problem.weights, state.active)
        return [told] if told else []

    @property
    def steps(self) -> list[dict[str, Any]]:
        """The loads that were reached, flat."""
        return [step.flat for step in self.loads]

    @property
    def verdict(self) -> str:
        """The class of the outcome: what a solve may end in of :data:`CLASSES`."""
        if self.unsupported:
            return UNSUPPORTED
        if self.outcome.converged:
            if any(step.certificate["failures"] for step in self.loads):
                return WRONG
            return UNSTABLE if self.unstable else CONVERGED
        capped = Outcome.ITERATION_LIMIT in (self.outcome, self.cause)
        return CAP_HIT if capped and not self.path_end else NOT_CONVERGED

    @property
    def path_end(self) -> dict[str, Any]:
        """What the path of the problem itself ends at before the load asked for: stage, kind, parameter, found_by.

        Empty where it does not end, or only the solver knows no further. Found by arc length, which has passed it, or
        by the tangent of the last states (:mod:`contact.continuation.critical_points`), which only comes near it.
        """
        point = None if self.end is None or self.outcome.converged else self.end.point
        if self.end is None or point is None or point.end is None or point.end.kind is PathEnd.NEITHER:
            return {}
        found_by = "arc length" if point.outcome is Outcome.LIMIT_POINT else "the tangent"
        at = point.reached if point.end.limit is None else point.end.limit
        return {"stage": self.end.stage.name, "kind": point.end.kind.value, "parameter": at, "found_by": found_by}

    def table(self, name: str) -> Table:
        """One of the tables, its parts from all loads below one another."""
        return Table.stacked(self.tables[name])

    def write(self, directory: Path) -> None:
        """result.json, fields.vtu and the tables; each appears whole or not at all, result.json last."""
        self.write_artefacts(directory)
        write_json(directory / "result.json", self.as_json())

    def write_artefacts(self, directory: Path) -> list[str]:
        """fields.vtu and the tables, each whole or not at all; returns their names."""
        tables = {name: self.table(name) for name in self.tables}
        for name, table in {**tables, "history": Table.of_rows(self.history, HISTORY)}.items():
            table.write(directory / f"{name}.csv")
        assert self.model is not None  # what was refused has no artefacts
        state, write_fields = self.last or ContactSolution.at_rest(self.model.n_unknowns, 0), self.model.write_fields
        write_by(directory / "fields.vtu", lambda path: write_fields(path, state))
        return [*(f"{name}.csv" for name in tables), "history.csv", "fields.vtu"]


def solve(scene: Scene, request: Request, progress: Callable[[str], None] = lambda text: None) -> Result:
    """Run the stages of the scene until done or until one fails; failure and refusal are recorded, not raised."""
    start, spent = time.perf_counter(), time.process_time()
    with counted() as work:
        model = scene.build(request)
        result = Result(request, model, work=work)
        built = time.perf_counter()
        result.counters["dofs"] = model.n_unknowns
        try:
            algorithm = configured(request.contact, request.settings)
        except ValueError as error:  # a parameter that it cannot have
            result.outcome, result.unsupported = Outcome.REFUSED, f"{request.contact} does not apply: {error}"
        else:
            _run_stages(model, algorithm, request.steps, result, progress)
    result.counters["operations"] = sum(work.values())
    times = {key[:-2]: result.counters.pop(key) for key in list(result.counters) if key.endswith("_s")}
    clocks = {"total": time.perf_counter() - start, "cpu": time.process_time() - spent}
    result.timing = {**clocks, "build": built - start, **times}
    result.counters = {key: int(value) for key, value in result.counters.items()}
    return result


def _run_stages(
    model: SceneModel, algorithm: ContactAlgorithm, steps: int, result: Result, progress: Callable[[str], None]
) -> None:
    for visited in walk(model.stages(), algorithm, steps, tell=lambda stage, at: progress(f"{stage} {at:g}")):
        point, stage = visited.point, visited.stage
        result.end = visited
        _account(result, stage.name, point.solution.counters, point.solution.history)
        if visited.trace is not None:
            _record_curve(visited, visited.trace, result, algorithm.epsilon)
        else:
            result.frozen = partial(_freeze, visited, result)
        if visited.converged or point.reached != 0.0:
            result.last = visited.state
        if not visited.converged:
            _record_end(visited, result)
        elif visited.trace is None:
            seen = stage.observe(visited.problem, point.solution, point.requested)
            counts = {k: int(v) for k, v in point.solution.counters.items() if not k.endswith("_s")}
            judged: dict[str, Any] = {}
            if seen.step is not None:  # what no step shows is not judged by itself: the next stage starts from it
                tolerance = result.request.number("tolerance")
                judged = certificate(visited.problem, point.solution, algorithm.epsilon, tolerance, visited.passed)
                if judged["stability"]["word"] == UNSTABLE:
                    result.unstable.append(f"{stage.name} at {point.requested:g}: {judged['stability']['sentence']}")
            _record(result, seen, judged, {**counts, "substeps": point.substeps})


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
    where = f"{stage} at {point.requested:g}: {said}" if visited.trace is None else f"{stage}: {visited.trace.reason}"
    result.reason = f"{where}; last converged at {point.reached:g}"


def _freeze(visited: Visited, result: Result) -> FrozenStep:
    """The contact problem at the end of the path, linearised: at its solution, or where the last step set out from.

    Raises UsageError when it has no contact candidates.
    """
    point, stage = visited.point, visited.stage.name
    parameter = point.requested if visited.converged else float(str(result.history[-1]["parameter"]))
    problem, state = visited.problem_at(parameter), point.solution
    if not len(problem.weights):
        raise UsageError(f"{result.request.scene} has no contact to freeze in its stage {stage!r}")
    told = result.as_json()
    origin = {key: told[key] for key in ("scene", "measure", "contact", "newton", "mesh", "model", "settings")}
    origin |= {"stage": stage, "parameter": parameter, "from": point.reached, "outcome": point.outcome.value}
    commit = {key: told["provenance"][key] for key in ("version", "commit")}
    return freeze(problem, state.u, state.pressure, plain({**origin, **commit}))


def _record_curve(visited: Visited, trace: Trace, result: Result, epsilon: float) -> None:
    """The points of a traced curve, each judged, and the table ``curve``."""
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
    result.quantities |= stage.summarise(trace.points)
    rows = [{**step.seen, "rounding": step.certificate["rounding"], **step.counters} for step in result.loads]
    result.tables["curve"] = [Table.of_rows(rows)]


def certificate(
    problem: ContactProblem,
    state: ContactSolution,
    epsilon: float = math.inf,
    tolerance: float = RESIDUAL_TOLERANCE,
    passed: Sequence[Crossing] = (),
) -> dict[str, Any]:
    """What the judge says of a state, by the law of its epsilon: failures by name, their diagnosis, kkt, balances,
    scales.

    stability: word, sentence and counts of :class:`contact.continuation.stability.Stability`; it is no failure.
    kkt has the true gaps, whatever epsilon.  tolerance: the equilibrium that was asked for. It is the claim that is
    judged: where it is wider than the judge's own bound, it is the bound, of equilibrium and of what follows from it.
    passed: what went through the foundation on the way from the state before; a failure of its own, SWEPT.
    """
    verdict = judge(problem, state.u, state.pressure, epsilon=epsilon)
    found = verdict.certificate
    found["kkt"] |= gap_residuals(problem, state.u, state.pressure, math.inf)
    found["failures"] = verdict.failures(**claim(tolerance, len(state.u)))
    found["diagnosis"] = diagnose(problem, state.u, state.pressure, epsilon=epsilon) if found["failures"] else []
    if passed:
        found["failures"].append(SWEPT)
        shares = f"{passed[0].enters:.3g} to {passed[0].leaves:.3g}"
        found["diagnosis"].append(f"{SWEPT}: {passed[0]}, from {shares} of its way")
    found["stability"] = stability(problem, state, epsilon).record
    return found


def _record(result: Result, seen: Observation, judged: Mapping[str, Any], spent: Mapping[str, int]) -> None:
    for name, table in seen.tables().items():
        result.tables.setdefault(name, []).append(table)
    result.quantities |= seen.quantities
    if seen.step is not None:
        result.loads.append(Step.of({**seen.step, **judged, **spent}, spent))


def _account(result: Result, stage: str, counters: Mapping[str, float], history: Sequence[Mapping[str, Any]]) -> None:
    for key, value in counters.items():
        result.counters[key] = result.counters.get(key, 0) + value
    result.history += [{"stage": stage, **row} for row in history]
