"""What is said of the tyre: what the paper's table can mean, which grids give its force, and how far that is known."""

from __future__ import annotations

from collections.abc import Iterator

import pandas as pd

from studies.analysis.comparisons.tyre.readings import MODEL
from studies.analysis.statements.record import LIMIT, OPENING, Statement

PAGE = "tyre"
NEAR = 0.01  # of the core rms: readings this close to the best fit as well
LINEAR = "linear strains"
WITHIN = 0.01  # error of the force
CHANGES = {  # what of the model changes the force, by its name in the budget
    "follower": "a pressure that follows the inner face",
    "full-3d": "the full three-dimensional law",
    "shell instead of a solid": "a solid (of an isotropic tyre)",
}
FAMILIES = ("adapted", "local")  # grids that follow the error
OURS = "the element and the mesh of the paper; the core of the printed patch, row label = 2 φ"


def printed(tyre_readings: pd.DataFrame) -> Iterator[Statement]:
    """What fits the printed table, what is excluded, and what cannot be known."""
    model = tyre_readings[tyre_readings["kind"] == MODEL]
    best, stated = (model[model[name].astype(bool)] for name in ("best", "stated"))
    if stated.empty:
        return
    near = best[best["core_rms"] <= best["core_rms"].min() + NEAR].sort_values("core_rms", kind="stable")
    first, at = near.iloc[0], stated.sort_values("core_rms", kind="stable").iloc[0]
    values: dict[str, float | str] = {"of": float(len(best)), "delta": at["delta_mm"], "first": first["reading"]}
    values |= {"low": near["delta_mm"].min(), "high": near["delta_mm"].max(), "others": _listed(near["reading"][1:])}
    values |= {"rms": first["core_rms"], "most": near["core_rms"].max(), "at": first["delta_mm"]}
    values |= {"near": float(len(near)), "nodes_low": near["in_one_only"].min(), "nodes": near["in_one_only"].max()}
    text = (
        "The paper's table of contact pressures is not reproduced at the travel that it states, {delta:g} mm. What "
        "fits: {near:.0f} of {of:.0f} readings about equally, at {low:g} to {high:g} mm, with differences of {rms:.1%} "
        "to {most:.1%} (rms) in the core of the patch and {nodes_low:.0f} to {nodes:.0f} nodes in contact in only one "
        "of the two: {first}; {others}."
    )
    yield Statement("printed-table", PAGE, text, values, len(tyre_readings), OURS, OPENING)
    linear = stated[stated["reading"] == LINEAR]
    values = {"delta": at["delta_mm"], "reading": at["reading"], "rms": at["core_rms"], "nodes": at["in_one_only"]}
    text = "What is excluded: at the stated {delta:g} mm no reading fits better than {rms:.1%} (rms) with {nodes:.0f} "
    text += "nodes in only one patch ({reading})"
    if len(linear):
        row = linear.iloc[0]
        values |= {"force": row["force_N"], "sum": row["printed_sum_N"], "linear_rms": row["core_rms"]}
        values |= {"off": abs(row["force_N"] / row["printed_sum_N"] - 1), "linear_nodes": row["in_one_only"]}
        values |= {"linear_best": model[model["reading"] == LINEAR]["core_rms"].min()}
        text += (
            "; linear strains, whose force of {force:.0f} N on the paper's mesh is within {off:.1%} of the {sum:.0f} N "
            "that the printed pressures add up to, agree in that sum by chance: their pressures differ by "
            "{linear_rms:.0%}, with {linear_nodes:.0f} nodes in only one patch, and by {linear_best:.0%} at the best "
            "of the travels tried"
        )
    yield Statement("printed-excluded", PAGE, f"{text}.", values, len(stated), OURS, OPENING)
    data = tyre_readings[(tyre_readings["kind"] != MODEL) & tyre_readings["best"].astype(bool)]
    values = {}
    text = "What cannot be known: where the paper counts the travel from, and which of the readings that fit it used"
    if len(data):
        values |= {"data_low": data["delta_mm"].min(), "data_high": data["delta_mm"].max()}
        text += (
            "; changes of cord angle, ply and inflation within their rounding move the travel of best fit "
            "between {data_low:g} and {data_high:g} mm"
        )
    yield Statement("origin-of-travel", PAGE, f"{text}.", values, len(near) + len(data), OURS, LIMIT)


def _listed(names: pd.Series) -> str:
    return "; ".join(map(str, names)) or "no other"


def grids(grids_reaching: pd.DataFrame, work_precision: pd.DataFrame) -> Iterator[Statement]:
    """Which grid gives the force of the tyre."""
    own = grids_reaching[(grids_reaching["within"] == WITHIN) & (grids_reaching["element"] == "refined")]
    found = own.set_index("family")["unknowns"]
    best = found.reindex(FAMILIES).min()
    uniform, patch = found.get("uniform"), found.get("patch")
    if pd.isna(best) or pd.isna(uniform):
        return
    largest = work_precision[work_precision["family"] == "patch"]["unknowns"].max()
    values = {"within": WITHIN, "adapted": best, "uniform": uniform, "largest": largest, "share": best / uniform}
    text = (
        "The tyre's force at 20 mm is within {within:.0%} of its limit from {uniform:.0f} unknowns on with uniform "
        "grids and from {adapted:.0f} on with grids that follow the error, {share:.0%} of them"
    )
    seconds = own.set_index("family")["total_s"]
    values |= {"seconds": seconds.reindex([found.reindex(FAMILIES).idxmin()]).iloc[0] / seconds["uniform"]}
    text += ", which with the estimate take {seconds:.1f} times the processor time"
    text += "; the paper's graded grid is not within it at {largest:.0f}." if pd.isna(patch) else "."
    text += " To know that without the limit takes the finer grids of the table above."
    scope = "default element, errors against the limit; a grid counts with all finer ones of its family"
    yield Statement("grids-of-the-tyre", "cost", text, values, len(work_precision), scope, OPENING, machine=True)


def force_known(work_precision: pd.DataFrame, tyre_budget: pd.DataFrame) -> Iterator[Statement]:
    """How far the force is known: by its grids, and by what its model leaves out."""
    row, changes = work_precision.iloc[0], tyre_budget.set_index("changed")
    values = {"force": row["reference_N"], "known": row["known"]}
    text = "The force of the paper's tyre at 20 mm is {force:.1f} N in the limit of its grids, known to {known:.2%}"
    said = []
    for name, words in CHANGES.items():
        if name in changes.index:
            own = changes.loc[[name]].iloc[-1]
            key = name.split()[0].replace("-", "_")
            values |= {key: float(own["change"]), f"{key}_known": float(own["within"])}
            said.append(f"{words} changes it by {{{key}:+.1%}} ± {{{key}_known:.1%}}")
    text += f"; that is the error of the mesh alone: {', '.join(said)}" if said else ""
    text += ". Beyond 14.5 mm short waves beside the patch cost no energy: finer grids may leave this path."
    scope = "dead load, mid-surface area, exact measure; a follower load or a solid has another force"
    yield Statement("force-known", "cost", text, values, len(work_precision), scope)
