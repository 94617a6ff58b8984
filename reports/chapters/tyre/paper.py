"""Sections of the tyre page: load and deflection, inflation, profiles and pressures of the paper's tyre."""

from __future__ import annotations

from typing import Any

import numpy as np

from reports.chapters.tyre import figures as figures_tyre
from reports.chapters.tyre.cells import CURVES, DELTA, FOLLOWER, ISOTROPIC, LINEAR, PAPER
from reports.maps import along_meridian, at_delta, pressure_map
from reports.markdown import Part, commands, fixed, joined, picture, prose, scientific, table
from reports.result_figures import mm_per_degree
from reports.tables import Cell, Store

KKT = ("equilibrium", "penetration", "tension", "complementarity")


def paper_part(store: Store) -> Part:
    """What the paper's tyre does."""
    sections = (_load, _linear_and_exact, _inflation, _profiles, _pressures)
    return joined([*(section(store) for section in sections), Part(commands(cell.command for cell in _tyres(store)))])


def _tyres(store: Store) -> list[Cell]:
    return [store.find(**asked) for asked in (PAPER, LINEAR, FOLLOWER, ISOTROPIC)]


def forces(store: Store) -> dict[float, tuple[float, float]]:
    """Forces of the linear and of the exact measure [N] by the travels of the latter up to 20 mm."""
    cells = store.find(**LINEAR), store.find(**PAPER)
    reached = [step["delta_mm"] for step in cells[1].steps if step["delta_mm"] <= DELTA]
    return {d: (cells[0].value("force_N", delta_mm=d), cells[1].value("force_N", delta_mm=d)) for d in reached}


def _load(store: Store) -> Part:
    cell = store.find(**PAPER)
    s = cell.result["settings"]
    text = prose(f"""## The paper's tyre under a plane

A torus of {s["plies"]} plies at ±{s["gamma_deg"]:g} deg to the meridian, held at ψ = ±{s["clamp_deg"]:g} deg, is
inflated by {s["p0_MPa"]:g} MPa ({s["load"]} load, mesh {cell.result["mesh"]}). A rigid frictionless plane then moves
towards the axis by Δ, counted from first touch. Half lengths are measured along φ, around the axis, half widths along
ψ, on the deformed outer face. The last four columns are residuals that a judge recomputes from the answer.""")
    header = ["Δ [mm]", "force P [N]", "centre pressure [MPa]", "nodes in contact", "half length [mm]"]
    header += ["half width [mm]", "Newton iterations"]
    header += ["equilibrium [-]", "penetration [mm]", "tension [MPa]", "complementarity [MPa mm]"]
    rows = table("Load, patch and residuals of the paper's tyre", header, (_load_row(step) for step in cell.steps))
    return Part("\n\n".join([text, rows]))


def _load_row(step: dict[str, Any]) -> list[str]:
    return [
        f"{step['delta_mm']:g}",
        fixed(step["force_N"], 2),
        fixed(step["centre_pressure_MPa"], 4),
        str(step["contact_nodes"]),
        fixed(step["half_length_mm"], 2),
        fixed(step["half_width_mm"], 2),
        str(step["newton_iterations"]),
        *(scientific(step["kkt"][name]) for name in KKT),
    ]


def _linear_and_exact(store: Store) -> Part:
    paper, linear = store.find(**PAPER), store.find(**LINEAR)
    pairs = forces(store)
    rows = [[f"{d:g}", fixed(low, 2), fixed(high, 2), fixed(low / high, 3)] for d, (low, high) in pairs.items()]
    linear_20, exact_20 = pairs[DELTA]
    text = prose(f"""### Linear against geometrically exact strains

At Δ = {DELTA:g} mm the linear measure needs {fixed(linear_20 / exact_20, 3)} times the force of the exact one.
The paper says "about two". Each measure counts Δ from the first touch of its own inflated tyre.""")
    header = ["Δ [mm]", "P linear [N]", "P exact [N]", "linear / exact"]
    curves = {
        f"{cell.result['measure']} strains": ([s["delta_mm"] for s in cell.steps], [s["force_N"] for s in cell.steps])
        for cell in (paper, linear)
    }
    name = "tyre-load-deflection.svg"
    shown = picture(name, "Force over the travel of the plane, linear and exact strains")
    rows_text = table("Force of the linear and of the exact measure", header, rows)
    text = "\n\n".join([text, rows_text, shown])
    return Part(text, {name: figures_tyre.load_deflection(curves)})


def _inflation(store: Store) -> Part:
    rows = []
    for cell in _tyres(store):
        settings, growth = cell.result["settings"], cell.result["quantities"]
        wall = "isotropic" if "E_MPa" in settings else f"plies at ±{settings['gamma_deg']:g} deg"
        what = f"{wall}, {cell.result['measure']} strains, {settings['load']} load, {settings['pressure_area']} area"
        rows.append(
            [what, *(fixed(growth.get(f"inflated_equator_{face}_mm"), 3, sign=True) for face in ("inner", "outer"))]
        )
    text = (
        "### Inflation\n\nWhich way the equator moves is up to the cords. A positive number is a growth of the radius."
    )
    title = "Displacement of the equator by inflation [mm]"
    body = table(title, ["tyre", "inner face", "outer face"], rows)
    return Part(f"{text}\n\n{body}")


def _profiles(store: Store) -> Part:
    cell = store.find(**PAPER)
    name = "tyre-profiles.svg"
    text = (
        f"### Deformed meridian\n\nInner and outer face at φ = 0, where the plane touches first.\n\n"
        f"{picture(name, 'Meridian profiles: unloaded, inflated and pressed')}"
    )
    return Part(text, {name: figures_tyre.profiles(cell.table("profile"), CURVES)})


def _pressures(store: Store) -> Part:
    cell = store.find(**PAPER)
    contact = cell.table("contact")
    curves = {f"Δ = {delta:g} mm": along_meridian(at_delta(contact, delta)) for delta in CURVES}
    pressures = pressure_map(at_delta(contact, DELTA))
    highest = float(pressures.max().max())
    row, column = np.argwhere(pressures.to_numpy() == highest)[0]
    at_psi, at_phi = abs(float(pressures.index[row])), abs(float(pressures.columns[column]))
    phi, psi = _extent(pressures.notna().any(axis=0)), _extent(pressures.notna().any(axis=1))
    names = "tyre-pressure-psi.svg", "tyre-pressure-map.svg"
    text = "\n\n".join(
        [
            "### Contact pressure",
            picture(names[0], "Contact pressure along the meridian under three travels"),
            f"At Δ = {DELTA:g} mm the outermost nodes in contact lie at φ = ±{phi:g} deg and ψ = ±{psi:g} deg; "
            f"the highest pressure is {fixed(highest, 3)} MPa, at |φ| = {at_phi:g} deg and |ψ| = {at_psi:g} deg.",
            picture(names[1], "Contact pressure over the patch, with its outline"),
        ]
    )
    drawn = figures_tyre.pressure_map(pressures, mm_per_degree(cell.table("profile")))
    return Part(text, {names[0]: figures_tyre.pressure_along_psi({"φ = 0": curves}), names[1]: drawn})


def _extent(touching: Any) -> float:
    """Largest angle of a boolean series by angle."""
    return float(max(abs(angle) for angle, inside in touching.items() if inside))
