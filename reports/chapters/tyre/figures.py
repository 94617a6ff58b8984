"""Pictures of a tyre: load-deflection curves, pressures along meridians, profiles, iteration histories.

They draw the tables they are given; what is compared with what is decided by the pages.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from scipy.interpolate import PchipInterpolator

from reports.figures.drawing import BLACK, GREY, VERMILION, canvas, legend_above, lines, look, looks, svg
from reports.figures.maps import SHOWN_PSI, at_delta

TRAVEL, FORCE = "travel of the plane Δ [mm]", "force P [N]"


@svg
def load_deflection(
    curves: Mapping[str, tuple[Sequence[float], Sequence[float]]],
    travel: str = TRAVEL,
    force: str = FORCE,
    **legend: Any,
) -> Figure:
    """Force over the travel of the plane; each curve starts at the first touch."""
    figure, (axes,) = canvas()
    lines(axes, {name: ([0, *deltas], [0, *forces]) for name, (deltas, forces) in curves.items()})
    axes.set(xlabel=travel, ylabel=force, xlim=(0, None), ylim=(0, None))
    axes.legend(**legend)
    return figure


@svg
def pressure_along_psi(panels: Mapping[str, Mapping[str, pd.Series]]) -> Figure:
    """Contact pressure along meridians: title of a panel -> name of a curve -> pressure by psi."""
    figure, every = canvas(len(panels))
    top = max(float(curve.max()) for curves in panels.values() for curve in curves.values())
    for axes, (title, curves) in zip(every, panels.items(), strict=True):
        shown = {name: curve[np.abs(curve.index.to_numpy(dtype=float)) <= SHOWN_PSI] for name, curve in curves.items()}
        lines(axes, {name: (curve.index, curve.to_numpy()) for name, curve in shown.items()}, markersize=4)
        axes.set(title=title, xlabel="meridian angle ψ [deg]", ylabel="contact pressure [MPa]")
        axes.set(ylim=(0, 1.05 * top), xticks=range(-60, 61, 20))
    legend_above(figure, every[0])
    return figure


@svg
def turning_back(deltas: Sequence[float], forces: Sequence[float], limit: Sequence[bool]) -> Figure:
    """Force over travel about the first limit point, on the way there and behind it; the limit points are marked."""
    figure, (axes,) = canvas()
    first = next(i for i, found in enumerate(limit) if found)
    behind = deltas[first] - min(deltas[first:])
    axes.plot(deltas, forces, marker="o", markersize=3)
    marked = np.flatnonzero(limit)
    axes.plot(
        np.take(deltas, marked), np.take(forces, marked), "D", color=VERMILION, label="limit points of the travel"
    )
    near = np.abs(np.subtract(deltas, deltas[first])) <= 3 * behind
    at, shown = (np.asarray(each, dtype=float)[near] for each in (deltas, forces))
    axes.set(xlim=(at.min() - 0.1 * behind, at.max() + 0.1 * behind), xlabel=TRAVEL, ylabel=FORCE)
    axes.set(ylim=(shown.min() - 0.1 * np.ptp(shown), shown.max() + 0.1 * np.ptp(shown)))
    axes.set_title(f"at {deltas[first]:.4g} mm and {forces[first]:.4g} N it turns back, by {behind:.3g} mm")
    axes.legend()
    return figure


@svg
def profiles(profile: pd.DataFrame, deltas: Sequence[float]) -> Figure:
    """Both faces of the meridian phi = 0: unloaded, inflated and under some travels of the plane."""
    figure, (axes,) = canvas(height=4.3)
    states = dict(iter(profile.groupby("state")))
    walls = {"unloaded": (states["unloaded"], GREY, "--"), "inflated": (states["inflated"], BLACK, "-")}
    for i, delta in enumerate(deltas):
        each = look(i)
        walls[f"Δ = {delta:g} mm"] = at_delta(states["pressed"], delta), each.colour, each.line if i else "-"
    for name, (rows, colour, line) in walls.items():
        for face, label in (("inner", None), ("outer", name)):
            wall = _smooth(rows[f"{face}_axial_mm"], rows[f"{face}_radial_mm"])
            axes.plot(*wall, color=colour, linestyle=line, linewidth=1.1, label=label)
    axes.set(xlabel="axial position z [mm]", ylabel="radial position x [mm]", aspect="equal")
    axes.set_adjustable("datalim")  # a box of its own would leave no room for the labels beside it
    figure.legend(loc="outside right center")
    return figure


def _smooth(x: pd.Series, y: pd.Series) -> tuple[np.ndarray, np.ndarray]:
    """A curve through points that nowhere goes beyond them, as a flat piece must stay flat."""
    points = np.stack([x.to_numpy(float), y.to_numpy(float)])
    along = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(points, axis=1)))])
    fine = PchipInterpolator(along, points, axis=1)(np.linspace(0.0, along[-1], 20 * len(along)))
    return fine[0], fine[1]


@svg
def iterations(histories: Mapping[str, pd.DataFrame]) -> Figure:
    """Residual over the iterations of the last step, a panel a solve; numbers: nodes in contact where they change."""
    figure, panels = canvas(len(histories), columns=min(len(histories), 3), width=10.0, height=2.7, sharey=True)
    drawn = looks(histories)
    steps = {name: last_step(history) for name, history in histories.items()}
    longest = max((len(step) for step in steps.values()), default=1)
    for axes, (name, step) in zip(panels, steps.items(), strict=True):
        _iterations(axes, step, drawn[name].colour)
        axes.set(title=name, yscale="log", xlim=(-0.04 * longest, 1.04 * longest), ylim=(1e-15, 1e3))
        axes.title.set_fontsize(9)
    for axes in panels[:: min(len(histories), 3)]:
        axes.set_ylabel("relative residual")
    for axes in panels[-3:]:
        axes.set_xlabel("iteration of the last step")
    panels[0].plot([], [], "o", color=BLACK, label="contact set changed, to so many nodes")
    panels[0].plot([], [], "o", color=BLACK, fillstyle="none", label="contact set kept")
    legend_above(figure, panels[0], columns=2)
    return figure


def last_step(history: pd.DataFrame) -> pd.DataFrame:
    """The iterations of the last attempt of the last load."""
    begins = np.flatnonzero(history["iteration"].to_numpy() == 0)
    return history.iloc[begins[-1] if len(begins) else 0 :]


def _iterations(axes: Axes, step: pd.DataFrame, colour: str) -> None:
    residual = step["residual"].to_numpy(dtype=float)
    residual = np.where(np.isfinite(residual) & (residual > 0), residual, np.nan)
    count, changed = np.arange(len(step)), (step["added"] + step["removed"]).to_numpy() > 0
    axes.plot(count, residual, color=colour, linewidth=1.1)
    for fill, chosen in (("full", changed), ("none", ~changed)):
        axes.plot(count[chosen], residual[chosen], "o", color=colour, fillstyle=fill, markersize=4)
    for i in count[changed & ~np.isnan(residual)]:
        nodes, above = str(step["contact_nodes"].iloc[i]), 5 + 8 * (i % 2)
        axes.annotate(nodes, (i, residual[i]), (0, above), textcoords="offset points", fontsize=7, ha="center")
