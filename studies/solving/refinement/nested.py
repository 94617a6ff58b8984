"""States of a path on a coarser grid as starts of the same path on another: nested iteration.

Results on coarser grids are not judged: they are starts, and values to compare with. The answer is that of the
last grid alone: where its path from a known one fails, or comes to a state that is not stable, it is followed from
rest, and that decides. Source: Hackbusch, Multi-Grid Methods (1985), ch. 5.

How states come from grid to grid is :mod:`studies.solving.refinement.carried`.
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from itertools import pairwise
from typing import Any

import numpy as np

from contact.continuation.candidates import Start, Starts, State
from contact.continuation.load_stepping import SMALLEST
from studies.ask.request import Request
from studies.ask.scene import CurveStage, Scene, SceneModel, ShellSceneModel, Stage
from studies.ask.settings import configured
from studies.scenes.plugins import blamed
from studies.scenes.walk import Visited, no_starts, walk
from studies.solving.refinement.carried import starts_from
from studies.solving.refinement.grids import element_size
from studies.solving.result import CONVERGED, Result
from studies.solving.solve import Late, StartsOf, Walked, counted, solve, stages_of

CUT = 0.5  # smallest part of a step on a coarser grid: one that is hard is left to the finer one
LOOSE = 1e-5  # of the forces: what a start is off is far more
FAR = 0.5  # of a step: a start farther than that from its state is not used


@dataclass(frozen=True, eq=False)
class Sketch:
    """A path that was followed and not judged: the requested points, what is read off them, and what it has cost.

    model, visits: none where only the values are kept.  tolerance: of the forces in balance.
    loads: a row a requested load, or the last point of a curve.
    quantities: the headline values.  clocks: CPU and wall time [s].  work: floating-point operations by kind.
    strayed: by stage the largest distance of a state from its start on a coarser grid, over its step; 0 without one.
    loaded: which of the visits the rows of ``loads`` are read off.
    """

    request: Request
    unknowns: int
    model: SceneModel | None
    visits: Sequence[Visited]
    tolerance: float
    loads: Sequence[dict[str, Any]]
    quantities: dict[str, float]
    clocks: Mapping[str, float]
    work: Mapping[str, int]
    strayed: Mapping[str, float] = field(default_factory=dict)
    loaded: Sequence[int] = ()

    @property
    def seconds(self) -> float:
        """CPU time."""
        return self.clocks["cpu"]

    @property
    def as_good(self) -> Walked | None:
        """What there is to judge of a path to the tolerance that its request has; None where it is but a start."""
        if self.model is None or self.tolerance > self.request.number("tolerance"):
            return None
        return Walked(self.model, self.visits, self.clocks, self.work)

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


def touches(visited: Visited) -> bool:
    """Whether some candidates are in contact."""
    return bool(np.any(visited.point.solution.active))


def solve_from(
    scene: Scene, request: Request, known: Sketch | None, progress: Callable[[str], None] = lambda text: None
) -> Result:
    """The result on the grid of the request, its path started from a known one; from rest where that is not stable.

    A path that is known on this grid, to the tolerance of the request, is judged as it stands.
    """
    known = known if known is not None and known.model is not None else None
    walked = known.as_good if known is not None and known.request is request else None
    starts = None if known is None or walked is not None else partial(starts_of, known)
    result = solve(scene, request, progress, starts, walked)
    if known is None or result.verdict == CONVERGED or result.unsupported:
        return result
    again = solve(scene, request, progress)
    if again.verdict != result.verdict:
        again.remarks.append(f"from a coarser grid the path is {result.verdict}: this one starts from rest")
    return again


def sketch(
    scene: Scene,
    request: Request,
    coarser: Sketch | None = None,
    loose: float = LOOSE,
    starts: StartsOf | None = None,
    lost: Callable[[str], None] = lambda why: None,
    seconds: float = math.inf,
) -> Sketch | None:
    """The path of a request to forces in balance to ``loose``; None where it does not reach its end.

    An algorithm that does not get there to ``loose`` has another go to the tolerance asked for.
    starts: where the steps of a model set out from; by default the path on the ``coarser`` grid.  lost: told why not.
    seconds: of CPU time, after which it is left.
    Raises PartError where a part from outside breaks.
    """
    if starts is None and coarser is not None:
        starts = partial(starts_of, coarser)
    wall, start = time.perf_counter(), time.process_time()
    with counted() as work, blamed(request.contact, request.measure, scene):
        model, asked = scene.build(request), request.number("tolerance")
        given = Given(no_starts if starts is None else starts(model))
        smallest = CUT if isinstance(model, ShellSceneModel) and loose > asked else SMALLEST

        def look(stage: str, t: float) -> None:
            if time.process_time() - start > seconds:
                raise Late(f"{stage} at {t:g}: after {seconds:.2g} s")

        follow = partial(_sketched, request, model, given, smallest, look)
        try:
            path = follow(max(loose, asked))
            if isinstance(path, str) and loose > asked:
                path = follow(asked)
        except Late as late:
            path = str(late)
    if isinstance(path, str):
        lost(path)
        return None
    clocks = {"total": time.perf_counter() - wall, "cpu": time.process_time() - start}
    return replace(path, clocks=clocks, work=work)


def _sketched(
    request: Request,
    model: SceneModel,
    given: Given,
    smallest: float,
    look: Callable[[str, float], None],
    tolerance: float,
) -> Sketch | str:
    """The path, or why it does not reach its end.  smallest: fraction of a step below which it is not cut."""
    visits, loads, quantities, loaded = list[Visited](), list[dict[str, Any]](), dict[str, float](), list[int]()
    try:
        algorithm = configured(request.contact, request.settings.with_values(tolerance=tolerance))
    except ValueError as error:  # an invalid parameter: the solve reports it
        return str(error)
    how = request.steps, None, look, smallest, given.to
    for visited in walk(stages_of(model, request), algorithm, *how):
        if not visited.converged:
            why = visited.said or visited.point.outcome.value
            return f"{visited.stage.name} at {visited.point.requested:g}: {why}"
        visits.append(visited)
        at = visited.point.reached  # a curve has what is asked for before its last target
        observation = visited.stage.observe(visited.problem_at(at), visited.point.solution, at)
        quantities |= observation.quantities
        if visited.trace is not None and isinstance(visited.stage, CurveStage):
            quantities |= visited.stage.summarise(visited.trace.points)
        if observation.step is not None:
            loads.append(observation.step)
            loaded.append(len(visits) - 1)
    if not loads:
        return "nothing is read off it"
    strayed = dict[str, float]()
    for visited in visits:
        strayed[visited.stage.name] = max(strayed.get(visited.stage.name, 0.0), given.strayed(visited))
    return Sketch(request, model.n_unknowns, model, visits, tolerance, loads, quantities, {}, {}, strayed, loaded)


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
    """Where the steps of a model set out from: the path that is known, but for stages that strayed as far."""
    if not isinstance(known.model, ShellSceneModel):
        return no_starts
    near = [visited for visited in known.visits if known.strayed.get(visited.stage.name, 0.0) < FAR]
    return starts_from(near, known.model, model)
