"""Ladders: scenes on three or more meshes, what is read off them, and the cells that climb them.

The same ladders serve every element and every table over all scenes; ladders.toml has them.
"""

from __future__ import annotations

import tomllib
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from studies.campaigns.cell import Cell

LABEL = "convergence {ladder} {mesh} {element}"


@dataclass(frozen=True)
class Ladder:
    """A scene on meshes from coarse to fine; the size of their elements falls as 1 over the first number.

    quantities: what is judged, the first one is the scene's headline. at: the step where they are read, KEY=VALUE;
    without one, the last step. family: whose picture they are in. settings, measure: as for ``footprint solve``.
    coarser: what is solved in the place of the finest mesh where that is left out and only two would be left.
    causes: why quantities by name are not in an asymptotic range.
    """

    name: str
    scene: str
    family: str
    meshes: tuple[str, ...]
    quantities: tuple[str, ...]
    settings: Mapping[str, str] = field(default_factory=dict)
    measure: str = "exact"
    at: str = ""
    coarser: tuple[str, ...] = ()
    causes: Mapping[str, str] = field(default_factory=dict)

    def climbed(self, *, finest: bool) -> tuple[str, ...]:
        """Its meshes, with the finest or without."""
        return self.meshes if finest else (*self.coarser, *self.meshes[:-1])


def _read() -> tuple[tuple[Ladder, ...], tuple[Ladder, ...]]:
    """Those of the report, and those of the benchmarks."""
    data = tomllib.loads(Path(__file__).with_name("ladders.toml").read_text(encoding="utf-8"))

    def ladder(entry: dict[str, Any]) -> Ladder:
        entry = {key: tuple(value) if isinstance(value, list) else value for key, value in entry.items()}
        causes = {quantity: data["causes"][cause] for quantity, cause in entry.pop("causes", {}).items()}
        return Ladder(**{"name": entry["scene"], **entry, "causes": causes})

    return tuple(map(ladder, data["ladder"])), tuple(map(ladder, data["benchmark"]))


LADDERS, BENCHMARKS = _read()
ISOTROPIC = next(ladder.settings for ladder in LADDERS if ladder.name == "tyre-isotropic")


def cells(element_settings: Mapping[str, str], element_label: str, *, finest: bool = True) -> tuple[Cell, ...]:
    """The cells of all ladders with one element; their labels are those that the pages ask for.

    ``finest``: with the last mesh of each ladder, which costs more than all others together.
    """
    return tuple(
        Cell(
            LABEL.format(ladder=ladder.name, mesh=mesh, element=element_label),
            ladder.scene,
            {"measure": ladder.measure, "mesh": mesh},
            {**ladder.settings, **element_settings},
        )
        for ladder in LADDERS
        for mesh in ladder.climbed(finest=finest)
    )
