"""Pictures of a tyre that was solved: load-deflection curves, pressures along a meridian and over the patch, profiles.

Contact tables are maps over the meridian angle psi (rows) and the angle phi around the axis (columns), in degrees, or
over the same places in millimetres of the outer face.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure
from scipy.interpolate import PchipInterpolator

from reports.figures.drawing import BLACK, GREY, VERMILION, canvas, legend_above, lines, look, shades, svg

ANGLE_DECIMALS = 6  # nodes are told apart by angles rounded to this
SHOWN_PSI = 60.0  # degrees to either side of the equator, beyond which nothing touches
SHOWN_PHI = 30.0  # degrees to either side of the first touch
ROOM = 1.25  # what is shown, over the size of the patch
TRAVEL, FORCE = "travel of the plane Δ [mm]", "force P [N]"


@dataclass(frozen=True, eq=False)
class Developed:
    """The inflated outer face rolled out: psi [deg] (n,) with arc length [mm] (n,) from the equator, and the radius of
    the equator [mm].
    """

    psi: np.ndarray
    arc: np.ndarray
    radius: float

    @classmethod
    def of(cls, profile: pd.DataFrame) -> Developed:
        """From the table of profiles."""
        inflated = profile[profile["state"] == "inflated"].sort_values("psi_deg")
        psi, radial, axial = (
            inflated[name].to_numpy(float) for name in ("psi_deg", "outer_radial_mm", "outer_axial_mm")
        )
        arc = np.concatenate([[0.0], np.cumsum(np.hypot(np.diff(radial), np.diff(axial)))])
        return cls(psi, arc - np.interp(0.0, psi, arc), float(np.interp(0.0, psi, radial)))

    def along(self, psi: np.ndarray) -> np.ndarray:
        """Arc length along the meridian [mm]."""
        return np.interp(psi, self.psi, self.arc)

    def around(self, phi: np.ndarray) -> np.ndarray:
        """Arc length along the equator [mm]."""
        return self.radius * np.deg2rad(phi)

    @property
    def per_degree(self) -> tuple[float, float]:
        """Lengths [mm] of a degree of psi and of phi at the equator."""
        crown = int(np.argmin(np.abs(self.psi)))
        near = slice(crown - 1, crown + 2)
        return float(np.ptp(self.arc[near]) / np.ptp(self.psi[near])), float(np.deg2rad(self.radius))


def at_delta(table: pd.DataFrame, delta: float) -> pd.DataFrame:
    """The rows of one travel of the plane."""
    return table[(table["delta_mm"] - delta).abs() < 1e-9]


def pressures_of(contact: pd.DataFrame) -> pd.DataFrame:
    """Pressure [MPa] of one travel by psi and phi; NaN where the node is not in contact."""
    nodes = pd.DataFrame(
        {
            "psi": contact["psi_deg"].round(ANGLE_DECIMALS) + 0.0,
            "phi": contact["phi_deg"].round(ANGLE_DECIMALS) + 0.0,
            "pressure": contact["pressure_MPa"].where(contact["active"] == 1),
        }
    )
    return nodes.pivot(index="psi", columns="phi", values="pressure").sort_index().sort_index(axis=1)


def along_meridian(contact: pd.DataFrame) -> pd.Series:
    """Pressure [MPa] by psi at phi = 0, zero out of contact."""
    return pressures_of(contact)[0.0].fillna(0.0)


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
        (odd, {"cmap": shades("RdBu"), "vmin": -most, "vmax": most}, "p minus its mirror image [MPa]"),
    ]
    for axes, (values, how, words) in zip(panels, drawn, strict=True):
        colours = axes.pcolormesh(x, y, values, **how)
        axes.add_collection(LineCollection(_outline(inside, x, y), colors=VERMILION, linewidths=1.4))
        _around_the_patch(axes, inside, x, y)
        axes.set_xlabel("around the axis [mm]")
        figure.colorbar(colours, ax=axes, label=words, location="bottom", shrink=0.8, aspect=30)
    panels[0].set_ylabel("along the meridian [mm]")
    panels[0].plot([], [], color=VERMILION, label="outline, half-way between nodes in contact and not")
    figure.legend(loc="outside upper center", fontsize=8)
    return figure


def _span(wanted: np.ndarray) -> slice:
    """From the one before the first to the one behind the last; all where there is none."""
    places = np.flatnonzero(wanted)
    return slice(max(places[0] - 1, 0), places[-1] + 2) if len(places) else slice(None)


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
    figure.colorbar(colours, ax=axes, label="normal displacement, largest = 1")
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
    first = next(i for i, turns in enumerate(limit) if turns)
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
    axes.set_title(f"at {deltas[first]:.4g} mm and {forces[first]:.4g} N the path turns back, by {behind:.3g} mm")
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
