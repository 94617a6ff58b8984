"""Sections of the tyre page: load and deflection, inflation, profiles and pressures of the paper's tyre."""

from __future__ import annotations

from typing import Any

import numpy as np

from reports.chapters.tyre import figures, figures_patch
from reports.chapters.tyre.cells import CURVES, DELTA, EVERY_MEASURE, FOLLOWER, ISOTROPIC, LINEAR, PAPER
from reports.figures.maps import Developed, along_meridian, at_delta, pressure_map
from reports.formats import fixed
from reports.markdown import Part, commands, folded, joined, listing, picture, prose, table
from reports.store.cells import Cell
from reports.store.tables import Store


def paper_part(store: Store) -> Part:
    """What the paper's tyre does."""
    sections = (_load, _linear_and_exact, _inflation, _profiles, _pressures)
    return joined(*(section(store) for section in sections), commands(cell.command for cell in _tyres(store)))


def _tyres(store: Store) -> list[Cell]:
    return [store.find(**asked) for asked in (PAPER, LINEAR, FOLLOWER, ISOTROPIC)]


def forces(store: Store) -> dict[float, tuple[float, float]]:
    """Forces of the linear and of the exact measure [N] by the travels of the latter up to 20 mm."""
    linear, exact = store.find(**LINEAR), store.find(**PAPER)
    reached = [step["delta_mm"] for step in exact.steps if step["delta_mm"] <= DELTA]
    return {d: (linear.value("force_N", delta_mm=d), exact.value("force_N", delta_mm=d)) for d in reached}


def _load(store: Store) -> Part:
    cell = store.find(**PAPER)
    s, mesh = cell.settings, cell.result["mesh"]
    text = prose(f"""## The paper's tyre under a plane

A torus of {s["plies"]} plies at ±{s["gamma_deg"]:g} deg to the meridian, held at ψ = ±{s["clamp_deg"]:g} deg, is
inflated by {s["p0_MPa"]:g} MPa ({s["load"]} load, mesh {mesh}). A rigid frictionless plane then moves
towards the axis by Δ, counted from first touch. Half lengths are measured along φ, around the axis, half widths along
ψ, on the deformed outer face, to half-way between the last node that touches and the first that does not: they are
known to half an element, and may stand still or fall while the patch passes from one line of nodes to the next. The
residuals are those that the judge recomputes from the answer.""")
    heads = "Δ [mm] | force P [N] | centre pressure [MPa] | nodes in contact | half length [mm] | half width [mm] | "
    heads += "Newton iterations"
    line = "{delta_mm:g} | {force_N:.2f} | {centre_pressure_MPa:.4f} | {contact_nodes} | {half_length_mm:.2f} | "
    line += "{half_width_mm:.2f} | {newton_iterations}"
    judged = "Δ [mm] | equilibrium [-] | penetration [mm] | tension [MPa] | complementarity [MPa mm]"
    left = "{delta_mm:g} | {kkt[equilibrium]:.1e} | {kkt[penetration]:.1e} | {kkt[tension]:.1e} | "
    left += "{kkt[complementarity]:.1e}"
    return joined(
        text,
        _given(cell),
        listing(f"Load and patch of the paper's tyre, {mesh}", cell.steps, heads, line),
        folded(
            "Residuals, recomputed by the judge", listing("Residuals of the paper's tyre", cell.steps, judged, left)
        ),
    )


def _given(cell: Cell) -> str:
    """Geometry, plies and moduli."""
    s = cell.settings
    rows = [
        [
            "radius of the tube, inner face",
            f"{s['R1_mm']:g} mm",
            "radius of the equator, inner face",
            f"{s['R0_mm']:g} mm",
        ],
        ["plies", f"{s['plies']} at ±{s['gamma_deg']:g} deg", "thickness of a ply", f"{s['ply_thickness_mm']:g} mm"],
        ["held at", f"ψ = ±{s['clamp_deg']:g} deg", "pressure inside", f"{s['p0_MPa']:g} MPa"],
        ["E along and across the cords", f"{s['E_L_MPa']:g}, {s['E_T_MPa']:g} MPa"],
        ["ν", f"LT {s['nu_LT']:g}, TT {s['nu_TT']:g}"],
    ]
    rows[3] += ["G", f"LT {s['G_LT_MPa']:g}, TT {s['G_TT_MPa']:g} MPa"]
    rows[4] += ["section; element", f"{s['section']}; paper"]
    return table("Geometry, plies and moduli", ["what", "is", "what", "is"], rows, words=4)


