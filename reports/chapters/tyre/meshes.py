"""Sections of the tyre page: meshes and loads, and the isotropic tyre against independent three-dimensional solids."""

from __future__ import annotations

import numpy as np
import pandas as pd

from reports.chapters.tyre import figures as figures_tyre
from reports.chapters.tyre.cells import BASE, DELTA, FINE, FOLLOWER, FOLLOWER_FINE, ISOTROPIC, ISOTROPIC_FINE
from reports.markdown import Part, commands, fixed, joined, percent, picture, prose, table
from reports.tables import Cell, Store

SOLID, INFLATION = "isotropic_tyre_3d_solid.csv", "isotropic_tyre_3d_inflation.csv"
SOLID_COLUMNS = ("delta_mm", "force_N_ngsolve", "force_N_calculix", "half_length_mm", "half_width_mm")
EQUATOR = "inflated_equator_{face}_mm"
DIRECTIONS = ("radial", "axial", "normal")


def meshes_part(store: Store) -> Part:
    """What mesh and load change, and how far the shell is from a solid."""
    return joined([_meshes(store), _solid_loads(store), _solid_inflation(store)])


def change(fine: Cell, coarse: Cell, quantity: str = "force_N") -> float:
    """Relative difference of a quantity at 20 mm: fine over coarse, less one."""
    values = [cell.value(quantity, delta_mm=DELTA) for cell in (fine, coarse)]
    return values[0] / values[1] - 1.0


def _meshes(store: Store) -> Part:
    pairs = [(store.find(**coarse), store.find(**fine)) for coarse, fine in ((BASE, FINE), (FOLLOWER, FOLLOWER_FINE))]
    rows = []
    for coarse, fine in pairs:
        for cell in (coarse, fine):
            rows.append([*_kind(cell), *_values(cell)])
        quantities = ("force_N", "centre_pressure_MPa", "half_length_mm", "half_width_mm")
        changes = [percent(change(fine, coarse, quantity)) for quantity in quantities]
        rows.append(["difference", "", changes[0], changes[1], "", *changes[2:]])
    header = ["load on area", "mesh", "force [N]", "centre pressure [MPa]", "nodes in contact", "half length [mm]"]
    dead, follower = (pair[0] for pair in pairs)
    text = prose(f"""## Mesh and load

The paper's mesh is {dead.result["mesh"]}; halving every element changes the force at Δ = {DELTA:g} mm by
{percent(change(pairs[0][1], dead))} with the paper's dead load on the mid-surface, and by
{percent(change(pairs[1][1], follower))} with a pressure that follows the true inner face, as in a real tyre. On the
same mesh the following load changes the force by {percent(change(follower, dead))}.""")
    body = table("Two meshes under two loads", [*header, "half width [mm]"], rows, words=2)
    return Part("\n\n".join([text, body, commands(cell.command for pair in pairs for cell in pair)]))


def _kind(cell: Cell) -> list[str]:
    settings = cell.result["settings"]
    return [f"{settings['load']}, {settings['pressure_area']}", cell.result["mesh"]]


def _values(cell: Cell) -> list[str]:
    decimals = {"force_N": 2, "centre_pressure_MPa": 4, "contact_nodes": 0, "half_length_mm": 2, "half_width_mm": 2}
    return [fixed(cell.value(quantity, delta_mm=DELTA), places) for quantity, places in decimals.items()]


def isotropic_differences(store: Store) -> list[tuple[float, float, float]]:
    """Travel and relative difference of the force from NGSolve, on the coarse and on the fine mesh."""
    solid = store.reference_table(SOLID, SOLID_COLUMNS)
    cells = store.find(**ISOTROPIC), store.find(**ISOTROPIC_FINE)
    found = []
    for delta, force in zip(solid["delta_mm"], solid["force_N_ngsolve"], strict=True):
        coarse, fine = (cell.value("force_N", delta_mm=delta) / force - 1.0 for cell in cells)
        found.append((float(delta), coarse, fine))
    return found


