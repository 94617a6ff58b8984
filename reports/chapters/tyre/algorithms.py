"""Sections of the tyre page: measures by algorithms, iteration histories, coupling of pressure to force, counters."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import pandas as pd

from reports.chapters.tyre import figures
from reports.chapters.tyre.cells import ALGORITHMS, BASE, CONSISTENT, DELTA, SLOWEST, SOFT, change, nodes_unlike
from reports.chapters.tyre.printed_pressures import HALF
from reports.figures.maps import at_delta, pressure_map
from reports.formats import NOTHING, digits, fixed, percent, scientific
from reports.markdown import Part, commands, fold, folded, joined, listing, machine, picture, prose, table
from reports.store.cells import Cell
from reports.store.tables import Store

TIMES = ("total", "build", "assembly", "factorisation", "solve", "contact")
ELSEWHERE = ("agreement", "models")  # lists of cells whose costs are on other pages
DRAWN_ROWS = (0.0, 30.0)  # labels of the printed rows beside which the couplings are drawn


def algorithms_part(store: Store) -> Part:
    """What the choice of the algorithm changes, and what not."""
    compared = commands(cell.command for cell in store.select(**ALGORITHMS))
    return joined(_answers(store), _histories(store), compared, _coupling(store))


def yardstick(store: Store, cell: Cell) -> Cell:
    """What the answers of the other algorithms are held against, for the measure of a cell."""
    return store.find(**{**BASE, "measure": cell.result["measure"]})


def _answers(store: Store) -> Part:
    cells = store.select(**ALGORITHMS)
    mesh = ALGORITHMS["mesh"]
    epsilon, base = store.find(**SOFT), store.find(**BASE)
    step = epsilon.find_step(delta_mm=DELTA)
    rejected = " A cost is a dash where a step was rejected: see Costs." if any(c.cuts for c in cells) else ""
    text = prose(f"""## Measures and algorithms

The same tyre at Δ = {DELTA:g} mm by every combination, mesh {mesh}, element of the paper; iterations, set changes and
factorisations include the inflation. The load steps stated are those of the inflation, and again of the travel. The
reference of a measure is its row with `semismooth`, mixed Newton and ε = inf, which enforces the contact condition
exactly; *in one set only* are nodes that touch in only one of an answer and its reference. With
ε = {_epsilon(epsilon)} MPa/mm the force changes by {scientific(change(epsilon, base), 2)} of its value, and the plane
is penetrated by up to {scientific(None if step is None else step["kkt"]["penetration"])} mm.{rejected}""")
    named = ["measure", "contact", "Newton", "ε [MPa/mm]"]
    answers = [*named, "force [N]", "off the reference", "nodes in contact", "in one set only"]
    shown = [[*_named(cell), *_answer(cell, yardstick(store, cell))] for cell in cells]
    costs = [*named, "Newton iterations", "set changes", "factorisations"]
    spent = [[*_named(cell), *_counts(cell)] for cell in cells]
    residuals = [*named, "equilibrium [-]", "penetration [mm]", "tension [MPa]", "central asymmetry [-]"]
    left = [[*_named(cell), *_residuals(cell)] for cell in cells]
    return joined(
        text,
        table(f"Answers of the algorithms, {mesh}", answers, shown, words=4),
        table(f"What they cost, {mesh}", costs, spent, words=4),
        folded("Residuals and asymmetry", table(f"Residuals and asymmetry, {mesh}", residuals, left, words=4)),
    )


def _named(cell: Cell) -> list[str]:
    result = cell.result
    return [result["measure"], result["contact"], f"{result['newton']}, {_steps(cell, 'step')}", _epsilon(cell)]


def _answer(cell: Cell, reference: Cell) -> list[str]:
    step = cell.find_step(delta_mm=DELTA)
    if step is None:
        return [f"{cell.result['outcome']}: {cell.result['reason']}", *[NOTHING] * 3]
    off, unlike = scientific(change(cell, reference)), fixed(nodes_unlike(cell, reference))
    return [digits(step["force_N"], 10), off, str(step["contact_nodes"]), unlike]


def _counts(cell: Cell) -> list[str]:
    counts = (cell.result["counters"][key] for key in ("newton_iterations", "set_changes", "factorisations"))
    return [NOTHING if cell.cuts else str(count) for count in counts]


def _residuals(cell: Cell) -> list[str]:
    step = cell.find_step(delta_mm=DELTA)
    if step is None:
        return [NOTHING] * 4
    residuals = [step["kkt"][name] for name in ("equilibrium", "penetration", "tension")]
    return [scientific(value) for value in (*residuals, step["central_asymmetry"])]


def _steps(cell: Cell, name: str) -> str:
    steps = cell.settings["steps"]
    return f"{steps} {name}{'s' if steps > 1 else ''}"


def _epsilon(cell: Cell) -> str:
    epsilon = cell.settings["epsilon"]
    return str(epsilon) if isinstance(epsilon, str) else f"{epsilon:g}"


def _histories(store: Store) -> Part:
    fast, slow = store.find(**BASE), store.find(**SLOWEST)
    counts = [cell.result["counters"]["newton_iterations"] for cell in (fast, slow)]
    histories = {_way(cell): cell.table("history") for cell in (fast, slow)}
    text = prose(f"""### Iterations of one step

