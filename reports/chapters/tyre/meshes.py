"""Sections of the tyre page: meshes and loads, and the isotropic tyre against independent three-dimensional solids."""

from __future__ import annotations

import numpy as np
import pandas as pd

from reports.chapters.tyre import figures
from reports.chapters.tyre.cells import BASE, DELTA, FINE, FOLLOWER, FOLLOWER_FINE, ISOTROPIC, ISOTROPIC_FINE, change
from reports.formats import fixed, percent, share
from reports.markdown import Part, commands, joined, listing, picture, prose, table
from reports.store.cells import Cell
from reports.store.tables import Store

SOLID, INFLATION = "isotropic_tyre_3d_solid.csv", "isotropic_tyre_3d_inflation.csv"
SOLID_COLUMNS = ("delta_mm", "force_N_ngsolve", "force_N_calculix", "half_length_mm", "half_width_mm")
EQUATOR = "inflated_equator_{face}_mm"
DIRECTIONS = ("radial", "axial", "normal")
VALUES = {  # head: quantity, decimals
    "force [N]": ("force_N", 2),
    "centre pressure [MPa]": ("centre_pressure_MPa", 4),
    "nodes in contact": ("contact_nodes", 0),
    "half length [mm]": ("half_length_mm", 2),
    "half width [mm]": ("half_width_mm", 2),
}


def meshes_part(store: Store) -> Part:
    """What mesh and load change, and how far the shell is from a solid."""
    return joined(_meshes(store), _solid_loads(store), _solid_inflation(store))


def _meshes(store: Store) -> Part:
    dead, dead_fine, follower, follower_fine = (store.find(**asked) for asked in (BASE, FINE, FOLLOWER, FOLLOWER_FINE))
    rows = []
    for coarse, fine in ((dead, dead_fine), (follower, follower_fine)):
        for cell in (coarse, fine):
            named = [f"{cell.settings['load']}, {cell.settings['pressure_area']}", cell.result["mesh"]]
            rows.append([*named, *(fixed(cell.value(name, delta_mm=DELTA), n) for name, n in VALUES.values())])
        changes = (percent(change(fine, coarse, name)) if decimals else "" for name, decimals in VALUES.values())
        rows.append(["difference", "", *changes])
    text = prose(f"""## Mesh and load

The paper's mesh is {dead.result["mesh"]}; halving every element changes the force at Δ = {DELTA:g} mm by
{percent(change(dead_fine, dead))} with the paper's dead load on the mid-surface, and by
{percent(change(follower_fine, follower))} with a pressure that follows the true inner face, as in a real tyre. On the
same mesh the following load changes the force by {percent(change(follower, dead))}.""")
    body = table("Two meshes under two loads", ["load on area", "mesh", *VALUES], rows, words=2)
    return joined(text, body, commands(cell.command for cell in (dead, dead_fine, follower, follower_fine)))


def _isotropic(store: Store) -> list[Cell]:
    """The isotropic tyre on the coarse and on the fine mesh."""
    return [store.find(**ISOTROPIC), store.find(**ISOTROPIC_FINE)]


def beside_solids(store: Store) -> pd.DataFrame:
    """Forces and half extents of the solids and of the shell on both meshes, and how far it is from NGSolve's force."""
    found = store.reference_table(SOLID, SOLID_COLUMNS)
    for mesh, cell in zip(("coarse", "fine"), _isotropic(store), strict=True):
        for name in ("force_N", "half_length_mm", "half_width_mm"):
            found[f"{mesh}_{name}"] = [cell.value(name, delta_mm=delta) for delta in found["delta_mm"]]
        found[f"{mesh}_off"] = found[f"{mesh}_force_N"] / found["force_N_ngsolve"] - 1.0
    return found.assign(calculix_off=found["force_N_calculix"] / found["force_N_ngsolve"] - 1.0)