def _solid_loads(store: Store) -> Part:
    solid = store.reference_table(SOLID, SOLID_COLUMNS)
    cells = store.find(**ISOTROPIC), store.find(**ISOTROPIC_FINE)
    rows, extents = [], []
    for (_, row), (delta, coarse, fine) in zip(solid.iterrows(), isotropic_differences(store), strict=True):
        forces = [cell.value("force_N", delta_mm=delta) for cell in cells]
        solids = [float(row["force_N_ngsolve"]), float(row["force_N_calculix"])]
        start = [f"{delta:g}", *(fixed(force, 2) for force in (*forces, *solids))]
        rows.append([*start, percent(coarse), percent(fine), percent(solids[1] / solids[0] - 1.0)])
        line = [f"{delta:g}"]
        for quantity in ("half_length_mm", "half_width_mm"):
            line += [fixed(value, 2) for value in (*(c.value(quantity, delta_mm=delta) for c in cells), row[quantity])]
        extents.append(line)
    meshes = [cell.result["mesh"] for cell in cells]
    header = ["Δ [mm]", *(f"P {mesh} [N]" for mesh in meshes), "P NGSolve [N]", "P CalculiX [N]"]
    header += [*(f"{mesh} - NGSolve" for mesh in meshes), "CalculiX - NGSolve"]
    names = [f"half {name} {who} [mm]" for name in ("length", "width") for who in (*meshes, "solid")]
    source = store.reference("tyre", "force_N", "computed", delta_mm=DELTA)
    s = cells[0].result["settings"]
    text = prose(f"""## An isotropic tyre against three-dimensional solids

The same torus of one isotropic layer (E = {s["E_MPa"]:g} MPa, ν = {s["nu"]:g}), load {s["load"]}, pressure
area {s["pressure_area"]}. Reference, computed independently: {source["source"]}; the uncertainty of its force is
{percent(source["uncertainty"], 1, sign=False)}. Half extents of the patch are known to half an element at best.""")
    tables = [
        table("Force of shell and solid", header, rows),
        table("Half extents of the patch, shell and solid", ["Δ [mm]", *names], extents),
    ]
    return Part("\n\n".join([text, *tables]))


def mid_displacement(profile: pd.DataFrame) -> pd.DataFrame:
    """Displacement of the mid-surface by inflation, by psi: radial, axial and along the unloaded normal [mm]."""
    states = [profile[profile["state"] == state].reset_index(drop=True) for state in ("unloaded", "inflated")]
    moved = pd.DataFrame({"psi_deg": states[0]["psi_deg"]})
    for name in DIRECTIONS[:2]:
        middle = [0.5 * (state[f"inner_{name}_mm"] + state[f"outer_{name}_mm"]) for state in states]
        moved[f"{name}_mm"] = middle[1] - middle[0]
    psi = np.deg2rad(moved["psi_deg"])
    moved["normal_mm"] = moved["radial_mm"] * np.cos(psi) + moved["axial_mm"] * np.sin(psi)
    return moved[moved["psi_deg"] > -1e-9].reset_index(drop=True)


def _solid_inflation(store: Store) -> Part:
    solid = store.reference_table(INFLATION, ["psi_deg", *(f"{name}_mm" for name in DIRECTIONS)])
    cells = [store.find(**ISOTROPIC), store.find(**ISOTROPIC_FINE)]
    inflated = [cell for cell in cells if EQUATOR.format(face="inner") in cell.result["quantities"]]
    moved = {cell.result["mesh"]: mid_displacement(cell.table("profile")) for cell in inflated}
    rows = []
    for _, row in solid.iterrows():
        line = [f"{row['psi_deg']:g}"]
        for name in DIRECTIONS:
            ours = [np.interp(row["psi_deg"], m["psi_deg"], m[f"{name}_mm"]) for m in moved.values()]
            line += [fixed(float(value), 4) for value in (*ours, row[f"{name}_mm"])]
        rows.append(line)
    header = ["ψ [deg]", *(f"{name} {who}" for name in DIRECTIONS for who in (*moved, "solid"))]
    name = "tyre-isotropic-inflation.svg"
    text = "\n\n".join(
        [
            "### Its inflation",
            _equator(store, inflated),
            "Displacement of the mid-surface, that is the mean of both faces, by the angle ψ of the meridian; between "
            "nodes the shell's is interpolated linearly.",
            table("Displacement of the mid-surface by inflation [mm]", header, rows),
            picture(name, "Radial and axial displacement of the mid-surface by inflation, shell and solid"),
            commands(cell.command for cell in cells),
        ]
    )
    curves = {f"shell {mesh}": displacement for mesh, displacement in moved.items()}
    return Part(text, {name: figures_tyre.inflated_displacement(curves, solid, "3D solid")})


def _equator(store: Store, cells: list[Cell]) -> str:
    """Growth of both faces of the equator beside the solid's."""
    rows = []
    for face in ("inner", "outer"):
        quantity = EQUATOR.format(face=face)
        reference = store.references_of("tyre", quantity, "computed")[0]["value"]
        ours = [cell.result["quantities"][quantity] for cell in cells]
        rows.append([face, *(fixed(v, 4) for v in (*ours, reference)), *(percent(v / reference - 1) for v in ours)])
    meshes = [cell.result["mesh"] for cell in cells]
    header = ["face", *meshes, "solid", *(f"{mesh} - solid" for mesh in meshes)]
    return table("Growth of the equator by inflation [mm]", header, rows)
