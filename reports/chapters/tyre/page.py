"""The page of the tyre: its load and patch, what its force is worth, and what the paper's printed table can mean."""

from __future__ import annotations

from reports.chapter import Chapter
from reports.chapters.tyre import figures_patch
from reports.chapters.tyre.budget import budget_part
from reports.chapters.tyre.cells import CURVES, DELTA, PAPER
from reports.chapters.tyre.printed_pressures import printed_part
from reports.chapters.tyre.solid import solid_part
from reports.figures.maps import Developed, at_delta, pressure_map
from reports.formats import fixed
from reports.markdown import Part, commands, folded, joined, listing, picture, prose, table
from reports.store.cells import Cell
from reports.store.tables import Store

TITLE = "The tyre"
PATCH_WORDS = "Contact pressure over the patch, and its difference from its mirror image, in mm of the outer face"


def tyre_page(store: Store) -> Part:
    """The whole page."""
    for delta in CURVES:  # without these travels there is no page
        store.find(**PAPER).step(delta_mm=delta)
    cell = store.find(**PAPER)
    parts = budget_part(store), printed_part(store), solid_part(store)
    return joined(f"# {TITLE}", _problem(cell), patch_picture(store), *parts, commands([cell.command]))


def _problem(cell: Cell) -> Part:
    s, mesh = cell.settings, cell.result["mesh"]
    crown = cell.result["quantities"].get("inflated_equator_outer_mm")
    text = prose(f"""A torus of {s["plies"]} plies at ±{s["gamma_deg"]:g} deg to the meridian, held at
ψ = ±{s["clamp_deg"]:g} deg, is inflated by {s["p0_MPa"]:g} MPa; a rigid frictionless plane then moves towards the axis
by the travel Δ, counted from first touch. The load is dead and acts on the mid-surface, the element is that of the
paper (`element=paper`, mesh {mesh}). ψ runs along the meridian and is zero at the outer equator, φ runs around the axis
and is zero where the plane touches first; pressures are positive in compression. Inflation moves the outer equator by
{fixed(crown, 2, sign=True)} mm. Half length (around the axis) and half width (along the meridian) are measured on the
deformed outer face and known to half an element.""")
    heads = "Δ [mm] | force P [N] | centre pressure [MPa] | nodes in contact | half length [mm] | half width [mm]"
    line = "{delta_mm:g} | {force_N:.1f} | {centre_pressure_MPa:.4f} | {contact_nodes} | {half_length_mm:.1f} | "
    line += "{half_width_mm:.1f}"
    return joined(
        text,
        listing(f"Load and patch of the paper's tyre, {mesh}", cell.steps, heads, line),
        folded("Geometry and moduli", _given(cell)),
    )


def _given(cell: Cell) -> str:
    """Geometry, plies and moduli."""
    s = cell.settings
    rows = [
        ["radius of the tube, inner face", f"{s['R1_mm']:g} mm"],
        ["radius of the equator, inner face", f"{s['R0_mm']:g} mm"],
        ["plies", f"{s['plies']}, {s['ply_thickness_mm']:g} mm each, at ±{s['gamma_deg']:g} deg in turn"],
        ["E along and across the cords", f"{s['E_L_MPa']:g}, {s['E_T_MPa']:g} MPa"],
        ["G", f"LT {s['G_LT_MPa']:g}, TT {s['G_TT_MPa']:g} MPa"],
        ["ν", f"LT {s['nu_LT']:g}, TT {s['nu_TT']:g}"],
        ["section", f"`{s['section']}`"],
    ]
    return table("Geometry, plies and moduli", ["what", "is"], rows, words=2)


def patch_picture(store: Store) -> Part:
    """The contact pressure of the paper's tyre over the patch, in millimetres."""
    cell = store.find(**PAPER)
    pressures = pressure_map(at_delta(cell.table("contact"), DELTA))
    patch = figures_patch.pressure_map(pressures, Developed.of(cell.table("profile")))
    return picture("tyre-pressure-map.svg", PATCH_WORDS, patch)


CHAPTER = Chapter(
    "tyre",
    TITLE,
    "an inflated angle-ply torus pressed on a plane: what its force is worth, the paper's printed table, a solid.",
    tyre_page,
    needs=("rules", "tyre_comparison", "tyre_readings", "tyre_budget", "tyre_symmetry", "solid_shell"),
    always=True,
)