{_way(fast)} needs {counts[0]} Newton iterations, {_way(slow)} {counts[1]}, the inflation included:
{fixed(counts[1] / counts[0], 1)} times as many. The picture shows the last step of each. Where the residual of the
slower one rises again, its iteration had converged on a contact set that was not the solution's.""")
    words = "Residual over the iterations of the last step of two algorithms, with the nodes in contact"
    return joined(text, picture("tyre-iterations.svg", words, figures.iterations(histories)))


def _way(cell: Cell) -> str:
    return f"{cell.result['contact']} with {cell.result['newton']} Newton, {_steps(cell, 'load step')}"


def _coupling(store: Store) -> Part:
    lumped, consistent = store.find(**BASE), store.find(**CONSISTENT)
    rows = [_coupling_row(cell, lumped) for cell in (lumped, consistent)]
    header = ["coupling", "force [N]", "difference", "centre pressure [MPa]", "highest [MPa]"]
    header += ["nodes in contact", "in one set only"]
    panels = {f"φ = {HALF * row:g} deg": _rows(store, (lumped, consistent), row) for row in DRAWN_ROWS}
    text = prose(f"""## From pressure to nodal force

`lumped` gives each node its own area; `consistent` spreads a nodal pressure over the neighbours by the mass matrix of
the elements, which lets pressures zig-zag near the rim, as the printed ones do. All at Δ = {DELTA:g} mm, the
printed rows under the reading φ = row label / 2.""")
    words = "Pressure along two meridians, lumped and consistent, with the printed rows"
    return joined(
        text,
        table(f"Lumped and consistent coupling, {lumped.result['mesh']}", header, rows),
        picture("tyre-coupling.svg", words, figures.pressure_along_psi(panels)),
        commands([lumped.command, consistent.command]),
    )


def _coupling_row(cell: Cell, lumped: Cell) -> list[str]:
    coupling, step = str(cell.settings["coupling"]), cell.find_step(delta_mm=DELTA)
    if step is None:
        return [coupling, f"{cell.result['outcome']}: {cell.result['reason']}", *[NOTHING] * 5]
    highest = float(at_delta(cell.table("contact"), DELTA)["pressure_MPa"].max())
    pressures = [fixed(value, 4) for value in (step["centre_pressure_MPa"], highest)]
    nodes = [fixed(count) for count in (step["contact_nodes"], nodes_unlike(cell, lumped))]
    return [coupling, fixed(step["force_N"], 2), percent(change(cell, lumped)), *pressures, *nodes]


def _rows(store: Store, cells: tuple[Cell, ...], row: float) -> Mapping[str, pd.Series]:
    """Pressures along the meridian of a printed row: ours by coupling, and the printed ones."""
    nodes = store.analysis("tyre_printed_nodes")
    own = nodes[(nodes["delta_mm"] == nodes["delta_mm"].iloc[0]) & (nodes["row_label"] == row)]
    curves = {
        cell.settings["coupling"]: pressure_map(at_delta(cell.table("contact"), DELTA))[HALF * row].fillna(0.0)
        for cell in cells
        if cell.find_step(delta_mm=DELTA) is not None
    }
    return {**curves, "printed": own.set_index("psi_deg")["printed_MPa"]}


def costs_part(store: Store) -> Part:
    """Counters and times of all tyre cells; what rounding decides stands in a machine block."""
    cells = [cell for cell in store.cells if cell.scene == "tyre" and cell.group not in ELSEWHERE]
    steady, cut = ([_costs(cell) for cell in cells if bool(cell.cuts) is rejected] for rejected in (False, True))
    every = [_costs(cell) for cell in cells]
    counters = "cell | unknowns | Newton iterations | factorisations | assemblies | set changes"
    counts = "{cell} | {dofs} | {newton_iterations} | {factorisations} | {assemblies} | {set_changes}"
    times = "".join(f" | {{{name}:.2f}}" for name in TIMES)
    parts = [listing("Wall times [s], one run each", every, " | ".join(["cell", *TIMES]), "{cell}" + times)]
    if cut:
        note = "How many iterations a rejected step takes is decided by rounding, and so by the machine."
        parts = [
            note,
            listing("Counters of the cells in which a load step was rejected and cut", cut, counters, counts),
            *parts,
        ]
    text = prose(f"""## Costs

What a tyre costs by algorithm, size and grid is on the pages of [cost](cost.md) and of
[algorithms](algorithms.md). Here are the counters and the wall times of the {len(cells)} solves behind this page and
the convergence of the tyre, as they were taken.""")
    title = "Counters of the cells whose load steps were all taken as asked"
    return joined(
        text,
        fold("Counters", listing(title, steady, counters, counts)),
        fold("Wall times, and counters of rejected steps", machine(*parts)),
        folded(
            "Every cell and its command", listing("Commands", every, "cell | command", "{cell} | `{command}`", words=2)
        ),
    )


def _costs(cell: Cell) -> dict[str, Any]:
    """Of one cell by name; None for a time that was not taken."""
    spent = {**cell.result["counters"], **dict.fromkeys(TIMES), **cell.result["timing_s"]}
    return {"cell": cell.label, "command": cell.command, **spent}
