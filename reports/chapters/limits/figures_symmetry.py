"""Pictures of symmetry: every deviation by its class, and the mirror asymmetry over the cord angle."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from reports.drawing import BLACK, BLUE, GREEN, ORANGE, PURPLE, SKY, VERMILION, canvas, looks, svg

LOOKS: dict[str, dict[str, Any]] = {
    "exactly zero": {"color": BLUE, "marker": "o"},
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
    """Over the cord angle: the sweep ``own`` beside the printed table, and every measure on a coarse mesh.

    Full marks are stable states, open ones have negative eigenvalues; printed: angle [deg] and asymmetry [MPa].
    """
    figure, (left, right) = canvas(2, width=9.0, height=4.6)
    _curve(left, sweeps[own], {"color": BLUE, "marker": "o"}, "ours")
    left.plot(printed[0], 1e3 * printed[1], color=VERMILION, marker="D", linestyle="none", label="printed")
    left.plot([], [], color=BLACK, marker="o", fillstyle="none", linestyle="none", label="not stable")
    left.set_title(own)
    left.legend(loc="upper center")
    others = {name.partition(", ")[::2]: sweep for name, sweep in sweeps.items() if name != own}
    drawn = looks(measure for measure, _ in others)
    for (measure, mesh), sweep in others.items():
        _curve(right, sweep, drawn[measure].points, measure)
        right.set_title(f"all measures, {mesh}")
    right.legend(fontsize=8)
    for axes in (left, right):
        axes.set(xlabel="cord angle γ [deg]", ylabel="largest difference from a mirror image [10⁻³ MPa]")
        axes.set(xlim=(-2, 92), ylim=(0, None), xticks=range(0, 91, 15))
    return figure


def _curve(axes: Axes, sweep: pd.DataFrame, look: Mapping[str, Any], label: str) -> None:
    angle, value, stable = sweep["gamma_deg"], 1e3 * sweep["mirror_both_MPa"], sweep["negative"] == 0
    axes.plot(angle, value, color=look["color"], linewidth=0.8, alpha=0.5)
    axes.plot(angle[stable], value[stable], linestyle="none", label=label, markersize=4, **look)
    axes.plot(angle[~stable], value[~stable], linestyle="none", fillstyle="none", markersize=4, **look)
