"""Pictures of friction: a tyre dragged and turned, errors over load steps, and its patch at three stops."""

from __future__ import annotations

from typing import Any

import numpy as np
import pandas as pd
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.collections import PolyCollection
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from reports.figures.drawing import (
    BLACK,
    BLUE,
    GREY,
    ORANGE,
    Look,
    canvas,
    legend_above,
    look,
    looks,
    shades,
    svg,
    ticks,
)

SHOWN_MM, SHOWN_DEG = 16.0, 10.0  # beyond these nothing happens any more
COLUMNS = 3
ROOM = 4.0  # mm around the patch
ARROW_MM = 10.0  # length of the longest traction
STATES = {1: ("sticks", BLUE), 0: ("slips", ORANGE)}


@svg
def filmstrip(table: pd.DataFrame) -> Figure:
    """COLUMNS stops side by side: a row of pressures with tractions, a row of states below it."""
    chosen = shown_stops(table)
    stops = [own for _, own in chosen.groupby("stop")]
    figure, panels = canvas(2 * len(stops), len(stops), width=11.0, height=1.95, head=0.9)
    pressure = chosen["normal_N"] / chosen["area_mm2"]
    traction = np.hypot(chosen["friction_y_N"], chosen["friction_z_N"]) / chosen["area_mm2"]
    size, farthest = _cell(stops[0]), float(table["drag_mm"].max())
    for k, own in enumerate(stops):
        above, below = panels[k], panels[len(stops) + k]
        painted = _pressures(above, own, size, float(pressure.max()))
        _tractions(above, own, float(traction.max()))
        _states(below, own, size)
        above.set_title(_title(own, table, farthest))
        for axes in (above, below):
            _bounds(axes, chosen)
        below.set_xlabel("y [mm]")
    for axes in panels[:: len(stops)]:
        axes.set_ylabel("z [mm]")
    figure.colorbar(painted, ax=panels, label="pressure [MPa]", location="right", shrink=0.5, aspect=40)
    marks: list[Artist] = [Patch(color=colour, label=name) for name, colour in STATES.values()]
    arrow = f"traction of the plane on the tyre; the longest arrow is {float(traction.max()):.3f} MPa"
    marks.append(Line2D([], [], color=BLACK, marker=">", label=arrow))
    figure.legend(handles=marks, loc="outside upper center", ncols=3)
    return figure


def shown_stops(table: pd.DataFrame) -> pd.DataFrame:
    """The rows of at most COLUMNS stops: the first of the drag, the farthest, the last."""
    drags = table.groupby("stop")["drag_mm"].first()
    chosen = {drags.index[min(1, len(drags) - 1)], drags.idxmax(), drags.index[-1]}
    return table[table["stop"].isin(chosen)]


def _title(own: pd.DataFrame, table: pd.DataFrame, farthest: float) -> str:
    stop, drag = own["stop"].iloc[0], float(own["drag_mm"].iloc[0])
    if stop == table["stop"].min():
        return "pressed"
    gone = bool((table[table["stop"] < stop]["drag_mm"] == farthest).any())
    return f"plane {'back ' if gone else ''}at {drag:g} mm"


def _cell(own: pd.DataFrame) -> tuple[float, float]:
    """Width and height [mm] of a rectangle of the mean area, its sides as neighbours are apart."""
    place = own[["y_mm", "z_mm"]].to_numpy(float)
    apart = np.linalg.norm(place[:, None] - place[None], axis=2)
    np.fill_diagonal(apart, np.inf)
    nearest = place[np.argmin(apart, axis=1)] - place
    short, area = float(np.median(np.min(apart, axis=1))), float(own["area_mm2"].mean())
    long = area / short
    across = np.median(np.abs(nearest[:, 1])) >= np.median(np.abs(nearest[:, 0]))
    return (long, short) if across else (short, long)


def _rectangles(own: pd.DataFrame, size: tuple[float, float]) -> np.ndarray:
    """Corners (n, 4, 2)."""
    corners = 0.5 * np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]]) * size
    return own[["y_mm", "z_mm"]].to_numpy(float)[:, None, :] + corners[None]


def _pressures(axes: Axes, own: pd.DataFrame, size: tuple[float, float], most: float) -> PolyCollection:
    painted = PolyCollection(list(_rectangles(own, size)), cmap=shades("viridis"), linewidths=0.0)
    painted.set_array((own["normal_N"] / own["area_mm2"]).to_numpy(float))
    painted.set_clim(0.0, most)
    axes.add_collection(painted)
    return painted


def _tractions(axes: Axes, own: pd.DataFrame, most: float) -> None:
    pull = own[["friction_y_N", "friction_z_N"]].to_numpy(float) / own[["area_mm2"]].to_numpy(float)
    how: dict[str, Any] = {"angles": "xy", "scale_units": "xy", "pivot": "mid", "width": 0.006}
    axes.quiver(own["y_mm"], own["z_mm"], pull[:, 0], pull[:, 1], color=BLACK, scale=(most or 1.0) / ARROW_MM, **how)


