"""What is said of cost: parts of the tyre, grids that follow the error, advice."""

from __future__ import annotations

from collections.abc import Iterator

import pandas as pd

from studies.analysis.statements.record import OPENING, Statement

WITHIN = 0.01  # error of the force
MODEL = {  # what of the model changes the force, by its name in the budget
    "follower": "a pressure that follows the inner face",
    "full-3d": "the full three-dimensional law",
    "shell instead of a solid": "a solid (of an isotropic tyre)",
}
FAMILIES = ("adapted", "local")  # grids that follow the error


def parts(tyre_models: pd.DataFrame) -> Iterator[Statement]:
    """What a part of the tyre saves."""
    rows = tyre_models.set_index(["plies", "model"])["operations_share"]
    wanted = {"half": ("angle plies", "half"), "quarter": ("isotropic", "quarter")}
    if not all(key in rows.dropna().index for key in wanted.values()):
        return
    values = {name: float(rows[key]) for name, key in wanted.items()}
    parts = tyre_models[tyre_models["model"] != "full"]
    values |= {"same": float(parts["same"].sum()), "of": float(len(parts))}
    text = (
        "A half of an angle-ply tyre takes {half:.0%} of the operations of the whole, a quarter of an isotropic one "
        "{quarter:.0%}; {same:.0f} of {of:.0f} parts give force, pressures and contact set of the whole. A part is "
        "refused where load or plies do not have its symmetry: a mirror for angle plies, any part with friction."
    )
    scope = "one travel of 20 mm on the mesh of the paper; a mirror is refused for angle plies"
    yield Statement("parts-of-the-tyre", "cost", text, values, len(tyre_models), scope, OPENING)


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
    for name, words in MODEL.items():
        if name in changes.index:
            own = changes.loc[[name]].iloc[-1]
            key = name.split()[0].replace("-", "_")
            values |= {key: float(own["change"]), f"{key}_known": float(own["within"])}
            said.append(f"{words} changes it by {{{key}:+.1%}} ± {{{key}_known:.1%}}")
    text += f"; that is the error of the mesh alone: {', '.join(said)}" if said else ""
    text += ". Beyond 14.5 mm short waves beside the patch cost no energy: finer grids may leave this path."
    scope = "dead load, mid-surface area, exact measure; a follower load or a solid has another force"
    yield Statement("force-known", "cost", text, values, len(work_precision), scope)


def advice(held_out_summary: pd.DataFrame) -> Iterator[Statement]:
    """What advice is worth."""
    own = held_out_summary[held_out_summary["quantities"] == "headline"]
    if own.empty or not own["advised"].iloc[0]:
        return
    row = own.iloc[0]
    values = {"met": row["met"], "advised": row["advised"], "median": row["median_regret"], "mean": row["mean_regret"]}
    text = (
        "`footprint advise`, tested on scenes withheld from its data, meets the tolerance in {met:.0%} of "
        "{advised:.0f} cases and costs {median:.2f} times the best in the median, {mean:.2f} in the mean"
    )
    if "worst_regret" in row:
        values |= {"worst": row["worst_regret"], "above": row["share_above"]}
        text += ", {worst:.1f} at worst; {above:.0%} cost more than 1.5 times"
    scope = "one quantity a scene, tolerances that its reference can decide"
    yield Statement("advice", "cost", text + ".", values, int(row["advised"]), scope, OPENING, machine=True)


MAKERS = (parts, grids, force_known, advice)
