"""The page of friction: the tyre dragged and turned, its patch, load steps, and the parts of the algorithms."""

from __future__ import annotations

from typing import Any

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from reports.chapter import chapter
from reports.chapters.friction.algorithms import SOLVED, algorithms_part, checks_part
from reports.chapters.friction.filmstrip import filmstrip
from reports.figures.drawing import BLACK, GREY, Look, canvas, legend_above, look, looks, svg, ticks
from reports.formats import formatted
from reports.markdown import Part, commands
from reports.store.tables import Store
from reports.template import Template

TYRE = ("friction_dragged", "friction_turned", "friction_patch", "friction_steps")
FITTED = ("friction_drag_ends", "friction_turn_ends", "friction_step_orders", "friction_algorithms", "friction_orders")
SHOWN_MM, SHOWN_DEG = 16.0, 10.0  # beyond these nothing happens any more
OTHERS = ("friction_agreement", "friction_greco", "friction_klarbring")


def _small(value: float) -> str:
    """A difference; what rounding leaves has no digits."""
    return formatted(value, "+.0e") if abs(value) > 1e-10 else "rounding"


TEXT = Template("friction", small=_small)


def friction_page(store: Store) -> Part:
    """The whole page."""
    drag, turn, patch, steps = map(store.table, TYRE)
    drawn = {
        "friction-dragged.svg": dragged(drag),
        "friction-turned.svg": turned(turn),
        "friction-patch.svg": filmstrip(patch),
        "friction-steps.svg": path_errors(steps),
    }
    orders = store.table("friction_step_orders").set_index("quantity")["order"]
    named = steps.assign(work=steps["dissipation_N_mm"] / 1e3, billions=steps["operations"] / 1e9)
    coarse = steps.sort_values("steps").iloc[0]
    many = "one step" if coarse["steps"] == 1 else f"{coarse['steps']:g} steps"
    told = {
        "patch": patch.to_dict("records")[0],
        "order": orders,
        "coarse": coarse,
        "coarse_steps": many,
        "steps": named,
    }
    parts = {"algorithms": algorithms_part(store), "checks": checks_part(store)}
    moved = {**_ends(store, drag, turn), **_certified(pd.concat([drag, turn]))}
    return TEXT("page", drawn, rules=store.rules(), **moved, **told, **parts)


def _ends(store: Store, drag: pd.DataFrame, turn: pd.DataFrame) -> dict[str, Any]:
    """Force at the end of a drag, torque at that of a turn, and what is dissipated on the way, the press included."""
    pulled, spun = (
        ends.assign(work=ends["mu"].map(moved.groupby("mu")["dissipation_N_mm"].last() / 1e3))
        for ends, moved in ((store.table(FITTED[0]), drag), (store.table(FITTED[1]), turn))
    )
    return {
        "mesh": pulled["mesh"].iloc[0],
        "dragged_by": pulled["last"].iloc[0],
        "turned_by": spun["last"].iloc[0],
        "dragged": pulled,
        "turned": spun.assign(peak=spun["largest"] / 1e3, torque=spun["value"] / 1e3, limit=spun["bound"] / 1e3),
        "commands": commands([*pulled["command"], *spun["command"]]),
    }


def _certified(moved: pd.DataFrame) -> dict[str, Any]:
    """Loads of the drags and turns that are not certified, or where the path has ended."""
    odd = moved[moved["failures"].notna() | (moved["outcome"] != SOLVED[0])]
    all_are = f"All {len(moved)} loads of these paths converged and are certified by the judge."
    return {"odd": odd, "certified": all_are if odd.empty else ""}


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


CHAPTER = chapter(
    TEXT,
    friction_page,
    needs=(*TYRE, *FITTED, *OTHERS),
)
