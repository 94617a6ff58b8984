"""Pictures of scenes without contact: load-displacement curves and errors over meshes."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import pandas as pd
from matplotlib.collections import PolyCollection
from matplotlib.figure import Figure

from reports.figures.drawing import BLACK, canvas, legend_above, looks, svg


@svg
def load_displacement(
    curves: Mapping[str, pd.DataFrame],
    names: Mapping[str, str],
    reference: pd.DataFrame | None = None,
    load: tuple[str, str] = ("load_fraction", "load fraction"),
) -> Figure:
    """The load over displacements, one panel for each column of ``names``.

    curves: label -> table with the columns of ``names`` (column -> axis label) and that of ``load``, another such pair;
    reference: the same columns, drawn as a black line with points.
    """
    loaded, load_words = load
    figure, panels = canvas(len(names))
    for axes, (column, words) in zip(panels, names.items(), strict=True):
        if reference is not None:
            x, y = reference[column], reference[loaded]
            axes.plot(x, y, color=BLACK, marker=".", linewidth=0.8, label="Sze et al.")
        for name, each in looks(curves).items():
            points = [0, *curves[name][column]], [0, *curves[name][loaded]]
            line = "-" if "limit_point" in curves[name] else "none"  # a curve that turns back needs its order
            axes.plot(*points, linestyle=line, **each.points, fillstyle="none", label=name)
        axes.set(xlabel=words, ylabel=load_words)
        if all(curve[[column, loaded]].min().min() >= 0 for curve in curves.values()):
            axes.set(xlim=(0, None), ylim=(0, None))
    legend_above(figure, panels[0])
    return figure


@svg
def refined_grid(elements: pd.DataFrame) -> Figure:
    """Elements in the plane of the coordinates, darker the more often they were cut."""
    ends = elements[["a1_low", "a1_high", "a2_low", "a2_high"]].to_numpy(float)
    corners = np.stack([ends[:, [0, 1, 1, 0]], ends[:, [2, 2, 3, 3]]], axis=-1)
    level = elements["level"].to_numpy(float)
    figure, (axes,) = canvas()
    drawn = PolyCollection(list(corners), edgecolors="0.35", linewidths=0.3, cmap="Blues")
    drawn.set_array(level)
    drawn.set_clim(level.min() - 1, level.max() + 1)
    axes.add_collection(drawn)
    span = {"xlim": (ends[:, 0].min(), ends[:, 1].max()), "ylim": (ends[:, 2].min(), ends[:, 3].max())}
    title = f"{len(elements)} elements, cut up to {int(level.max())} times"
    axes.set(xlabel="a1 [rad or mm]", ylabel="a2 [rad or mm]", title=title, **span)
    return figure
