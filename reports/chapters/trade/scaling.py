"""The section on one Newton step over the number of unknowns: times, powers, memory, and what the core could do."""

from __future__ import annotations

import pandas as pd
from matplotlib.figure import Figure

from reports.figures.drawing import BLACK, canvas, legend_above, lines, svg
from reports.formats import NOTHING, fixed, interval, scientific
from reports.markdown import Part, commands, joined, machine, picture, prose, table
from reports.store.tables import Store

STEP = ("elements", "scatter", "factorisation", "solve", "contact", "total")
DRAWN = ("total", "factorisation", "elements", "solve")
COMMAND = "footprint bench scaling --table .footprint/store/tables/scaling.csv"


def scaling_part(store: Store) -> Part:
    """One Newton step over the unknowns; it takes memory and a quiet machine, so no campaign measures it by itself."""
    heading = "## One Newton step over the number of unknowns"
    if not store.has_table("scaling"):
        return joined(heading, machine(f"Not measured here; `{COMMAND}` does."))
    data = store.table("scaling")
    rows = [
        [
            *(row["mesh"], row["dofs"]),
            *(fixed(1e3 * row[f"{part}_s"], 1) for part in STEP),
            fixed(row["factorisation_s"] / row["superlu_s"], 2),
            fixed(row["peak_GiB"], 2),
        ]
        for row in data.to_dict("records")
    ]
    fitted = store.analysis("scaling_exponents").to_dict("records") if store.has_analysis("scaling_exponents") else [{}]
    powers = [fixed(fitted[0].get(part), 2) for part in STEP]
    largest = data.sort_values("dofs").iloc[-1]
    beside, limit, analysis = (
        data[f"{one}_s"] / data[f"{other}_s"]
        for one, other in (("factorisation", "superlu"), ("factorisation", "core"), ("analysis", "factorisation"))
    )
    text = prose(f"""The whole tyre, the paper's element, in contact; shortest processor time of several, each size in a
process of its own. The factorisation is by dense fronts on the elimination tree of the grid; it takes
{interval((beside.min(), beside.max()))} of the time of SuperLU on the same matrix in the same order, and
{interval((limit.min(), limit.max()), 1)} times what its operations take at the rate of a product of large matrices, the
core's limit. The analysis of the pattern, once a solve, takes {fixed(analysis.max(), 1)} factorisations at the most;
solutions have a backward error of {scientific(data["backward_error"].max())} or less. A step with
{largest["dofs"]:,} unknowns takes {fixed(largest["total_s"], 1)} s and {fixed(largest["peak_GiB"], 1)} GiB, of which
the factorisation is {fixed(largest["factorisation_s"], 1)} s. The last line is the exponent of the unknowns, fitted
from {store.rules()["fitted_from"]:g} on; in theory nested dissection takes 1.5 to factorise, and all else is linear but
for a logarithm.""")
    header = ["mesh", "unknowns", *(f"{part} [ms]" for part in STEP), "of SuperLU", "peak memory [GiB]"]
    body = table("One Newton step", header, [*rows, ["exponent", NOTHING, *powers, NOTHING, NOTHING]])
    drawn = picture(
        "cost-scaling.svg", "Time and memory of one Newton step over the unknowns", step_over_unknowns(data)
    )
    return joined(heading, machine(text, body, commands([COMMAND])), drawn)


@svg
def step_over_unknowns(data: pd.DataFrame) -> Figure:
    """Times of the parts with SuperLU's and the core's limit of the factorisation, and the peak memory."""
    figure, (time, memory) = canvas(2, width=10.0, height=4.2)
    lines(time, {part: (data["dofs"], data[f"{part}_s"]) for part in DRAWN})
    time.plot(data["dofs"], data["superlu_s"], color=BLACK, linestyle="--", label="factorisation by SuperLU")
    time.plot(data["dofs"], data["core_s"], color=BLACK, linestyle=":", label="core's limit of the factorisation")
    time.set(ylabel="processor time [s]")
    memory.plot(data["dofs"], data["peak_GiB"], color=BLACK, marker="o")
    memory.set(ylabel="peak memory of the process [GiB]")
    for axes in (time, memory):
        axes.set(xlabel="unknowns", xscale="log", yscale="log")
    legend_above(figure, time, columns=3)
    return figure
