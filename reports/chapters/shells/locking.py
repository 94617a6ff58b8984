"""The page of locking: thickness, shear, curved beam and membrane, with what is not removed."""

from __future__ import annotations

from itertools import pairwise, product
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from reports.chapter import Chapter
from reports.figures.drawing import BLACK, canvas, lines, looks, svg
from reports.formats import NOTHING, code, fixed, scientific, share
from reports.markdown import Part, joined, listing, machine, picture, prose, table
from reports.store.tables import Store

INTRODUCTION = prose("""# Locking

An element locks when it can bend only with a strain that real bending does not have, and that strain costs the more
the thinner the shell is. The test is the same everywhere: the mesh stays, the shell gets thinner. A ratio found/exact
that stays where it is has no locking in it; its distance from 1 is the ordinary error of the mesh. All problems are
linear, with the linear measure.""")
REMEDY = "constant-s33"
YARDSTICKS: dict[str, dict[str, Any]] = {  # bilinear elements, drawn in the colours of their meshes
    kind: {"marker": marker, "linestyle": "none", "markersize": 10, "fillstyle": "none", "markeredgewidth": 1.6}
    for kind, marker in (("reduced", "D"), ("unreduced", "X"))
}
ROUNDED, ONE = 5e-5, 0.01  # h/R below which rounding reaches the third decimal; a change that is still none
STILL, SMALLEST = 1e-3, 1e-3  # h/R at which no mesh of the free hyperboloid locks; an excess that is not rounding


def locking_page(store: Store) -> Part:
    """The whole page."""
    return joined(INTRODUCTION, _thickness(store), _shear(store), _ring(store), _membrane(store))


def _thickness(store: Store) -> Part:
    """Poisson thickness locking: a property of the section, on every mesh the same."""
    data = store.table("thickness_locking")
    finest = data[data["elements"] == data["elements"].max()]
    loads, nus = list(dict.fromkeys(finest["load"])), sorted(set(finest["nu"]))
    rows = []
    for (load, section), group in finest.groupby(["load", "section"], sort=False):
        by_nu = group.drop_duplicates("nu").set_index("nu")[["stiffness_ratio", "law"]].loc[nus]
        rows.append([load, code(section), *(fixed(value, 4) for value in by_nu.to_numpy().ravel())])
    spread = data.groupby(["load", "section", "nu"])["stiffness_ratio"].agg(lambda r: r.max() / r.min() - 1).max()
    miss = (data["stiffness_ratio"] / data["law"] - 1).abs().max()
    off = (data["stiffness_ratio"] - 1).abs().groupby(data["section"]).max()
    stiff = data[(data["section"] == "full-3d") & (data["load"] == loads[0]) & (data["nu"] > 0)]
    worst = stiff.groupby("nu")["stiffness_ratio"].max()
    found = ", ".join(f"{fixed(ratio, 3)} at ν = {nu:g}" for nu, ratio in worst.items())
    text = prose(f"""## Poisson thickness locking

When a shell bends, Poisson's ratio makes its strain E33 vary linearly through the thickness; one director has a
constant E33 only. With the full three-dimensional law (`full-3d`) the missing part becomes a stress and the shell is
too stiff: by (1 - ν)²/(1 - 2ν) in cylindrical bending and by (1 - ν)/((1 + ν)(1 - 2ν)) when it bends both ways. Found
in cylindrical bending: {found}.
`{REMEDY}`, which takes S33 instead of E33 as constant, and `nonsymmetric` have none of it. Neither mesh nor thinness
enters the law: over all meshes a ratio changes, is off its law, and with `{REMEDY}` and `nonsymmetric` off plane
stress, by at most {_within(max(spread, miss, off[REMEDY], off["nonsymmetric"]))}.""")
    header = ["load", "section", *(word for nu in nus for word in (f"ν = {nu:g}", "law"))]
    return joined(text, table("Bending stiffness over that of plane stress", header, rows, words=2))


