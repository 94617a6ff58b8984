"""Pictures of a tyre's patch: pressures with their mirror image, differences from print, how the wall buckles."""

from __future__ import annotations

from typing import Any

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure

from reports.figures.drawing import VERMILION, canvas, shades, svg
from reports.figures.maps import ANGLE_DECIMALS, Developed

SHOWN_PHI = 30.0  # degrees to either side of the first touch
ROOM = 1.25  # what is shown, over the size of the patch


@svg
def pressure_map(pressures: pd.DataFrame, developed: Developed) -> Figure:
    """Pressure over the patch with its outline, and its difference from its mirror image, in mm of the outer face.

    pressures: by psi and phi [deg], NaN out of contact, which counts as zero in the difference.
    """
    psi, phi = (angles.to_numpy(dtype=float) for angles in (pressures.index, pressures.columns))
    p = pressures.to_numpy(dtype=float)
    mirrored = pressures.reindex(index=np.round(-psi, ANGLE_DECIMALS) + 0.0).to_numpy(dtype=float)
    odd = np.where(np.isnan(p) & np.isnan(mirrored), np.nan, np.nan_to_num(p) - np.nan_to_num(mirrored))
    rows, columns = (_span(np.any(~np.isnan(odd), axis=axis)) for axis in (1, 0))  # cells that are empty are not drawn
    psi, phi, p, odd = psi[rows], phi[columns], p[rows, columns], odd[rows, columns]
    x, y, inside = _edges(developed.around(phi)), _edges(developed.along(psi)), ~np.isnan(p)
    figure, panels = canvas(2, width=10.0, height=3.6, sharey=True)
    most = float(np.nanmax(np.abs(odd), initial=0.0)) or 1.0
    drawn: list[tuple[np.ndarray, dict[str, Any], str]] = [
        (p, {"cmap": shades("viridis"), "vmin": 0.0}, "contact pressure p [MPa]"),
        (odd, {"cmap": shades("RdBu"), "vmin": -most, "vmax": most}, "p less its mirror image [MPa]"),
    ]
    for axes, (values, how, words) in zip(panels, drawn, strict=True):
        colours = axes.pcolormesh(x, y, values, **how)
        axes.add_collection(LineCollection(_outline(inside, x, y), colors=VERMILION, linewidths=1.4))
        _around_the_patch(axes, inside, x, y)
        axes.set_xlabel("around the axis [mm]")
        figure.colorbar(colours, ax=axes, label=words, location="bottom", shrink=0.8, aspect=30)
    panels[0].set_ylabel("along the meridian [mm]")
    panels[0].plot([], [], color=VERMILION, label="outline, half-way between nodes that touch and that do not")
    figure.legend(loc="outside upper center", fontsize=8)
    return figure


def _span(wanted: np.ndarray) -> slice:
    """From the one before the first to the one behind the last; all where there is none."""
    found = np.flatnonzero(wanted)
    return slice(max(found[0] - 1, 0), found[-1] + 2) if len(found) else slice(None)


def _around_the_patch(axes: Axes, inside: np.ndarray, x: np.ndarray, y: np.ndarray) -> None:
    """As much as the patch needs, true to scale."""
    rows, columns = np.nonzero(inside)
    wide, high = (
        ROOM * np.max(np.abs(edges[np.append(at, at + 1)]), initial=1.0) for at, edges in ((columns, x), (rows, y))
    )
    axes.set(xlim=(-wide, wide), ylim=(-high, high), aspect="equal")


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
    colours = axes.pcolormesh(_edges(columns), _edges(rows), table, cmap=shades("RdBu"), vmin=-most, vmax=most)
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
