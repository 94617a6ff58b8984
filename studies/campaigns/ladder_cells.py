"""Ladders of all scenes, and the cells that climb them.

The same ladders serve every element and every table over all scenes.
"""

from __future__ import annotations

from collections.abc import Mapping

from studies.campaigns.cell import Cell
from studies.scenes import SCENES
from studies.scenes.ladders import BENCHMARKS as OF_BENCHMARKS
from studies.scenes.ladders import ladders_of

LABEL = "convergence {ladder} {mesh} {element}"
CLIMBED = (  # the scenes that declare ladders, as they come in tables and pictures
    *("cantilever", "sze-moment", "sze-annulus", "hemisphere", "sze-pullout", "sze-pinched"),
    *("semicylinder", "semicylinder-0-90-0", "semicylinder-90-0-90"),
    *("roof-a", "roof-b", "roof-c", "roof-d", "roof-e", "roof-f", "shallow-cap"),
    *("scordelis-lo", "pinched-cylinder", "free-hyperboloid", "pagano"),
    *("pressurised-cylinder", "pressurised-sphere", "pressurised-torus"),
    *("strip-contact", "heavy-strip", "plate-contact", "ring", "tyre"),
)
_DECLARED = tuple(ladder for name in CLIMBED for ladder in ladders_of(SCENES[name]))
LADDERS = tuple(ladder for ladder in _DECLARED if ladder.family != OF_BENCHMARKS)
BENCHMARKS = tuple(ladder for ladder in _DECLARED if ladder.family == OF_BENCHMARKS)


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
