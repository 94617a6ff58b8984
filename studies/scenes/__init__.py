"""The catalogue of scenes: one file a scene, one line here. A module is loaded when one of its scenes is asked for."""

from __future__ import annotations

import importlib
from collections import UserDict
from collections.abc import Mapping

from studies.ask.scene import Scene

MODULES: Mapping[str, str] = {  # whose SCENES have the scene of a name
    "tyre": "studies.scenes.tyre.scene",
    "cantilever": "studies.scenes.benchmarks.cantilever",
    "hemisphere": "studies.scenes.benchmarks.hemisphere",
    # nonlinear
    "sze-annulus": "studies.scenes.benchmarks.sze_annulus",
    "sze-moment": "studies.scenes.benchmarks.sze_moment",
    "sze-pullout": "studies.scenes.benchmarks.sze_pullout",
    "sze-pinched": "studies.scenes.benchmarks.sze_pinched",
    "semicylinder": "studies.scenes.benchmarks.semicylinder",
    "semicylinder-0-90-0": "studies.scenes.benchmarks.semicylinder",
    "semicylinder-90-0-90": "studies.scenes.benchmarks.semicylinder",
    **{f"roof-{letter}": "studies.scenes.benchmarks.roofs" for letter in "abcdef"},
    "shallow-cap": "studies.scenes.benchmarks.shallow_cap",
    "pressurised-cylinder": "studies.scenes.benchmarks.pressurised",
    "pressurised-sphere": "studies.scenes.benchmarks.pressurised",
    "pressurised-torus": "studies.scenes.benchmarks.pressurised",
    # linear
    "scordelis-lo": "studies.scenes.benchmarks.scordelis_lo",
    "pinched-cylinder": "studies.scenes.benchmarks.pinched_cylinder",
    "free-hyperboloid": "studies.scenes.benchmarks.hyperboloid",
    "pagano": "studies.scenes.benchmarks.pagano",
    # contact
    "strip-contact": "studies.scenes.contact.strip",
    "heavy-strip": "studies.scenes.contact.heavy_strip",
    "plate-contact": "studies.scenes.contact.plate",
    "ring": "studies.scenes.contact.ring",
    "panel": "studies.scenes.contact.panel",
    # an experiment, and solids
    "crushed-ring": "studies.scenes.contact.crushed_ring",
    "crushed-ring-solid": "studies.scenes.contact.crushed_ring_solid",
    "tyre-solid": "studies.scenes.tyre.solid",
    # exact solutions that are given
    "manufactured": "studies.scenes.manufactured.scene",
    "manufactured-contact": "studies.scenes.manufactured.contact_scene",
}


class Catalogue(UserDict[str, Scene]):
    """Scenes by name, ours and those that are put in; names are known without loading anything."""

    data: dict[str, Scene | None]  # type: ignore[assignment]  # None: not loaded yet

    def __init__(self) -> None:
        super().__init__()
        self.data = dict.fromkeys(MODULES)

    def __getitem__(self, name: str) -> Scene:
        scene = self.data[name]
        if scene is None:
            scenes: tuple[Scene, ...] = importlib.import_module(MODULES[name]).SCENES
            scene = self.data[name] = next(each for each in scenes if each.name == name)
        return scene


SCENES = Catalogue()
