"""The picture of grids: error of the force over the unknowns, a point a grid."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pandas as pd
from matplotlib.figure import Figure

from reports.figures.drawing import BLACK, canvas, legend_above, looks, svg

LEAST = 1e-5  # below it an error is chance


@svg
def precision(data: pd.DataFrame, errors: Sequence[float]) -> Figure:
    """Error of the force over the unknowns, a panel an element, a colour a family of grids.

    A line is the largest error of a grid and all finer ones of its family. Dotted lines at ``errors``; grey where the
    reference is not known.
    """
    elements = data.groupby("element", sort=False)
    drawn = looks(data["family"])
    figure, panels = canvas(len(elements), width=10.0, height=4.2, sharey=True)
    for axes, (element, own) in zip(panels, elements, strict=True):
        for family, grids in own.sort_values("unknowns").groupby("family", sort=False):
            error = grids["error"].abs().clip(lower=LEAST).to_numpy(float)
            worst, look = np.maximum.accumulate(error[::-1])[::-1], drawn[family]
            axes.step(grids["unknowns"], worst, where="post", linewidth=1.1, **look.dashes)
            axes.plot(grids["unknowns"], error, linestyle="none", markersize=4.5, **look.points)
            axes.plot([], [], label=family, **look.whole)
        for level in errors:
            axes.axhline(level, color=BLACK, linewidth=1, linestyle=":")
        axes.axhspan(LEAST / 2, own["known"].iloc[0], color=BLACK, alpha=0.08, linewidth=0)
        axes.set(title=f"element {element}", xlabel="unknowns", xscale="log", yscale="log", ylim=(LEAST / 2, None))
        axes.tick_params(axis="x", which="minor", labelbottom=False)
    panels[0].set_ylabel("relative error of the force")
    legend_above(figure, panels[0], columns=5)
    return figure