def _shear(store: Store) -> Part:
    """Straight cantilever, elements of growing slenderness."""
    data = store.table("shear_locking")
    heads = "length over thickness of an element | deflection over Timoshenko's | law | fully integrated (law)"
    line = "{l_over_h:g} | {ratio:.5f} | {two_node:.5f} | {fully_integrated:.1e}"
    n, spread = int(data["elements"].iloc[0]), float((data["ratio"] / data["two_node"] - 1).abs().max())
    text = prose(f"""## Shear locking

A straight cantilever of {n} elements under end shear. Transverse shear strains are sampled at the middles of the edges
of the element, so that bending has none. What is left is the error 1/(4 n²) of a linear element in the bending part, at
any slenderness: the ratio is off that law by at most {_within(spread)}. A fully integrated linear element would keep
the last column.""")
    words = "Deflection over the exact one over the slenderness of the elements"
    shown = picture("locking-shear.svg", words, draw_shear(data))
    return joined(text, listing("Cantilever under end shear", data, heads, line), shown)


def _within(part: float) -> str:
    """A share that may be rounding alone."""
    return share(part, 4) if part >= ROUNDED / 100 else f"{scientific(part)} of itself, which is rounding"


@svg
def draw_shear(data: pd.DataFrame) -> Figure:
    """Tip deflection over Timoshenko's, over the slenderness of an element: ours and a fully integrated one."""
    figure, (axes,) = canvas()
    full = "fully integrated linear element (law)"
    curves = {"this element": data["ratio"], full: data["fully_integrated"]}
    lines(axes, {name: (data["l_over_h"], curve) for name, curve in curves.items()})
    axes.set(xlabel="length over thickness of an element", ylabel="deflection over the exact one")
    axes.set(xscale="log", yscale="log")
    axes.legend(loc="lower left")
    return figure


