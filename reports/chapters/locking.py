"""Section of the page of verification: what locks when the mesh stays and the shell gets thinner, and what does not."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import pandas as pd
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from reports.figures.drawing import BLACK, canvas, looks, svg
from reports.formats import NOTHING, fixed
from reports.markdown import Part, Template
from reports.store import Store

TEXT = Template("convergence")
REMEDY, STIFF = "constant-s33", "full-3d"
DEFAULT = "relaxed"  # membrane of the default element
YARDSTICKS: dict[str, dict[str, Any]] = {  # bilinear elements, drawn in the colours of their meshes
    kind: {"marker": marker, "linestyle": "none", "markersize": 10, "fillstyle": "none", "markeredgewidth": 1.6}
    for kind, marker in (("reduced", "D"), ("unreduced", "X"))
}
STILL, SMALLEST = 1e-3, 1e-3  # h/R at which no mesh of the free hyperboloid locks; an excess that is not rounding


def locking_part(store: Store) -> Part:
    """The whole section."""
    data = store.table("membrane_locking")
    known = data.dropna(subset=["yardstick_reduced"])
    by_h, by_l = rates(data)
    values = {
        "count": len(known),
        "better": int((known["energy_norm_error"] < known["yardstick_reduced"]).sum()),
        "least": float((known["yardstick_unreduced"] / known["energy_norm_error"]).min()),
        "still": STILL,
    }
    drawn = {"locking-membrane.svg": draw_membrane(data[data["membrane"] == DEFAULT])}
    return TEXT("locking", drawn, rows=list(_rows(store, data)), by_h=by_h, by_l=by_l, **values)


def _rows(store: Store, data: pd.DataFrame) -> Iterator[dict[str, Any]]:
    """A line a problem and mesh: stiffness, deflection or energy found over exact, of a thick and of a thin one."""
    walls = store.table("thickness_locking")
    walls = walls[(walls["elements"] == walls["elements"].max()) & (walls["load"] == walls["load"].iloc[0])]
    for section in (STIFF, REMEDY):
        own = walls[walls["section"] == section].sort_values("nu")
        yield _ends(own, "nu", "stiffness_ratio", "Poisson thickness", f"bending, `{section}`: stiffness", "ν")
    shear = store.table("shear_locking").sort_values("l_over_h")
    yield _ends(shear, "l_over_h", "ratio", "shear", "cantilever: deflection", "l/h")
    for _, own in _thinned(store.table("curved_beam")).groupby("elements"):
        yield _ends(own, "h_over_R", "ratio", "curved beam", "quarter ring: deflection", "h/R")
    mine = _thinned(data[data["membrane"] == DEFAULT])
    for surface, end, count in data[["surface", "end", "elements"]].drop_duplicates().to_numpy():
        own = mine[(mine["surface"] == surface) & (mine["end"] == end) & (mine["elements"] == count)]
        yield _ends(own, "h_over_R", "energy_ratio", "membrane", f"{surface}, {end} ends: energy", "h/R")


def _thinned(rows: pd.DataFrame) -> pd.DataFrame:
    """From the thickest to the thinnest."""
    return rows.sort_values("h_over_R", ascending=False)


def _ends(rows: pd.DataFrame, at: str, ratio: str, kind: str, problem: str, name: str) -> dict[str, Any]:
    """The first and the last row."""
    first, last = rows.iloc[0], rows.iloc[-1]
    ends = {"thick": first[at], "thick_ratio": first[ratio], "thin": last[at], "thin_ratio": last[ratio]}
    return {"kind": kind, "problem": problem, "elements": int(first["elements"]), "name": name, **ends}


@svg
def draw_membrane(data: pd.DataFrame) -> Figure:
    """Error in the energy norm over h/R: a panel a surface and end, a line a mesh."""
    meshes = looks(sorted(set(data["elements"])))
    cases = list(dict.fromkeys(zip(data["surface"], data["end"], strict=True)))
    figure, panels = canvas(len(cases), columns=2, width=9.0, height=2.5, sharey=True)
    for axes, (surface, end) in zip(panels, cases, strict=True):
        rows = data[(data["surface"] == surface) & (data["end"] == end)]
        for n, mesh in meshes.items():
            own = rows[rows["elements"] == n]
            axes.loglog(own["h_over_R"], own["energy_norm_error"], **mesh.whole, label=f"{n} x {n} elements")
            known = own.dropna()
            for name, points in YARDSTICKS.items():
                axes.loglog(known["h_over_R"], known[f"yardstick_{name}"], color=mesh.colour, **points)
        axes.set(title=f"{surface}, {end} ends", ylim=(8e-3, 1.6))
        axes.invert_xaxis()
    for axes in panels[-2:]:
        axes.set_xlabel("h/R")
    for axes in panels[::2]:
        axes.set_ylabel("error, energy norm")
    handles, _ = panels[0].get_legend_handles_labels()
    marks = [Line2D([], [], color=BLACK, **points, label=f"bilinear, {kind}") for kind, points in YARDSTICKS.items()]
    figure.legend(handles=[*handles, *marks], loc="outside upper center", ncols=5)
    return figure


def rates(data: pd.DataFrame) -> tuple[str, str]:
    """By what the excess grows with the last decade of h, and falls with the first halving of l."""
    more = excess(data, DEFAULT)
    first, second = more.columns[:2]
    last, before = more[first].iloc[-1], more[first].iloc[-2]
    halved = more[second].iloc[-1]
    return (
        fixed(last / before) if min(last, before) > SMALLEST else NOTHING,
        fixed(last / halved) if min(last, halved) > SMALLEST else NOTHING,
    )


def excess(data: pd.DataFrame, membrane: str) -> pd.DataFrame:
    """U/U_h - 1 of the free hyperboloid (rows h/R, columns elements), less what is there at h/R = STILL."""
    own = data[(data["surface"] == "hyperboloid") & (data["end"] == "free") & (data["membrane"] == membrane)]
    grid = 1 / own.pivot_table(index="h_over_R", columns="elements", values="energy_ratio") - 1
    still = grid[grid.index >= 0.99 * STILL].iloc[0]
    return (grid - still)[grid.index < 0.99 * STILL].sort_index(ascending=False)
