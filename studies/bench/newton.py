"""``footprint bench newton`` and ``scaling``: what one Newton step on the tyre in contact costs, and how that grows.

The tyre of the paper, its pressed state and the parts of one step are what the other benchmarks measure, too. Of
``scaling`` every size is measured in a process of its own, so that its peak memory is its own. The state is that of one
coarse solve, interpolated: what a step costs does not depend on how the step was reached.
"""

from __future__ import annotations

import multiprocessing
import statistics
import time
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass, field
from functools import partial
from typing import Any, ParamSpec, TypeVar

import numpy as np
import pandas as pd
from scipy import sparse

from contact.algorithms.semismooth import Semismooth
from contact.newton.pivots import Pivots
from contact.newton.ports import Bound
from contact.newton.solves import Tally
from contact.newton.step import NewtonRun
from contact.problem import ContactProblem, ContactSolution
from contact.solvers.analysis import analysed, clear
from contact.solvers.sparse import Factor, backward_error, factor_flops, factorise
from formulations.geometry.grid import TensorGrid
from formulations.geometry.transfer import Transfer
from formulations.shell import ShellModel
from studies.ask.request import Request
from studies.ask.scene import UsageError
from studies.output.stopwatch import CPU, WALL, Clock, timed
from studies.output.terminal import columns
from studies.run.task import status_MB
from studies.scenes.complete import complete
from studies.scenes.tyre.model import TyreModel
from studies.scenes.tyre.scene import Tyre
from studies.scenes.walk import walk

MESHES = ("20x18", "42x40", "84x80", "132x128", "210x200", "416x410")  # 2, 10, 40, 100, 250, 1000 thousand unknowns
COARSE = "42x40"
FITTED_FROM = 9_000  # unknowns; below, calls cost more than numbers
SECONDS = 20.0  # spent on one size at the least, or MOST repetitions
LEAST, MOST = 3, 25
SHOWN = {name: name for name in ("elements", "scatter", "prediction", "contact", "factorisation")}
SHOWN |= {"solution": "solve", "total": "total"}  # parts of an iteration by the name that they are shown under
TIMES = ("elements", "scatter", "assembly", "factorisation", "solve", "contact", "total")
# what the time of a part is compared with: the same machine, the same run, no code of ours; core: the operations of the
# factorisation at the rate of a product of large matrices
FLOORS = dict.fromkeys(TIMES, "copy") | {"elements": "gemm"} | dict.fromkeys(("factorisation", "total"), "core")
BY_SUPERLU = 300_000  # unknowns up to which SuperLU factorises the same matrix, too: a million take minutes
GEMM, COPIED = 1000, 100_000_000  # rows and columns of the matrices multiplied; bytes
LINEAR = 1  # degree that carries pressures without overshooting
P = ParamSpec("P")
T = TypeVar("T")


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


def pressed(model: TyreModel) -> tuple[ContactProblem, ContactSolution]:
    """The last problem of the path and its solution."""
    *_, last = walk(model.stages(), Semismooth())
    return last.problem, last.state


def bench(mesh: str = COARSE, repeats: int = 9) -> tuple[int, dict[str, float]]:
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


@dataclass(frozen=True, eq=False)
class Pressed:
    """The pressed tyre on a grid: v (N, 6) [mm] and pressure (N,) [MPa] at its nodes."""

    grid: TensorGrid
    v: np.ndarray
    pressure: np.ndarray

    @classmethod
    def of(cls, model: TyreModel) -> Pressed:
        """Solved, off its unknowns."""
        state, grid = pressed(model)[1], model.part.grid
        assert isinstance(grid, TensorGrid)
        return cls(grid, model.shell.displacements(state.u).reshape(grid.n_nodes, -1), model.outer_pressure(state))

    def on(self, model: TyreModel) -> tuple[np.ndarray, np.ndarray]:
        """Unknowns (n,) and pressures (m,) of the state on another grid, bilinear in psi and phi."""
        transfer = Transfer(self.grid, model.part.grid)
        v, pressure = (transfer.nodal(values, LINEAR) for values in (self.v, self.pressure))
        return model.shell.discretisation.map.restrict(v), pressure[model.nodes]


