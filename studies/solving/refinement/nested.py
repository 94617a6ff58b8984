"""Nested iteration: a path is followed on a coarser grid first, which starts it near its solution on the next one.

What coarser grids have come to is not judged: they are starts, and values to compare with. The answer is that of the
last grid alone: where its path from a known one fails, or comes to a state that is not stable, it is followed from
rest, and that decides. Source: Hackbusch, Multi-Grid Methods (1985), ch. 5.
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from itertools import pairwise, product
from typing import Any, Protocol, runtime_checkable

import numpy as np

from contact.continuation.critical_points import State
from contact.continuation.starts import Start, Starts
from studies.ask.request import Request
from studies.ask.scene import CurveStage, Scene, SceneModel, ShellSceneModel, Stage, UsageError
from studies.ask.settings import configured
from studies.scenes.plugins import blamed
from studies.scenes.walk import Visited, no_starts, walk
from studies.solving.refinement.carried import starts_from
from studies.solving.result import CONVERGED, Result
from studies.solving.solve import cold, solve, stages_of

COARSER = 4  # the default mesh over the coarsest one
FEWEST = 4  # elements along a coordinate, below which it is not made coarser
NEAR = 2  # how far from the elements that are wanted those of a grid may be, where a scene does not take them
CUT = 0.5  # smallest part of a step on a coarser grid: one that is hard is left to the finer one
LOOSE = 1e-5  # of the forces: what a start is off is far more
FAR = 0.5  # of a step, as far as which from its state a start is none


@runtime_checkable
class AdaptedScene(Protocol):
    """A scene whose grid lines may follow an estimate of the error, ``grading=adapted``."""

    def adapted(self, request: Request) -> Scene:
        """With the estimate, for grids of any number of elements; raises UsageError where there is none."""


@dataclass(frozen=True, eq=False)
class Sketch:
    """A path on a coarser grid: the requested points, what is read off them, and the CPU time.

    model, visits: none where only the values are kept.  loads: a row a requested load, or the last point of a curve.
    quantities: the headline values.  strayed: the largest distance of a state from its start on a coarser grid, over
    its step; 0 where no step had one.
    """

    request: Request
    unknowns: int
    model: ShellSceneModel | None
    visits: Sequence[Visited]
    loads: Sequence[dict[str, Any]]
    quantities: dict[str, float]
    seconds: float
    strayed: float = 0.0

    @classmethod
    def of(cls, result: Result) -> Sketch:
        """A path that was solved to its last load, with all that it cost."""
        assert isinstance(result.model, ShellSceneModel)
        loads, seconds = [step.seen for step in result.loads], result.timing["cpu"]
        unknowns = result.model.n_unknowns
        return cls(result.request, unknowns, result.model, result.visits, loads, result.quantities, seconds)

    @property
    def values_only(self) -> Sketch:
        """Without the states, kilobytes an unknown: from here no path is started any more."""
        return replace(self, model=None, visits=())

    @property
    def end(self) -> Visited:
        """The last requested point."""
        return self.visits[-1]

    @property
    def mesh(self) -> str:
        """N1xN2."""
        return self.request.mesh_text

    @property
    def size(self) -> float:
        """Of the elements, over that of a single one."""
        return element_size(self.request)


def element_size(request: Request) -> float:
    """Of the elements along the coordinates that have several, over that of a single one."""
    several = [n for n in request.mesh if n > 1] or [1]
    return math.prod(several) ** (-1 / len(several))


def ways(request: Request) -> int:
    """Coordinates that have several elements."""
    return sum(n > 1 for n in request.mesh)


def touches(visited: Visited) -> bool:
    """Whether some candidates are in contact."""
    return bool(np.any(visited.point.solution.active))


def solve_from(
    scene: Scene, request: Request, known: Sketch | None, progress: Callable[[str], None] = lambda text: None
) -> Result:
    """The result on the grid of the request, its path started from a known one; from rest where that is not stable."""
    result = solve(scene, request, progress, partial(starts_of, known) if known is not None else cold)
    if known is None or result.verdict == CONVERGED or result.unsupported:
        return result
    again = solve(scene, request, progress)
    if again.verdict != result.verdict:
        again.remarks.append(f"from a coarser grid the path is {result.verdict}: this one is followed from rest")
    return again


def sketch(scene: Scene, request: Request, coarser: Sketch | None = None, loose: float = LOOSE) -> Sketch | None:
    """The path of a request to forces in balance to ``loose``; None where it does not get there.

    Raises PartError where a part from outside breaks.
    """
    with blamed(request.contact, request.measure, scene):
        return _sketched(scene, request, coarser, loose)


def _sketched(scene: Scene, request: Request, coarser: Sketch | None, loose: float) -> Sketch | None:
    start = time.process_time()
    model = scene.build(request)
    tolerance = max(loose, request.number("tolerance"))
    visits, loads, quantities = list[Visited](), list[dict[str, Any]](), dict[str, float]()
    if not isinstance(model, ShellSceneModel):
        return None
    try:
        algorithm = configured(request.contact, request.settings.with_values(tolerance=tolerance))
    except ValueError:  # a parameter that it cannot have: who solves says so
        return None
    given = Given(no_starts if coarser is None else starts_of(coarser, model))
    for visited in walk(stages_of(model, request), algorithm, request.steps, smallest=CUT, starts=given.to):
        if not visited.converged:
            return None
        visits.append(visited)
        at = visited.point.reached  # a curve has what is asked for before its last target
        seen = visited.stage.observe(visited.problem_at(at), visited.point.solution, at)
        quantities |= seen.quantities
        if visited.trace is not None and isinstance(visited.stage, CurveStage):
            quantities |= visited.stage.summarise(visited.trace.points)
        if seen.step is not None:
            loads.append(seen.step)
    if not loads:
        return None
    strayed = max(map(given.strayed, visits))
    seconds = time.process_time() - start
    return Sketch(request, model.n_unknowns, model, visits, loads, quantities, seconds, strayed)


@dataclass(frozen=True, eq=False)
class Given:
    """The starts of a path, and which of them it has been given."""

    starts: Callable[[Stage], Starts]
    used: dict[tuple[str, float], np.ndarray] = field(default_factory=dict)

    def to(self, stage: Stage) -> Starts:
        """Those of a stage, on record."""
        starts = self.starts(stage)

        def at(index: int, last: State, parameter: float) -> Start | None:
            start = starts(index, last, parameter)
            if start is not None:
                self.used[stage.name, parameter] = start.u
            return start

        return at

    def strayed(self, visited: Visited) -> float:
        """The largest distance of a state on the way to a point from its start, over that from the state before."""
        far = 0.0
        for (_, before), (t, state) in pairwise(visited.point.way):
            u = self.used.get((visited.stage.name, t))
            if u is not None:
                moved = float(np.linalg.norm(state.u - before.u))
                far = max(far, float(np.linalg.norm(state.u - u)) / (moved or math.inf))
        return far


def starts_of(known: Sketch, model: SceneModel) -> Callable[[Stage], Starts]:
    """Where the steps of a model set out from: the path that is known, unless its own starts were as far from it."""
    if known.model is None or known.strayed >= FAR:
        return no_starts
    return starts_from(known.visits, known.model, model)


def quarter(scene: Scene) -> tuple[int, int]:
    """A quarter of the default mesh both ways."""
    n1, n2 = (n if n == 1 else max(2, n // COARSER) for n in scene.default_mesh)
    return n1, n2


def near(scene: Scene, request: Request, times: float) -> Request | None:
    """The request with so many times the elements along each coordinate, or nearly; None where there is no such grid.

    A coordinate with one element keeps it, and none is made coarser than FEWEST.
    """
    wanted = [n if n == 1 else max(n * times, min(n, FEWEST)) for n in request.mesh]
    around = [[n] if n == 1 else _around(want) for n, want in zip(request.mesh, wanted, strict=True)]
    for mesh in sorted(
        product(*around), key=lambda mesh: sum(abs(n / w - 1) for n, w in zip(mesh, wanted, strict=True))
    ):
        asked = replace(request, mesh=(mesh[0], mesh[1]))
        try:
            scene.build(asked)
        except UsageError:
            continue
        return asked if mesh != request.mesh else None
    return None


def _around(wanted: float) -> list[int]:
    return [n for n in range(round(wanted) - NEAR, round(wanted) + NEAR + 1) if n > 1]
