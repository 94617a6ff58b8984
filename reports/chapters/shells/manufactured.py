"""Section of the page of verification: errors of manufactured solutions, and the orders by which they fall."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from reports.figures.drawing import BLACK, canvas, legend_above, lines, svg, ticks
from reports.formats import fixed
from reports.markdown import Part, commands
from reports.store.tables import Store
from reports.template import Template

TEXT = Template("convergence")
COMMANDS = ("footprint run truth", "footprint solve manufactured --measure sanders --mesh 32x32")
NORMS = ("displacement", "resultants", "mean_resultants", "energy")
KINDS = {"exact": "exact", "linear": "linear"}  # of measures; the others are nonlinear approximations
OTHER = "nonlinear approximations"
DRAWN = ("torus", "refined")  # surface and element of the picture


def manufactured_part(store: Store) -> Part:
    """The whole section."""
    found, rules, data = store.table("manufactured_orders"), store.rules(), store.table("manufactured")
    far = len(found[~found["near"]])
    told = {
        "count": len(found),
        "far": f"{far} lie" if far else "none lies",
        "coarse": found["coarse"].astype(bool).sum(),
        "rising": found["rising"].astype(bool).sum(),
        "below": rules["theory_mean_resultants"] - rules["coarse_below"],
        "finest": found["n"].max(),
        "statements": _statements(store),
        "spans": list(_spans(found)),
    }
    surface, element = DRAWN
    own = data[(data["group"] == "measures") & (data["surface"] == surface) & (data["element"] == element)]
    drawn = {"manufactured.svg": errors(own)}
    return TEXT("manufactured", drawn, rules=rules, **told, **_contact(store), commands=commands(COMMANDS))


def _statements(store: Store) -> Part:
    """Are the tables of the measures what these state?"""
    data = store.table("manufactured_statements")
    wrong = data[data["wrong"].notna()]
    if wrong.empty:
        return TEXT("coefficients-kept", judged=data["measure"].nunique())
    return TEXT("coefficients-wrong", rows=wrong)


def _spans(found: pd.DataFrame) -> Iterator[dict[str, Any]]:
    """The lowest and the highest order in each norm, by element and kind of measure."""
    kinds = found["measure"].map(KINDS).fillna(OTHER)
    for (element, kind), own in found.groupby(["element", kinds], sort=False):
        orders = {norm: own[f"order_{norm}"] for norm in NORMS}
        spans = {norm: f"{fixed(order.min(), 2)} to {fixed(order.max(), 2)}" for norm, order in orders.items()}
        yield {"element": element, "kind": kind, "cases": len(own), **spans}


def _contact(store: Store) -> dict[str, Any]:
    """Orders of displacement, pressure and edge with contact, and how far the edge is off."""
    orders, data = store.table("manufactured_contact_orders"), store.table("manufactured_contact")
    spans = {name: orders[f"order_{name}"] for name in ("displacement", "pressure", "edge")}
    away, unsolved = orders["edge_elements"], data[~data["class"].isin(("converged", "unstable"))]["measure"]
    return {
        "measures": orders["measure"].nunique(),
        "unsolved": unsolved.nunique() or "none",
        "touching": len(orders),
        "of": {n: f"{fixed(s.median(), 1)} ({fixed(s.min(), 1)} to {fixed(s.max(), 1)})" for n, s in spans.items()},
        "least": orders.sort_values("order_displacement").iloc[0],
        "nearest": away.min(),
        "farthest": away.max(),
    }


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
