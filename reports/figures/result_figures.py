"""The pictures of one solved request, as drawn by ``footprint solve --plot``.

Which pictures a scene has is decided here; how they look, in the figures of the tyre and of the benchmarks.
"""

from __future__ import annotations

from itertools import takewhile
from pathlib import Path

import pandas as pd
from matplotlib.figure import Figure

from reports.chapters.shells import figures_benchmarks
from reports.chapters.tyre import figures as figures_tyre
from reports.chapters.tyre import figures_patch
from reports.figures.drawing import Picture, drawn
from reports.figures.maps import Developed, along_meridian, at_delta, pressure_map
from reports.files import write_texts
from reports.store.cells import TYRES, Cell, load_cell

UNITS = ("mm", "MPa", "N", "deg")


def draw_result(directory: Path) -> list[Path]:
    """Draw what ``directory`` holds into its folder ``figures``; raises StoreError when there is no result."""
    pictures = _pictures(load_cell(directory, directory.name))
    return write_texts(directory / "figures", {name: picture() for name, picture in pictures.items()})


def figures_of(directory: Path) -> list[Figure]:
    """The same pictures as figures; raises StoreError when there is no result."""
    with drawn() as figures:
        for picture in _pictures(load_cell(directory, directory.name)).values():
            picture()
    return figures


def _pictures(cell: Cell) -> dict[str, Picture]:
    refined = _grid_picture(cell)
    if cell.scene in TYRES:
        return (tyre_pictures(cell) if cell.steps else {}) | _mode_picture(cell) | refined
    return ({"load-displacement.svg": _load_displacement(cell)} if cell.steps else {}) | refined


def _grid_picture(cell: Cell) -> dict[str, Picture]:
    """The grid that an error has asked for."""
    if not (cell.directory / "grid.csv").exists():
        return {}
    return {"grid.svg": figures_benchmarks.refined_grid(cell.table("grid"))}


def _mode_picture(cell: Cell) -> dict[str, Picture]:
    """How the wall moves where its path turns back, if it has been found to."""
    if not (cell.directory / "mode.csv").exists():
        return {}
    return {"mode.svg": figures_patch.mode_map(cell.table("mode"), Developed.of(cell.table("profile")).per_degree)}


def tyre_pictures(cell: Cell) -> dict[str, Picture]:
    """Load-deflection, pressure along psi, pressure map at the last travel, profiles; inflated alone, the profile."""
    profile = cell.table("profile")
    if not any(step["delta_mm"] for step in cell.steps):  # inflated alone
        return {"profiles.svg": figures_tyre.profiles(profile, [])}
    contact = cell.table("contact")
    reached = [step["delta_mm"] for step in cell.steps]  # in the order of the path, which may turn back
    forces = [step["force_N"] for step in cell.steps]
    shown = reached[-4:]
    curves = {f"Δ = {delta:g} mm": along_meridian(at_delta(contact, delta)) for delta in shown}
    last = pressure_map(at_delta(contact, reached[-1]))
    limits = [bool(step.get("limit_point", 0)) for step in cell.steps]
    turns = {"turning-back.svg": figures_tyre.turning_back(reached, forces, limits)} if any(limits) else {}
    return {
        "load-deflection.svg": figures_tyre.load_deflection({cell.result["measure"]: (reached, forces)}),
        **turns,
        "pressure-psi.svg": figures_tyre.pressure_along_psi({"φ = 0": curves}),
        "pressure-map.svg": figures_patch.pressure_map(last, Developed.of(profile)),
        "profiles.svg": figures_tyre.profiles(profile, shown),
    }


def _load_displacement(cell: Cell) -> Picture:
    first = cell.steps[0]  # the load, what is read off, then the certificate, which is no number
    load, *columns = takewhile(lambda name: not isinstance(first[name], dict | list), first)
    named = (load, "load fraction" if load == "load_fraction" else _words(load))
    names = {name: _words(name) for name in columns}
    drawn = cell.table("curve") if (cell.directory / "curve.csv").exists() else pd.DataFrame(cell.steps)
    return figures_benchmarks.load_displacement({cell.scene: drawn}, names, load=named)


def _words(quantity: str) -> str:
    """tip_deflection_mm -> tip deflection [mm]."""
    name, _, unit = quantity.rpartition("_")
    words = name.replace("_", " ")
    return f"{words} [{unit}]" if unit in UNITS else f"{words} {unit}"
