"""The page of manufactured solutions: errors that are known, and the orders by which they fall."""

from __future__ import annotations

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from reports.chapter import Chapter
from reports.figures.drawing import BLACK, canvas, legend_above, lines, svg, ticks
from reports.formats import fixed
from reports.markdown import Part, commands, joined, listing, machine, picture, prose, table
from reports.store.tables import Store

COMMAND = "footprint run truth"
NORMS = {
    "displacement": "displacement, L2",
    "resultants": "resultants at the Gauss points, L2",
    "mean_resultants": "mean resultants of the elements",
    "energy": "energy norm",
}
CONTACT_MEASURE = "exact"  # of the picture of contact
DRAWN = ("torus", "refined")  # surface and element of the picture


def manufactured_page(store: Store) -> Part:
    """The whole page."""
    found = store.analysis("manufactured_orders")
    return joined(
        _introduction(store, found),
        _statements(store),
        _groups(store, found),
        picture("manufactured.svg", "Errors of nine measures on a torus over the mesh", errors(_drawn_rows(store))),
        _measures(found),
        _contact(store),
        commands([COMMAND, "footprint solve manufactured --measure sanders --mesh 32x32"]),
    )


def _introduction(store: Store, found: pd.DataFrame) -> str:
    far, theory = found[~found["near"]], store.rules()["theory_displacement"]
    outside = "none lies" if far.empty else f"{len(far)} lie"
    return prose(f"""# Manufactured solutions

A motion of both faces is given: a piece of a surface is stretched, bent into waves and turned. What a measure states,
written in vectors and not as its table of coefficients, makes strains of it, the law of the section resultants, and
the balance of forces the body forces and edge loads under which that motion is the exact solution. So the error of a
mesh is known in every norm: no reference has to be believed, and nothing is extrapolated. Of the orders of the
displacement {outside} further from {theory:g} than {store.rules()["near_order"]:g}.""")


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


def _groups(store: Store, found: pd.DataFrame) -> Part:
    rules = store.rules()
    rows = []
    for group, own in found.groupby("group", sort=False):
        spans = (own[f"order_{norm}"] for norm in NORMS)
        rows.append([group, len(own), *(f"{fixed(span.min(), 2)} to {fixed(span.max(), 2)}" for span in spans)])
    rows.append(["theory", "", *(f"{rules[f'theory_{norm}']:g}" for norm in NORMS)])
    title = f"Orders between the two finest meshes, the last {found['n'].max()} elements along either side"
    coarse = found["coarse"].astype(bool)
    text = prose(f"""Resultants are of the first order at the Gauss points, because the element has no linear mode of
most strains, and of the second in the mean over an element; both come from one solve. Of the {coarse.sum()} orders of
means below {rules["theory_mean_resultants"] - rules["coarse_below"]:g}, {found["rising"].astype(bool).sum()} are higher
than on the meshes before: the waves are not yet resolved there.""")
    return joined(text, table(title, ["varied", "cases", *NORMS.values()], rows))


def _measures(found: pd.DataFrame) -> str:
    own = found[found["group"] == "measures"]
    title = "Order of displacements and error on the finest mesh, measure by measure"
    heads = "measure | surface | element | order | error | order of resultants | order of their means"
    line = "`{measure}` | {surface} | {element} | {order_displacement:.3f} | {error_displacement:.1e}"
    line += " | {order_resultants:.2f} | {order_mean_resultants:.2f}"
    return machine(listing(title, own, heads, line, words=3))


def _contact(store: Store) -> Part:
    orders, data = store.analysis("manufactured_contact_orders"), store.table("manufactured_contact")
    spans = {name: orders[f"order_{name}"] for name in ("displacement", "pressure", "edge")}
    of = {name: f"{fixed(s.median(), 1)} ({fixed(s.min(), 1)} to {fixed(s.max(), 1)})" for name, s in spans.items()}
    away, least = orders["edge_elements"], orders.sort_values("order_displacement").iloc[0]
    unsolved = sorted(set(data[~data["class"].isin(("converged", "unstable"))]["measure"]))
    text = prose(f"""## With contact

A piece is led onto a ball: inside a curve its outer face lies on the ball under a pressure that falls to zero on the
curve, outside it clears the ball by the square of the distance. The curve widens along the path, so that the edge of
contact moves. Of {orders["measure"].nunique()} measures {len(unsolved) or "none"} failed on a mesh. Orders, medians and
ranges: displacement {of["displacement"]}, pressure {of["pressure"]}, edge {of["edge"]}; the lowest of displacements is
that of {least["measure"]} on the {least["surface"]} at radius {least["radius"]:g}.

The first order is all that an edge can have here: where a gap opens with the square of the distance, an error l² of the
face moves the edge by about l. It is off by {fixed(away.min(), 1)} to {fixed(away.max(), 1)} elements on the finest
meshes. As its place within an element is any, errors jump from mesh to mesh, and an order is the slope of a line
through all meshes. The edge is read where the pressure of the last two nodes, led on, is zero.""")
    heads = "measure | surface | radius | elements | order of displacement | of pressure | of edge"
    heads += " | error of pressure | of edge"
    line = "`{measure}` | {surface} | {radius:g} | {n} | {order_displacement:.2f} | {order_pressure:.2f}"
    line += " | {order_edge:.2f} | {error_pressure:.1%} | {error_edge:.1%}"
    title = "Orders with contact, and errors on the finest mesh, by its elements a side"
    drawn = picture(
        "manufactured-contact.svg", "Errors of displacement, pressure and edge over the mesh", contact(data)
    )
    return joined(text, machine(listing(title, orders, heads, line, words=2)), drawn)


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


@svg
def contact(data: pd.DataFrame) -> Figure:
    """Errors with contact over the number of elements, at the middle radius, of one measure on every surface."""
    middle = data[(data["radius"] == sorted(data["radius"].unique())[1]) & (data["measure"] == CONTACT_MEASURE)]
    figure, panels = canvas(3, width=10.0, height=3.8)
    for axes, norm, slope in zip(panels, ("displacement", "pressure", "edge"), (2, 1, 1), strict=True):
        lines(axes, {s: (g["n"], g[f"error_{norm}"]) for s, g in middle.groupby("surface", sort=False)})
        _finished(axes, middle, norm, slope)
    legend_above(figure, panels[0])
    return figure


def _finished(axes: Axes, data: pd.DataFrame, norm: str, slope: int) -> None:
    """Logarithmic axes, and a line of the slope below the curves."""
    n = np.array(sorted(data["n"].unique()), float)
    first = data[data["n"] == n[0]][f"error_{norm}"].min()
    axes.plot(n, 0.5 * first * (n[0] / n) ** slope, color=BLACK, linewidth=1, linestyle=":")
    axes.set(xscale="log", yscale="log", xlabel="elements along a side", title=f"error: {norm}; dotted: order {slope}")
    ticks(axes, n, [f"{each:g}" for each in n])


CHAPTER = Chapter(
    "manufactured",
    "Manufactured solutions",
    "exact solutions on demand: orders of every measure, surface and element, and of contact with a moving edge.",
    manufactured_page,
    needs=("manufactured", "manufactured_contact", "manufactured_statements"),
    always=True,
)
