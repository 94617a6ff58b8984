"""Section of the page of verification: what meshes that follow no coordinates cost, by measure, shell and option."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.figure import Figure

from reports.figures.drawing import BLACK, canvas, legend_above, lines, svg, ticks
from reports.markdown import Part, Template
from reports.store import Store

TEXT = Template("convergence")
OPTIONS = ["thickness_strain", "membrane"]
DEFAULT = {"thickness_strain": "balanced", "membrane": "relaxed"}


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
