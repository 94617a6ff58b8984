"""The error that load steps leave with friction: the path again, with every accepted step halved.

A step counts its slip from the last accepted state: the implicit Euler rule of a path-dependent law, of first order in
the step. With F of the answer and F' of the path of half steps its error is 2 (F' - F) then. Two paths cannot show that
this is the order, since contact that changes node by node is not smooth in the step: intervals are SAFETY times
as wide. Measured on 12 small problems, from 1, 2 and 4 steps, against the limit of 8 and 16: 215 of 226 values are
within, 75 of 75 from 2 steps; 9 of the 11 others are the dissipation of a single step. Where both paths agree, as where
both steps are too long for anything to slip, they say nothing: a ring of 32 elements has the same force in 4 steps as
in 1, and another one in 8. Halved are the accepted steps, those of automatic cuts, too. The answer is not changed.

The resultant of friction is a vector: where it turns from one path to the other, its length may agree and it does not.
F' - F is the length of the difference of both. Where all slips, both are at Coulomb's bound, whatever their steps: the
way of a candidate from the last accepted load to its touch counts as slip. Whether it slips is what the dissipation of
the load tells: where its own interval has 0, friction may be anything within that bound.

No scene, no algorithm and nothing of Newton may enter here.
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace
from itertools import accumulate, chain
from typing import Any

import numpy as np

from studies.ask.scene import Observation, Stage
from studies.ask.settings import configured
from studies.output.atomic import Table
from studies.scenes.friction_readings import FRICTION, RESULTANT, resultant
from studies.scenes.walk import Visited, walk
from studies.solving.certificate import certificate
from studies.solving.friction_stages import Stages
from studies.solving.result import COUNTS, SOLVED, Result, unit_of

TABLE = "load_steps"
SAFETY = 3.0  # of an estimate by two grids, whose order was not observed: Roache, J. Fluids Eng. 116 (1994) 405-413
NOISE = 10.0  # times the tolerance of the largest in a unit: what is smaller is no difference
SHOWN, IN_A_TURN = RESULTANT, "moment_N_mm"  # beside the first quantity
BOUNDS = {RESULTANT: "bound_N", IN_A_TURN: "moment_bound_N_mm"}
DISSIPATION = "dissipation_N_mm"
TURNED = 1.0  # deg: from here on the turn of a resultant is printed
REMARK = (
    "errors of load steps are estimates: two paths, one with half the steps, cannot confirm first order; "
    f"the intervals are {SAFETY:g} times as wide"
)


@dataclass(frozen=True)
class StepError:
    """A quantity at a load, and on the path of half steps.  noise: less is no difference.

    turned_deg: angle a between both where these are the lengths F, F' of vectors, which then differ by the root of
    (F' - F)^2 + 4 F F' sin^2(a/2).  bound: of Coulomb, where nothing shows that anything slips.
    """

    quantity: str
    value: float
    halved: float
    noise: float
    turned_deg: float = 0.0
    bound: float | None = None

    @property
    def error(self) -> float:
        """What is to be added to the value, if that is of first order in the step; of a vector its length."""
        apart = 2 * math.sqrt(abs(self.value * self.halved)) * math.sin(math.radians(self.turned_deg) / 2)
        return 2 * math.copysign(math.hypot(self.halved - self.value, apart), self.halved - self.value)

    @property
    def interval(self) -> dict[str, float]:
        """low and high around the value; nothing where the paths agree."""
        width = SAFETY * abs(self.error)
        if self.bound is not None:
            width = max(width, abs(self.value) + self.bound)
        return {"low": self.value - width, "high": self.value + width} if abs(self.error) > self.noise else {}

    @property
    def positive(self) -> bool:
        """Whether the interval of a value that is not below 0 has only what is above."""
        return self.interval.get("low", 1.0) > 0

    @property
    def row(self) -> dict[str, Any]:
        """As plain data."""
        figures = {"quantity": self.quantity, "value": self.value, "halved": self.halved, "error": self.error}
        more = {"noise": self.noise, "turned_deg": self.turned_deg, "bound": self.bound, "low": None, "high": None}
        return {**figures, **more, **self.interval}


def estimate(result: Result, tell: Callable[[str], None] = lambda text: None) -> None:
    """Solve with every step halved: ``errors``, the table :data:`TABLE` and a remark of the result.

    Where that path ends before its last load, or the judge refuses a state of it, there is no estimate from there on.
    """
    if result.verdict not in SOLVED:
        return
    start, rows = time.process_time(), list[dict[str, Any]]()
    loads = (each for each in enumerate(result.loads) if each[1].counters["substeps"])  # others: nothing to halve
    headline, of_load = dict[str, StepError](), result.headline_loads
    rubbed = (number for number, step in enumerate(result.loads) if RESULTANT in step.quantities)
    pulls = dict(zip(rubbed, map(resultant, result.tables.get(FRICTION, [])), strict=True))
    result.remarks.append(REMARK)
    lost, lost_there = 0.0, 0.0  # up to the load before
    for visited, steps in _halved(result, tell):
        stage, at = visited.stage.name, visited.point.requested
        observation, failed = _seen(visited, result)
        if failed:
            result.remarks.append(f"the error of load steps is not known from {stage} at {at:g} on: {failed}")
            break
        if observation.step is None:
            continue
        number, step = next(loads)
        there = resultant(observation.tables()[FRICTION]) if number in pulls else None
        turned = 0.0 if there is None else _angle_deg(pulls[number], there)
        mine, other, tolerance = step.quantities, observation.step, result.request.number("tolerance")
        slips = True
        if there is not None:
            slip = next(each for each in compared(mine, other, tolerance) if each.quantity == DISSIPATION)
            slips = replace(slip, value=slip.value - lost, halved=slip.halved - lost_there).positive
            slips = slips or bool(mine["sticking"] or other["sticking"])
            lost, lost_there = slip.value, slip.halved
        step_errors = compared(mine, other, tolerance, turned, slips=slips)
        headline |= {each.quantity: each for each in step_errors if of_load.get(each.quantity) == number}
        spent = {"substeps": step.counters["substeps"], "halved_substeps": steps}
        rows += [{"stage": stage, "load": at, **spent, **each.row} for each in step_errors]
    widened = {quantity: _widened(result.errors.get(quantity, {}), each) for quantity, each in headline.items()}
    result.errors = {name: interval for name, interval in (result.errors | widened).items() if interval}
    result.tables |= {TABLE: [Table.of_rows(rows)]} if rows else {}
    result.timing[TABLE] = time.process_time() - start


def _widened(interval: Mapping[str, float], steps: StepError) -> dict[str, float]:
    """The interval of grids, if there is one, with that of load steps on both sides."""
    if not interval or not steps.interval:
        return {**interval, **steps.interval}
    width = steps.interval["high"] - steps.value
    return {"low": interval["low"] - width, "high": interval["high"] + width}


def compared(
    mine: Mapping[str, Any], other: Mapping[str, Any], tolerance: float, turned_deg: float = 0.0, *, slips: bool = True
) -> list[StepError]:
    """The quantities of a load that are not counts, beside those of the path of half steps.

    turned_deg: between the resultants of friction.  slips: whether the dissipation of the load shows that, or some
    stick, so that friction is not at its bound.
    """
    values = {key: value for key, value in mine.items() if key not in COUNTS and isinstance(value, float)}
    largest = {unit: max(abs(v) for k, v in values.items() if unit_of(k) == unit) for unit in map(unit_of, values)}
    errors = [StepError(k, v, float(other[k]), NOISE * tolerance * largest[unit_of(k)]) for k, v in values.items()]
    bounds = {k: None if slips else mine[bound] for k, bound in BOUNDS.items() if bound in mine}
    of_friction: Mapping[str, dict[str, Any]] = {
        k: {"turned_deg": turned_deg if k == RESULTANT else 0.0, "bound": bounds[k]} for k in bounds
    }
    return [replace(each, **of_friction.get(each.quantity, {})) for each in errors]


def _angle_deg(one: np.ndarray, other: np.ndarray) -> float:
    """Between two vectors (3,); 0 where one is nothing."""
    return math.degrees(math.atan2(float(np.linalg.norm(np.cross(one, other))), float(one @ other)))


def _halved(result: Result, tell: Callable[[str], None]) -> Iterator[tuple[Visited, int]]:
    """The requested points on a path of half steps, with the number of these; the last may not be converged."""
    assert result.model is not None
    request, ends = result.request, dict[str, set[int]]()

    def halved(stage: Stage) -> Stage:
        ways = [substeps for name, substeps in result.ways if name == stage.name]
        ends[stage.name] = set(accumulate(map(len, ways)))
        return replace(stage, targets=tuple(chain(*ways)) or stage.targets)

    stages = map(halved, Stages(result.model.stages(), request.settings))
    algorithm, name, passed, steps = configured(request.contact, request.settings), "", 0, 0
    for visited in walk(stages, algorithm, 2, tell=lambda stage, at: tell(f"{stage} {at:g} in half steps")):
        passed = passed + 1 if visited.stage.name == name else 1
        name, steps = visited.stage.name, steps + visited.point.substeps
        if passed in ends[name] or not visited.converged:
            yield visited, steps
            steps = 0


def _seen(visited: Visited, result: Result) -> tuple[Observation, str]:
    """What is read off a point, and why its state does not count, if it does not."""
    nothing = Observation(None)
    if not visited.converged:
        return nothing, f"the path with half steps stops: {visited.said}"
    problem, state = visited.problem, visited.point.solution
    observation = visited.stage.observe(problem, state, visited.point.requested)
    if observation.step is None or problem.coulomb is None:
        return observation, ""
    tolerance, epsilon = result.request.number("tolerance"), result.request.number("epsilon")
    judged = certificate(problem, state, epsilon, tolerance, visited.passed, visited.last_accepted)
    failed = ", ".join(judged["failures"])
    return observation, f"its state in half steps is wrong: {failed}" if failed else ""


def lines(result: Result) -> list[str]:
    """For people: the first quantity and friction, or its torque, at each load; then the automatic cuts."""
    if TABLE not in result.tables:
        return []
    rows = list(result.table(TABLE).rows())
    first = rows[0]["quantity"]
    shown = [row for row in rows if row["quantity"] in (first, IN_A_TURN if row["stage"] == "turn" else SHOWN)]
    report = [_line(row) for row in shown if abs(row["value"]) > row["noise"]]
    return [*report, *(f"load steps: {cut}" for cut in result.as_json()["cuts"])]


def _line(row: Mapping[str, Any]) -> str:
    """A quantity at a load."""
    head = f"{row['stage']} {row['load'] + 0.0:g}: {row['quantity']} {row['value']:.6g} in {row['substeps']} steps"
    if abs(row["error"]) <= row["noise"]:
        return f"{head}, the same in {row['halved_substeps']}: its error is not known"
    turned = f", turned by {row['turned_deg']:.3g} degrees" if row["turned_deg"] >= TURNED else ""
    share = 100 * abs(row["error"] / row["value"])
    size = f"first-order error of this answer {abs(row['error']):.2g} ({share:.2g} %)"
    if row["bound"] is not None:
        size = f"its dissipation does not show any slip, so it is only known to lie within {row['bound']:.6g}"
    return f"{head}, {row['halved']:.6g} in {row['halved_substeps']}{turned}; {size}"
