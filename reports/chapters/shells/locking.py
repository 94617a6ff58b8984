"""Section of the page of verification: what locks when the mesh stays and the shell gets thinner, and what does not."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import pandas as pd
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from reports.figures.drawing import BLACK, canvas, looks, svg
from reports.formats import NOTHING, fixed
from reports.markdown import Part, joined, picture, prose, table
from reports.store.tables import Store

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
    better = int((known["energy_norm_error"] < known["yardstick_reduced"]).sum())
    least = float((known["yardstick_unreduced"] / known["energy_norm_error"]).min())
    by_h, by_l = rates(data)
    text = prose("""## Locking

An element locks when it can bend only with a strain that real bending does not have, which costs the more the thinner
the shell is. The mesh stays, the shell gets thinner: a ratio found/exact that stays where it is has no locking in it;
its distance from 1 is the ordinary error of the mesh. All problems are linear. Poisson thickness locking is a property
of the section, the same on every mesh and at every thickness.""")
    law = prose(f"""*What is not removed*: the free hyperboloid locks on coarse meshes. Its excess U/U_h - 1, less what
is there at h/R = {STILL:g}, follows (l³/h)² with the length l of an element (factor {by_h} for the last decade of h and
{by_l} for a halving of l on the coarsest meshes): l³ must be small against h R². None of the membrane options removes
it.

The yardstick of the picture is what Elmer (ElmerCSC/elmerfem, tests `Shell_BenchmarkCase1_Quad` and
`Shell_BenchmarkCase2_Quad`) prints of bilinear elements on the cylinder: errors of this element, with either membrane
option, are below those of the reduced one in {better} of {len(known)} cases, and below those of the unreduced one by a
factor of at least {fixed(least, 1)}.""")
    heads = ["locking", "problem", "elements", "thick", "found/exact", "thin", "found/exact"]
    body = table("Found over exact, from thick to thin", heads, _rows(store, data), words=2)
    words = "Error in the energy norm over h/R, by surface, ends and mesh"
    drawn = picture("locking-membrane.svg", words, draw_membrane(data[data["membrane"] == DEFAULT]))
    return joined(text, body, drawn, law)


def _rows(store: Store, data: pd.DataFrame) -> Iterator[list[object]]:
    """A line a problem and mesh: stiffness, deflection or energy found over exact, of a thick and of a thin one."""
    walls = store.table("thickness_locking")
    walls = walls[(walls["elements"] == walls["elements"].max()) & (walls["load"] == walls["load"].iloc[0])]
    for section in (STIFF, REMEDY):
        own = walls[walls["section"] == section].drop_duplicates("nu").sort_values("nu")
        ends = (entry for row in (own.iloc[0], own.iloc[-1]) for entry in _end("ν", row["nu"], row["stiffness_ratio"]))
        yield ["Poisson thickness", f"bending, `{section}`: stiffness", own["elements"].iloc[0], *ends]
    shear = store.table("shear_locking").sort_values("l_over_h")
    ends = (entry for row in (shear.iloc[0], shear.iloc[-1]) for entry in _end("l/h", row["l_over_h"], row["ratio"]))
    yield ["shear", "cantilever: deflection", shear["elements"].iloc[0], *ends]
    for n, own in store.table("curved_beam").groupby("elements"):
        yield ["curved beam", "quarter ring: deflection", n, *_thinned(own, "ratio")]
    mine = data[data["membrane"] == DEFAULT]
    for (surface, end, count), own in mine.groupby(["surface", "end", "elements"], sort=False):
        yield ["membrane", f"{surface}, {end} ends: energy", count, *_thinned(own, "energy_ratio")]


def _thinned(rows: pd.DataFrame, name: str) -> list[str]:
    """The thickest and the thinnest."""
    own = rows.sort_values("h_over_R", ascending=False)
    return [entry for row in (own.iloc[0], own.iloc[-1]) for entry in _end("h/R", row["h_over_R"], row[name])]


def _end(name: str, at: float, ratio: float) -> tuple[str, str]:
    return f"{name} = {at:g}", fixed(ratio, 3)


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
