"""Pictures of the contact studies: forces over the travel, and what epsilon does; each returns SVG text."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
import pandas as pd

from reports.drawing import BLACK, canvas, looks, style, to_svg

LOOKS = {"multiplier": "-", "displacement": "--"}
PAPER = 1e4  # MPa/mm


def forces(curves: Mapping[str, tuple[Sequence[float], Sequence[float]]]) -> str:
    """Force [N] over the travel [mm]."""
    with style():
        figure, (axes,) = canvas()
        drawn = looks(curves)
        for name, (travel, force) in curves.items():
            axes.plot([0, *travel], [0, *force], **drawn[name].points, label=name)
        axes.set(xlabel="travel of the plane [mm]", ylabel="force [N]", xlim=(0, None), ylim=(0, None))
        axes.legend(loc="upper left")
        return to_svg(figure)


def epsilon(table: pd.DataFrame) -> str:
    """Penetration, force error and condition over epsilon: a colour a case, solid and dashed the two forms.

    Hollow markers: not converged; what is not even of the size of the answer is left out. Dotted: the paper's epsilon.
    """
    panels = (
        ("penetration_mm", "penetration [mm]", (1e-15, 1e2)),
        ("force_error", "relative error of the force", (1e-17, 1e1)),
        ("condition", "condition (1-norm)", (1e4, 1e18)),
    )
    table = table[np.isfinite(table["epsilon"]) & (table["force_error"].abs() < 1)]
    with style():
        figure, axes = canvas(3, width=12.0, height=4.4)
        for panel, (column, label, limits) in zip(axes, panels, strict=True):
            drawn = looks(table["case"])
            for case, own in table.groupby("case", sort=False):
                colour, marker = drawn[case].colour, drawn[case].marker
                for form, line in LOOKS.items():
                    rows = own[own["form"] == form]
                    value = rows[column].abs().where(rows[column].abs().between(*limits))
                    look = {"color": colour, "linestyle": line, "label": f"{case}, {form} form"}
                    panel.loglog(rows["epsilon"], value, **look)
                    for fill, chosen in (("full", rows["outcome"] == "converged"), ("none", None)):
                        shown = value.where(chosen if chosen is not None else rows["outcome"] != "converged")
                        dots = {"color": colour, "marker": marker, "linestyle": "none", "fillstyle": fill}
                        panel.loglog(rows["epsilon"], shown, **dots)
            panel.axvline(PAPER, color=BLACK, linestyle=":", linewidth=1)
            panel.set(xlabel="ε [MPa/mm]", ylabel=label, ylim=limits, xlim=(3e-3, 3e14))
        handles, names = axes[0].get_legend_handles_labels()
        figure.legend(handles, names, loc="outside upper center", ncols=4)
        return to_svg(figure)
