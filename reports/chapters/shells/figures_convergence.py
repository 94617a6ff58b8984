"""Pictures of convergence: changes from mesh to mesh, and the errors of two elements beside each other."""

from __future__ import annotations

from typing import Any

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from reports.figures.drawing import BLACK, BLUE, GREY, LINES, MARKERS, ORANGE, canvas, look, svg
from reports.formats import fixed, quantity

SMALLEST = 1e-6  # relative error, below which a point is drawn there


@svg
def mesh_changes(data: pd.DataFrame) -> Figure:
    """Relative changes from a mesh to the next finer one over the unknowns of the coarser, log-log.

    A colour is a scene, a line and a marker one of its quantities, a full marker a sequence in its asymptotic range.
    Dotted black: first and second order in the element size.
    """
    drawn = dict.fromkeys(data["ladder"], 0)
    scenes = list(drawn)
    figure, (axes,) = canvas(width=9.5, height=4.4)
    for _, own in data.groupby("sequence", sort=False):
        first, values = own.iloc[0], own["value"].to_numpy(float)
        change = np.abs(np.diff(values) / values[-1])
        j, drawn[first["ladder"]] = drawn[first["ladder"]], drawn[first["ladder"]] + 1
        how: dict[str, Any] = {"color": look(scenes.index(first["ladder"])).colour, "linestyle": LINES[j % len(LINES)]}
        how |= {"marker": MARKERS[j % len(MARKERS)], "fillstyle": "full" if first["asymptotic"] else "none"}
        name = f"{first['ladder']}, {quantity(first['quantity'])}: {fixed(own['order'].iloc[-1], 2)}"
        axes.plot(own["dofs"].to_numpy(float)[:-1], np.where(change > 0, change, np.nan), **how, label=name)
    axes.set(xscale="log", yscale="log", xlabel="unknowns", ylabel="relative change to the next mesh")
    _orders(axes)
    figure.legend(loc="outside right upper", fontsize=8)
    return figure


def _orders(axes: Axes) -> None:
    """Lines of the orders 1 and 2 in the element size, by unknowns, from one corner of the picture."""
    (left, right), (low, high) = axes.get_xlim(), axes.get_ylim()
    for order in (1, 2):
        end = high * (left / right) ** (order / 2)
        axes.plot([left, right], [high, end], color=BLACK, linestyle=":", linewidth=1)
        x = right if end > low else left * (high / low) ** (2 / order)
        axes.text(x, max(end, low), f"order {order} ", ha="right", va="bottom", fontsize=8)
    axes.set(xlim=(left, right), ylim=(low, high))


@svg
def both_elements(found: pd.DataFrame) -> Figure:
    """Size of the error on the coarsest mesh by both elements, a row a quantity, largest difference first.

    found: columns ladder, quantity, verdict, paper and default.
    """
    apart = (
        np.log(found["paper"].abs().clip(lower=SMALLEST)) - np.log(found["default"].abs().clip(lower=SMALLEST))
    ).abs()
    rows = found.assign(apart=apart).sort_values("apart", kind="stable").reset_index(drop=True)
    figure, (axes,) = canvas(width=9.0, height=0.21 * len(rows) + 1.3)
    each = rows.to_dict("records")
    for i, row in enumerate(each):
        sizes = [max(abs(row[name]), SMALLEST) for name in ("paper", "default")]
        axes.plot(sizes, [i, i], color=GREY, linewidth=1)
    for name, marker, colour in (("paper", "s", ORANGE), ("default", "o", BLUE)):
        axes.plot(rows[name].abs().clip(lower=SMALLEST), rows.index, marker, color=colour, linestyle="none")
    axes.set_yticks(range(len(rows)), [f"{row['ladder']}, {quantity(row['quantity'])}" for row in each], fontsize=7)
    axes.set(xscale="log", xlabel="relative error on the coarsest mesh", ylim=(-0.7, len(rows) - 0.3))
    axes.axvline(0.01, color=BLACK, linewidth=0.8, linestyle=":")
    keys = [
        Line2D([], [], color=ORANGE, marker="s", linestyle="none", label="element of the paper"),
        Line2D([], [], color=BLUE, marker="o", linestyle="none", label="default element"),
    ]
    figure.legend(handles=keys, loc="outside upper center", ncols=2)
    return figure
