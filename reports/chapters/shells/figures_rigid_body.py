"""Picture of rigid rotations: strains over a full turn with the declared laws on top; returns SVG text."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import pandas as pd
from matplotlib.figure import Figure

from reports.drawing import BLACK, looks, style, to_svg

SAME = 1e-9  # measures this close all the way share a curve


def shared_curves(rows: pd.DataFrame) -> Iterator[tuple[str, pd.DataFrame]]:
    """The measures of one case grouped by equal strains: their names and one of their tables."""
    groups: list[tuple[list[str], pd.DataFrame]] = []
    for name, own in rows.groupby("measure", sort=False):
        strain = own["strain"].to_numpy()
        same = (names for names, first in groups if np.allclose(first["strain"], strain, rtol=0, atol=SAME))
        names = next(same, None)
        if names is None:
            groups.append(([str(name)], own))
        else:
            names.append(str(name))
    for names, own in groups:
        yield ", ".join(names), own


def full_turn(sweep: pd.DataFrame) -> str:
    """Strain over the angle of a rigid rotation, a panel a case; the exact answer is zero."""
    cases = list(dict.fromkeys(zip(sweep["surface"], sweep["motion"], strict=True)))
    drawn = looks(sweep["measure"])
    with style():
        figure = Figure(figsize=(9.0, 4.2 * ((len(cases) + 1) // 2)), layout="constrained")
        panels = figure.subplots((len(cases) + 1) // 2, 2, squeeze=False).ravel()
        for axes, (surface, motion) in zip(panels[: len(cases)], cases, strict=True):
            rows = sweep[(sweep["surface"] == surface) & (sweep["motion"] == motion)]
            for names, own in shared_curves(rows):
                colour = drawn[own["measure"].iloc[0]].colour
                angle = np.degrees(own["theta_rad"])
                axes.plot(angle, own["strain"], color=colour, linewidth=3.5, alpha=0.7, label=_wrapped(names))
                axes.plot(angle, own["declared"], color=BLACK, linestyle=":", linewidth=1.2)
            axes.set(title=f"{surface}, {motion}", xlabel="rotation [deg]", ylabel="strain [-]", xlim=(0, 360))
            axes.set_xticks([0, 90, 180, 270, 360])
            axes.legend(loc="upper center", bbox_to_anchor=(0.5, -0.16), fontsize=8, frameon=False)
        for axes in panels[len(cases) :]:
            axes.set_axis_off()
        return to_svg(figure)


def _wrapped(names: str, width: int = 62) -> str:
    """Names on lines of a panel's width."""
    lines = [""]
    for name in names.split(", "):
        joined = f"{lines[-1]}, {name}" if lines[-1] else name
        if len(joined) > width:
            lines[-1] += ","
            lines.append(name)
        else:
            lines[-1] = joined
    return "\n".join(lines)
