"""Pictures of the page of cost; each returns SVG text."""

from __future__ import annotations

import pandas as pd

from reports.drawing import BLACK, canvas, looks, style, to_svg

WITHIN = 0.01
LEAST = 1e-5  # below it an error is chance


def precision(data: pd.DataFrame) -> str:
    """Error of the force over the unknowns, a panel an element, a colour a family of grids; the line is 1 %."""
    with style():
        elements = list(dict.fromkeys(data["element"]))
        figure, panels = canvas(len(elements), width=10.0, height=4.2)
        for axes, element in zip(panels, elements, strict=True):
            own = data[data["element"] == element]
            drawn = looks(data["family"])
            for family, grids in own.groupby("family", sort=False):
                error = grids["error"].abs().clip(lower=LEAST)
                axes.loglog(grids["unknowns"], error, **drawn[family].points, label=str(family))
            axes.axhline(WITHIN, color=BLACK, linewidth=1, linestyle=":")
            axes.set(title=f"element {element}", xlabel="unknowns", ylabel="relative error of the force")
        handles, names = panels[0].get_legend_handles_labels()
        figure.legend(handles, names, loc="outside upper center", ncols=3)
        return to_svg(figure)
