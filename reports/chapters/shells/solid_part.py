"""Section "Shell against solid": the difference of the two isotropic tyres, split into mesh parts and a model part."""

from __future__ import annotations

import math

import pandas as pd

from reports.chapters.tyre.cells import ISOTROPIC_FINE
from reports.formats import digits, fixed, percent, share
from reports.markdown import Part, commands, filled, joined, prose, table
from reports.store.tables import Store

PENALTY = 20.0  # MPa/mm, NGSolve's


def solid_part(store: Store) -> Part:
    """The whole section."""
    data = store.analysis("solid_shell")
    forces = data[data["quantity"] == "force_N"]
    growth = data[data["quantity"].str.startswith("inflated")]
    order = data["body"].map({"solid": 0, "shell": 2}).fillna(1).argsort(kind="stable")  # the soft plane between them
    return joined(
        _introduction(store, forces),
        _values("Force [N] on three meshes", "Δ [mm]", forces, 2),
        _parts("What the difference of the forces is made of", "Δ [mm]", forces),
        _penalty(store, data[data["quantity"] == "penalty"]),
        _equator(growth),
        _values("Growth of the equator by inflation [mm] on three meshes", "face", growth, 4),
        _parts("What the difference of the growth is made of", "face", growth),
        commands(data["command"].iloc[order]),
    )


def _introduction(store: Store, forces: pd.DataFrame) -> str:
    s = store.find(scene="tyre-solid", mesh="56x72", epsilon=math.inf).settings
    options = store.find(**ISOTROPIC_FINE).settings
    return prose(f"""## Shell against solid

The same isotropic tyre (E = {s["E_MPa"]:g} MPa, ν = {s["nu"]:g}, one layer of {s["ply_thickness_mm"]:g} mm, pressure
{s["p0_MPa"]:g} MPa that follows the inner face) as a shell (thickness strain {options["thickness_strain"]}, membrane
{options["membrane"]}) and as a solid of quadratic hexahedra, under the same plane
by the same contact algorithm. On no two meshes do they differ by the model alone, so each body is extrapolated first.
The difference of the finest shell ({forces["mesh"].iloc[-1]}) from the solid is then the sum of the shell's mesh part
and the model part, what one director and the constant S33 of the shell are worth.

A patch grows by whole nodes, so its force converges irregularly: the order that three meshes show scatters, or does not
exist (a dash). The limits below are extrapolated from the two finer meshes with the order
{store.rules()["formal_order"]:g}; "known to" adds up how far the limits of both bodies have moved since the two coarser
meshes. A model part smaller than that is not distinguished from zero. Pressures at single nodes are not compared:
those of
quadratic faces scatter from corners to midpoints.""")


def _values(title: str, first: str, data: pd.DataFrame, decimals: int) -> str:
    header, lines = [first], []
    for body, own in data[data["at"] == data["at"].iloc[0]].groupby("body", sort=False):
        header += [*(f"{body} {mesh}" for mesh in own["mesh"]), "limit", "order"]
    for at, rows in data.groupby("at", sort=False):
        line = [str(at)]
        for _, own in rows.groupby("body", sort=False):
            line += [fixed(value, decimals) for value in (*own["value"], own["limit"].iloc[0])]
            line.append(fixed(own["order"].iloc[0], 1))
        lines.append([*line, fixed(rows["other"].iloc[0], decimals)])
    return table(title, [*header, "NGSolve"], lines)


def _parts(title: str, first: str, data: pd.DataFrame) -> str:
    header = [first, "mesh part of the solid", "mesh part of the shell", "model part", "known to"]
    header += ["solid's limit - NGSolve", "shell's limit - NGSolve"]
    lines = []
    for at, rows in data.groupby("at", sort=False):
        each = rows.drop_duplicates("body")
        model, known = percent(each["model_part"].iloc[0]), share(each["known_to"].iloc[0])
        lines.append([str(at), *map(percent, each["mesh_part"]), model, known, *map(percent, each["off_other"])])
    return table(title, header, lines)


def _penalty(store: Store, changes: pd.DataFrame) -> str:
    soft = store.find(scene="tyre-solid", epsilon=PENALTY).result
    each = ", ".join(filled("{value:+.2%} at {at} mm", changes))
    return prose(f"""NGSolve holds the plane by a penalty of {soft["settings"]["epsilon"]:g} MPa/mm. The same
penalty changes the force of our solid ({soft["mesh"]}) by {each}; that much of the difference between the two
solids is the penalty's.""")


def _equator(growth: pd.DataFrame) -> str:
    parts = " and ".join(filled("{model_part:+.2%} ({at})", growth.drop_duplicates("at")))
    return prose(f"""### The inflated equator

Nothing touches yet, but the difference is larger: {parts}. The radius grows by the hoop strain
(N_φ - ν N_ψ)/(E h), and on a torus the two terms nearly cancel: by membrane theory N_φ alone is
{digits(float(growth["cancellation"].iloc[0]), 2)} times their difference, so that what the shell neglects appears
enlarged. It falls with the square of the thickness, and with ν. Both bodies are held over the whole edge, where the
solution is not smooth: hence the low orders.""")
