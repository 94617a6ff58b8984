"""Section of the tyre page: the isotropic tyre as a shell and as a solid, split into mesh parts and a model part."""

from __future__ import annotations

import math

import pandas as pd

from reports.chapters.tyre.cells import ISOTROPIC_FINE
from reports.formats import digits, fixed, percent, share
from reports.markdown import Part, commands, filled, joined, prose, table
from reports.store.tables import Store

PENALTY = 20.0  # MPa/mm, NGSolve's
HEAD = (
    *("limit of the solid", "mesh part of the solid", "limit of the shell", "mesh part of the shell"),
    *("model part", "known to", "limit of the solid over NGSolve"),
)


def solid_part(store: Store) -> Part:
    """The whole section."""
    data = store.analysis("solid_shell")
    forces, growth = data[data["quantity"] == "force_N"], data[data["quantity"].str.startswith("inflated")]
    order = data["body"].map({"solid": 0, "shell": 2}).fillna(1).argsort(kind="stable")  # the soft plane between them
    return joined(
        _introduction(store, forces),
        _parts("Force of shell and solid [N]", "Δ [mm]", forces, 2),
        _penalty(store, data[data["quantity"] == "penalty"], growth),
        _parts("Growth of the equator by inflation [mm]", "face", growth, 4),
        commands(data["command"].iloc[order]),
    )


def _introduction(store: Store, forces: pd.DataFrame) -> str:
    s = store.find(scene="tyre-solid", mesh="56x72", epsilon=math.inf).settings
    options = store.find(**ISOTROPIC_FINE).settings
    return prose(f"""## Shell against solid

An isotropic tyre (E = {s["E_MPa"]:g} MPa, ν = {s["nu"]:g}, one layer of {s["ply_thickness_mm"]:g} mm, pressure
{s["p0_MPa"]:g} MPa that follows the inner face) as a shell (thickness strain {options["thickness_strain"]}, membrane
{options["membrane"]}) and as a solid of quadratic hexahedra, under the same plane by the same contact algorithm. Each
body is extrapolated over three meshes before they are compared; the finest shell ({forces["mesh"].iloc[-1]}) then
differs from the solid by the mesh part of the shell and by the *model part*: one director and constant S33. Forces of a
patch that grows by whole nodes converge irregularly, so limits are extrapolated with the order
{store.rules()["formal_order"]:g}; *known to* adds up how far both have moved since the two coarser meshes. A smaller
model part is not distinguished from zero.""")


def _parts(title: str, first: str, data: pd.DataFrame, decimals: int) -> str:
    lines = []
    for at, rows in data.groupby("at", sort=False):
        (_, solid), (_, shell) = rows.drop_duplicates("body").iterrows()
        bodies = ((fixed(each["limit"], decimals), percent(each["mesh_part"])) for each in (solid, shell))
        split = [percent(solid["model_part"]), share(solid["known_to"]), percent(solid["off_other"])]
        lines.append([str(at), *(entry for body in bodies for entry in body), *split])
    return table(title, [first, *HEAD], lines)


def _penalty(store: Store, changes: pd.DataFrame, growth: pd.DataFrame) -> str:
    soft = store.find(scene="tyre-solid", epsilon=PENALTY).result
    each = ", ".join(filled("{value:+.2%} at {at} mm", changes))
    parts = " and ".join(filled("{model_part:+.2%} ({at})", growth.drop_duplicates("at")))
    return prose(f"""NGSolve, solved independently, holds the plane by a penalty of {soft["settings"]["epsilon"]:g}
MPa/mm, which changes the force of our solid ({soft["mesh"]}) by {each}.

The inflated equator differs by more: {parts}. Its radius grows by (N_φ - ν N_ψ)/(E h), and on a torus the two terms
nearly cancel: by membrane theory N_φ alone is {digits(float(growth["cancellation"].iloc[0]), 2)} times their
difference, so that what the shell neglects appears enlarged.""")
