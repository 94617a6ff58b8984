"""Pictures of the tyre with friction: force over the way, torque over the angle, errors over load steps."""

from __future__ import annotations

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from reports.figures.drawing import BLACK, GREY, Look, canvas, legend_above, look, looks, svg, ticks

SHOWN_MM, SHOWN_DEG = 16.0, 10.0  # beyond these nothing happens any more


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
    _from_zero(left, "way of the plane [mm]", "friction $F_t$ [N]")
    _from_zero(right, "way of the plane [mm]", "$F_t$ / $F_n$")
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
    left.set(xscale="log", yscale="log", xlabel="load steps of press and of drag", ylabel="error, of the limit")
    ticks(left, table["steps"], [f"{steps:g}" for steps in table["steps"]])
    right.set(xscale="log", xlabel="operations [10⁹]")
    spent = table["operations"] / 1e9
    round_ones = [n * 10.0**k for k in range(-6, 7) for n in (1, 2, 5)]
    near = [each for each in round_ones if spent.min() <= each <= spent.max()]
    ticks(right, near, [f"{each:g}" for each in near])
    legend_above(figure, left)
    return figure
