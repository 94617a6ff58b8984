"""``footprint bench``: what one Newton iteration on the tyre costs, as ratios inside one run (machines are noisy)."""

from __future__ import annotations

import statistics
import time
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial

import numpy as np

from contact.algorithms.semismooth import Semismooth
from contact.newton.step import NewtonRun
from contact.problem import ContactProblem, ContactSolution
from formulations.shell import ShellModel
from studies.complete import complete
from studies.scenes.tyre.model import TyreModel
from studies.scenes.tyre.scene import Tyre
from studies.walk import walk


@dataclass(frozen=True)
class IterationCost:
    """Medians in seconds of the parts of one iteration, and of the whole iteration measured on its own."""

    dofs: int
    elements: float
    scatter: float
    prediction: float
    contact: float
    factorisation: float
    solution: float
    total: float


def bench(mesh: str = "42x40", delta_mm: float = 20.0, repeats: int = 9) -> IterationCost:
    """Bring the paper's tyre into contact, then repeat one iteration of mixed semismooth Newton from that state."""
    _, request = complete("tyre", {"delta_mm": repr(delta_mm)}, mesh, model="full")
    model = TyreModel.on(request, *Tyre().lines(request))
    problem, state = pressed(model)
    return _measure(model.shell, problem, state, repeats)


def pressed(model: TyreModel) -> tuple[ContactProblem, ContactSolution]:
    """The last problem of the path and its solution."""
    *_, last = walk(model.stages(), Semismooth())
    return last.problem, last.state


def _measure(shell: ShellModel, problem: ContactProblem, state: ContactSolution, repeats: int) -> IterationCost:
    grid, u = shell.discretisation, state.u
    memory = shell.linearise(u, None).remember(np.zeros_like(u))
    _, _, tangents = shell.element_contributions(u, memory)
    totals, runs, elements, scatter = [], [], [], []
    for _ in range(repeats):  # interleaved, so that a slow moment of the machine meets every part
        runs.append(NewtonRun(problem))
        totals.append(timed(partial(iterate, runs[-1], state, memory)))
        elements.append(timed(lambda: shell.element_contributions(u, memory)))
        scatter.append(timed(lambda: grid.assemble(tangents)))
    part = {key: statistics.median(run.tally.counters[key] for run in runs) for key in runs[0].tally.counters}
    assembly = statistics.median(elements) + statistics.median(scatter)
    return IterationCost(
        dofs=grid.n_free,
        elements=statistics.median(elements),
        scatter=statistics.median(scatter),
        prediction=max(part["assembly_s"] - assembly, 0.0),
        contact=part["contact_s"],
        factorisation=part["factorisation_s"],
        solution=part["solve_s"],
        total=statistics.median(totals),
    )


def iterate(run: NewtonRun, state: ContactSolution, memory: object) -> None:
    """Everything an algorithm does between two iterates."""
    lin = run.linearise(state.u, memory)
    run.closed(run.at(lin, state.u, state.pressure, state.active))
    du, _ = run.step(lin, state.u, state.pressure, state.active)
    run.remember(lin, du)


def timed(work: Callable[[], object], clock: Callable[[], float] = time.perf_counter) -> float:
    """Time [s] by the clock, wall time unless given."""
    start = clock()
    work()
    return clock() - start
