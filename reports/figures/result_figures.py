"""The pictures of one solved request, as drawn by ``footprint solve --plot``.

Which pictures a scene has is decided here; how those of a tyre look, in figures of its own.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from itertools import takewhile
from pathlib import Path

import numpy as np
import pandas as pd
from matplotlib.collections import PolyCollection
from matplotlib.figure import Figure

from reports.figures import tyre
from reports.figures.drawing import BLUE, VERMILION, Picture, canvas, drawn, legend_above, look, svg
from reports.figures.tyre import Developed, along_meridian, at_delta, pressures_of
from reports.files import write_texts
from reports.store import TYRES, Cell, load_cell

UNITS = ("mm", "MPa", "N", "deg")


def draw_result(directory: Path) -> list[Path]:
    """Draw what ``directory`` holds into its folder ``figures``; raises StoreError when there is no result."""
    pictures = _pictures(load_cell(directory))
    return write_texts(directory / "figures", {name: picture() for name, picture in pictures.items()})


def figures_of(directory: Path) -> list[Figure]:
    """The same pictures as figures; raises StoreError when there is no result."""
    with drawn() as figures:
        for picture in _pictures(load_cell(directory)).values():
            picture()
    return figures


def _pictures(cell: Cell) -> dict[str, Picture]:
    refined = _grid_picture(cell) | _gradient_picture(cell)
    if cell.scene in TYRES:
        return (tyre_pictures(cell) if cell.steps else {}) | _mode_picture(cell) | refined
    return ({"load-displacement.svg": _load_displacement(cell)} if cell.steps else {}) | refined


def _grid_picture(cell: Cell) -> dict[str, Picture]:
    """The grid that an error has asked for."""
    if not (cell.directory / "grid.csv").exists():
        return {}
    return {"grid.svg": refined_grid(cell.table("grid"))}


def _gradient_picture(cell: Cell) -> dict[str, Picture]:
    """What settings do to the quantities at the last load, where derivatives were asked for."""
    if not (cell.directory / "gradients.csv").exists():
        return {}
    table = cell.table("gradients")
    last = table[table["relative"].notna()]
    return {"gradients.svg": tornado(last, f"load {len(cell.steps)}")} if len(last) else {}


def _mode_picture(cell: Cell) -> dict[str, Picture]:
    """How the wall moves where its path turns back, if it has been found to."""
    if not (cell.directory / "mode.csv").exists():
        return {}
    return {"mode.svg": tyre.mode_map(cell.table("mode"), Developed.of(cell.table("profile")).per_degree)}


def tyre_pictures(cell: Cell) -> dict[str, Picture]:
    """Load-deflection, pressure along psi, pressure map at the last travel, profiles; inflated alone, the profile."""
    profile = cell.table("profile")
    if not any(step["delta_mm"] for step in cell.steps):  # inflated alone
        return {"profiles.svg": tyre.profiles(profile, [])}
    contact = cell.table("contact")
    reached = [step["delta_mm"] for step in cell.steps]  # in the order of the path, which may turn back
    forces = [step["force_N"] for step in cell.steps]
    shown = reached[-4:]
    curves = {f"Δ = {delta:g} mm": along_meridian(at_delta(contact, delta)) for delta in shown}
    last = pressures_of(at_delta(contact, reached[-1]))
    limits = [bool(step.get("limit_point", 0)) for step in cell.steps]
    turns = {"turning-back.svg": tyre.turning_back(reached, forces, limits)} if any(limits) else {}
    return {
        "load-deflection.svg": tyre.load_deflection({cell.result["measure"]: (reached, forces)}),
        **turns,
        "pressure-psi.svg": tyre.pressure_along_psi("φ = 0", curves),
        "pressure-map.svg": tyre.pressure_map(last, Developed.of(profile)),
        "profiles.svg": tyre.profiles(profile, shown),
    }


def _load_displacement(cell: Cell) -> Picture:
    first = cell.steps[0]  # the load, what is read off, then the certificate, which is not a number
    load, *columns = takewhile(lambda name: not isinstance(first[name], dict | list), first)
    named = (load, "load fraction" if load == "load_fraction" else _words(load))
    names = {name: _words(name) for name in columns}
    curve = cell.table("curve") if (cell.directory / "curve.csv").exists() else pd.DataFrame(cell.steps)
    return load_displacement(cell.scene, curve, names, named)


def _words(quantity: str) -> str:
    """tip_deflection_mm -> tip deflection [mm]."""
    name, _, unit = quantity.rpartition("_")
    words = name.replace("_", " ")
    return f"{words} [{unit}]" if unit in UNITS else f"{words} {unit}"


@svg
def load_displacement(scene: str, curve: pd.DataFrame, names: Mapping[str, str], load: tuple[str, str]) -> Figure:
    """The load over displacements, one panel for each column of ``names`` (column -> axis label); load: such a pair."""
    loaded, load_words = load
    rows = math.ceil(len(names) / 3)
    figure, panels = canvas(len(names), math.ceil(len(names) / rows), height=4.5 if rows == 1 else 3.2)
    for axes, (column, words) in zip(panels, names.items(), strict=True):
        points = [0, *curve[column]], [0, *curve[loaded]]
        line = "-" if "limit_point" in curve else "none"  # a curve that turns back needs its order
        axes.plot(*points, linestyle=line, **look(0).points, fillstyle="none", label=scene)
        axes.set(xlabel=words, ylabel=load_words)
        if curve[[column, loaded]].min().min() >= 0:
            axes.set(xlim=(0, None), ylim=(0, None))
    legend_above(figure, panels[0])
    return figure


@svg
def tornado(gradients: pd.DataFrame, at: str) -> Figure:
    """A panel a quantity, a bar a setting, the strongest on top: per cent of the quantity for one per cent of it.

    gradients: quantity, setting, relative.  at: where they were taken.
    """
    names = list(dict.fromkeys(gradients["quantity"]))
    longest = int(gradients.groupby("quantity").size().max())
    figure, panels = canvas(len(names), min(len(names), 2), height=1.2 + 0.28 * longest)
    for axes, name in zip(panels, names, strict=True):
        own = gradients[gradients["quantity"] == name]
        own = own.iloc[own["relative"].abs().argsort(kind="stable")]
        axes.barh(own["setting"], own["relative"], color=[BLUE if each > 0 else VERMILION for each in own["relative"]])
        axes.axvline(0.0, color="black", linewidth=0.8)
        axes.set(xlabel=f"% of {_words(name).partition(' [')[0]} for 1 %", title=f"{name}, {at}")
        axes.grid(visible=False, axis="y")
    return figure


@svg
def refined_grid(elements: pd.DataFrame) -> Figure:
    """Elements in the plane of the coordinates, darker the more often they were cut."""
    ends = elements[["a1_low", "a1_high", "a2_low", "a2_high"]].to_numpy(float)
    corners = np.stack([ends[:, [0, 1, 1, 0]], ends[:, [2, 2, 3, 3]]], axis=-1)
    level = elements["level"].to_numpy(float)
    figure, (axes,) = canvas()
    drawn = PolyCollection(list(corners), edgecolors="0.35", linewidths=0.3, cmap="Blues")
    drawn.set_array(level)
    drawn.set_clim(level.min() - 1, level.max() + 1)
    axes.add_collection(drawn)
    span = {"xlim": (ends[:, 0].min(), ends[:, 1].max()), "ylim": (ends[:, 2].min(), ends[:, 3].max())}
    title = f"{len(elements)} elements, subdivided up to {int(level.max())} times"
    axes.set(xlabel="a1 [rad or mm]", ylabel="a2 [rad or mm]", title=title, **span)
    return figure