def _linear_and_exact(store: Store) -> Part:
    pairs = forces(store)
    rows = [[f"{d:g}", fixed(low, 2), fixed(high, 2), fixed(low / high, 3)] for d, (low, high) in pairs.items()]
    linear_20, exact_20 = pairs[DELTA]
    paper, linear, others = store.find(**PAPER), store.find(**LINEAR), store.select(**EVERY_MEASURE)
    printed = store.analysis("tyre_comparison")["printed_sum_N"].iloc[0]
    text = prose(f"""### Linear against geometrically exact strains

At Δ = {DELTA:g} mm the linear measure needs {fixed(linear_20 / exact_20, 3)} times the force of the exact one, on the
mesh {paper.result["mesh"]} with the element of the paper, whose authors say "about two". Each measure counts Δ from
the first touch of its own inflated tyre. In the picture the printed pressures, summed over the areas of their nodes,
stand beside both, and on the right all measures on a coarser mesh with the default element; how far each is off there,
and from which travel on, is the matter of [another page](measures.md).""")
    header, words = ["Δ [mm]", "P linear [N]", "P exact [N]", "linear / exact"], "by strain measure, and printed"
    body = table(f"Force of the linear and of the exact measure, {paper.result['mesh']}", header, rows)
    curves = {cell.result["measure"]: _curve(cell) for cell in (paper, linear)}
    titles = f"{paper.result['mesh']}, element paper", f"{EVERY_MEASURE['mesh']}, element refined"
    every = {cell.result["measure"]: _curve(cell) for cell in others}
    drawn = figures.measures_and_print(curves, (DELTA, printed), every, titles)
    return joined(
        text, body, picture("tyre-load-deflection.svg", f"Force over the travel of the plane, {words}", drawn)
    )


def _curve(cell: Cell) -> tuple[list[float], list[float]]:
    return [step["delta_mm"] for step in cell.steps], [step["force_N"] for step in cell.steps]


def _inflation(store: Store) -> Part:
    text = "Which way the equator moves is up to the cords. A positive number is a growth of the radius."
    rows = [[_description(cell), _growth(cell, "inner"), _growth(cell, "outer")] for cell in _tyres(store)]
    body = table("Displacement of the equator by inflation [mm]", ["tyre", "inner face", "outer face"], rows)
    return joined("### Inflation", text, body)


def _growth(cell: Cell, face: str) -> str:
    return fixed(cell.result["quantities"].get(f"inflated_equator_{face}_mm"), 3, sign=True)


def _description(cell: Cell) -> str:
    s = cell.settings
    wall = "isotropic" if "E_MPa" in s else f"plies at ±{s['gamma_deg']:g} deg"
    return f"{wall}, {cell.result['measure']} strains, {s['load']} load, {s['pressure_area']} area"


def _profiles(store: Store) -> Part:
    text = (
        "### Deformed meridian\n\nInner and outer face at φ = 0, where the plane touches first; smooth between nodes."
    )
    drawn = figures.profiles(store.find(**PAPER).table("profile"), CURVES)
    return joined(text, picture("tyre-profiles.svg", "Meridian profiles: unloaded, inflated and pressed", drawn))


PATCH_WORDS = "Contact pressure over the patch, and its difference from its mirror image, in mm of the outer face"


def patch_picture(store: Store) -> Part:
    """The contact pressure of the paper's tyre over the patch, in millimetres."""
    cell = store.find(**PAPER)
    pressures = pressure_map(at_delta(cell.table("contact"), DELTA))
    patch = figures_patch.pressure_map(pressures, Developed.of(cell.table("profile")))
    return picture("tyre-pressure-map.svg", PATCH_WORDS, patch)


def _pressures(store: Store) -> Part:
    cell = store.find(**PAPER)
    contact = cell.table("contact")
    curves = {f"Δ = {delta:g} mm": along_meridian(at_delta(contact, delta)) for delta in CURVES}
    pressures = pressure_map(at_delta(contact, DELTA))
    highest = float(pressures.max().max())
    row, column = np.argwhere(pressures.to_numpy() == highest)[0]
    at_psi, at_phi = abs(float(pressures.index[row])), abs(float(pressures.columns[column]))
    phi, psi = _extent(pressures.notna().any(axis=0)), _extent(pressures.notna().any(axis=1))
    along = figures.pressure_along_psi({"φ = 0": curves})
    return joined(
        "### Contact pressure",
        picture("tyre-pressure-psi.svg", "Contact pressure along the meridian under three travels", along),
        f"At Δ = {DELTA:g} mm the outermost nodes in contact lie at φ = ±{phi:g} deg and ψ = ±{psi:g} deg; "
        f"the highest pressure is {fixed(highest, 3)} MPa, at |φ| = {at_phi:g} deg and |ψ| = {at_psi:g} deg.",
        patch_picture(store),
    )


def _extent(touching: Any) -> float:
    """Largest angle of a boolean series by angle."""
    return float(max(abs(angle) for angle, inside in touching.items() if inside))
