"""Pictures of symmetry: every deviation by its class, and the mirror asymmetry over the cord angle; SVG text."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from reports.drawing import BLACK, BLUE, GREEN, ORANGE, PURPLE, SKY, VERMILION, canvas, looks, style, to_svg

LOOKS = {  # class: colour, marker
    "exactly zero": (BLUE, "o"),
    "rounding": (SKY, "o"),
    "solver tolerance": (GREEN, "^"),
    "broken by design": (ORANGE, "s"),
    "broken by accident": (VERMILION, "X"),
    "does not apply": (PURPLE, "|"),
}
ZERO = 1e-17  # where an exact zero is drawn


def deviations(table: pd.DataFrame) -> str:
    """All measures and algorithms as points, a row a check; the grey bar is what rounding explains."""
    checks = list(dict.fromkeys(table["check"]))
    rng = np.random.default_rng(0)
    with style():
        figure, (axes,) = canvas(width=9.0, height=0.36 * len(checks) + 1.7)
        for row, check in enumerate(checks):
            own = table[table["check"] == check]
            axes.barh(row, own["rounding"].median(), left=ZERO / 3, height=0.72, color="#DDDDDD", zorder=0)
        for name, (colour, marker) in LOOKS.items():
            own = table[table["class"] == name].dropna(subset=["deviation"])
            if own.empty:
                continue
            places = own["check"].map(checks.index).to_numpy() + rng.uniform(-0.25, 0.25, len(own))
            axes.scatter(
                np.maximum(own["deviation"], ZERO),
                places,
                s=16,
                color=colour,
                marker=marker,
                label=name,
                linewidths=0.8,
            )
        axes.set(xscale="log", xlim=(ZERO / 3, 2.0), xlabel="largest deviation over the largest value [-]")
        axes.set_yticks(range(len(checks)), checks)
        axes.invert_yaxis()
        figure.legend(loc="outside upper center", ncols=4)
        return to_svg(figure)


def mirror(sweeps: Mapping[str, pd.DataFrame], own: str, printed: tuple[float, float]) -> str:
    """Over the cord angle: the sweep ``own`` beside the printed table, and every measure on a coarse mesh.

    Full marks are stable states, open ones have negative eigenvalues; printed: angle [deg] and asymmetry [MPa].
    """
    with style():
        figure = Figure(figsize=(9.0, 4.6), layout="constrained")
        left, right = figure.subplots(1, 2)
        _curve(left, sweeps[own], BLUE, "o", "ours")
        left.plot(printed[0], 1e3 * printed[1], color=VERMILION, marker="D", linestyle="none", label="printed")
        left.plot([], [], color=BLACK, marker="o", fillstyle="none", linestyle="none", label="not stable")
        left.set_title(own)
        left.legend(loc="upper center")
        others = {name: sweep for name, sweep in sweeps.items() if name != own}
        drawn = looks(name.partition(",")[0] for name in others)
        for name, sweep in others.items():
            measure = name.partition(",")[0]
            _curve(right, sweep, drawn[measure].colour, drawn[measure].marker, measure)
        right.set_title(f"all measures, {next(iter(others)).partition(', ')[2]}" if others else "")
        right.legend(fontsize=8)
        for axes in (left, right):
            axes.set(xlabel="cord angle γ [deg]", ylabel="largest difference from a mirror image [10⁻³ MPa]")
            axes.set(xlim=(-2, 92), ylim=(0, None), xticks=range(0, 91, 15))
        return to_svg(figure)


def _curve(axes: Axes, sweep: pd.DataFrame, colour: str, marker: str, label: str) -> None:
    look: dict[str, Any] = {"color": colour, "marker": marker, "markersize": 4}
    stable = sweep["negative"] == 0
    value = 1e3 * sweep["mirror_both_MPa"]
    axes.plot(sweep["gamma_deg"], value, color=colour, linewidth=0.8, alpha=0.5)
    axes.plot(sweep["gamma_deg"][stable], value[stable], linestyle="none", label=label, **look)
    axes.plot(sweep["gamma_deg"][~stable], value[~stable], linestyle="none", fillstyle="none", **look)
