"""What a solve will take, before it begins: unknowns, seconds and memory, from the same path on two small grids.

On each of them the path is solved, and the fronts of its tangent are analysed. Per unknown, what an iteration costs
grows with the square root of the number of unknowns n (elimination by nested dissection takes O(n^3/2) operations),
entries of the factors with its logarithm (O(n log n)); iterations, seconds per operation and all other memory per
unknown are those of the finer of the two. Source: George, SIAM J. Numer. Anal. 10 (1973) 345-363. Nothing is refused
here, and no limit is set.
"""

from __future__ import annotations

import math
import tracemalloc
from dataclasses import dataclass

import numpy as np
from scipy import sparse

from contact.solvers.analysis import analysed, clear
from contact.solvers.sparse import symmetric
from studies.ask.request import Request
from studies.ask.scene import Scene, ShellSceneModel
from studies.solving.refinement.grids import element_size, near, ways
from studies.solving.solve import solve

ELEMENTS = (100, 400)  # of the two grids, nearly
HELD = (
    1.05  # memory that a process holds over what it has allocated: 1.01 to 1.08 on shells of 10 to 61 thousand unknowns
)
MB = 2**20
FLOAT = 8


@dataclass(frozen=True)
class Foresight:
    """unknowns: of the grid.  seconds: of CPU time, None where the path fails on a small grid.

    memory_MB: the largest at a time, beyond that of a process at rest.
    """

    unknowns: int
    seconds: float | None
    memory_MB: float

    def __str__(self) -> str:
        seconds = "" if self.seconds is None else f" {_rounded(self.seconds):,} CPU s,"
        return f"about {_rounded(self.unknowns):,} unknowns,{seconds} {_rounded(self.memory_MB):,} MB"


@dataclass(frozen=True)
class _Seen:
    """Of one small grid: unknowns, entries of the factors, peak of memory, and what the path has cost if it has ended.

    cost: CPU seconds, operations and iterations.
    """

    unknowns: int
    entries: int
    peak_MB: float
    cost: tuple[float, float, float] | None


def foresee(scene: Scene, request: Request) -> Foresight | None:
    """None without two coarser grids, or for a body that is not a shell."""
    many = max(ways(request), 1)
    grids = [near(scene, request, (elements / math.prod(request.mesh)) ** (1 / many)) for elements in ELEMENTS]
    small_grid, large_grid = grids
    if small_grid is None or large_grid is None or element_size(large_grid) <= element_size(request):
        return None
    small, large = _look(scene, small_grid), _look(scene, large_grid)
    if small is None or large is None:
        return None
    times = (element_size(large_grid) / element_size(request)) ** many
    n, more = large.unknowns * times, large.unknowns / small.unknowns
    if more <= 1:
        return None
    fill = [each.entries / each.unknowns for each in (small, large)]
    filled = max(fill[1] - fill[0], 0.0) / math.log(more) * math.log(times)
    memory = large.peak_MB * times + FLOAT * filled * n / MB
    return Foresight(int(n), _seconds(small, large, times), memory)


def _seconds(small: _Seen, large: _Seen, times: float) -> float | None:
    """Of so many times the unknowns of the larger grid."""
    if small.cost is None or large.cost is None:
        return None
    seconds, operations, iterations = large.cost
    each = [grid.cost[1] / max(grid.cost[2], 1) / grid.unknowns for grid in (small, large) if grid.cost is not None]
    root = math.sqrt(large.unknowns / small.unknowns)
    slope = max(each[1] - each[0], 0.0) / (root - 1) * root  # a + b sqrt(n): b sqrt(n) on the larger grid
    grown = each[1] + slope * (math.sqrt(times) - 1)
    return seconds / max(operations, 1.0) * iterations * large.unknowns * times * grown


def _look(scene: Scene, request: Request) -> _Seen | None:
    """One small grid, solved from rest and judged; the second time, which is not traced, shows the seconds."""
    if not isinstance(scene.build(request), ShellSceneModel):
        return None
    clear()  # an analysis that is kept from before would not be counted
    tracing = tracemalloc.is_tracing()
    tracemalloc.start()
    try:
        before = tracemalloc.get_traced_memory()[0]
        tracemalloc.reset_peak()
        solve(scene, request)
        peak = HELD * (tracemalloc.get_traced_memory()[1] - before) / MB
    finally:
        if not tracing:
            tracemalloc.stop()
    result, model = solve(scene, request), scene.build(request)
    assert isinstance(model, ShellSceneModel)
    cost = (result.timing["cpu"], result.counters["operations"], result.counters.get("newton_iterations", 0))
    return _Seen(model.n_unknowns, _entries(model), peak, cost if result.outcome.converged else None)


def _entries(model: ShellSceneModel) -> int:
    """Of the factors of the tangent at rest: m (m + 1)/2 + m b of every front, of all if it is not symmetric."""
    K = sparse.csc_matrix(model.shell.linearise(np.zeros(model.n_unknowns)).tangent)
    K, analysis = analysed(K)
    sizes = [(front.stop - front.start, len(front.boundary)) for front in analysis.fronts]
    half = sum(m * (m + 1) // 2 + m * b for m, b in sizes)
    return half if symmetric(K) else 2 * half


def _rounded(value: float) -> float:
    """To two digits."""
    return int(float(f"{value:.2g}")) if value >= 10 else float(f"{value:.2g}")
