"""The page of the tyre: its load and patch, what its force is worth, and what the paper's printed table can mean."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from reports.chapter import chapter
from reports.chapters.tyre.cells import CURVES, DELTA, PAPER
from reports.chapters.tyre.printed_pressures import printed_part
from reports.chapters.tyre.solid import solid_part
from reports.figures import patch
from reports.figures.maps import Developed, at_delta, pressure_map
from reports.formats import NOTHING, code, formatted
from reports.markdown import Part, commands
from reports.store.tables import Store
from reports.template import Template

TEXT = Template("tyre")
WORDS = {
    "follower": "pressure that follows the inner face, over dead pressure on the mid-surface",
    "full-3d": "full three-dimensional law (`full-3d`), over constant S33",
    "nonsymmetric": "`nonsymmetric`, over constant S33",
}


def tyre_page(store: Store) -> Part:
    """The whole page."""
    cell = store.find(**PAPER)
    for delta in CURVES:  # without these travels there is no page
        cell.step(delta_mm=delta)
    crown = cell.result["quantities"].get("inflated_equator_outer_mm")
    own = {"tyre": cell.settings, "mesh": cell.result["mesh"], "crown": crown, "steps": cell.steps}
    parts = {"budget": _budget(store), "printed": printed_part(store), "solid": solid_part(store)}
    shown = {"patch": patch_picture(store), "commands": commands([cell.command])}
    return TEXT("page", **own, **parts, **shown)


def patch_picture(store: Store) -> Part:
    """The contact pressure of the paper's tyre over the patch, in millimetres."""
    cell = store.find(**PAPER)
    pressures = pressure_map(at_delta(cell.table("contact"), DELTA))
    drawn = patch.pressure_map(pressures, Developed.of(cell.table("profile")))
    return TEXT("patch", {"tyre-pressure-map.svg": drawn})


def _budget(store: Store) -> Part:
    """Every error of the force at 20 mm, those of the mesh beside those of the model."""
    found = store.table("tyre_budget").to_dict("records")
    early = {row["changed"]: row for row in found if row["delta_mm"] != DELTA}
    rows = [{**row, "early": _change(early.get(row["changed"]))} for row in _at_delta(found)]
    other = next((f"{row['delta_mm']:g}" for row in early.values()), "")
    return TEXT("budget", delta=DELTA, other=other, rows=rows)


def model_table(store: Store) -> Part:
    """The same of the mesh, the load, the section and the shell; nothing where the campaign does not have them."""
    found = _at_delta(store.rows("tyre_budget").to_dict("records"))
    return TEXT("model", delta=DELTA, rows=[row for row in found if row["part"] != "measure"])


def _at_delta(found: list[dict[Any, Any]]) -> list[dict[Any, Any]]:
    """The rows of the last travel, with words for what is changed and by how much that changes the force."""
    return [{**row, "name": _name(row), "now": _change(row)} for row in found if row["delta_mm"] == DELTA]


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


CHAPTER = chapter(
    TEXT,
    tyre_page,
    needs=("rules", "tyre_comparison", "tyre_readings", "tyre_budget", "tyre_symmetry", "solid_shell"),
    always=True,
)