@dataclass(frozen=True, eq=False)
class _Kept(NewtonRun):
    """A run that keeps the matrices it has factorised, their factors and the largest backward error."""

    matrices: list[sparse.csc_matrix] = field(default_factory=list)
    factors: list[Factor] = field(default_factory=list)
    errors: list[float] = field(default_factory=list)

    def factorise(self, A: sparse.csc_matrix, of: Bound | Pivots | None = None) -> Factor:
        """Factorise and keep."""
        self.matrices.append(A)
        self.factors.append(super().factorise(A, of))
        return self.factors[-1]

    def solution(self, factor: Factor, A: sparse.csc_matrix, b: np.ndarray) -> np.ndarray:
        """Solve and keep the error."""
        x = super().solution(factor, A, b)
        self.errors.append(backward_error(A, x, b))
        return x


def scaling(
    meshes: Sequence[str] = MESHES,
    progress: Callable[[int, int, str], None] = lambda done, planned, label: None,
    *,
    coarse: str = COARSE,
    seconds: float = SECONDS,
) -> pd.DataFrame:
    """One row a mesh: mesh, dofs, elements, shortest times [s] of the parts and the floors, peak memory [GiB].

    analysis: of the pattern, once a solve.  superlu: of the same matrix, NaN where it would take minutes.  core: the
    operations of the factorisation by fronts at the rate of a product of large matrices.  backward_error: of the
    solution, the largest.

    Times are processor time of one thread (OPENBLAS_NUM_THREADS=1, as the command line sets it), the shortest of
    several repetitions: other programs on the machine disturb that least. Tyre of the paper with its element, model
    ``full``, 20 mm. Raises UsageError for a mesh that the tyre cannot have.
    """
    for mesh in (*meshes, coarse):
        request_of(mesh)
    progress(0, len(meshes), f"{coarse} into contact")
    state = _alone(_pressed, coarse)
    rows = []
    for done, mesh in enumerate(meshes):
        progress(done, len(meshes), mesh)
        rows.append(_alone(_cost, mesh, state, seconds))
    progress(len(meshes), len(meshes), "done")
    return pd.DataFrame(rows)


def exponents(table: pd.DataFrame, smallest: int = FITTED_FROM) -> dict[str, float]:
    """The p of time = c dofs^p for every part: least squares of log time over log dofs, sizes from ``smallest`` on.

    NaN where fewer than two sizes are left.
    """
    large = table[table["dofs"] >= smallest]
    if len(large) < 2:
        return dict.fromkeys(TIMES, float("nan"))
    size = np.log(large["dofs"].to_numpy(float))
    return {part: float(np.polyfit(size, np.log(large[f"{part}_s"].to_numpy(float)), 1)[0]) for part in TIMES}


def lines(table: pd.DataFrame, *, floors: bool = False) -> Iterator[str]:
    """The table for a terminal, in ms, with its exponents; ``floors``: each time over that of its floor."""
    rows = [["mesh", "dofs", *TIMES, "us/element", "of superlu", "error", "GiB"]]
    for row in table.to_dict("records"):
        cells = [f"{1e3 * row[f'{part}_s']:.2f}" + _ratio(row, part, floors) for part in TIMES]
        per_element = 1e6 * row["elements_s"] / row["elements"]
        share, error = row["factorisation_s"] / row["superlu_s"], f"{row['backward_error']:.1e}"
        rows.append([row["mesh"], str(row["dofs"]), *cells, f"{per_element:.2f}"])
        rows[-1] += ["" if np.isnan(share) else f"{share:.2f}", error, f"{row['peak_GiB']:.2f}"]
    rows.append(["exponent", f"from {FITTED_FROM}", *(f"{p:.2f}" for p in exponents(table).values()), *[""] * 4])
    yield from columns(rows, right=range(len(rows[0])))
    if floors:
        yield "in brackets: over the machine's floor in the same run, for " + ", ".join(
            f"{part} {floor.replace('_', ' ')}" for part, floor in FLOORS.items()
        )
        for floor, what in (("gemm", f"product of matrices {GEMM}x{GEMM}"), ("copy", f"copy of {COPIED // 10**6} MB")):
            yield f"{what}: {1e3 * statistics.median(table[f'{floor}_s']):.2f} ms"


