"""What is said of the tyre: what the paper's table can mean, linear strains, mesh, load and solids."""

from __future__ import annotations

from collections.abc import Iterator

import pandas as pd

from studies.analysis.comparisons.tyre.readings import MODEL
from studies.analysis.statements.record import LIMIT, OPENING, Statement

PAGE = "tyre"
NEAR = 0.01  # of the core rms: readings this close to the best fit as well
LINEAR = "linear strains"
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


def linear(tyre_budget: pd.DataFrame) -> Iterator[Statement]:
    """Linear against exact strains, both in the limit of their meshes."""
    own = tyre_budget[tyre_budget["changed"] == "linear"].sort_values("delta_mm")
    if len(own) < 2:
        return
    values: dict[str, float | str] = {}
    for name, row in zip(("first", "last"), own.to_dict("records"), strict=True):
        values |= {f"{name}_mm": row["delta_mm"], name: row["change"], f"{name}_known": row["within"]}
    text = (
        "In the limit of the meshes linear strains change the force of the tyre by {last:+.1%} ± {last_known:.1%} at a "
        "travel of {last_mm:g} mm, where the paper speaks of about twice the force, and by {first:+.1%} ± "
        "{first_known:.1%} at {first_mm:g} mm."
    )
    scope = "the paper's tyre with dead load; each measure counts the travel from first touch of its own inflated tyre"
    yield Statement("tyre-linear", PAGE, text, values, 2 * len(own), scope, OPENING)


def assumptions(tyre_budget: pd.DataFrame) -> Iterator[Statement]:
    """What the mesh and the load of the paper change."""
    mesh, load = (tyre_budget[tyre_budget["part"] == part] for part in ("mesh", "load"))
    if mesh.empty or load.empty:
        return
    values = {"at": mesh["delta_mm"].iloc[0], "mesh": mesh["change"].iloc[0], "mesh_known": mesh["within"].iloc[0]}
    values |= {"follower": load["change"].iloc[0], "known": load["within"].iloc[0]}
    text = (
        "The mesh of the paper errs by {mesh:+.1%} ± {mesh_known:.1%} in the force at {at:g} mm. Its dead load is a "
        "model: in the limit of the meshes a pressure that follows the inner face changes the force by "
        "{follower:+.1%} ± {known:.1%}."
    )
    yield Statement("tyre-mesh-and-load", PAGE, text, values, len(mesh) + 2 * len(load), OURS, LIMIT)


def solids(solid_shell: pd.DataFrame) -> Iterator[Statement]:
    """The shell beside solids."""
    off = solid_shell[(solid_shell["quantity"] == "force_N") & (solid_shell["body"] != "solid")]
    off = off.dropna(subset=["model_part"]).drop_duplicates("at")
    if off.empty:
        return
    size, known = off["model_part"].abs(), off["known_to"]
    values = {"off": size.max(), "low": known.min(), "high": known.max(), "travels": float(len(off))}
    values |= {"apart": float((size > known).sum())}
    text = (
        "The forces of an isotropic tyre as a shell and as a solid differ in the limit of the meshes by at most "
        "{off:.2%} at {travels:.0f} travels, by more than the uncertainty ({low:.2%} to {high:.2%}) at {apart:.0f} of "
        "them."
    )
    scope = "isotropic tyre, follower load on the true face; an angle-ply solid is not computed"
    yield Statement("tyre-solid", PAGE, text, values, len(off), scope, LIMIT)


MAKERS = (printed, linear, assumptions, solids)
