"""The page of cost: what a smaller model and a better grid save, and what one Newton step costs."""

from __future__ import annotations

import re

import numpy as np
import pandas as pd

from reports import labels
from reports.chapter import Chapter
from reports.chapters.trade import figures_cost
from reports.maps import at_delta
from reports.markdown import (
    NOTHING,
    Part,
    commands,
    fixed,
    joined,
    machine,
    percent,
    picture,
    prose,
    scientific,
    table,
)
from reports.tables import Cell, Store

PRECISION = "cost-precision.svg"
STEP = ("elements", "scatter", "factorisation", "solve", "contact", "total")
FITTED_FROM = 9_000  # unknowns
WITHIN = 0.01  # error of the force that an engineer asks for
SAME = 1e-9  # relative difference below which a part of the tyre gives the whole
TIMES = ("total", "build", "assembly", "factorisation", "solve", "contact")


def cost_page(store: Store) -> Part:
    """The whole page."""
    introduction = prose("""# What it costs

Times are wall times of one run each, on the machine of the [overview](index.md); what is compared is their ratio.""")
    return joined([Part(introduction), _models(store), _precision(store), _scaling(store), _peers(store)])


def _models(store: Store) -> Part:
    """Parts of the tyre beside the whole."""
    cells = store.matching(labels.MODEL)
    rows, times, same = [], [], 0
    for cell in cells:
        model, plies = _words(cell)
        whole = store.cell(f"model full {plies}")
        counters = cell.result["counters"]
        counts = [str(counters[name]) for name in ("dofs", "newton_iterations", "factorisations")]
        off = differences(cell, whole)
        rows.append([plies, f"`{model}`", *counts, *map(_difference, off)])
        same += max(off) <= SAME
        share = cell.result["timing_s"]["total"] / whole.result["timing_s"]["total"]
        spent = [fixed(cell.result["timing_s"].get(name, 0.0), 2) for name in TIMES]
        times.append([plies, f"`{model}`", *spent, percent(share, 0, sign=False)])
    delta = fixed(labels.DELTA, 0)
    text = prose(f"""## Do less: a part of the tyre

Inflation is the same all around and is solved on one column of elements; pressed to {delta} mm on a mesh of
{cells[0].result["mesh"]}, a tyre with angle plies is a half under a turn by 180° about the contact normal, one without
is a quarter between two mirror planes. {same} of {len(cells)} models give the force, the pressures and the contact set
of the whole to {scientific(SAME, 0)} of their value. `--model auto` takes the smallest valid one; a mirror is refused
for angle plies.""")
    header = ["plies", "model", "unknowns", "iterations", "factorisations", "force off", "pressure off"]
    spent_on = ["plies", "model", *(f"{name} [s]" for name in TIMES), "of the whole"]
    steady = table(f"Inflation and {delta} mm, against the whole", header, rows, words=2)
    timed = machine(table("Wall times", spent_on, times, words=2))
    return Part("\n\n".join([text, steady, timed, commands(cell.command for cell in cells)]))


def _precision(store: Store) -> Part:
    """Force against unknowns on uniform, hand-made and adapted grids."""
    data = store.table("work_precision")
    rows, times, found = [], [], []
    for element in dict.fromkeys(data["element"]):
        own = data[data["element"] == element]
        needed = {family: reaching(grids, WITHIN) for family, grids in own.groupby("family", sort=False)}
        uniform, adapted = needed.get("uniform"), needed.get("adapted")
        if uniform is not None and adapted is not None:
            share = adapted["unknowns"] / uniform["unknowns"]
            found.append(f"element `{element}`: {percent(share, 0, sign=False)} of the unknowns of a uniform grid")
        for family, grid in needed.items():
            named = [f"`{element}`", f"`{family}`"]
            rows.append([*named, *([NOTHING] * 4 if grid is None else _grid(grid))])
            if grid is not None:
                times.append([*named, fixed(grid["factorisation_s"], 2), fixed(grid["total_s"], 2)])
    delta, within = fixed(labels.DELTA, 0), percent(WITHIN, 0, sign=False)
    text = prose(f"""## Put the elements where the force is decided

Force of the paper's tyre at {delta} mm against the mean of two fine adapted grids. `patch` is the spacing of the paper,
finer around the patch; `adapted` follows an estimate of the error of the force from two coarse solutions. A force goes
up and down with the place of the rim of the patch between the lines, so that a single good grid may be chance: a grid
*reaches* {within} when all finer ones of its family stay below. Adapted grids need,
{"; ".join(found) or "as yet unknown"}. `footprint solve tyre --error 1%` chooses such a grid by itself.""")
    header = ["element", "grid", "first mesh", "unknowns", "force [N]", "error"]
    body = table(f"Grids that reach {within}", header, rows, words=2)
    spent = ["element", "grid", "factorisation [s]", "total with its estimate [s]"]
    timed = machine(table(f"Wall times of the grids that reach {within}", spent, times, words=2))
    shown = picture(PRECISION, "Error of the force over the unknowns, by grid")
    return Part(f"{text}\n\n{body}\n\n{timed}\n\n{shown}", {PRECISION: figures_cost.precision(data)})