def _ring(store: Store) -> Part:
    """Curved beam: membrane and trapezoidal locking."""
    data = store.table("curved_beam")
    grid = data.pivot_table(index="h_over_R", columns="elements", values="ratio").sort_index(ascending=False)
    rows = [[f"{h:g}", *(_ratio(value, h) for value in grid.loc[h])] for h in grid.index]
    spread, all_of_it = (float((part.max() / part.min() - 1).max()) for part in (grid[grid.index > ROUNDED], grid))
    middle = grid.index[len(grid) // 2]
    thin = store.analysis("curved_beam_limits").set_index("h_over_R").loc[middle]
    text = prose(f"""## Curved beam: membrane and trapezoidal locking

A quarter of a ring, clamped at one end and pulled radially at the other, against the closed form of the curved
Timoshenko beam. Two kinds of locking could show here: a curved element that must stretch to bend (membrane), and
directors that fan out along the element, as the sides of a trapezium do, and are squeezed when it bends. While h/R
falls from {grid.index[0]:g} to {grid.index[grid.index > ROUNDED][-1]:g}, a ratio changes by at most
{share(spread)}; with the thinnest ring, by {"less" if all_of_it < ONE else "more"} than
{share(ONE, 0)}. At h/R = {middle:g} the order is {fixed(thin["order"], 2)} and the limit
{fixed(thin["limit"], 4)}. The thick ring differs by O(h/R)², since the strain between the faces is linear and not that
of fibres of unequal length. In the thinnest one rounding takes what follows the second decimal: (R/h)² of double
precision is gone. Trapezia in the plane of the shell, bent about their own plane, cannot arise on a tensor grid and are
not tested.""")
    body = table("End deflection over the closed form", ["h/R", *(f"{n} elements" for n in grid.columns)], rows)
    shown = picture("locking-ring.svg", "Error of the deflection of the ring over h/R", draw_ring(data))
    return joined(text, body, shown)


@svg
def draw_ring(data: pd.DataFrame) -> Figure:
    """Error of the curved beam over h/R, a line a mesh."""
    figure, (axes,) = canvas()
    each = {f"{n} elements": rows for n, rows in data.groupby("elements")}
    lines(axes, {name: (rows["h_over_R"], np.abs(rows["ratio"] - 1)) for name, rows in each.items()})
    axes.set(xlabel="h/R", ylabel="error of the deflection", ylim=(1e-4, 1e-1), xscale="log", yscale="log")
    axes.invert_xaxis()
    axes.legend(loc="upper left", ncols=3)
    return figure


def _ratio(value: float, h: float) -> str:
    """As many decimals as rounding leaves."""
    return fixed(value, 4 if h > ROUNDED else 2)


def _membrane(store: Store) -> Part:
    """Shells of revolution under p cos 2φ against the bilinear yardstick, and the hyperboloid that still locks."""
    data = store.table("membrane_locking")
    text = prose("""## Membrane locking

An octant of a shell of revolution under the pressure p cos 2φ, R = 1 and half the length 1, n x n elements, against a
spectral solution of the same shell. Free ends let it bend without stretching, and there a membrane strain that bending
does not have makes it lock; clamped ends stretch it, and there a remedy must not lose anything. The error is that
of the
energy norm, the square root of |1 - U_h/U|. With assumed strains U_h may exceed U; where it passes U on its way, the
error dips without the solution being any better.""")
    words = "Error in the energy norm over h/R, by surface, ends, mesh and membrane"
    shown = picture("locking-membrane.svg", words, draw_membrane(data))
    return joined(text, shown, _against_yardstick(data), _energies(data), *_left_over(data))


@svg
def draw_membrane(data: pd.DataFrame) -> Figure:
    """Error in the energy norm over h/R: a row a surface and end, a column a membrane, a line a mesh."""
    meshes, kinds = looks(sorted(set(data["elements"]))), list(dict.fromkeys(data["membrane"]))
    cases = list(dict.fromkeys(zip(data["surface"], data["end"], strict=True)))
    figure, panels = canvas(len(cases) * len(kinds), columns=len(kinds), width=9.0, height=2.5, sharey=True)
    for axes, ((surface, end), kind) in zip(panels, product(cases, kinds), strict=True):
        rows = data[(data["surface"] == surface) & (data["end"] == end) & (data["membrane"] == kind)]
        for n, mesh in meshes.items():
            own = rows[rows["elements"] == n]
            axes.loglog(own["h_over_R"], own["energy_norm_error"], **mesh.whole, label=f"{n} elements")
            known = own.dropna()
            for name, points in YARDSTICKS.items():
                axes.loglog(known["h_over_R"], known[f"yardstick_{name}"], color=mesh.colour, **points)
        axes.set(title=f"{surface}, {end} ends, {kind}", ylim=(8e-3, 1.6))
        axes.invert_xaxis()
    for axes in panels[-len(kinds) :]:
        axes.set_xlabel("h/R")
    for axes in panels[:: len(kinds)]:
        axes.set_ylabel("error, energy norm")
    handles, _ = panels[0].get_legend_handles_labels()
    marks = [Line2D([], [], color=BLACK, **points, label=f"bilinear, {kind}") for kind, points in YARDSTICKS.items()]
    figure.legend(handles=[*handles, *marks], loc="outside upper center", ncols=5)
    return figure


def _against_yardstick(data: pd.DataFrame) -> Part:
    """Where printed errors exist."""
    known = data.dropna(subset=["yardstick_reduced"])
    heads = "shell | membrane | elements | h/R | this element | reduced | unreduced"
    line = "{surface}, {end} | {membrane} | {elements} | {h_over_R:g} | {energy_norm_error:.4f} | "
    line += "{yardstick_reduced:.4f} | {yardstick_unreduced:.4f}"
    better = int((known["energy_norm_error"] < known["yardstick_reduced"]).sum())
    least = float((known["yardstick_unreduced"] / known["energy_norm_error"]).min())
    text = prose(f"""The yardstick is what Elmer (ElmerCSC/elmerfem, `Readme.txt` of the tests
`Shell_BenchmarkCase1_Quad` and `Shell_BenchmarkCase2_Quad`) prints of bilinear elements, with and without strain
reduction, on the cylinder of Pitkäranta and others. This element is below the reduced one in {better} of
{len(known)} cases and below the unreduced one by a factor of at least {fixed(least, 1)}.""")
    return joined(text, listing("Errors in the energy norm against the yardstick", known, heads, line, words=2))


def _energies(data: pd.DataFrame) -> str:
    """Energy ratios over the range of thinness."""
    grid = data.pivot_table(
        index=["surface", "end", "membrane", "elements"], columns="h_over_R", values="energy_ratio", sort=False
    ).sort_index(axis=1, ascending=False)
    rows = []
    for (surface, end, membrane, n), line in zip(grid.index, grid.to_numpy(), strict=True):
        values = (_ratio(value, h) for h, value in zip(map(float, grid.columns), line, strict=True))
        rows.append([f"{surface}, {end}", membrane, n, *values])
    header = ["shell", "membrane", "elements", *(f"h/R = {h:g}" for h in grid.columns)]
    return table("Energy found over energy", header, rows, words=2)


def excess(data: pd.DataFrame, membrane: str) -> pd.DataFrame:
    """U/U_h - 1 of the free hyperboloid (rows h/R, columns elements), less what is there at h/R = STILL."""
    own = data[(data["surface"] == "hyperboloid") & (data["end"] == "free") & (data["membrane"] == membrane)]
    grid = 1 / own.pivot_table(index="h_over_R", columns="elements", values="energy_ratio") - 1
    still = grid[grid.index >= 0.99 * STILL].iloc[0]
    return (grid - still)[grid.index < 0.99 * STILL].sort_index(ascending=False)


def worst_energy(store: Store) -> tuple[str, float, int, float]:
    """The surface, h/R and elements with free ends that find least of the energy, and what share."""
    data = store.table("membrane_locking")
    row = data[data["end"] == "free"].sort_values("energy_ratio").iloc[0]
    return str(row["surface"]), float(row["h_over_R"]), int(row["elements"]), float(row["energy_ratio"])


def _left_over(data: pd.DataFrame) -> tuple[str, str]:
    """What is not removed, with its law."""
    worst = float(data[(data["surface"] == "hyperboloid") & (data["end"] == "free")]["energy_ratio"].min())
    rows = []
    for membrane in dict.fromkeys(data["membrane"]):
        more = excess(data, membrane)
        halving = [None, *(a / b for a, b in pairwise(more.iloc[-1]))]
        for n, by_mesh in zip(more.columns, halving, strict=True):
            values, told = list(more[n]), more[n].min() > SMALLEST
            growth = values[-1] / values[-2] if told else None
            line = [scientific(value, 2) if value > SMALLEST else NOTHING for value in values]
            rows.append([membrane, n, *line, fixed(growth), fixed(by_mesh)])
    thinner = [f"h/R = {h:g}" for h in excess(data, str(data["membrane"].iloc[0])).index]
    text = prose(f"""### What is not removed

The free hyperboloid locks on coarse meshes: its energy falls to {fixed(worst, 3)} of the exact one. The excess
U/U_h - 1, less what is there at h/R = {STILL:g}, follows (l³/h)² with the length l of an element: a factor of 100 for
each decade of h and of 64 for each halving of l. It is a membrane strain of third order in l that the element adds to
the inextensional bending of a doubly curved surface, and none of the membranes in the table removes it. What helps is
the mesh: l³ must be small against h R². A dash stands for less than {SMALLEST:g}, where rounding begins.""")
    header = ["membrane", "elements", *thinner, "factor by the last decade of h", "factor by halving l"]
    return text, machine(table("Excess U/U_h - 1 of the free hyperboloid", header, rows))


CHAPTER = Chapter(
    "locking",
    "Locking",
    "thickness, shear, curved beam and membrane, over thinner and thinner shells.",
    locking_page,
    needs=("thickness_locking", "shear_locking", "curved_beam", "curved_beam_limits", "membrane_locking"),
    always=True,
)
