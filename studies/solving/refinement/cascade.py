"""A quantity to an error by a cascade of grids: each up to twice the unknowns of the one before, and started from it.

A grid that is foreseen to be enough has no more unknowns than that takes. It ends with the first grid whose interval is
narrow enough, or with the last that a budget of seconds allows. A cascade that is foreseen to need more than MOST
unknowns is left to grids that are cut where the error is (:mod:`studies.solving.refinement.error_control`), which pay
where something singular decides; where a scene leaves nothing to those, it ends before the grid of so many.
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from contact.problem import Outcome
from studies.ask.request import Request
from studies.ask.scene import CutScene, RefinedScene, Scene, UsageError
from studies.solving.refinement.adaptive_grids import Family, parts_of
from studies.solving.refinement.edge_layer import EdgeLayer
from studies.solving.refinement.error_control import TOO_LONG, solve_to_error
from studies.solving.refinement.grids import element_size, near, ways
from studies.solving.refinement.limits import FEW, FEWEST, Estimate, Seen, estimate_of, of_judged
from studies.solving.refinement.mesh_error import round_of
from studies.solving.refinement.nested import LOOSE, Sketch, sketch, solve_from, touches
from studies.solving.refinement.records import default_quantity, no_limit, record_estimate, record_grids, record_loads
from studies.solving.refinement.rim import rims_of
from studies.solving.result import Result

FINER = math.sqrt(2)  # elements along a coordinate from grid to grid, at the most
CLOSER = 1.3  # the same where the rim of contact is a curve, whose jumps average out, until a limit is stated
CLOSEST = 1.2  # at the least
MOST = 100_000  # unknowns of a grid of a cascade
TIGHT = 1e-2  # of the error asked for: what the iteration on a grid may leave of the forces
JUDGED = 1.0  # CPU seconds of the judged answer of a grid over those of its path
DEARER = 4.0  # CPU seconds of the next grid and of its judged answer over those of the last grid
ALMOST = 1.2  # of the unknowns of the next grid, up to which it is foreseen to be the last
USUAL = 0.04  # a first interval, where something touches
SLOW = 1.5  # the lowest order that a cascade is foreseen to have
TOO_FINE = 0.4  # size of elements over that of the first grid, below which a path that fails is not tried again
ENOUGH = 2  # grids that show what quantities there are
STARTS = 2  # first grids from which paths of other measures and elements may start


@dataclass
class Cascade:
    """Grids of a request, coarse to fine."""

    scene: Scene
    error: float
    quantity: str | None
    grids: list[Sketch] = field(default_factory=list)

    def grow(self, asked: Request, loose: float = LOOSE, seconds: float = math.inf) -> bool:
        """Follow the path on one grid more, to forces in balance to ``loose``; False where it does not reach its end.

        seconds: of CPU time that it may take; the first grid with an answer takes what it takes. The states of the
        first grids stay, where others may start from; those of finer ones until the next.
        """
        coarser, bound = (self.last, seconds) if self.grids else (None, math.inf)
        path = sketch(self.scene, asked, coarser, loose, seconds=bound)
        if path is None:
            return False
        self.quantity = self.quantity or default_quantity(self.scene, path.quantities)
        if len(self.grids) > STARTS:
            self.grids[-1] = self.grids[-1].values_only
        self.grids.append(path)
        return True

    @property
    def name(self) -> str:
        """Of the quantity."""
        assert self.quantity is not None
        return self.quantity

    @property
    def last(self) -> Sketch:
        """The finest grid."""
        return self.grids[-1]

    def stated(self) -> Estimate | str:
        """What all grids so far say of the limit, or why they do not."""
        (rim,) = rims_of(self.last, [self.last.quantities])
        return self._limit(self.values, rim)

    @property
    def values(self) -> list[float]:
        """Of the quantity, by grid; NaN where one does not have it."""
        return [each.quantities.get(self.name, math.nan) for each in self.grids]

    def check_quantity(self, most: int = ENOUGH) -> None:
        """Raise UsageError where more grids than ``most`` do not have the quantity, and none does."""
        if len(self.grids) > most and not any(self.name in each.quantities for each in self.grids):
            has = ", ".join(self.last.quantities)
            raise UsageError(f"{self.scene.name} has no quantity {self.name!r}; it has {has}")

    def at_loads(self, judged: Sequence[float]) -> list[Estimate | str]:
        """The same at every requested load, of which the last grid has these values once it is judged.

        Empty where loads do not have the quantity.
        """
        if any(step.get(self.name) is None for each in self.grids for step in each.loads):
            return []
        rows = [[float(step[self.name]) for step in each.loads] for each in self.grids]
        rims = rims_of(self.last, [*self.last.loads, self.last.quantities])
        limits = [self._limit(*each) for each in zip(zip(*rows, strict=True), rims, strict=False)]
        return [
            of_judged(limit, sketched, value) if isinstance(limit, Estimate) else limit
            for limit, sketched, value in zip(limits, rows[-1], judged, strict=False)
        ]

    def rows(self) -> list[dict[str, Any]]:
        """A row a grid: its unknowns, the value and the CPU seconds of its path."""
        return [
            {
                "quantity": self.name,
                "mesh": each.mesh,
                "unknowns": each.unknowns,
                "value": each.quantities.get(self.name),
                "seconds": each.seconds,
            }
            for each in self.grids
        ]

    def _limit(self, values: Sequence[float], rim: Mapping[str, float]) -> Estimate | str:
        points = [Seen(grid.size, float(value)) for grid, value in zip(self.grids, values, strict=True)]
        limit = estimate_of(points, touching=touches(self.last.end), rim=rim.get(self.name, 0.0))
        if not isinstance(limit, Estimate) or not isinstance(self.scene, CutScene):
            return limit
        layer = EdgeLayer.of(self.last, points[0].size / points[-1].size)
        return limit if layer is None else layer.within(limit, abs(points[-1].value - points[0].value))


def parse_budget(text: str | None, name: str = "budget") -> float:
    """Seconds of "5s" or "5", inf of None; raises UsageError unless they are above 0."""
    if text is None:
        return math.inf
    try:
        value = float(text.removesuffix("s"))
    except ValueError:
        value = math.nan
    if not 0 < value < math.inf:
        raise UsageError(f"{name} {text!r} must be a number of seconds above 0, e.g. 5s")
    return value


def answer(
    scene: Scene,
    request: Request,
    error: float,
    quantity: str | None = None,
    progress: Callable[[str], None] = lambda text: None,
    budget: float = math.inf,
) -> tuple[Result, bool]:
    """The result on the first grid that knows its quantity to a relative ``error``, and whether there is one.

    request: on the coarsest mesh.  quantity: by default the force, or the first that the scene has references for.
    budget: CPU seconds, beyond which no grid is begun, nor gone on with where there is a coarser one; the best answer
    in that time is one. The quantities hold the estimate, the table ``refinement`` the grids, ``loads`` what is stated
    of every load. No limit is stated for what has none under a point load. What a cascade does not reach is left to
    grids that are cut where the error is, if the scene names no coarsest grid for them. Raises UsageError for a
    quantity that the scene does not have.
    """
    start, cascade = time.process_time(), Cascade(scene, error, quantity)
    grid: Request | None = request
    estimate: Estimate | str = FEW
    late, spent = False, 0.0
    widths: list[tuple[float, float]] = []
    more = least = FINER ** ways(request)
    while grid is not None and not late:
        progress(round_of(len(cascade.grids) + 1, grid, cascade.grids))
        last = more <= ALMOST * least if widths else len(cascade.grids) >= FEWEST and error >= USUAL
        most = budget - (JUDGED * cascade.last.seconds if cascade.grids else 0.0)
        followed = cascade.grow(grid, 0.0 if last else TIGHT * error, most - spent)
        spent = time.process_time() - start
        late = spent > (budget if followed else most)
        if not followed and (cascade.grids or element_size(grid) < TOO_FINE * element_size(request)):
            break
        finer, more = FINER, least
        if cascade.grids:
            cascade.check_quantity()
            estimate, touching = cascade.stated(), touches(cascade.last.end)
            finer = CLOSER if touching and ways(request) > 1 else FINER
            if isinstance(estimate, Estimate):
                progress(f"{cascade.name} {estimate}")
                widths.append((cascade.last.size, estimate.uncertainty))
                if estimate.uncertainty <= error:
                    break
            if widths:
                more = _more(widths, error, ways(request), SLOW if touching else 2.0)
                finer = float(np.clip(more ** (1 / ways(request)), CLOSEST, FINER))
            growth = finer ** ways(request) if isinstance(scene, RefinedScene) else max(more, least)
            if math.isinf(budget) and cascade.last.unknowns * growth > MOST:
                break
            late = spent + DEARER * cascade.last.seconds > budget or cascade.last.unknowns > MOST
        grid = near(scene, grid, finer)
    left = budget - (time.process_time() - start)
    late = late or left <= 0
    known = isinstance(estimate, Estimate) and (estimate.uncertainty <= error or late)
    if not known and not late and not (cascade.grids and isinstance(scene, RefinedScene)):
        return solve_to_error(scene, _for_cuts(scene, request), error, quantity, progress, budget=left)
    if not cascade.grids:
        return _none(scene, request, budget, spent), False
    result = solve_from(scene, cascade.last.request, cascade.last, progress)
    if not result.outcome.converged:
        return result, False
    longer = _longer(scene, result, request)
    left = budget - (time.process_time() - start)
    if longer is not None and left > 0:
        return answer(scene, longer, error, quantity, progress, left)
    known = _stated(result, cascade, estimate) and known
    if longer is not None:
        result.reason = TOO_LONG
    return result, known and longer is None


def _none(scene: Scene, request: Request, budget: float, seconds: float) -> Result:
    """Without a load: none of the grids that the budget has let begin has a path to the last one."""
    model = scene.build(request)
    result = Result(request, model, Outcome.STEP_LIMIT, timing={"total": seconds, "cpu": seconds})
    result.counters["dofs"] = model.n_unknowns
    result.reason = f"no grid started within {budget:.3g} s reaches the last load"
    return result


def _stated(result: Result, cascade: Cascade, estimate: Estimate | str) -> bool:
    """Whether a cascade states the error of a judged result on its finest grid, with tables and the reason if not."""
    name, error = cascade.name, cascade.error
    record_grids(result, cascade.rows())
    if name not in result.quantities:
        cascade.check_quantity(0)
        result.reason = f"the finest grid has no {name}, though a coarser one has it"
        return False
    endless = no_limit(result, name, error)
    if isinstance(estimate, str) or endless:
        result.reason = endless or f"the error of {name} is not known: {estimate}"
        return False
    value, sketched = result.quantities[name], cascade.last.quantities[name]
    if abs(value - sketched) > max(estimate.uncertainty, TIGHT * error) * max(abs(value), abs(sketched)):
        result.reason = f"{name} from rest differs from {name} from coarser grids: there are two branches"
        return False
    estimate = of_judged(estimate, sketched, value)
    record_estimate(result, name, estimate, error)
    record_loads(result, name, cascade.at_loads([step.seen.get(name, math.nan) for step in result.loads]))
    if estimate.uncertainty > error:
        result.reason = f"{name} is known to {100 * estimate.uncertainty:.2g} %, not to {100 * error:g} %"
    return True


def _for_cuts(scene: Scene, request: Request) -> Request:
    """The request on the coarsest grid that the scene names, no coarser than its own."""
    if not isinstance(scene, RefinedScene):
        return request
    n1, n2 = map(max, request.mesh, scene.coarsest_mesh)
    return replace(request, mesh=(n1, n2))


def _more(widths: Sequence[tuple[float, float]], error: float, ways: int, order: float) -> float:
    """How many times the unknowns the error takes, by the order that intervals (size, width) have shown.

    ways: coordinates that are refined.  order: as long as none is seen. It is taken to be SLOW to 2, for it comes with
    finer grids.
    """
    size, width = widths[-1]
    if len(widths) > 2:
        before, wider = widths[-3]
        order = float(np.clip(math.log(wider / width) / math.log(before / size), SLOW, 2.0))
    return float((width / error) ** (ways / order))


def _longer(scene: Scene, result: Result, request: Request) -> Request | None:
    """The coarsest request with more elements where those of the result are too long and have modes by themselves."""
    if max(parts_of(result)) == 1:
        return None
    family = Family.of(scene, result.request)
    shorter = family.shortened(scene, result)
    if shorter is family:
        return None
    n1, n2 = (n * k // m for n, k, m in zip(request.mesh, shorter.request.mesh, result.request.mesh, strict=True))
    return replace(request, mesh=(n1, n2))