def reaching(grids: pd.DataFrame, error: float) -> pd.Series | None:
    """The smallest grid from which on every larger one stays below the error; None if there is none."""
    rows = grids.sort_values("unknowns")
    beyond = np.flatnonzero((rows["error"].abs() > error).to_numpy())
    first = int(beyond[-1]) + 1 if len(beyond) else 0
    return rows.iloc[first] if first < len(rows) else None


def _grid(grid: pd.Series) -> list[str]:
    return [str(grid["mesh"]), str(grid["unknowns"]), fixed(grid["force_N"], 1), percent(grid["error"])]


def _scaling(store: Store) -> Part:
    """One Newton step over the unknowns; it takes memory and a quiet machine, so no campaign measures it by itself."""
    command = "footprint bench --scaling --table .footprint/store/tables/scaling.csv"
    heading = "## One Newton step over the number of unknowns"
    if not store.has_table("scaling"):
        return Part(f"{heading}\n\n" + machine(f"Not measured here; `{command}` does."))
    data = store.table("scaling")
    rows = [
        [row["mesh"], str(row["dofs"]), *(fixed(1e3 * row[f"{part}_s"], 1) for part in STEP), fixed(row["peak_GiB"], 2)]
        for row in data.to_dict("records")
    ]
    large = data[data["dofs"] >= FITTED_FROM]
    powers = [fixed(_exponent(large["dofs"], large[f"{part}_s"]), 2) for part in STEP]
    text = prose(f"""The whole tyre, the paper's element, in contact; shortest processor time of several, each size in a
process of its own. The last line is the exponent of the unknowns, fitted from {FITTED_FROM} on; in theory nested
dissection takes 1.5 to factorise, and all else is linear but for a logarithm.""")
    header = ["mesh", "unknowns", *(f"{part} [ms]" for part in STEP), "peak memory [GiB]"]
    body = table("One Newton step", header, [*rows, ["exponent", NOTHING, *powers, NOTHING]])
    return Part(f"{heading}\n\n" + machine(f"{text}\n\n{body}\n\n{commands([command])}"))


def _peers(store: Store) -> Part:
    """Shells beside another program's solids; it takes that program, so no campaign measures it by itself."""
    command = "footprint bench --peers --table .footprint/store/tables/peers.csv"
    heading = "## Beside three-dimensional solids of another program"
    if not store.has_table("peers"):
        return Part(f"{heading}\n\n" + machine(f"Not measured here; `{command}` does, with the extra peers."))
    rows = [
        [
            row["program"],
            row["elements"],
            row["unknowns"],
            fixed(row["force_N"], 2),
            percent(row["error"]),
            fixed(row["seconds"], 2),
            fixed(row["ratio"], 1),
        ]
        for row in store.table("peers").to_dict("records")
    ]
    text = prose("""The isotropic tyre at 10 mm, a quarter against a quarter, by shells and by NGSolve's cubic hexahedra
in the same run: processor time of one thread from the request to the force. Meshes of `footprint` count the whole tyre,
those of `ngsolve` the quarter. *Error*: of the force against a finer solid, which is known to 0.3 %. *Ratio*: of the
time to that of the coarsest shell from which on all finer ones are within 0.3 %.""")
    header = ["program", "mesh", "unknowns", "force [N]", "error", "time [s]", "ratio"]
    body = table("Force against cost", header, rows, words=2)
    return Part(f"{heading}\n\n" + machine(f"{text}\n\n{body}\n\n{commands([command])}"))


def _exponent(size: pd.Series, time: pd.Series) -> float:
    return float(np.polyfit(np.log(size), np.log(time), 1)[0]) if len(size) > 1 else float("nan")


def _words(cell: Cell) -> tuple[str, str]:
    found = re.fullmatch(labels.MODEL, cell.label)
    assert found is not None
    return found["model"], found["plies"]


def differences(cell: Cell, whole: Cell) -> tuple[float, float]:
    """Force and largest nodal pressure relative to the whole; infinite for another contact set, NaN where unreached."""
    if any(each.find_step(delta_mm=labels.DELTA) is None for each in (cell, whole)):
        return float("nan"), float("nan")
    force = abs(cell.value("force_N", delta_mm=labels.DELTA) / whole.value("force_N", delta_mm=labels.DELTA) - 1)
    own, other = (at_delta(each.table("contact"), labels.DELTA) for each in (cell, whole))
    if not np.array_equal(own["active"], other["active"]):
        return force, float("inf")
    pressures = own["pressure_MPa"].to_numpy(), other["pressure_MPa"].to_numpy()
    return force, float(np.max(np.abs(pressures[0] - pressures[1])) / np.max(pressures[1]))


def _difference(value: float) -> str:
    return f"under {scientific(SAME, 0)}" if value <= SAME else scientific(value)


CHAPTER = Chapter(
    "cost",
    "Cost of the tyre",
    "what a part of the tyre saves, what a grid that follows the error saves, and what a step costs.",
    cost_page,
    needs=("work_precision",),
    always=True,
)
