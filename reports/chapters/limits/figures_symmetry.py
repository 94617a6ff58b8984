"""Pictures of symmetry: deviations of all checks by class, and the mirror asymmetry over the cord angle."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from reports.figures.drawing import BLUE, GREEN, ORANGE, PURPLE, SKY, VERMILION, canvas, legend_above, looks, svg

LOOKS: dict[str, dict[str, Any]] = {  # of the classes
    "exactly zero": {"color": BLUE, "marker": "P"},
    "rounding": {"color": SKY, "marker": "o"},
    "solver tolerance": {"color": GREEN, "marker": "^"},
    "broken by design": {"color": ORANGE, "marker": "s"},
    "broken by accident": {"color": VERMILION, "marker": "X"},
    "does not apply": {"color": PURPLE, "marker": "|"},
}
ZERO = 1e-17  # where an exact zero is drawn


@svg
def deviations(table: pd.DataFrame) -> Figure:
    """All measures and algorithms as points, a row a check; the grey bar is what rounding explains."""
    checks = list(dict.fromkeys(table["check"]))
    rng = np.random.default_rng(0)
    figure, (axes,) = canvas(width=9.0, height=0.36 * len(checks) + 1.7)
    for row, check in enumerate(checks):
        rounding = table[table["check"] == check]["rounding"].median()
        axes.barh(row, rounding, left=ZERO / 3, height=0.72, color="#DDDDDD", zorder=0)
    for name, look in LOOKS.items():
        own = table[table["class"] == name].dropna(subset=["deviation"])
        if len(own):
            places = own["check"].map(checks.index).to_numpy() + rng.uniform(-0.25, 0.25, len(own))
            axes.scatter(np.maximum(own["deviation"], ZERO), places, s=16, label=name, linewidths=0.8, **look)
    axes.set(xscale="log", xlim=(ZERO / 3, 2.0), xlabel="largest deviation over the largest value [-]")
    axes.set_yticks(range(len(checks)), checks)
    axes.invert_yaxis()
    figure.legend(loc="outside upper center", ncols=4)
    return figure


@svg
def mirror(sweeps: Mapping[str, pd.DataFrame], own: str, printed: tuple[float, float]) -> Figure:
    """Over the cord angle: the sweep ``own`` beside the printed table, and every measure on a coarse mesh, each in a
    panel with the others in grey.

    Full marks are stable states, open ones have negative eigenvalues; printed: angle [deg] and asymmetry [MPa].
    """
    others = {name.partition(", ")[::2]: sweep for name, sweep in sweeps.items() if name != own}
    figure, (first, *panels) = canvas(1 + len(others), columns=min(5, 1 + len(others)), width=11.0, height=2.7)
    _curve(first, sweeps[own], BLUE, "o")
    first.plot(printed[0], 1e3 * printed[1], color=VERMILION, marker="D", linestyle="none", label="printed")
    first.plot([], [], color=BLUE, marker="o", markersize=4, linestyle="none", label="stable")
    first.plot([], [], color=BLUE, marker="o", markersize=4, fillstyle="none", linestyle="none", label="not stable")
    first.set_title(own, fontsize=9)
    drawn = looks(measure for measure, _ in others)
    for axes, ((measure, mesh), sweep) in zip(panels, others.items(), strict=True):
        for each in others.values():
            axes.plot(each["gamma_deg"], 1e3 * each["mirror_both_MPa"], color="#CCCCCC", linewidth=0.6, zorder=0)
        _curve(axes, sweep, drawn[measure].colour, drawn[measure].marker)
        axes.set_title(f"{measure}, {mesh}", fontsize=9)
    top = 1.05e3 * max((float(sweep["mirror_both_MPa"].max()) for sweep in others.values()), default=1.0)
    for axes in (first, *panels):
        axes.set(xlim=(-2, 92), ylim=(0, None if axes is first else top), xticks=range(0, 91, 30))
    figure.supxlabel("cord angle γ [deg]", fontsize=10)
    figure.supylabel("asymmetry [10⁻³ MPa]", fontsize=10)
    legend_above(figure, first)
    return figure


def _curve(axes: Axes, sweep: pd.DataFrame, colour: str, marker: str) -> None:
    angle, value, stable = sweep["gamma_deg"], 1e3 * sweep["mirror_both_MPa"], sweep["negative"] == 0
    axes.plot(angle, value, color=colour, linewidth=0.9)
    for fill, chosen in (("full", stable), ("none", ~stable)):
        how: dict[str, Any] = {"linestyle": "none", "color": colour, "fillstyle": fill, "markersize": 3.5}
        axes.plot(angle[chosen], value[chosen], marker=marker, **how)
