"""Pictures of a tyre: load-deflection curves, pressures, patches, profiles, iteration histories; each returns SVG text.

They draw the tables they are given; what is compared with what is decided by the pages.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection

from reports.drawing import BLACK, VERMILION, canvas, look, looks, style, to_svg
from reports.maps import at_delta

GREY = "#777777"
SHOWN_PSI, SHOWN_PHI = 60.0, 30.0  # degrees around the patch


def load_deflection(curves: Mapping[str, tuple[Sequence[float], Sequence[float]]]) -> str:
    """Force over the travel of the plane; each curve starts at the first touch."""
    with style():
        figure, (axes,) = canvas()
        drawn = looks(curves)
        for name, (deltas, forces) in curves.items():
            axes.plot([0, *deltas], [0, *forces], **drawn[name].points, label=name)
        axes.set(xlabel="travel of the plane Δ [mm]", ylabel="force P [N]", xlim=(0, None), ylim=(0, None))
        axes.legend()
        return to_svg(figure)


def pressure_along_psi(panels: Mapping[str, Mapping[str, pd.Series]]) -> str:
    """Contact pressure along meridians: title of a panel -> name of a curve -> pressure by psi."""
    with style():
        figure, all_axes = canvas(len(panels))
        top = max(float(curve.max()) for curves in panels.values() for curve in curves.values())
        for axes, (title, curves) in zip(all_axes, panels.items(), strict=True):
            drawn = looks(curves)
            for name, curve in curves.items():
                shown = curve[np.abs(curve.index.to_numpy(dtype=float)) <= SHOWN_PSI]
                axes.plot(shown.index, shown.to_numpy(), **drawn[name].points, markersize=4, label=name)
            axes.set(title=title, xlabel="meridian angle ψ [deg]", ylabel="contact pressure [MPa]")
            axes.set(ylim=(0, 1.05 * top), xticks=range(-60, 61, 20))
        handles, names = all_axes[0].get_legend_handles_labels()
        figure.legend(handles, names, loc="outside upper center", ncols=4)
        return to_svg(figure)


def pressure_map(pressures: pd.DataFrame, mm_per_degree: tuple[float, float]) -> str:
    """Pressure over the patch with its outline; ``mm_per_degree`` of psi and phi make the picture true to scale."""
    with style():
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
        return to_svg(figure)


def _edges(nodes: np.ndarray) -> np.ndarray:
    """Borders half-way between nodes, the outermost nodes in the middle of theirs."""
    middles = 0.5 * (nodes[1:] + nodes[:-1])
    return np.concatenate([[2 * nodes[0] - middles[0]], middles, [2 * nodes[-1] - middles[-1]]])


def _outline(inside: np.ndarray, x: np.ndarray, y: np.ndarray) -> list[list[tuple[float, float]]]:
    """The borders between cells inside and outside; columns along x, rows along y."""
    padded = np.pad(inside, 1)
    lines = [[(x[j], y[i]), (x[j], y[i + 1])] for i, j in np.argwhere(padded[1:-1, 1:] != padded[1:-1, :-1]).tolist()]
    lines += [[(x[j], y[i]), (x[j + 1], y[i])] for i, j in np.argwhere(padded[1:, 1:-1] != padded[:-1, 1:-1]).tolist()]
    return lines


def profiles(profile: pd.DataFrame, deltas: Sequence[float]) -> str:
    """Both faces of the meridian phi = 0: unloaded, inflated and under some travels of the plane."""
    with style():
        figure, (axes,) = canvas(height=4.3)
        _wall(axes, profile[profile["state"] == "unloaded"], "unloaded", GREY, "--")
        _wall(axes, profile[profile["state"] == "inflated"], "inflated", BLACK, "-")
        pressed = profile[profile["state"] == "pressed"]
        for i, delta in enumerate(deltas):
            _wall(axes, at_delta(pressed, delta), f"Δ = {delta:g} mm", look(i).colour, "-")
        axes.set(xlabel="axial position z [mm]", ylabel="radial position x [mm]", aspect="equal")
        figure.legend(loc="outside right center")
        return to_svg(figure)


def _wall(axes: Axes, rows: pd.DataFrame, name: str, colour: str, line: str) -> None:
    for face, label in (("inner", None), ("outer", name)):
        axes.plot(
            rows[f"{face}_axial_mm"],
            rows[f"{face}_radial_mm"],
            color=colour,
            linestyle=line,
            linewidth=1.1,
            label=label,
        )


def table_differences(panels: Mapping[str, tuple[pd.DataFrame, pd.DataFrame]]) -> str:
    """(computed - printed)/printed in per cent on the printed places, side by side, with the nodes only one has."""
    with style():
        figure, all_axes = canvas(len(panels), height=4.6)
        for axes, (title, (computed, printed)) in zip(all_axes, panels.items(), strict=True):
            psi, labels = (np.asarray(v, dtype=float) for v in (printed.columns, printed.index))
            ours, theirs = computed.to_numpy(dtype=float), printed.to_numpy(dtype=float)
            relative = 100 * (ours / theirs - 1)
            colours = axes.pcolormesh(_edges(psi), _edges(labels), relative, cmap="PuOr_r", vmin=-30, vmax=30)
            for only, marker, name in (
                (~np.isnan(theirs) & np.isnan(ours), "o", "only printed"),
                (np.isnan(theirs) & ~np.isnan(ours), "x", "only computed"),
            ):
                rows, columns = np.nonzero(only)
                axes.plot(psi[columns], labels[rows], marker, color=BLACK, fillstyle="none", markersize=4, label=name)
            axes.set(title=title, xlabel="ψ [deg]", ylabel="printed row label")
            axes.grid(visible=False)
        handles, names = all_axes[0].get_legend_handles_labels()
        figure.legend(handles, names, loc="outside lower center", ncols=2)
        figure.colorbar(colours, ax=all_axes, label="(computed - printed) / printed [%]", extend="both", shrink=0.8)
        return to_svg(figure)


def iterations(histories: Mapping[str, pd.DataFrame]) -> str:
    """Relative residual and size of the contact set over all residual evaluations of a solve."""
    with style():
        figure, (left, right) = canvas(2, height=4.2)
        drawn = {name: {**each.points, "markersize": 3, "linewidth": 1} for name, each in looks(histories).items()}
        for name, history in histories.items():
            evaluation = np.arange(1, len(history) + 1)
            residual = history["residual"].to_numpy(dtype=float)
            finite = np.where(np.isfinite(residual) & (residual > 0), residual, np.nan)
            left.semilogy(evaluation, finite, **drawn[name], label=name)
            right.plot(evaluation, history["contact_nodes"], **drawn[name])
        left.set(xlabel="residual evaluations", ylabel="relative residual")
        right.set(xlabel="residual evaluations", ylabel="nodes in the contact set")
        figure.legend(loc="outside upper center", ncols=1)
        return to_svg(figure)


def inflated_displacement(computed: Mapping[str, pd.DataFrame], reference: pd.DataFrame, source: str) -> str:
    """Radial and axial displacement of the mid-surface by inflation, by psi."""
    with style():
        figure, panels = canvas(2, height=4.0)
        for axes, direction in zip(panels, ("radial", "axial"), strict=True):
            column = f"{direction}_mm"
            drawn = looks(computed)
            for name, table in computed.items():
                axes.plot(table["psi_deg"], table[column], **drawn[name].dashes, label=name)
            axes.plot(reference["psi_deg"], reference[column], "o", color=BLACK, fillstyle="none", label=source)
            axes.set(xlabel="meridian angle ψ [deg]", ylabel=f"{direction} displacement [mm]", xticks=range(0, 121, 30))
        handles, names = panels[0].get_legend_handles_labels()
        figure.legend(handles, names, loc="outside upper center", ncols=3)
        return to_svg(figure)