def _states(axes: Axes, own: pd.DataFrame, size: tuple[float, float]) -> None:
    for state, (_, colour) in STATES.items():
        some = own[own["sticks"] == state]
        axes.add_collection(PolyCollection(list(_rectangles(some, size)), facecolors=colour, edgecolors="white"))
    axes.plot(0.0, 0.0, "+", color=BLACK, markersize=5)


def _bounds(axes: Axes, table: pd.DataFrame) -> None:
    """The same for all pictures, true to scale."""
    for name, limit in (("y_mm", axes.set_xlim), ("z_mm", axes.set_ylim)):
        limit(float(table[name].min()) - 2 * ROOM, float(table[name].max()) + 2 * ROOM)
    axes.set_aspect("equal")
    axes.grid(visible=False)


@svg
def dragged(table: pd.DataFrame) -> Figure:
    """F_t over the way of the plane with its bound, and over F_n; a curve each coefficient, from the press on."""
    figure, (left, right) = canvas(2, width=10.0, height=4.2)
    for mu, style, own in _curves(table):
        shown = own[own["drag_mm"].fillna(0.0) <= SHOWN_MM]
        way = shown["drag_mm"].fillna(0.0)
        left.plot(way, shown["friction_N"], **style.points, label=f"μ = {mu:g}")
        left.plot(way, shown["bound_N"], color=style.colour, linestyle="--", linewidth=1.0)
        right.plot(way, shown["friction_N"] / shown["force_N"], **style.points, label=f"μ = {mu:g}")
        right.axhline(mu, color=style.colour, linestyle="--", linewidth=1.0)
    left.plot([], [], color=GREY, linestyle="--", linewidth=1.0, label="bound μ $F_n$")
    _from_zero(left, "displacement of the plane [mm]", "friction $F_t$ [N]")
    _from_zero(right, "displacement of the plane [mm]", "$F_t$ / $F_n$")
    legend_above(figure, left)
    return figure


def _curves(table: pd.DataFrame) -> list[tuple[float, Look, pd.DataFrame]]:
    every = looks(table["mu"])
    return [(mu, style, table[table["mu"] == mu]) for mu, style in every.items()]


def _from_zero(axes: Axes, x: str, y: str) -> None:
    axes.set(xlabel=x, ylabel=y, xlim=(0, None), ylim=(0, None))


@svg
def turned(table: pd.DataFrame) -> Figure:
    """Torque over the angle with its bound, and over that bound, with cos(step/2)."""
    figure, (left, right) = canvas(2, width=10.0, height=4.2)
    for mu, style, own in _curves(table):
        moved = own[own["turn_deg"].notna()]
        near = moved[moved["turn_deg"] <= SHOWN_DEG]
        left.plot(near["turn_deg"], near["moment_N_mm"] / 1e3, **style.points, label=f"μ = {mu:g}")
        left.plot(near["turn_deg"], near["moment_bound_N_mm"] / 1e3, color=style.colour, linestyle="--", linewidth=1.0)
        right.plot(
            moved["turn_deg"], moved["moment_N_mm"] / moved["moment_bound_N_mm"], **style.points, label=f"μ = {mu:g}"
        )
    stops = np.unique(table["turn_deg"].dropna())
    chord = np.cos(np.deg2rad(np.diff(stops, prepend=0.0)) / 2)
    right.plot(stops, chord, color=BLACK, linestyle=":", drawstyle="steps-pre", label="cos(step/2)")
    left.plot([], [], color=GREY, linestyle="--", linewidth=1.0, label="bound μ Σ f r")
    left.plot([], [], color=BLACK, linestyle=":", label="cos(step/2)")
    _from_zero(left, "angle of the plane [deg]", "torque [N m]")
    right.set(xlabel="angle of the plane [deg]", ylabel="torque / μ Σ f r", ylim=(0.98, 1.002), xlim=(0, None))
    legend_above(figure, left, 5)
    return figure


@svg
def path_errors(table: pd.DataFrame) -> Figure:
    """Errors of force and dissipation over load steps, with a line of first order, and over operations."""
    figure, (left, right) = canvas(2, width=10.0, height=4.0, sharey=True)
    for n, (name, words) in enumerate((("friction_N", "force $F_t$"), ("dissipation_N_mm", "dissipation"))):
        error, style = table[f"{name}_error"].abs(), look(n)
        left.plot(table["steps"], error, **style.points, label=words)
        right.plot(table["operations"] / 1e9, error, **style.points, label=words)
        finest = float(error.iloc[-1])
        line = finest * float(table["steps"].iloc[-1]) / table["steps"]
        left.plot(table["steps"], line, color=GREY, linestyle="--", linewidth=1.0, label="first order" if n else None)
    left.set(xscale="log", yscale="log", xlabel="load steps of pressing and of dragging", ylabel="relative error")
    ticks(left, table["steps"])
    right.set(xscale="log", xlabel="operations [10⁹]")
    spent = table["operations"] / 1e9
    round_ones = [n * 10.0**k for k in range(-6, 7) for n in (1, 2, 5)]
    ticks(right, [each for each in round_ones if spent.min() <= each <= spent.max()])
    legend_above(figure, left)
    return figure