def _ratio(row: dict[Any, Any], part: str, floors: bool) -> str:
    return f" ({row[f'{part}_s'] / row[f'{FLOORS[part]}_s']:.2f})" if floors else ""


def _alone(work: Callable[P, T], *arguments: P.args, **named: P.kwargs) -> T:
    """The same in a fresh process: nothing of what others have allocated counts."""
    with ProcessPoolExecutor(1, mp_context=multiprocessing.get_context("spawn")) as pool:
        return pool.submit(work, *arguments, **named).result()


def _pressed(mesh: str) -> Pressed:
    return Pressed.of(tyre(request_of(mesh)))


def _cost(mesh: str, coarse: Pressed, seconds: float) -> dict[str, Any]:
    model = tyre(request_of(mesh))
    u, pressure = coarse.on(model)
    *_, stage = model.stages()
    rest = ContactSolution.at_rest(model.n_unknowns, 0)
    state = ContactSolution(u, pressure, pressure > 0, rest.outcome)
    problem = stage.begin(state)[0](0.0)  # the plane touches the state as it is: gaps are no matter of cost
    shell = model.shell
    memory = shell.linearise(u, None).remember(np.zeros_like(u))
    samples: list[dict[str, float]] = []
    start, peak = time.perf_counter(), 0.0
    while len(samples) < LEAST or (time.perf_counter() - start < seconds and len(samples) < MOST):
        sample, run = _sample(shell, problem, state, memory)
        # before the floors have taken theirs; ru_maxrss would include the parent: it survives fork and exec
        peak = peak or status_MB("VmHWM") / 1024
        samples.append({**sample, **_floors(run, problem)})
    best = {f"{key}_s": min(sample[key] for sample in samples) for key in samples[0]}
    sizes = {"mesh": mesh, "dofs": model.n_unknowns, "elements": len(model.part.grid.elements)}
    error = max(run.errors)
    return {**sizes, **best, "peak_GiB": peak, "backward_error": error, "repeats": len(samples)}


def _sample(
    shell: ShellModel, problem: ContactProblem, state: ContactSolution, memory: object
) -> tuple[dict[str, float], _Kept]:
    """One Newton step, whole and by its parts [s], and what it has factorised and solved."""
    run = _Kept(problem, tally=Tally(clock=CPU))
    tangent = problem.linearise(state.u, memory).tangent
    clear()
    analysis, _ = timed(partial(analysed, tangent))
    spent = parts(shell, run, state, memory, CPU)
    spent["assembly"] = spent["elements"] + spent["scatter"]
    return {**{part: spent[part] for part in TIMES}, "analysis": analysis}, run


def _floors(run: _Kept, problem: ContactProblem) -> dict[str, float]:
    """Times [s] of the same factorisation by SuperLU, of a matrix product, at its rate, and of a copy."""
    square, memory = np.ones((GEMM, GEMM)), np.ones(COPIED, np.uint8)
    target = np.zeros_like(memory)  # touched: the first touch of fresh memory costs more than the copy
    matrix, flops = run.matrices[-1], factor_flops(run.factors[-1])
    run.factors.clear()  # room for the other factors
    gemm, _ = timed(partial(np.matmul, square, square))
    small = matrix.shape[0] <= BY_SUPERLU
    return {
        "superlu": timed(partial(factorise, matrix, "splu", ordered=problem.ordered))[0] if small else float("nan"),
        "gemm": gemm,
        "core": gemm * flops / (2 * GEMM**3),
        "copy": timed(partial(np.copyto, target, memory))[0],
    }
