"""What a plain solve says of the error of its mesh: the same path on two coarser grids, from which it sets out, too.

Every quantity has an interval for its limit (:mod:`studies.solving.refinement.limits`), or a reason why it has none.
Both coarser grids have half the elements of the next along each coordinate: the estimate is valid for grids that are
fine enough to have an order, so none is coarser than a quarter of the mesh of the scene. No grid is made finer here.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from itertools import pairwise
from typing import TYPE_CHECKING, Any

from studies.ask.request import Request
from studies.ask.scene import CutScene, Scene
from studies.output.atomic import Table
from studies.solving.refinement.grids import FEWEST, alone, element_size, near, on_one_grid, quarter, ways
from studies.solving.refinement.limits import Estimate, Seen, estimate_of, three_of
from studies.solving.refinement.nested import Sketch, sketch, solve_from, touches
from studies.solving.refinement.records import HALVINGS, growth
from studies.solving.refinement.richardson import order_of
from studies.solving.result import COUNTS, SOLVED, Result, unit_of

if TYPE_CHECKING:
    from studies.solving.refinement.edge_layer import EdgeLayer

TABLE, HALF_SIZE, COARSER = "mesh_error", "half_size", "coarser_grids"  # the table, and two times
NESTED, COLD = "nested", "cold"
STARTS = (NESTED, COLD)
TWICE = 2  # grids below that of the request
GROWS = (1.0, 1.5)  # powers of the unknowns that seconds grow with: of assembly, and of the factorisation
NOISE = 1e-7  # of the largest quantity in a unit: what is smaller is 0
POINT_LOAD = "it grows by {:.2g} % with every halving of the elements under a point load"
NO_GRIDS = "not known: grids with half and a quarter of the elements need a mesh of {} or more"
SAME = "not known: the unknowns do not follow the mesh"
FAILED = "not known: the path does not reach the last load on {}"


@dataclass(frozen=True)
class MeshError:
    """A quantity, at a requested load or of the whole path, and what the grids say of its limit.

    load: 0 for the first; None of the whole path.  order: that the three grids show; None where they show none.
    """

    load: int | None
    quantity: str
    value: float
    limit: Estimate | str
    order: float | None = None

    @property
    def row(self) -> dict[str, Any]:
        """As plain data."""
        named = {"load": self.load, "quantity": self.quantity, "value": self.value, "order": self.order}
        if isinstance(self.limit, str):
            return {**named, "limit": None, "low": None, "high": None, "error": None, "unknown": self.limit}
        known = self.limit
        return {**named, "limit": known.limit, **known.interval, "error": known.error, "unknown": None}


def solve_with_error(
    scene: Scene,
    request: Request,
    progress: Callable[[str], None] = lambda text: None,
    *,
    start: str = NESTED,
    error: bool = True,
) -> Result:
    """The result on the grid of the request: ``errors`` of its quantities, the table :data:`TABLE`, and two times.

    start: ``nested`` from the path on the coarser grids, or ``cold`` from rest.  error: False leaves it out, and with
    ``cold`` no coarser grid is solved. The answer is the same. timing: CPU seconds of the coarser grids, and those that
    elements of half the size are foreseen to take. Raises PartError where a part from outside breaks.
    """
    if start == COLD and not error:
        return solve_from(scene, request, None, progress)
    scene = on_one_grid(scene, request)
    requests = coarser_grids(scene, request)
    grids, lost = list[Sketch](), dict[str, str]()
    for number, each in enumerate(reversed(requests), 1):
        progress(round_of(number, each, grids))
        path = sketch(scene, each, grids[-1] if grids else None, lost=partial(lost.__setitem__, each.mesh_text))
        if path is not None:
            grids.append(path)
    known = grids[-1] if grids and start == NESTED else None
    last = round_of(len(requests) + 1, request, grids)
    result = solve_from(scene, request, known, headed(progress, last))
    if error:
        state_error(scene, result, requests, grids, lost)
        if result.verdict in SOLVED and isinstance(scene, CutScene) and grids and max(grids[0].request.mesh) == 1:
            result.remarks.append(_as_it_stands(grids[0]))
    return result


def round_of(number: int, asked: Request, grids: Sequence[Sketch]) -> str:
    """Which grid it is, and the seconds that are foreseen for it from the last one before, if there is one."""
    label = f"round {number}, {asked.mesh_text}"
    if not grids:
        return label
    more = (grids[-1].size / element_size(asked)) ** ways(asked)
    return f"{label}, about {grids[-1].seconds * more ** (sum(GROWS) / len(GROWS)):.2g} CPU s"


def headed(progress: Callable[[str], None], head: str) -> Callable[[str], None]:
    """The words of progress for a round, with the round before it."""
    return lambda text: progress(f"{head}: {text}")


def state_error(
    scene: Scene, result: Result, asked: Sequence[Request], grids: Sequence[Sketch], lost: Mapping[str, str]
) -> None:
    """What the paths on coarser grids, coarse to fine, of those asked for, say of the error; into a solved result.

    lost: by mesh why a path does not reach its end.
    """
    if result.verdict in SOLVED:
        too_few = _too_few(scene, result.request, asked, grids, lost)
        unknowns = [*(each.unknowns for each in grids), result.counters["dofs"]]
        if not too_few and any(fine <= coarse for coarse, fine in pairwise(unknowns)):
            too_few = SAME
        _state(result, grids, too_few, cut=isinstance(scene, CutScene))


def coarser_grids(scene: Scene, request: Request) -> list[Request]:
    """Of half the elements and of half those, as far as there are such grids of that shape; fine to coarse.

    None where one element stands along a coordinate along which answers vary: their limit would be another.
    """
    coarser = list[Request]()
    least = [min(n, q) for n, q in zip(request.mesh, quarter(scene), strict=True)]
    while len(coarser) < TWICE and not request.leaves and not alone(scene, request.mesh):
        half = near(scene, coarser[-1] if coarser else request, 0.5)
        if half is None or any(n < m for n, m in zip(half.mesh, least, strict=True)):
            break
        coarser.append(half)
    return coarser


def _as_it_stands(uncut: Sketch) -> str:
    """What is read off the mesh of a scene before it is cut."""
    values = ", ".join(f"{name} {uncut.quantities[name]:.6g}" for name in _compared(uncut.quantities))
    return f"on its own mesh, {uncut.mesh}: {values}"


def enough(scene: Scene) -> tuple[int, int]:
    """The coarsest mesh that has grids of half and of a quarter of its elements; the finer ones have them, too."""
    if isinstance(scene, CutScene):
        return 2**TWICE, 2**TWICE
    n1, n2 = (n if n == 1 else max(n, FEWEST) * 2**TWICE for n in quarter(scene))
    return n1, n2


def _too_few(
    scene: Scene, last: Request, requests: Sequence[Request], grids: Sequence[Sketch], lost: Mapping[str, str]
) -> str:
    """Why the error is not known; empty where it may be.

    Grids that keep what few elements they have along a coordinate are not of half and a quarter of the elements.
    """
    sizes = [*(element_size(each) for each in reversed(requests)), element_size(last)]
    if three_of([Seen(size, 0.0) for size in sizes]) is None:
        return NO_GRIDS.format("{}x{}".format(*enough(scene)))
    missing = [each.mesh_text for each in reversed(requests) if each not in [grid.request for grid in grids]]
    return FAILED.format(" and ".join(f"{mesh} ({lost[mesh]})" for mesh in missing)) if missing else ""


def _state(result: Result, grids: Sequence[Sketch], too_few: str, *, cut: bool = False) -> None:
    """What the grids say, into the result; cut: their lines are those of a mesh that knows of no layer at edges."""
    if grids:
        result.timing[COARSER] = sum(each.seconds for each in grids)
        result.timing[HALF_SIZE] = result.timing["cpu"] * _growth(result, grids[-1])
    if too_few:
        result.remarks.append(f"the error of the mesh is {too_few}")
        return
    layer = None
    if cut:
        from studies.solving.refinement.edge_layer import EdgeLayer  # loaded with a deck alone

        layer = EdgeLayer.of(result, grids[0].size / element_size(result.request))
    errors = list(_stated(result, grids, layer))
    if layer is not None and layer.said:
        result.remarks.append(layer.said)
    result.tables[TABLE] = [Table.of_rows([each.row for each in errors])]
    of_load = result.headline_loads
    headline = {each.quantity: each.limit for each in errors if each.load in (None, of_load.get(each.quantity))}
    result.errors |= {name: each.interval for name, each in headline.items() if isinstance(each, Estimate)}


def _stated(result: Result, grids: Sequence[Sketch], layer: EdgeLayer | None) -> Iterator[MeshError]:
    """At every requested load, then of the whole path."""
    steps = list[Mapping[str, Any]]()
    if all(len(each.loads) == len(result.loads) for each in grids):
        steps = [step.quantities for step in result.loads]
    rims = [dict[str, float]()] * (len(steps) + 1)
    if touches(grids[-1].end):
        from studies.solving.refinement.rim import rims_of  # loaded with contact alone

        rims = rims_of(grids[-1], [*steps, result.quantities], element_size(result.request) / grids[-1].size)
    for index, quantities in enumerate(steps):
        for name in _compared(quantities):
            values = [*(each.loads[index].get(name) for each in grids), quantities[name]]
            rim = rims[index].get(name, 0.0)
            yield _limit(result, grids, index, name, values, rim, last=index == len(steps) - 1, layer=layer)
    for name in _compared(result.quantities):
        if not steps or name not in steps[-1]:
            values = [*(each.quantities.get(name) for each in grids), result.quantities[name]]
            yield _limit(result, grids, None, name, values, rims[-1].get(name, 0.0), last=True, layer=layer)


def _compared(quantities: Mapping[str, Any]) -> list[str]:
    """Those that have a limit, without counts and without those that are zero but for rounding."""
    values = {k: v for k, v in quantities.items() if k not in COUNTS and isinstance(v, float) and math.isfinite(v)}
    largest = {unit: max(abs(v) for k, v in values.items() if unit_of(k) == unit) for unit in map(unit_of, values)}
    return [name for name, value in values.items() if abs(value) > NOISE * largest[unit_of(name)]]


def _limit(
    result: Result,
    grids: Sequence[Sketch],
    load: int | None,
    name: str,
    values: Sequence[Any],
    rim: float = 0.0,
    *,
    last: bool,
    layer: EdgeLayer | None = None,
) -> MeshError:
    """What the values on all grids say; last: of the state that can be asked how it grows under a point load.

    rim: what the place of the rim of contact leaves unknown.  layer: what that at free edges does.
    """
    if not all(isinstance(value, float) and math.isfinite(value) for value in values):
        return MeshError(load, name, values[-1], "a coarser grid does not have it")
    sizes = [*(each.size for each in grids), element_size(result.request)]
    points = [Seen(size, value) for size, value in zip(sizes, values, strict=True)]
    limit = estimate_of(points, touching=touches(grids[-1].end), rim=rim)
    if isinstance(limit, Estimate) and layer is not None:
        limit = layer.within(limit, abs(values[-1] - values[0]))
    if isinstance(limit, Estimate) and last:
        grown = growth(result, name)
        if HALVINGS * grown > limit.high * abs(limit.limit):
            limit = POINT_LOAD.format(100 * grown / abs(values[-1]))
    order = order_of(sizes, values)
    return MeshError(load, name, values[-1], limit, None if math.isnan(order) else order)


def _growth(result: Result, half: Sketch) -> float:
    """How many times the seconds elements of half the size take, from what the last halving has taken."""
    more = float(2 ** ways(result.request))
    return min(max(result.timing["cpu"] / half.seconds, more ** GROWS[0]), more ** GROWS[1])


def lines(result: Result) -> list[str]:
    """For people: the limit of every quantity at the last load, and what half the size costs."""
    report = list[str]()
    if TABLE in result.tables:
        last = None, len(result.loads) - 1
        rows = {row["quantity"]: row for row in result.table(TABLE).rows() if row["load"] in last}
        unknown = dict[str, list[str]]()
        for name, row in rows.items():
            if row["unknown"] is not None:
                unknown.setdefault(row["unknown"], []).append(name)
            else:
                report.append(_line(row))
        report += [f"limit not known, {why}: {', '.join(names)}" for why, names in unknown.items()]
    if HALF_SIZE in result.timing:
        report.append(f"elements of half the size would take about {result.timing[HALF_SIZE]:.2g} s")
    return report


def _line(row: Mapping[str, Any]) -> str:
    width = 100 * (row["high"] - row["low"]) / 2 / abs(row["limit"])
    order = "" if row["order"] is None else f", order {row['order']:.2g}"
    head = f"{row['quantity']} {row['value']:.6g}: limit {row['limit']:.6g} +- {width:.2g} %"
    return f"{head}, error {100 * row['error']:.2g} %{order}"
