"""``footprint bench newton``: what one Newton iteration on the tyre costs, as ratios inside one run.

The tyre of the paper, its pressed state and the parts of one step are what the other benchmarks measure, too.
"""

from __future__ import annotations

from functools import partial

import numpy as np
import pandas as pd

from contact.algorithms.semismooth import Semismooth
from contact.newton.step import NewtonRun
from contact.problem import ContactProblem, ContactSolution
from formulations.shell import ShellModel
from studies.ask.request import Request
from studies.output.stopwatch import WALL, Clock, timed
from studies.scenes.complete import complete
from studies.scenes.tyre.model import TyreModel
from studies.scenes.tyre.scene import Tyre
from studies.scenes.walk import walk

SHOWN = {name: name for name in ("elements", "scatter", "prediction", "contact", "factorisation")}
SHOWN |= {"solution": "solve", "total": "total"}  # parts of an iteration by the name that they are shown under


def asked(mesh: str, **settings: str) -> Request:
    """For the whole tyre of the paper, to be pressed by 20 mm; raises UsageError."""
    return complete("tyre", {"delta_mm": "20", **settings}, mesh, model="full")[1]


def tyre(request: Request) -> TyreModel:
    """The model; raises UsageError."""
    return TyreModel.on(request, *Tyre().lines(request))


def pressed(model: TyreModel) -> tuple[ContactProblem, ContactSolution]:
    """The last problem of the path and its solution."""
    *_, last = walk(model.stages(), Semismooth())
    return last.problem, last.state


def bench(mesh: str = "42x40", repeats: int = 9) -> tuple[int, dict[str, float]]:
    """Unknowns, and medians [s] of the parts of one iteration and of the whole, measured on its own.

    The tyre is brought into contact, then one iteration of mixed semismooth Newton is repeated from that state.
    """
    model = tyre(asked(mesh))
    problem, state = pressed(model)
    shell, u = model.shell, state.u
    memory = shell.linearise(u, None).remember(np.zeros_like(u))
    samples = [parts(shell, NewtonRun(problem), state, memory, WALL) for _ in range(repeats)]
    median = pd.DataFrame(samples).median()
    median["prediction"] = max(median["linearise"] - median["elements"] - median["scatter"], 0.0)
    return shell.discretisation.n_free, {name: float(median[part]) for name, part in SHOWN.items()}


def parts(shell: ShellModel, run: NewtonRun, state: ContactSolution, memory: object, clock: Clock) -> dict[str, float]:
    """Times [s] of one Newton step: the whole, its parts as the run has counted them, elements and scatter alone."""
    total, _ = timed(partial(_iterate, run, state, memory), clock)
    elements, (_, _, tangents) = timed(partial(shell.element_contributions, state.u, memory), clock)
    scatter, _ = timed(partial(shell.discretisation.assemble, tangents), clock)
    spent = {name: run.tally.counters[f"{name}_s"] for name in ("factorisation", "solve", "contact")}
    alone = {"elements": elements, "scatter": scatter, "linearise": run.tally.counters["assembly_s"]}
    return {**alone, **spent, "total": total}


def _iterate(run: NewtonRun, state: ContactSolution, memory: object) -> None:
    """Everything an algorithm does between two iterates."""
    lin = run.linearise(state.u, memory)
    run.closed(run.at(lin, state.u, state.pressure, state.active))
    du, _ = run.step(lin, state.u, state.pressure, state.active)
    run.remember(lin, du)
