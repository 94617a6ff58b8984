"""Pictures of scenes without contact: load-displacement curves and errors over meshes; each returns SVG text."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
import pandas as pd

from reports.drawing import BLACK, canvas, looks, style, to_svg


def load_displacement(
    curves: Mapping[str, pd.DataFrame],
    names: Mapping[str, str],
    reference: pd.DataFrame | None = None,
    load: tuple[str, str] = ("load_fraction", "load fraction"),
) -> str:
    """The load over displacements, one panel for each column of ``names``.

    curves: label -> table with the columns of ``names`` (column -> axis label) and that of ``load``, another such pair;
    reference: the same columns, drawn as a black line with points.
    """
    loaded, load_words = load
    with style():
        figure, panels = canvas(len(names))
        for axes, (column, words) in zip(panels, names.items(), strict=True):
            if reference is not None:
                x, y = reference[column], reference[loaded]
                axes.plot(x, y, color=BLACK, marker=".", linewidth=0.8, label="Sze et al.")
            drawn = looks(curves)
            for name, curve in curves.items():
                points = [0, *curve[column]], [0, *curve[loaded]]
                line = "-" if "limit_point" in curve else "none"  # a curve that turns back needs its order
                axes.plot(*points, linestyle=line, **drawn[name].points, fillstyle="none", label=name)
            axes.set(xlabel=words, ylabel=load_words)
            if all(curve[[column, loaded]].min().min() >= 0 for curve in curves.values()):
                axes.set(xlim=(0, None), ylim=(0, None))
        handles, labels = panels[0].get_legend_handles_labels()
        figure.legend(handles, labels, loc="outside upper center", ncols=4)
        return to_svg(figure)


def error_by_mesh(elements: Sequence[int], errors: Mapping[str, Sequence[float]], side: str) -> str:
    """Absolute relative errors over the elements along a side, log-log, with the slope of second order."""
    with style():
        figure, (axes,) = canvas()
        n = np.asarray(elements, dtype=float)
        drawn = looks(errors)
        for name, values in errors.items():
            axes.loglog(n, np.abs(np.asarray(values)), **drawn[name].points, label=name)
        top = np.nanmax(np.abs([[float(value) for value in values] for values in errors.values()]), initial=0.0)
        axes.loglog(n, (top or 1.0) * (n[0] / n) ** 2, color=BLACK, linestyle=":", linewidth=1, label="second order")
        axes.set(xlabel=f"elements along {side}", ylabel="relative error")
        axes.set_xticks(n, [f"{count:g}" for count in n])
        axes.set_xticks([], minor=True)
        axes.legend()
        return to_svg(figure)
