"""Sections of the tyre page: measures by algorithms, iteration histories, coupling of pressure to force, counters."""

from __future__ import annotations

import pandas as pd

from reports.chapters.tyre import figures as figures_tyre
from reports.chapters.tyre.cells import ALGORITHMS, BASE, CONSISTENT, DELTA, SLOWEST, SOFT
from reports.chapters.tyre.printed_pressures import HALF
from reports.maps import at_delta, different_nodes, pressure_map
from reports.markdown import (
    NOTHING,
    Part,
    commands,
    digits,
    fixed,
    folded,
    joined,
    machine,
    percent,
    picture,
    prose,
    scientific,
    table,
)
from reports.tables import Cell, Store

COUNTERS = ("dofs", "newton_iterations", "factorisations", "assemblies", "set_changes")
TIMES = ("total", "build", "assembly", "factorisation", "solve", "contact")
ELSEWHERE = ("agreement", "models")  # lists of cells whose costs are on other pages
DRAWN_ROWS = (0.0, 30.0)  # labels of the printed rows beside which the couplings are drawn


def algorithms_part(store: Store) -> Part:
    """What the choice of the algorithm changes, and what not."""
    compared = Part(commands(cell.command for cell in store.select(**ALGORITHMS)))
    return joined([_answers(store), _histories(store), compared, _coupling(store)])


def yardstick(store: Store, cell: Cell) -> Cell:
    """What the answers of the other algorithms are held against, for the measure of a cell."""
    return store.find(**{**BASE, "measure": cell.result["measure"]})


def relative_difference(cell: Cell, other: Cell) -> float:
    """Of the forces at 20 mm; NaN when one of them did not get there."""
    return cell.value("force_N", delta_mm=DELTA) / other.value("force_N", delta_mm=DELTA) - 1.0


def set_difference(cell: Cell, other: Cell) -> int | None:
    """Nodes in contact at 20 mm in only one of two cells; None when one of them did not get there."""
    if cell.find_step(delta_mm=DELTA) is None or other.find_step(delta_mm=DELTA) is None:
        return None
    return different_nodes(*(at_delta(c.table("contact"), DELTA) for c in (cell, other)))


def _answers(store: Store) -> Part:
    cells = store.select(**ALGORITHMS)
    rows = [_answer_row(cell, yardstick(store, cell)) for cell in cells]
    header = ["measure", "contact", "Newton", "ε [MPa/mm]", "force [N]", "relative difference", "nodes in contact"]
    header += ["nodes unlike the reference", "Newton iterations", "set changes", "factorisations"]
    header += ["equilibrium [-]", "penetration [mm]", "tension [MPa]", "central asymmetry [-]"]
    epsilon, base = store.find(**SOFT), store.find(**BASE)
    difference = relative_difference(epsilon, base)
    step = epsilon.find_step(delta_mm=DELTA)
    rejected = " A cost is a dash where a step was rejected: see Costs." if any(c.cuts() for c in cells) else ""
    penetration = None if step is None else step["kkt"]["penetration"]
    text = prose(f"""## Measures and algorithms

The same tyre at Δ = {DELTA:g} mm by every combination; iterations, set changes and factorisations include the
inflation. The load steps stated are those of the inflation, and again of the travel. The reference of a measure is its
row with `semismooth`, mixed Newton and ε = inf, which enforces the contact condition exactly. With
ε = {_epsilon(epsilon)} MPa/mm the force changes by {scientific(difference, 2)} of its value, and the plane is
penetrated by up to {scientific(penetration)} mm.{rejected}""")
    body = table("Answers and costs of the algorithms", header, rows, words=3)
    return Part(f"{text}\n\n{body}")


def _answer_row(cell: Cell, reference: Cell) -> list[str]:
    result, counters = cell.result, cell.result["counters"]
    steps = result["settings"]["steps"]
    newton = f"{result['newton']}, {steps} step{'s' if steps > 1 else ''}"
    row = [result["measure"], result["contact"], newton, _epsilon(cell)]
    step = cell.find_step(delta_mm=DELTA)
    costs = [str(counters[key]) for key in ("newton_iterations", "set_changes", "factorisations")]
    if cell.cuts():
        costs = [NOTHING] * 3
    if step is None:
        return [*row, f"{result['outcome']}: {result['reason']}", *[NOTHING] * 3, *costs, *[NOTHING] * 4]
    row += [digits(step["force_N"], 10), scientific(relative_difference(cell, reference)), str(step["contact_nodes"])]
    row += [fixed(set_difference(cell, reference), 0), *costs]
    residuals = [step["kkt"][name] for name in ("equilibrium", "penetration", "tension")]
    return row + [scientific(value) for value in (*residuals, step["central_asymmetry"])]


def _epsilon(cell: Cell) -> str:
    epsilon = cell.result["settings"]["epsilon"]
    return str(epsilon) if isinstance(epsilon, str) else f"{epsilon:g}"


