"""``footprint bench newton`` and ``scaling``: what one Newton step on the tyre in contact costs, and how that grows.

The tyre of the paper and its tangent are what the other benchmarks measure, too. On each mesh it is pressed from the
path on the one before.

``footprint bench overhead``: what running a cell costs beside solving it.
"""

from __future__ import annotations

import statistics
import tempfile
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import closing
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from contact.newton.solves import Tally
from contact.newton.step import NewtonRun
from contact.problem import ContactSolution
from formulations.shell import ShellModel
from studies.ask.request import Request
from studies.ask.scene import UsageError
from studies.output.stopwatch import CPU, WALL, timed
from studies.run.archive import Archive
from studies.run.children import Children
from studies.run.plan import planned
from studies.run.task import Limits, status_MB
from studies.scenes.complete import Cell, complete
from studies.scenes.tyre.model import TyreModel
from studies.scenes.tyre.scene import Tyre
from studies.scenes.walk import Visited
from studies.solving.refinement.nested import sketch

MESHES = ("20x18", "42x40", "84x80", "132x128", "210x200", "416x410")  # 2, 10, 40, 100, 250, 1000 thousand unknowns
COARSE = "42x40"
FITTED_FROM = 9_000  # unknowns; below, calls cost more than numbers
SECONDS = 20.0  # spent on one size at the least, or MOST repetitions
LEAST, MOST = 3, 25
TIMES = ("elements", "scatter", "assembly", "factorisation", "solve", "contact", "total")


def asked(mesh: str, **settings: str) -> Request:
    """For the whole tyre of the paper, to be pressed by 20 mm; raises UsageError."""
    return complete("tyre", {"delta_mm": "20", **settings}, mesh, model="full")[1]


def request_of(mesh: str) -> Request:
    """The tyre of ``scaling``; raises UsageError for a mesh that it cannot have."""
    request = asked(mesh, element="paper")
    if min(request.mesh) < 6 or request.mesh[0] % 2 or request.mesh[1] % 2:
        raise UsageError(f"mesh {mesh}: both numbers must be even and at least 6")
    return request


def tyre(request: Request) -> TyreModel:
    """The model; raises UsageError."""
    return TyreModel.on(request, *Tyre().lines(request))


def parts(shell: ShellModel, run: NewtonRun, state: ContactSolution, memory: object) -> dict[str, float]:
    """Times [s] of one Newton step: the whole, its parts as the run has counted them, elements and scatter alone."""
    total, _ = timed(partial(_iterate, run, state, memory))
    elements, (_, _, tangents) = timed(partial(shell.element_contributions, state.u, memory))
    scatter, _ = timed(partial(shell.discretisation.assemble, tangents))
    spent = {name: run.tally.counters[f"{name}_s"] for name in ("factorisation", "solve", "contact")}
    return {"elements": elements, "scatter": scatter, "assembly": elements + scatter, **spent, "total": total}


def _iterate(run: NewtonRun, state: ContactSolution, memory: object) -> None:
    """Everything an algorithm does between two iterates."""
    lin = run.linearise(state.u, memory)
    run.closed(run.at(lin, state.u, state.pressure, state.active))
    du, _ = run.step(lin, state.u, state.pressure, state.active)
    run.remember(lin, du)


def scaling(
    meshes: Sequence[str] = MESHES,
    progress: Callable[[int, int, str], None] = lambda done, planned, label: None,
    *,
    coarse: str = COARSE,
    seconds: float = SECONDS,
) -> pd.DataFrame:
    """One row a mesh: mesh, dofs, elements, shortest times [s] of the parts, peak memory [GiB] of the process so far.

    Times are processor time of one thread (OPENBLAS_NUM_THREADS=1, as the command line sets it), the shortest of
    several repetitions: other programs on the machine disturb that least. Tyre of the paper with its element, model
    ``full``, 20 mm. Raises UsageError for a mesh that the tyre cannot have, or on which it is not pressed.
    """
    requests = [request_of(mesh) for mesh in meshes]
    progress(0, len(meshes), f"{coarse} into contact")
    path, rows = sketch(Tyre(), request_of(coarse)), []
    for done, (mesh, request) in enumerate(zip(meshes, requests, strict=True)):
        progress(done, len(meshes), mesh)
        path = sketch(Tyre(), request, path)
        if path is None or not isinstance(path.model, TyreModel):
            raise UsageError(f"mesh {mesh}: the tyre is not pressed by 20 mm on it")
        rows.append({"mesh": mesh, **_cost(path.model, path.end, seconds)})
    progress(len(meshes), len(meshes), "done")
    return pd.DataFrame(rows)


