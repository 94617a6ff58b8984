"""What friction costs: the tyre pressed against a plane that is then dragged, step by step, beside the one without.

The candidates are those that the press can reach. Operations are all that is spent on linear systems and on the choice
of states, an iteration of Newton; times are left to others.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pandas as pd

from contact.algorithms.semismooth import Semismooth as Frictionless
from contact.coulomb import Motion
from contact.friction.foundation import Slip
from contact.friction.path import PathState, Stage, follow
from contact.friction.problem import FrictionalProblem, FrictionalSolution
from contact.friction.semismooth import Semismooth
from contact.obstacles.foundation import Candidates
from contact.operations import SPENT
from contact.problem import ContactSolution
from studies.complete import complete
from studies.scenes.tyre.foundation import NORMAL
from studies.scenes.tyre.model import TyreModel
from studies.walk import walk

REACH = 3.0  # times the travel: gaps of the inflated tyre beyond which nobody touches


def dragged_tyre(
    mesh: str = "28x26", delta: float = 10.0, mu: float = 0.5, drags: Sequence[float] = (0.5, 1.0, 2.0, 4.0, 8.0)
) -> pd.DataFrame:
    """The press by ``delta`` [mm] without and with friction, then the plane dragged to each of ``drags`` [mm].

    press_N, drag_N: forces of the plane; sticking, slipping: candidates; operations: in millions an iteration; ratio:
    to those of the press without friction; work_N_mm: dissipation of the step.
    """
    scene, request = complete("tyre", {"delta_mm": delta}, mesh, model="full")
    model = scene.build(request)
    assert isinstance(model, TyreModel)
    stages = list(model.stages())
    *_, last = walk(stages[:-1], Frictionless())
    inflated = last.state
    problem_at, begun = stages[-1].begin(inflated)
    touching = problem_at(0.0)
    chosen = touching.gap(inflated.u) <= REACH * delta
    assert touching.only is not None
    near = replace(problem_at(delta).only(chosen), ordered=True)  # type: ignore[misc]
    crown = float(np.max(model.candidates.positions(inflated.u) @ NORMAL))
    plane = model.foundation.moved((crown - delta) * NORMAL)
    points = (3 * np.flatnonzero(chosen)[:, None] + np.arange(3)).ravel()
    candidates = Candidates(
        model.candidates.reference[chosen], model.candidates.operator[points], model.candidates.weights[chosen]
    )
    m = int(chosen.sum())
    way = np.cross(NORMAL, [0.0, 0.0, 1.0]) + np.array([0.0, 0.0, 0.5])
    way /= np.linalg.norm(way)

    rows = []
    before = dict(SPENT)
    start = ContactSolution(begun.u, np.zeros(m), np.zeros(m, bool), begun.outcome)
    smooth = Frictionless().solve(near, start)
    row = _row("pressed without friction", 0.0, smooth.counters["newton_iterations"], before)
    rows.append(
        row | {"outcome": smooth.outcome.word, "candidates": m, "press_N": float(near.weights @ smooth.pressure)}
    )

    def stage_at(drag: float, anchors: np.ndarray) -> Stage:
        motion = Motion(drag * way, np.zeros(3), np.zeros(3))
        slip = Slip(candidates, plane, motion, anchors)
        size = plane.size + float(np.max(np.abs(candidates.reference)))
        problem = FrictionalProblem(near, np.full(m, mu), slip, slip.jacobian, size)
        return Stage(problem, slip.places)

    rest = FrictionalSolution.at_rest(len(begun.u), m)
    at = PathState(0.0, replace(rest, u=begun.u), candidates.positions(begun.u))
    before = dict(SPENT)
    for state in follow(stage_at, (0.0, *drags), Semismooth(), at):
        found = state.solution
        label = "pressed" if state.load == 0 else "dragged"
        row = _row(label, state.load, found.counters["newton_iterations"], before)
        before = dict(SPENT)
        rows.append(
            row
            | {"outcome": found.outcome.word, "press_N": float(found.normal.sum())}
            | {"drag_N": float(np.linalg.norm(found.friction.sum(axis=0)))}
            | {"sticking": int(np.sum(found.state == 1)), "slipping": int(np.sum(found.state == 2))}
            | {"work_N_mm": state.dissipation}
        )
    table = pd.DataFrame(rows)
    table["ratio"] = table["operations"] / table["operations"].iloc[0]
    return table


def _row(what: str, drag: float, iterations: float, before: dict[str, int]) -> dict[str, object]:
    spent = {kind: SPENT[kind] - before[kind] for kind in before}
    each = sum(spent.values()) / max(iterations, 1) / 1e6
    parts = {kind: value / 1e6 for kind, value in spent.items()}
    return {"step": what, "drag_mm": drag, "iterations": iterations, "operations": each} | parts
