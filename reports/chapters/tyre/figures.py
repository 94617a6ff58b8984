"""Pictures of a tyre: load-deflection curves, pressures, patches, profiles, iteration histories.

They draw the tables they are given; what is compared with what is decided by the pages.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure

from reports.drawing import BLACK, VERMILION, canvas, legend_above, lines, look, looks, svg
from reports.maps import ANGLE_DECIMALS, at_delta

GREY = "#777777"
SHOWN_PSI, SHOWN_PHI = 60.0, 30.0  # degrees around the patch
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
def pressure_map(pressures: pd.DataFrame, mm_per_degree: tuple[float, float]) -> Figure:
    """Pressure over the patch with its outline; ``mm_per_degree`` of psi and phi make the picture true to scale."""
    figure, (axes,) = canvas(height=3.4)
    near = [np.abs(angles.to_numpy(dtype=float)) <= SHOWN_PSI for angles in (pressures.index, pressures.columns)]
    pressures = pressures.loc[near[0], near[1]]
    psi, phi = (angles.to_numpy(dtype=float) for angles in (pressures.index, pressures.columns))
    p = pressures.to_numpy(dtype=float)
    x, y = _edges(phi), _edges(psi)
    colours = axes.pcolormesh(x, y, p, cmap="viridis", vmin=0)
    axes.add_collection(LineCollection(_outline(~np.isnan(p), x, y), colors=VERMILION, linewidths=1.8))
    axes.plot([], [], color=VERMILION, label="patch outline")
    axes.set(xlim=(-SHOWN_PHI, SHOWN_PHI), ylim=(-SHOWN_PSI, SHOWN_PSI), aspect=mm_per_degree[0] / mm_per_degree[1])
    axes.set(xlabel="angle around the axis φ [deg]", ylabel="meridian angle ψ [deg]")
    axes.legend(loc="upper right")
    figure.colorbar(colours, ax=axes, label="contact pressure [MPa]")
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
def mode_map(mode: pd.DataFrame, mm_per_degree: tuple[float, float]) -> Figure:
    """How the wall moves along its normal where the path turns back, the largest motion of a node as unit."""
    psi, phi = (np.deg2rad(mode[f"{name}_deg"].to_numpy(dtype=float)) for name in ("psi", "phi"))
    normal = np.stack([np.cos(psi) * np.cos(phi), np.cos(psi) * np.sin(phi), np.sin(psi)], axis=-1)
    along = np.sum(normal * mode[["x", "y", "z"]].to_numpy(dtype=float), axis=-1)
    nodes = mode.assign(along=along).round({"psi_deg": ANGLE_DECIMALS, "phi_deg": ANGLE_DECIMALS})
    table = nodes.pivot(index="psi_deg", columns="phi_deg", values="along")
    rows, columns = (angles.to_numpy(dtype=float) for angles in (table.index, table.columns))
    figure, (axes,) = canvas(height=5.4)
    most = float(np.max(np.abs(table.to_numpy(dtype=float))))
    colours = axes.pcolormesh(_edges(columns), _edges(rows), table, cmap="RdBu", vmin=-most, vmax=most)
    shown = float(np.max(rows))
    axes.set(xlim=(-SHOWN_PHI, SHOWN_PHI), ylim=(-shown, shown), aspect=mm_per_degree[0] / mm_per_degree[1])
    axes.set(xlabel="angle around the axis φ [deg]", ylabel="meridian angle ψ [deg]")
    figure.colorbar(colours, ax=axes, label="motion along the normal, largest = 1")
    return figure


def _edges(nodes: np.ndarray) -> np.ndarray:
    """Borders half-way between nodes, the outermost nodes in the middle of theirs."""
    middles = 0.5 * (nodes[1:] + nodes[:-1])
    return np.concatenate([[2 * nodes[0] - middles[0]], middles, [2 * nodes[-1] - middles[-1]]])


def _outline(inside: np.ndarray, x: np.ndarray, y: np.ndarray) -> list[list[tuple[float, float]]]:
    """The borders between cells inside and outside; columns along x, rows along y."""
    padded = np.pad(inside, 1)
    borders = [[(x[j], y[i]), (x[j], y[i + 1])] for i, j in np.argwhere(padded[1:-1, 1:] != padded[1:-1, :-1]).tolist()]
    across = np.argwhere(padded[1:, 1:-1] != padded[:-1, 1:-1]).tolist()
    return borders + [[(x[j], y[i]), (x[j + 1], y[i])] for i, j in across]


@svg
def profiles(profile: pd.DataFrame, deltas: Sequence[float]) -> Figure:
    """Both faces of the meridian phi = 0: unloaded, inflated and under some travels of the plane."""
    figure, (axes,) = canvas(height=4.3)
    states = dict(iter(profile.groupby("state")))
    walls = {"unloaded": (states["unloaded"], GREY, "--"), "inflated": (states["inflated"], BLACK, "-")}
    for i, delta in enumerate(deltas):
        walls[f"Δ = {delta:g} mm"] = at_delta(states["pressed"], delta), look(i).colour, "-"
    for name, (rows, colour, line) in walls.items():
        for face, label in (("inner", None), ("outer", name)):
            wall = rows[f"{face}_axial_mm"], rows[f"{face}_radial_mm"]
            axes.plot(*wall, color=colour, linestyle=line, linewidth=1.1, label=label)
    axes.set(xlabel="axial position z [mm]", ylabel="radial position x [mm]", aspect="equal")
    axes.set_adjustable("datalim")  # a box of its own would leave no room for the labels beside it
    figure.legend(loc="outside right center")
    return figure


@svg
def table_differences(panels: Mapping[str, Sequence[pd.DataFrame]]) -> Figure:
    """(computed - printed)/printed in per cent on the printed places, side by side, with the nodes only one has."""
    figure, every = canvas(len(panels), height=4.6)
    for axes, (title, (computed, printed)) in zip(every, panels.items(), strict=True):
        psi, labels = (np.asarray(v, dtype=float) for v in (printed.columns, printed.index))
        ours, theirs = computed.to_numpy(dtype=float), printed.to_numpy(dtype=float)
        relative = 100 * (ours / theirs - 1)
        colours = axes.pcolormesh(_edges(psi), _edges(labels), relative, cmap="PuOr_r", vmin=-30, vmax=30)
        for there, missing, marker, name in ((theirs, ours, "o", "only printed"), (ours, theirs, "x", "only computed")):
            rows, columns = np.nonzero(~np.isnan(there) & np.isnan(missing))
            axes.plot(psi[columns], labels[rows], marker, color=BLACK, fillstyle="none", markersize=4, label=name)
        axes.set(title=title, xlabel="ψ [deg]", ylabel="printed row label")
        axes.grid(visible=False)
    handles, names = every[0].get_legend_handles_labels()
    figure.legend(handles, names, loc="outside lower center", ncols=2)
    figure.colorbar(colours, ax=every, label="(computed - printed) / printed [%]", extend="both", shrink=0.8)
    return figure


@svg
def iterations(histories: Mapping[str, pd.DataFrame]) -> Figure:
    """Relative residual and size of the contact set over all residual evaluations of a solve."""
    figure, (left, right) = canvas(2, height=4.2)
    residuals, sets = {}, {}
    for name, history in histories.items():
        evaluation, residual = np.arange(1, len(history) + 1), history["residual"].to_numpy(dtype=float)
        residuals[name] = evaluation, np.where(np.isfinite(residual) & (residual > 0), residual, np.nan)
        sets[name] = evaluation, history["contact_nodes"]
    lines(left, residuals, markersize=3, linewidth=1)
    lines(right, sets, markersize=3, linewidth=1)
    left.set(xlabel="residual evaluations", ylabel="relative residual", yscale="log")
    right.set(xlabel="residual evaluations", ylabel="nodes in the contact set")
    legend_above(figure, left, columns=1)
    return figure


@svg
def inflated_displacement(computed: Mapping[str, pd.DataFrame], reference: pd.DataFrame, source: str) -> Figure:
    """Radial and axial displacement of the mid-surface by inflation, by psi."""
    figure, panels = canvas(2, height=4.0)
    for axes, direction in zip(panels, ("radial", "axial"), strict=True):
        column = f"{direction}_mm"
        for name, each in looks(computed).items():
            axes.plot(computed[name]["psi_deg"], computed[name][column], **each.dashes, label=name)
        axes.plot(reference["psi_deg"], reference[column], "o", color=BLACK, fillstyle="none", label=source)
        axes.set(xlabel="meridian angle ψ [deg]", ylabel=f"{direction} displacement [mm]", xticks=range(0, 121, 30))
    legend_above(figure, panels[0], columns=3)
    return figure
