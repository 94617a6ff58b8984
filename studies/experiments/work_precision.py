"""Work and precision of the tyre's grids: the force on uniform, patch and adapted ones, and what it costs."""

from __future__ import annotations

import time
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import pandas as pd

from studies.complete import complete
from studies.request import Request
from studies.scene import Scene
from studies.scenes.tyre.scene import Tyre
from studies.solving import solve

FAMILIES = dict.fromkeys(("uniform", "patch"), tuple((n, n) for n in range(20, 84, 4)))
ELEMENTS = (400, 500, 600, 700, 800, 900, 1000, 1200, 1400, 1700, 2000, 2500)  # of the adapted one
REFERENCE = (7000, 10_000)  # elements of adapted grids whose mean force is the extrapolated value where none is given
COLUMNS = ("family", "mesh", "unknowns", "force_N", "error", "factorisation_s", "total_s")


def work_precision(
    settings: Mapping[str, str],
    families: Mapping[str, Sequence[tuple[int, int]]] = FAMILIES,
    elements: Sequence[int] = ELEMENTS,
    reference: float | None = None,
) -> pd.DataFrame:
    """One row a grid with COLUMNS: force at the last travel [N], signed relative error, seconds.

    families: grids of each grading but "adapted", whose numbers of elements are ``elements``; the total time of each of
    these includes the estimate on coarse grids, once. reference [N]: what the errors are against.
    """
    rows = []
    for family, meshes in families.items():
        scene, request = complete("tyre", {**settings, "grading": family})
        rows += [_solved(scene, request, mesh, 0.0) for mesh in meshes]
    scene, request = complete("tyre", {**settings, "grading": "adapted"})
    assert isinstance(scene, Tyre)
    start = time.perf_counter()
    scene = scene.adapted(request)
    estimate = time.perf_counter() - start
    adapted = [_solved(scene, request, scene.mesh_of(request, count), estimate) for count in elements]
    if reference is None:
        fine = [_solved(scene, request, scene.mesh_of(request, count), estimate) for count in REFERENCE]
        reference = sum(row["force_N"] for row in fine) / len(fine)
    table = pd.DataFrame(rows + adapted)
    table["error"] = table["force_N"] / reference - 1
    return table[list(COLUMNS)]


def work_precision_study() -> pd.DataFrame:
    """The paper's tyre at 20 mm with the paper's element and with the default one, told apart by a column."""
    elements = ("paper", "refined")
    tables = [work_precision({"element": each, "delta_mm": "20"}).assign(element=each) for each in elements]
    return pd.concat(tables, ignore_index=True)


def _solved(scene: Scene, request: Request, mesh: tuple[int, int], before: float) -> dict[str, Any]:
    """A row without its error; raises RuntimeError where the tyre is not solved."""
    result = solve(scene, replace(request, mesh=mesh))
    if not result.outcome.converged:
        raise RuntimeError(f"{mesh[0]}x{mesh[1]}: {result.reason}")
    return {
        "family": str(request.settings["grading"]),
        "mesh": f"{mesh[0]}x{mesh[1]}",
        "unknowns": result.counters["dofs"],
        "force_N": float(result.steps[-1]["force_N"]),
        "factorisation_s": result.timing["factorisation"],
        "total_s": result.timing["total"] + before,
    }
