"""The page of cost: what a smaller model and a better grid save, and what one Newton step costs."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

from reports.chapter import Chapter
from reports.chapters.trade import figures_cost
from reports.chapters.tyre.cells import DELTA
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
from reports.tables import Store

PRECISION = "cost-precision.svg"
STEP = ("elements", "scatter", "factorisation", "solve", "contact", "total")
TIMES = ("total", "build", "assembly", "factorisation", "solve", "contact")


def cost_page(store: Store) -> Part:
    """The whole page."""
    introduction = prose("""# What it costs

Times are wall times of one run each, on the machine of the [overview](index.md); what is compared is their ratio.""")
    return joined([Part(introduction), _models(store), _precision(store), _scaling(store), _peers(store)])


def _models(store: Store) -> Part:
    """Parts of the tyre beside the whole."""
    found, same_at = store.analysis("tyre_models"), store.rules()["same_model"]
    rows, times = [], []
    for row in found.to_dict("records"):
        result, named = store.cell(row["label"]).result, [row["plies"], f"`{row['model']}`"]
        counts = [str(result["counters"][name]) for name in ("dofs", "newton_iterations", "factorisations")]
        rows.append([*named, *counts, *(_difference(row[name], same_at) for name in ("force_off", "pressure_off"))])
        spent = [fixed(result["timing_s"].get(name, 0.0), 2) for name in TIMES]
        times.append([*named, *spent, percent(row["time_share"], 0, sign=False)])
    delta = fixed(DELTA, 0)
    text = prose(f"""## Do less: a part of the tyre

Inflation is the same all around and is solved on one column of elements; pressed to {delta} mm on a mesh of
{found["mesh"].iloc[0]}, a tyre with angle plies is a half under a turn by 180° about the contact normal, one without
is a quarter between two mirror planes. {found["same"].sum()} of {len(found)} models give the force, the pressures and
the contact set of the whole to {scientific(same_at, 0)} of their value. `--model auto` takes the smallest valid one; a
mirror is refused for angle plies.""")
    header = ["plies", "model", "unknowns", "iterations", "factorisations", "force off", "pressure off"]
    spent_on = ["plies", "model", *(f"{name} [s]" for name in TIMES), "of the whole"]
    steady = table(f"Inflation and {delta} mm, against the whole", header, rows, words=2)
    timed = machine(table("Wall times", spent_on, times, words=2))
    return Part("\n\n".join([text, steady, timed, commands(found["command"])]))


def _precision(store: Store) -> Part:
    """Force against unknowns on uniform, hand-made and adapted grids."""
    needed, delta = store.analysis("grids_reaching"), fixed(DELTA, 0)
    within = percent(store.rules()["within"], 0, sign=False)
    rows, times = [], []
    for row in needed.to_dict("records"):
        named, known = [f"`{row['element']}`", f"`{row['family']}`"], not math.isnan(row["unknowns"])
        rows.append([*named, *(_grid(row) if known else [NOTHING] * 4)])
        if known:
            times.append([*named, fixed(row["factorisation_s"], 2), fixed(row["total_s"], 2)])
    adapted = needed[(needed["family"] == "adapted") & needed["share"].notna()]
    found = [
        f"element `{row['element']}`: {percent(row['share'], 0, sign=False)} of the unknowns of a uniform grid"
        for row in adapted.to_dict("records")
    ]
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
    drawn = {PRECISION: figures_cost.precision(store.table("work_precision"))}
    return Part(f"{text}\n\n{body}\n\n{timed}\n\n{shown}", drawn)


def _grid(row: Mapping[Any, Any]) -> list[str]:
    return [str(row["mesh"]), f"{row['unknowns']:.0f}", fixed(row["force_N"], 1), percent(row["error"])]


def _scaling(store: Store) -> Part:
    """One Newton step over the unknowns; it takes memory and a quiet machine, so no campaign measures it by itself."""
    command = "footprint bench scaling --table .footprint/store/tables/scaling.csv"
    heading = "## One Newton step over the number of unknowns"
    if not store.has_table("scaling"):
        return Part(f"{heading}\n\n" + machine(f"Not measured here; `{command}` does."))
    data = store.table("scaling")
    rows = [
        [row["mesh"], str(row["dofs"]), *(fixed(1e3 * row[f"{part}_s"], 1) for part in STEP), fixed(row["peak_GiB"], 2)]
        for row in data.to_dict("records")
    ]
    fitted = store.analysis("scaling_exponents").to_dict("records") if store.has_analysis("scaling_exponents") else [{}]
    powers = [fixed(fitted[0].get(part), 2) for part in STEP]
    text = prose(f"""The whole tyre, the paper's element, in contact; shortest processor time of several, each size in a
process of its own. The last line is the exponent of the unknowns, fitted from {store.rules()["fitted_from"]:g} on; in
theory nested dissection takes 1.5 to factorise, and all else is linear but for a logarithm.""")
    header = ["mesh", "unknowns", *(f"{part} [ms]" for part in STEP), "peak memory [GiB]"]
    body = table("One Newton step", header, [*rows, ["exponent", NOTHING, *powers, NOTHING]])
    return Part(f"{heading}\n\n" + machine(f"{text}\n\n{body}\n\n{commands([command])}"))


def _peers(store: Store) -> Part:
    """Shells beside another program's solids; it takes that program, so no campaign measures it by itself."""
    command = "footprint bench peers --table .footprint/store/tables/peers.csv"
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


def _difference(value: float, same: float) -> str:
    return f"under {scientific(same, 0)}" if value <= same else scientific(value)


CHAPTER = Chapter(
    "cost",
    "Cost of the tyre",
    "what a part of the tyre saves, what a grid that follows the error saves, and what a step costs.",
    cost_page,
    needs=("rules", "work_precision", "grids_reaching", "tyre_models"),
    always=True,
)
