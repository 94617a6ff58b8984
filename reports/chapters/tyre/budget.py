"""Section of the tyre page: every error of the force at 20 mm, those of the mesh beside those of the model."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from reports.chapters.tyre.cells import DELTA
from reports.formats import NOTHING, code, formatted
from reports.markdown import Part, joined, prose, table
from reports.store.tables import Store

WORDS = {
    "follower": "pressure that follows the inner face, over dead pressure on the mid-surface",
    "full-3d": "full three-dimensional law (`full-3d`), over constant S33",
    "nonsymmetric": "`nonsymmetric`, over constant S33",
}


def budget_part(store: Store) -> Part:
    """The whole section."""
    found = store.analysis("tyre_budget").to_dict("records")
    early = {row["changed"]: row for row in found if row["delta_mm"] != DELTA}
    rows = [
        [row["part"], _name(row), _change(row), _change(early.get(row["changed"])), row["rests_on"]]
        for row in found
        if row["delta_mm"] == DELTA
    ]
    other = next((f"{row['delta_mm']:g}" for row in early.values()), NOTHING)
    text = prose(f"""## What the force is worth

Errors of the force at Δ = {DELTA:g} mm, relative to the exact measure with dead load on the shell; measures also at
{other} mm. Mesh errors are those of one grid against the limit; what a measure, a section or a load changes is stated
in the limit of the meshes, with the interval of that limit; *not settled* where the interval is wider than the change.
The parts are not added: the load is a choice of the model, the measure and the section are approximations that nobody
has to make. Two errors are not in the
table: short waves beside the patch, which cost no energy at this travel, so that grids finer than these may leave the
path (README, known limits), and a solid of angle plies, which is not solved.""")
    heads = ["part", "changed", f"at {DELTA:g} mm", f"at {other} mm", "read from"]
    return joined(text, table(f"Errors of the force at {DELTA:g} mm", heads, rows, words=2))


def model_table(store: Store) -> str:
    """The same of the mesh, the load, the section and the shell; nothing where the campaign does not have them."""
    if not store.has_analysis("tyre_budget"):
        return ""
    found = store.analysis("tyre_budget").to_dict("records")
    own = [row for row in found if row["delta_mm"] == DELTA and row["part"] != "measure"]
    rows = [[row["part"], _name(row), _change(row), row["rests_on"]] for row in own]
    heads = ["part", "changed", "change of the force", "read from"]
    return table(f"The force at {DELTA:g} mm beside its mesh and its model", heads, rows, words=2) if rows else ""


def _name(row: Mapping[Any, Any]) -> str:
    return code(row["changed"]) if row["part"] == "measure" else WORDS.get(row["changed"], row["changed"])


def _change(row: Mapping[Any, Any] | None) -> str:
    """A change with its interval."""
    if row is None:
        return NOTHING
    if row["change"] == 0.0:
        return f"± {formatted(row['within'], '.1%')}"
    told = f"{formatted(row['change'], '+.1%')} ± {formatted(row['within'], '.1%')}"
    return told if str(row["settled"]) == "True" else f"{told}, not settled"
