"""What friction costs: steps of the tyre with it beside the press without it, an iteration of Newton for another."""

from __future__ import annotations

import time
from collections.abc import Iterable, Iterator
from typing import Any

import pandas as pd

from contact.operations import SPENT
from contact.problem import ContactAlgorithm
from studies.algorithm_settings import configured
from studies.complete import complete
from studies.friction.stages import Stages
from studies.scene import Stage
from studies.walk import walk

SETTINGS = {"delta_mm": 10.0}
RUBBED = {"mu": 0.5, "drag_mm": (0.5, 1.0, 2.0, 4.0, 8.0), "drag_deg": 90.0}


def cost_table(mesh: str = "42x40", contact: str = "semismooth", repeats: int = 3) -> pd.DataFrame:
    """Each step: iterations, factorisations an iteration, operations [million] and CPU time [s] an iteration.

    operations_ratio, time_ratio: to those of the press without friction, an iteration.  Times are the least of so many
    repeats, each of them with both, so that a machine that slows down slows both.
    """
    runs = [list(_both(mesh, contact)) for _ in range(repeats)]
    table = pd.DataFrame(runs[0])
    table["cpu_s"] = [min(run[k]["cpu_s"] for run in runs) for k in range(len(table))]
    plain = table.iloc[0]
    table["operations_ratio"] = table["operations"] / plain["operations"]
    table["time_ratio"] = table["cpu_s"] / plain["cpu_s"]
    return table


def _both(mesh: str, contact: str) -> Iterator[dict[str, Any]]:
    for settings in (SETTINGS, {**SETTINGS, **RUBBED}):
        scene, request = complete("tyre", settings, mesh, contact=contact, model="full")
        stages: Iterable[Stage] = scene.build(request).stages()
        rubbed = "mu" in settings
        stages = Stages(stages, request.settings) if rubbed else stages
        yield from _steps(stages, configured(contact, request.settings), rubbed=rubbed)


def _steps(stages: Iterable[Stage], algorithm: ContactAlgorithm, *, rubbed: bool) -> Iterator[dict[str, Any]]:
    spent, clock = sum(SPENT.values()), time.process_time()
    for visited in walk(stages, algorithm):
        counters = visited.point.solution.counters
        now, at = sum(SPENT.values()), time.process_time()
        iterations = counters["newton_iterations"]
        if len(visited.problem.weights):
            yield {
                "stage": visited.stage.name,
                "friction": int(rubbed),
                "load": visited.point.requested,
                "outcome": visited.point.outcome.word,
                "iterations": int(iterations),
                "factorisations": counters["factorisations"] / iterations,
                "operations": (now - spent) / iterations / 1e6,
                "cpu_s": (at - clock) / iterations,
            }
        spent, clock = sum(SPENT.values()), time.process_time()
