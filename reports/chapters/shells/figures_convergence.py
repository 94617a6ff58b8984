"""Pictures of convergence: mesh errors over the element size with their orders; returns SVG text."""

from __future__ import annotations

import numpy as np
import pandas as pd

from reports.drawing import BLACK, LINES, MARKERS, canvas, look, style, to_svg
from reports.markdown import fixed


def mesh_errors(data: pd.DataFrame) -> str:
    """Errors over the element size, as a share of that of the coarsest mesh, log-log: a row a mesh of sequences.

    A colour is a scene, a line and a marker one of its quantities, a full marker a sequence in its asymptotic range.
    Dotted black: first and second order.
    """
    scenes = list(dict.fromkeys(data["ladder"]))
    drawn = dict.fromkeys(scenes, 0)
    finest, top = 1.0, 0.0
    with style():
        figure, (axes,) = canvas(width=8.5, height=4.2)
        for _, own in data.groupby("sequence", sort=False):
            first, errors = own.iloc[0], np.abs(own["value"].to_numpy(float) / own["limit"].to_numpy(float) - 1)
            i, j = scenes.index(first["ladder"]), drawn[first["ladder"]]
            drawn[first["ladder"]] += 1
            drawn_as = {
                "color": look(i).colour,
                "marker": MARKERS[j % len(MARKERS)],
                "linestyle": LINES[j % len(LINES)],
            }
            drawn_as["fillstyle"] = "full" if first["asymptotic"] else "none"
            h = own["size"].to_numpy(float) / first["size"]
            name = f"{first['ladder']}, {first['quantity']}: {fixed(own['order'].iloc[-1], 2)}"
            axes.loglog(h, errors, **drawn_as, label=name)
            finest, top = min(finest, float(h[-1])), max(top, 2 * float(errors[0]))
        for order in (1, 2):
            axes.loglog([finest, 1], [top * finest**order, top], color=BLACK, linestyle=":", linewidth=1)
            axes.text(0.97 * finest, top * finest**order, f"order {order}", ha="right", va="center", fontsize=8)
        ticks = [1 / k for k in (1, 2, 3, 4, 6, 8) if 1 / k > 0.99 * finest]
        axes.set_xticks(ticks, [f"1/{1 / tick:.0f}" if tick < 1 else "1" for tick in ticks])
        axes.set_xticks([], minor=True)
        axes.set(xlabel="element size over that of the coarsest mesh", ylabel="relative mesh error")
        axes.set_xlim(0.65 * finest, 1.15)
        figure.legend(loc="outside right upper", fontsize=8)
        return to_svg(figure)