def _solid_loads(store: Store) -> Part:
    found, cells = beside_solids(store), _isotropic(store)
    meshes = [cell.result["mesh"] for cell in cells]
    forces = ["Δ [mm]", *(f"P {mesh} [N]" for mesh in meshes), "P NGSolve [N]", "P CalculiX [N]"]
    heads = " | ".join([*forces, *(f"{mesh} - NGSolve" for mesh in meshes), "CalculiX - NGSolve"])
    line = (
        "{delta_mm:g} | {coarse_force_N:.2f} | {fine_force_N:.2f} | {force_N_ngsolve:.2f} | {force_N_calculix:.2f} | "
    )
    line += "{coarse_off:+.2%} | {fine_off:+.2%} | {calculix_off:+.2%}"
    extents = ["Δ [mm]", *(f"half {name} {who} [mm]" for name in ("length", "width") for who in (*meshes, "solid"))]
    extent = "{delta_mm:g} | {coarse_half_length_mm:.2f} | {fine_half_length_mm:.2f} | {half_length_mm:.2f} | "
    extent += "{coarse_half_width_mm:.2f} | {fine_half_width_mm:.2f} | {half_width_mm:.2f}"
    by_extent = listing("Half extents of the patch, shell and solid", found, " | ".join(extents), extent)
    source = store.reference("tyre", "force_N", "computed", delta_mm=DELTA)
    s = cells[0].settings
    text = prose(f"""## An isotropic tyre against three-dimensional solids

The same torus of one isotropic layer (E = {s["E_MPa"]:g} MPa, ν = {s["nu"]:g}), load {s["load"]}, pressure
area {s["pressure_area"]}. Reference, computed independently: {source["source"]}; the uncertainty of its force is
{share(source["uncertainty"], 1)}. Half extents of the patch are known to half an element at best.""")
    return joined(text, listing("Force of shell and solid", found, heads, line), by_extent)


def mid_displacement(profile: pd.DataFrame) -> pd.DataFrame:
    """Displacement of the mid-surface by inflation, by psi: radial, axial and along the unloaded normal [mm]."""
    unloaded, inflated = (
        profile[profile["state"] == state].reset_index(drop=True) for state in ("unloaded", "inflated")
    )
    moved = unloaded[["psi_deg"]].copy()
    for name in DIRECTIONS[:2]:
        before, after = (0.5 * (s[f"inner_{name}_mm"] + s[f"outer_{name}_mm"]) for s in (unloaded, inflated))
        moved[f"{name}_mm"] = after - before
    psi = np.deg2rad(moved["psi_deg"])
    moved["normal_mm"] = moved["radial_mm"] * np.cos(psi) + moved["axial_mm"] * np.sin(psi)
    return moved[moved["psi_deg"] > -1e-9].reset_index(drop=True)


def _solid_inflation(store: Store) -> Part:
    solid, cells = store.reference_table(INFLATION, ["psi_deg", *(f"{n}_mm" for n in DIRECTIONS)]), _isotropic(store)
    inflated = [cell for cell in cells if EQUATOR.format(face="inner") in cell.result["quantities"]]
    moved = {cell.result["mesh"]: mid_displacement(cell.table("profile")) for cell in inflated}
    shown = solid[["psi_deg"]].rename(columns={"psi_deg": "ψ [deg]"})
    for name in DIRECTIONS:
        for mesh, ours in moved.items():
            shown[f"{name} {mesh}"] = np.interp(solid["psi_deg"], ours["psi_deg"], ours[f"{name}_mm"])
        shown[f"{name} solid"] = solid[f"{name}_mm"]
    heads, line = " | ".join(shown.columns), "{ψ [deg]:g}" + "".join(f" | {{{name}:.4f}}" for name in shown.columns[1:])
    words = "Radial and axial displacement of the mid-surface by inflation, shell and solid"
    drawn = figures.inflated_displacement({f"shell {mesh}": each for mesh, each in moved.items()}, solid, "3D solid")
    return joined(
        "### Its inflation",
        _equator(store, inflated),
        "Displacement of the mid-surface, that is the mean of both faces, by the angle ψ of the meridian; between "
        "nodes the shell's is interpolated linearly.",
        listing("Displacement of the mid-surface by inflation [mm]", shown, heads, line),
        picture("tyre-isotropic-inflation.svg", words, drawn),
        commands(cell.command for cell in cells),
    )


def _equator(store: Store, cells: list[Cell]) -> str:
    """Growth of both faces of the equator beside the solid's."""
    rows = []
    for face in ("inner", "outer"):
        quantity = EQUATOR.format(face=face)
        reference = store.reference("tyre", quantity, "computed")["value"]
        ours = [cell.result["quantities"][quantity] for cell in cells]
        rows.append([face, *(fixed(v, 4) for v in (*ours, reference)), *(percent(v / reference - 1) for v in ours)])
    meshes = [cell.result["mesh"] for cell in cells]
    header = ["face", *meshes, "solid", *(f"{mesh} - solid" for mesh in meshes)]
    return table("Growth of the equator by inflation [mm]", header, rows)
