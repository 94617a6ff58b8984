"""Section of the page of verification: errors of manufactured solutions, and the orders by which they fall."""

from __future__ import annotations

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from reports.figures.drawing import BLACK, canvas, legend_above, lines, svg, ticks
from reports.formats import fixed
from reports.markdown import Part, commands, joined, listing, picture, prose, table
from reports.store.tables import Store

COMMANDS = ("footprint run truth", "footprint solve manufactured --measure sanders --mesh 32x32")
NORMS = {
    "displacement": "displacement, L2",
    "resultants": "resultants at Gauss points, L2",
    "mean_resultants": "mean resultants of elements",
    "energy": "energy norm",
}
KINDS = {"exact": "exact", "linear": "linear"}  # of measures; the others are nonlinear approximations
OTHER = "nonlinear approximations"
DRAWN = ("torus", "refined")  # surface and element of the picture


def manufactured_part(store: Store) -> Part:
    """The whole section."""
    found = store.analysis("manufactured_orders")
    return joined(
        _introduction(store, found),
        _statements(store),
        _orders(store, found),
        picture("manufactured.svg", "Errors of all measures on a torus over the mesh", errors(_drawn_rows(store))),
        _contact(store),
        commands(COMMANDS),
    )


def _introduction(store: Store, found: pd.DataFrame) -> str:
    rules = store.rules()
    far, theory = found[~found["near"]], rules["theory_displacement"]
    outside = "none lies" if far.empty else f"{len(far)} lie"
    coarse = found["coarse"].astype(bool)
    return prose(f"""## Orders against theory

In a manufactured solution a motion of both faces is given; the statement of the measure, the law of the section
resultants and equilibrium give the loads under which it is exact. So the error of a mesh is known in every norm,
without a reference and without extrapolation. Of {len(found)} orders of the displacement {outside} further from
{theory:g} than {rules["near_order"]:g}. Resultants are of the first order at the Gauss points, because the element has
no linear mode of most strains, and of the second in the mean over an element; of the {coarse.sum()} orders of means
below {rules["theory_mean_resultants"] - rules["coarse_below"]:g}, {found["rising"].astype(bool).sum()} are higher than
on the meshes before.""")


def _statements(store: Store) -> str:
    data = store.table("manufactured_statements")
    wrong = data[data["wrong"].notna()]
    if wrong.empty:
        judged = data["measure"].nunique()
        return prose(f"""The tables of all {judged} quadratic measures are what the measures state, coefficient by
coefficient (least squares over random gradients).""")
    return listing(
        "Coefficients that are not what the measure states", wrong, "measure | wrong", "`{measure}` | {wrong}"
    )


def _orders(store: Store, found: pd.DataFrame) -> str:
    """A line an element and kind of measure."""
    kinds, rows = found["measure"].map(KINDS).fillna(OTHER), []
    for (element, kind), own in found.groupby(["element", kinds], sort=False):
        spans = (own[f"order_{norm}"] for norm in NORMS)
        rows.append([element, kind, len(own), *(f"{fixed(s.min(), 2)} to {fixed(s.max(), 2)}" for s in spans)])
    rows.append(["theory", "", "", *(f"{store.rules()[f'theory_{norm}']:g}" for norm in NORMS)])
    title = f"Orders between the two finest meshes, the last {found['n'].max()} elements along either side"
    return table(title, ["element", "measures", "cases", *NORMS.values()], rows, words=2)


def _contact(store: Store) -> str:
    orders, data = store.analysis("manufactured_contact_orders"), store.table("manufactured_contact")
    spans = {name: orders[f"order_{name}"] for name in ("displacement", "pressure", "edge")}
    of = {name: f"{fixed(s.median(), 1)} ({fixed(s.min(), 1)} to {fixed(s.max(), 1)})" for name, s in spans.items()}
    away, least = orders["edge_elements"], orders.sort_values("order_displacement").iloc[0]
    unsolved = sorted(set(data[~data["class"].isin(("converged", "unstable"))]["measure"]))
    return prose(f"""**With contact** a piece is led onto a ball, and the edge of contact moves along the path. Of
{orders["measure"].nunique()} measures {len(unsolved) or "none"} failed on a mesh. Orders over {len(orders)} cases,
medians and ranges: displacement {of["displacement"]}, pressure {of["pressure"]}, edge {of["edge"]}; the lowest of
displacements is that of {least["measure"]} on the {least["surface"]} at radius {least["radius"]:g}. The first order is
all that an edge can have: where a gap opens with the square of the distance, an error l² of the face moves the edge by
about l. On the finest meshes its error is {fixed(away.min(), 1)} to {fixed(away.max(), 1)} elements; since its place
within an element is any, errors jump from mesh to mesh.""")


def _drawn_rows(store: Store) -> pd.DataFrame:
    data = store.table("manufactured")
    surface, element = DRAWN
    return data[(data["group"] == "measures") & (data["surface"] == surface) & (data["element"] == element)]


@svg
def errors(data: pd.DataFrame) -> Figure:
    """Errors of the displacement and of the resultants over the number of elements, with the slopes of theory."""
    figure, panels = canvas(2, width=9.0, height=4.4)
    for axes, norm, slope in zip(panels, ("displacement", "resultants"), (2, 1), strict=True):
        own = {m: (g["n"], g[f"error_{norm}"]) for m, g in data.groupby("measure", sort=False)}
        lines(axes, own)
        _finished(axes, data, norm, slope)
    legend_above(figure, panels[0], columns=5)
    return figure


def _finished(axes: Axes, data: pd.DataFrame, norm: str, slope: int) -> None:
    """Logarithmic axes, and a line of the slope below the curves."""
    n = np.array(sorted(data["n"].unique()), float)
    first = data[data["n"] == n[0]][f"error_{norm}"].min()
    axes.plot(n, 0.5 * first * (n[0] / n) ** slope, color=BLACK, linewidth=1, linestyle=":")
    axes.set(xscale="log", yscale="log", xlabel="elements along a side", title=f"error: {norm}; dotted: order {slope}")
    ticks(axes, n, [f"{each:g}" for each in n])
