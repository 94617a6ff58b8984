"""Pictures of a tyre that was solved: load-deflection curves, pressures along a meridian, profiles."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
import pandas as pd
from matplotlib.figure import Figure
from scipy.interpolate import PchipInterpolator

from reports.figures.drawing import BLACK, GREY, VERMILION, canvas, legend_above, lines, look, svg
from reports.figures.maps import SHOWN_PSI, at_delta

TRAVEL, FORCE = "travel of the plane Δ [mm]", "force P [N]"


@svg
def load_deflection(curves: Mapping[str, tuple[Sequence[float], Sequence[float]]]) -> Figure:
    """Force over the travel of the plane; each curve starts at the first touch."""
    figure, (axes,) = canvas()
    lines(axes, {name: ([0, *deltas], [0, *forces]) for name, (deltas, forces) in curves.items()})
    axes.set(xlabel=TRAVEL, ylabel=FORCE, xlim=(0, None), ylim=(0, None))
    axes.legend()
    return figure


@svg
def pressure_along_psi(title: str, curves: Mapping[str, pd.Series]) -> Figure:
    """Contact pressure along a meridian: name of a curve -> pressure by psi."""
    figure, (axes,) = canvas()
    top = max(float(curve.max()) for curve in curves.values())
    shown = {name: curve[np.abs(curve.index.to_numpy(dtype=float)) <= SHOWN_PSI] for name, curve in curves.items()}
    lines(axes, {name: (curve.index, curve.to_numpy()) for name, curve in shown.items()}, markersize=4)
    axes.set(title=title, xlabel="meridian angle ψ [deg]", ylabel="contact pressure [MPa]")
    axes.set(ylim=(0, 1.05 * top), xticks=range(-60, 61, 20))
    legend_above(figure, axes)
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
