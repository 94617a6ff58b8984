"""Ladders of all scenes, and the cells that climb them.

The same ladders serve every element and every table over all scenes.
"""

from __future__ import annotations

from collections.abc import Mapping

from studies.ask.declarations import BENCHMARKS as PUBLISHED
from studies.ask.declarations import CLOSED, CONTACT, LINEAR, ROTATIONS, SNAP, TYRE, Ladder
from studies.ask.scene import ladders_of
from studies.scenes import SCENES
from studies.scenes.complete import Cell

LABEL = "convergence {ladder} {mesh} {element}"
CLIMBED = {  # the scenes that declare ladders of each family, as they come in tables and pictures
    ROTATIONS: (
        "cantilever",
        "sze-moment",
        "sze-annulus",
        "hemisphere",
        "sze-pullout",
        "sze-pinched",
        "semicylinder",
        "semicylinder-0-90-0",
        "semicylinder-90-0-90",
    ),
    SNAP: ("roof-a", "roof-b", "roof-c", "roof-d", "roof-e", "roof-f", "shallow-cap"),
    LINEAR: ("scordelis-lo", "pinched-cylinder", "free-hyperboloid", "pagano"),
    CLOSED: ("pressurised-cylinder", "pressurised-sphere", "pressurised-torus"),
    CONTACT: ("strip-contact", "heavy-strip", "plate-contact", "ring"),
    TYRE: ("tyre",),
}


def _declared(family: str, scenes: tuple[str, ...]) -> tuple[Ladder, ...]:
    return tuple(ladder for name in scenes for ladder in ladders_of(SCENES[name]) if ladder.family == family)


LADDERS = tuple(ladder for family, scenes in CLIMBED.items() for ladder in _declared(family, scenes))
BENCHMARKS = _declared(PUBLISHED, ("cantilever", "hemisphere"))


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