def exponents(table: pd.DataFrame) -> dict[str, float]:
    """The p of time = c dofs^p for every part: least squares of log time over log dofs, sizes from FITTED_FROM on.

    NaN where fewer than two sizes are left.
    """
    large = table[table["dofs"] >= FITTED_FROM]
    if len(large) < 2:
        return dict.fromkeys(TIMES, float("nan"))
    size = np.log(large["dofs"].to_numpy(float))
    return {part: float(np.polyfit(size, np.log(large[f"{part}_s"].to_numpy(float)), 1)[0]) for part in TIMES}


def shown(table: pd.DataFrame) -> str:
    """The table for a terminal, in ms, with its exponents."""
    formatted = pd.DataFrame({name: 1e3 * table[f"{name}_s"] for name in TIMES})
    formatted["us/element"] = 1e6 * table["elements_s"] / table["elements"]
    formatted = formatted.assign(GiB=table["peak_GiB"]).map("{:.2f}".format)
    formatted = pd.concat([table[["mesh", "dofs"]], formatted], axis=1)
    last = {"mesh": "exponent", "dofs": f"from {FITTED_FROM}"}
    last |= {part: f"{p:.2f}" for part, p in exponents(table).items()}
    return pd.concat([formatted, pd.DataFrame([last])]).to_string(index=False, na_rep="")


def _cost(model: TyreModel, end: Visited, seconds: float) -> dict[str, Any]:
    state = end.state
    memory = model.shell.linearise(state.u, None).remember(np.zeros_like(state.u))
    samples: list[dict[str, float]] = []
    start = time.perf_counter()
    while len(samples) < LEAST or (time.perf_counter() - start < seconds and len(samples) < MOST):
        samples.append(parts(model.shell, NewtonRun(end.problem, tally=Tally(clock=CPU)), state, memory))
    best = {f"{part}_s": min(sample[part] for sample in samples) for part in TIMES}
    sizes = {"dofs": model.n_unknowns, "elements": len(model.part.grid.elements)}
    return {**sizes, **best, "peak_GiB": status_MB("VmHWM") / 1024, "repeats": len(samples)}


TRIVIAL = Cell(
    "trivial", "cantilever", {"mesh": "1x1", "measure": "linear"}, {"load_fraction": "0.001"}, artefacts=False
)
SECOND = Cell("of about 1 s", "hemisphere", {"mesh": "24x24"}, artefacts=False)
REPEATS = 9


@dataclass(frozen=True)
class Cost:
    """One row: what was done, its seconds, those of the solve inside it, and the bound it must keep."""

    what: str
    seconds: float
    solve: float
    bound: str
    kept: bool


def harness(repeats: int = REPEATS) -> list[Cost]:
    """Medians over repeats; the store lies in a temporary directory."""
    with tempfile.TemporaryDirectory() as folder, closing(Children()) as children:
        return list(_cells(children, Path(folder), repeats))


def beside_solving(costs: list[Cost]) -> str:
    """A table for the terminal."""
    table = pd.DataFrame(costs).assign(beside_ms=[1e3 * (cost.seconds - cost.solve) for cost in costs])
    return table.to_string(index=False, float_format="{:.4f}".format)


def _cells(children: Children, root: Path, repeats: int) -> Iterator[Cost]:
    """The whole of a task: to the process and back, the record written and on the disk; the process is warm."""
    for cell, times in ((TRIVIAL, repeats), (SECOND, max(2, repeats // 3))):
        spent, inside = [], []
        for _ in range(1 + times):
            task = planned(cell).task(artefacts=True)
            spent.append(timed(partial(children.perform, task, str(root), Limits()), WALL)[0])
            record = Archive(root).record(task.id)
            assert record is not None
            inside.append(record["timing_s"]["total"])
        beside = statistics.median(a - b for a, b in zip(spent[1:], inside[1:], strict=True))
        total, solve = statistics.median(spent[1:]), statistics.median(inside[1:])
        bound, kept = ("50 ms", beside < 0.05) if cell is TRIVIAL else ("5 %", beside < 0.05 * solve)
        yield Cost(f"cell: {cell.label}", total, total - beside, f"beside the solve under {bound}", kept)
