"""Pictures of error over cost, in seconds and in unknowns: every answer, and a line a measure through its best ones."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import LogLocator, NullFormatter

from reports.figures.drawing import BLACK, GREY, Look, canvas, looks, svg

PANELS = 3  # beside one another
FIXED = ("contact", "newton", "element", "model", "tolerance")  # one of each along a line
LEAST_SPAN = 12.0  # of an axis, so that a power of ten is on it
WORDS = {"seconds": "processor time [s]", "dofs": "unknowns", "operations": "operations"}


def usual(rows: pd.DataFrame) -> pd.DataFrame:
    """Of one scene the answers of that configuration of FIXED which most measures were asked on most meshes."""
    asked = rows[rows["error"].notna()].fillna(dict.fromkeys(FIXED, ""))
    counts = asked.groupby(list(FIXED), sort=False).size()
    if counts.empty:
        return asked
    chosen = dict(zip(FIXED, counts.index[int(counts.argmax())], strict=True))
    return asked[(asked[list(FIXED)] == pd.Series(chosen)).all(axis=1)]


@svg
def work_precision(fronts: pd.DataFrame, cost: str) -> Figure:
    """Error over cost, a panel a scene, the measures in the configuration asked most often, on all grids.

    Every answer of it is a mark, a wrong one, too; the line of a measure joins those that nothing cheaper of its own
    comes below. Grey: below what the reference is known to.
    """
    scenes = {str(scene): usual(own) for scene, own in fronts.groupby("scene", sort=False)}
    shown = {scene: own for scene, own in scenes.items() if own["mesh"].nunique() > 1}
    drawn = looks(pd.concat([own["measure"] for own in shown.values()]) if shown else [])
    figure, panels = canvas(max(len(shown), 1), columns=PANELS, width=10.0, head=0.9, height=2.6)
    for axes, (scene, own) in zip(panels, shown.items(), strict=False):
        _scene(axes, scene, own, cost, drawn)
    for axes in panels[::PANELS]:
        axes.set_ylabel("relative error")
    for axes in panels[-PANELS:]:
        axes.set_xlabel(WORDS[cost])
    handles = [panels[0].plot([], [], **each.whole, label=name)[0] for name, each in drawn.items()]
    figure.legend(handles=handles, loc="outside upper center", ncols=5)
    return figure


def _scene(axes: Axes, scene: str, rows: pd.DataFrame, cost: str, drawn: Mapping[str, Look]) -> None:
    known = float(rows["uncertainty"].median())
    error = np.maximum(rows["error"], rows["uncertainty"])
    points = rows.assign(shown=error, price=rows[f"cost.{cost}"].astype(float)).sort_values("price", kind="stable")
    for name, own in points.groupby("measure", sort=False):
        look, best = drawn[str(name)].whole, own[own["shown"] < own["shown"].cummin().shift(fill_value=np.inf)]
        axes.plot(own["price"], own["shown"], **{**look, "linestyle": ""}, markersize=3, alpha=0.4)
        axes.plot(best["price"], best["shown"], **look, linewidth=1.1, markersize=4, alpha=0.9)
    axes.set(xscale="log", yscale="log")
    for low, high, widen in ((*axes.get_xlim(), axes.set_xlim), (*axes.get_ylim(), axes.set_ylim)):
        room = max(1.0, (LEAST_SPAN * low / high) ** 0.5)
        widen(low / room, high * room)
    if known > axes.get_ylim()[0]:
        axes.axhspan(axes.get_ylim()[0], known, color="#EEEEEE", zorder=0)
    axes.axhline(0.01, color=GREY, linewidth=0.8, linestyle=":")
    axes.set_title(f"{scene}: {rows['quantity'].iloc[0]}\n{_held(rows)}", fontsize=8)
    axes.tick_params(labelsize=8)
    for axis in (axes.xaxis, axes.yaxis):
        axis.set_major_locator(LogLocator(numticks=6))
        axis.set_minor_formatter(NullFormatter())
    axes.set_xlabel("", color=BLACK)


def _held(rows: pd.DataFrame) -> str:
    """What is the same along all lines of a panel."""
    first = rows.iloc[0]
    contact = f", {first['contact']}" if first["contact"] else ""
    return f"element {first['element']}{contact}" if first["element"] else contact.lstrip(", ")
