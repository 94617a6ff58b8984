"""Section of the page of verification: what locks when the mesh stays and the shell gets thinner, and what does not.

And what meshes that follow no coordinates cost, by measure, shell and option.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from reports.figures.drawing import BLACK, canvas, legend_above, lines, looks, svg, ticks
from reports.formats import NOTHING, fixed
from reports.markdown import Part, Template
from reports.store import Store

TEXT = Template("convergence")
REMEDY, STIFF = "constant-s33", "full-3d"
DEFAULT = {"thickness_strain": "balanced", "membrane": "relaxed"}  # of the element
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
    drawn = {"locking-membrane.svg": draw_membrane(data[data["membrane"] == DEFAULT["membrane"]])}
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
    mine = _thinned(data[data["membrane"] == DEFAULT["membrane"]])
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
    more = excess(data, DEFAULT["membrane"])
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


OPTIONS = ["thickness_strain", "membrane"]


def distortion_part(store: Store) -> Part:
    """The whole section."""
    data, shells, orders = (store.table(name) for name in ("distortion", "distorted_shells", "distortion_orders"))
    own = shells[(shells[list(DEFAULT)] == pd.Series(DEFAULT)).all(axis=1)]
    most, middle = shells["amount"].max(), shells.loc[~shells.index.isin(own.index), "amount"].max()
    kinds = list(dict.fromkeys(orders[orders["amount"] > 0]["distortion"]))
    values = {"most": most, "middle": middle, "finest": orders["n"].max(), "count": shells["scene"].nunique()}
    rows = {
        "measures": list(_measures(orders, most)),
        "shells": list(_shells(own[own["amount"] == most])),
        "options": list(_options(shells[(shells["amount"] == middle) & (shells["finer"] == 1)])),
    }
    drawn = {
        "distortion-measures.svg": draw_measures(data[data["amount"].isin((0.0, most))]),
        "distortion-shells.svg": draw_shells(own[own["finer"] == own["finer"].min()], kinds),
    }
    return TEXT("distortion", drawn, **values, **rows)


def _measures(orders: pd.DataFrame, most: float) -> Iterator[dict[Any, Any]]:
    """A line a measure: the regular mesh, then what each distortion makes of it."""
    for measure, own in orders.groupby("measure", sort=False):
        (still,) = own[own["amount"] == 0].to_dict("records")
        moved = {row["distortion"]: row for row in own[own["amount"] == most].to_dict("records")}
        regular = {"error": still["error_displacement"], "order": still["order_displacement"]}
        yield {"measure": measure, **regular, **moved}


def _shells(moved: pd.DataFrame) -> Iterator[dict[str, Any]]:
    """A line a shell: changes on the coarser mesh, then on the finer one."""
    for scene, own in moved.groupby("scene", sort=False):
        line: dict[str, Any] = {"scene": scene}
        for (_, mesh), each in own.groupby(["finer", "mesh"]):
            before = "fine_" if "mesh" in line else ""
            changes = dict(zip(each["distortion"], each["change"], strict=True))
            line |= {f"{before}mesh": mesh, **{f"{before}{kind}": change for kind, change in changes.items()}}
        yield line


def _options(moved: pd.DataFrame) -> Iterator[dict[Any, Any]]:
    """A line an element: median and largest size of the changes over the shells."""
    for names, own in moved.groupby(OPTIONS, sort=False):
        sizes = own["change"].abs().groupby(own["distortion"]).agg(["median", "max"])
        yield {**dict(zip(OPTIONS, names, strict=True)), **sizes.to_dict("index")}


@svg
def draw_measures(data: pd.DataFrame) -> Figure:
    """Error of the displacement over the number of elements: a panel a distortion, a line a measure."""
    kinds = list(dict.fromkeys(data["distortion"]))
    figure, panels = canvas(len(kinds), columns=2, width=9.0, height=3.0, sharey=True)
    n = np.array(sorted(data["n"].unique()), float)
    first = data[data["n"] == n[0]]["error_displacement"].min()
    for axes, kind in zip(panels, kinds, strict=True):
        own = data[data["distortion"] == kind]
        lines(axes, {m: (g["n"], g["error_displacement"]) for m, g in own.groupby("measure", sort=False)})
        axes.plot(n, 0.5 * first * (n[0] / n) ** 2, color=BLACK, linewidth=1, linestyle=":")
        axes.set(xscale="log", yscale="log", title=kind)
        ticks(axes, n)
    for axes in panels[-2:]:
        axes.set_xlabel("elements along a side; dotted: order 2")
    for axes in panels[::2]:
        axes.set_ylabel("error of displacement")
    legend_above(figure, panels[0], columns=5)
    return figure


@svg
def draw_shells(data: pd.DataFrame, kinds: list[str]) -> Figure:
    """Size of the change of the deflection over the distortion: a panel a way of moving nodes, a line a shell."""
    figure, panels = canvas(len(kinds), width=10.0, height=3.6, sharey=True)
    for axes, kind in zip(panels, kinds, strict=True):
        own = data[data["distortion"] == kind]
        lines(axes, {scene: (g["amount"], g["change"].abs()) for scene, g in own.groupby("scene", sort=False)})
        axes.set(xscale="log", yscale="log", title=kind, xlabel="distort")
        ticks(axes, sorted(own["amount"].unique()))
    panels[0].set_ylabel("change of the deflection")
    legend_above(figure, panels[0], columns=5)
    return figure