def _histories(store: Store) -> Part:
    fast, slow = store.find(**BASE), store.find(**SLOWEST)
    names = {_words(cell): cell for cell in (fast, slow)}
    counts = [cell.result["counters"]["newton_iterations"] for cell in (fast, slow)]
    name = "tyre-iterations.svg"
    text = prose(f"""### Iteration histories

The cell `{fast.label}` needs {counts[0]} Newton iterations, `{slow.label}` {counts[1]}, the inflation included:
{fixed(counts[1] / counts[0], 1)} times as many. A tooth of the slower curve is a Newton iteration that converged on a
contact set which turned out wrong, or a load step.

{picture(name, "Residual and contact set over the residual evaluations of two algorithms")}""")
    histories = {words: cell.table("history") for words, cell in names.items()}
    return Part(text, {name: figures_tyre.iterations(histories)})


def _words(cell: Cell) -> str:
    steps = cell.result["settings"]["steps"]
    return f"{cell.result['contact']} with {cell.result['newton']} Newton, {steps} load step{'s' if steps > 1 else ''}"


def _coupling(store: Store) -> Part:
    lumped, consistent = store.find(**BASE), store.find(**CONSISTENT)
    rows = [_coupling_row(cell, lumped) for cell in (lumped, consistent)]
    header = ["coupling", "force [N]", "difference", "centre pressure [MPa]", "highest [MPa]"]
    header += ["nodes in contact", "nodes unlike lumped"]
    panels = {f"φ = {HALF * row:g} deg": _rows(store, (lumped, consistent), row) for row in DRAWN_ROWS}
    name = "tyre-coupling.svg"
    text = prose(f"""## From pressure to nodal force

`lumped` gives each node its own area; `consistent` spreads a nodal pressure over the neighbours by the mass matrix of
the elements, which lets pressures zig-zag near the rim, as the printed ones do. All at Δ = {DELTA:g} mm, the
printed rows under the reading φ = row label / 2.""")
    body = table("Lumped and consistent coupling", header, rows)
    shown = picture(name, "Pressure along two meridians, lumped and consistent, with the printed rows")
    text = "\n\n".join([text, body, shown, commands([lumped.command, consistent.command])])
    return Part(text, {name: figures_tyre.pressure_along_psi(panels)})


def _coupling_row(cell: Cell, lumped: Cell) -> list[str]:
    row, at = [cell.result["settings"]["coupling"]], {"delta_mm": DELTA}
    if cell.find_step(**at) is None:
        return [*row, f"{cell.result['outcome']}: {cell.result['reason']}", *[NOTHING] * 5]
    highest = float(at_delta(cell.table("contact"), DELTA)["pressure_MPa"].max())
    row += [fixed(cell.value("force_N", **at), 2), percent(relative_difference(cell, lumped))]
    row += [fixed(value, 4) for value in (cell.value("centre_pressure_MPa", **at), highest)]
    return [*row, fixed(cell.value("contact_nodes", **at), 0), fixed(set_difference(cell, lumped), 0)]


def _rows(store: Store, cells: tuple[Cell, ...], row: float) -> dict[str, pd.Series]:
    """Pressures along the meridian of a printed row: ours by coupling, and the printed ones."""
    nodes = store.analysis("tyre_printed_nodes")
    own = nodes[(nodes["delta_mm"] == nodes["delta_mm"].iloc[0]) & (nodes["row_label"] == row)]
    curves = {
        cell.result["settings"]["coupling"]: pressure_map(at_delta(cell.table("contact"), DELTA))[HALF * row]
        for cell in cells
        if cell.find_step(delta_mm=DELTA) is not None
    }
    return {
        **{name: curve.fillna(0.0) for name, curve in curves.items()},
        "printed": own.set_index("psi_deg")["printed_MPa"],
    }


def costs_part(store: Store) -> Part:
    """Counters and times of all tyre cells; what rounding decides stands in a machine block."""
    cells = [cell for cell in store.cells.values() if cell.scene == "tyre" and cell.group not in ELSEWHERE]
    header = ["cell", "unknowns", "Newton iterations", "factorisations", "assemblies", "set changes"]
    counters = {cell: [cell.label, *(str(cell.result["counters"][name]) for name in COUNTERS)] for cell in cells}
    steady = [row for cell, row in counters.items() if not cell.cuts()]
    unsteady = [row for cell, row in counters.items() if cell.cuts()]
    parts = []
    if unsteady:
        parts.append("How many iterations a rejected step takes is decided by rounding, and so by the machine.")
        parts.append(table("Counters of the cells in which a load step was rejected and cut", header, unsteady))
    times = [[cell.label, *(fixed(cell.result["timing_s"].get(name), 2) for name in TIMES)] for cell in cells]
    parts.append(table("Wall times [s], one run each", ["cell", *TIMES], times))
    commands_of = [[cell.label, f"`{cell.command}`"] for cell in cells]
    every = folded("Every cell and its command", table("Commands", ["cell", "command"], commands_of, words=2))
    body = table("Counters of the cells whose load steps were all taken as asked", header, steady)
    return Part("\n\n".join(["## Costs", body, machine("\n\n".join(parts)), every]))
