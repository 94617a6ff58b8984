"""The page of the tyre: its load and patch, what its force is worth, and what the paper's printed table can mean."""

from __future__ import annotations

from reports.chapter import Chapter
from reports.chapters.tyre import figures_patch
from reports.chapters.tyre.budget import budget_part
from reports.chapters.tyre.cells import CURVES, DELTA, PAPER
from reports.chapters.tyre.printed_pressures import printed_part
from reports.chapters.tyre.solid import solid_part
from reports.figures.maps import Developed, at_delta, pressure_map
from reports.markdown import Part, commands
from reports.store.tables import Store
from reports.template import Template

TEXT = Template("tyre")


def tyre_page(store: Store) -> Part:
    """The whole page."""
    cell = store.find(**PAPER)
    for delta in CURVES:  # without these travels there is no page
        cell.step(delta_mm=delta)
    crown = cell.result["quantities"].get("inflated_equator_outer_mm")
    own = {"tyre": cell.settings, "mesh": cell.result["mesh"], "crown": crown, "steps": cell.steps}
    parts = {"budget": budget_part(store), "printed": printed_part(store), "solid": solid_part(store)}
    shown = {"patch": patch_picture(store), "commands": commands([cell.command])}
    return TEXT("page", title=CHAPTER.title, **own, **parts, **shown)


def patch_picture(store: Store) -> Part:
    """The contact pressure of the paper's tyre over the patch, in millimetres."""
    cell = store.find(**PAPER)
    pressures = pressure_map(at_delta(cell.table("contact"), DELTA))
    drawn = figures_patch.pressure_map(pressures, Developed.of(cell.table("profile")))
    return TEXT("patch", {"tyre-pressure-map.svg": drawn})


CHAPTER = Chapter(
    "tyre",
    "The tyre",
    "an inflated angle-ply torus pressed on a plane: what its force is worth, the paper's printed table, a solid.",
    tyre_page,
    needs=("rules", "tyre_comparison", "tyre_readings", "tyre_budget", "tyre_symmetry", "solid_shell"),
    always=True,
)
