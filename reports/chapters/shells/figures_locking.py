"""Pictures of locking: what is found over how thin the shell is; each returns SVG text."""

from __future__ import annotations

import numpy as np
import pandas as pd
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from reports.drawing import BLACK, canvas, look, looks, style, to_svg

YARDSTICKS = {"reduced": "_", "unreduced": "x"}  # in the colours of their meshes


def shear(table: pd.DataFrame) -> str:
    """Tip deflection over Timoshenko's, over the slenderness of an element: ours and a fully integrated one."""
    with style():
        figure, (axes,) = canvas()
        axes.loglog(table["l_over_h"], table["ratio"], **look(0).points, label="this element")
        full = {**look(1).points, "label": "fully integrated linear element (law)"}
        axes.loglog(table["l_over_h"], table["fully_integrated"], **full)
        axes.set(xlabel="length over thickness of an element", ylabel="deflection over the exact one")
        axes.legend(loc="lower left")
        return to_svg(figure)


def ring(table: pd.DataFrame) -> str:
    """Error of the curved beam over h/R, a line a mesh."""
    with style():
        figure, (axes,) = canvas()
        for i, (n, rows) in enumerate(table.groupby("elements")):
            error = np.abs(rows["ratio"] - 1)
            axes.loglog(rows["h_over_R"], error, **look(i).points, label=f"{n} elements")
        axes.set(xlabel="h/R", ylabel="error of the deflection", ylim=(1e-4, 1e-1))
        axes.invert_xaxis()
        axes.legend(loc="upper left", ncols=3)
        return to_svg(figure)


def membrane(table: pd.DataFrame) -> str:
    """Error in the energy norm over h/R: a panel a surface and end, colours for meshes, lines for membranes."""
    cases = list(dict.fromkeys(zip(table["surface"], table["end"], strict=True)))
    meshes, kinds = sorted(set(table["elements"])), list(dict.fromkeys(table["membrane"]))
    lines = {kind: each.line for kind, each in looks(kinds).items()}
    with style():
        figure = Figure(figsize=(9.0, 7.0), layout="constrained")
        panels = figure.subplots((len(cases) + 1) // 2, 2, squeeze=False, sharey=True).ravel()
        for axes, (surface, end) in zip(panels[: len(cases)], cases, strict=True):
            rows = table[(table["surface"] == surface) & (table["end"] == end)]
            for n, drawn in looks(meshes).items():
                for kind, line in lines.items():
                    own = rows[(rows["elements"] == n) & (rows["membrane"] == kind)]
                    own_look = {**drawn.points, "linestyle": line, "fillstyle": "full" if line == "-" else "none"}
                    axes.loglog(own["h_over_R"], own["energy_norm_error"], **own_look, label=f"{n}, {kind}")
                known = rows[(rows["elements"] == n) & (rows["membrane"] == kinds[0])].dropna()
                for kind, marker in YARDSTICKS.items():
                    points = {"color": drawn.colour, "marker": marker, "linestyle": "none", "markersize": 9}
                    axes.loglog(known["h_over_R"], known[f"yardstick_{kind}"], **points)
            axes.set(title=f"{surface}, {end} ends", xlabel="h/R", ylim=(8e-3, 1.3))
            axes.invert_xaxis()
        for axes in panels[::2]:
            axes.set_ylabel("error in the energy norm")
        handles, names = panels[0].get_legend_handles_labels()
        for kind, marker in YARDSTICKS.items():
            handles.append(Line2D([], [], color=BLACK, marker=marker, linestyle="none", markersize=9))
            names.append(f"bilinear, {kind}")
        figure.legend(handles, names, loc="outside upper center", ncols=4)
        return to_svg(figure)
