"""Scenes of a kind, by what they declare."""

from __future__ import annotations

from studies.scenes import SCENES
from studies.scenes.benchmarks.quads import OnQuads

ON_QUADS = frozenset(name for name, scene in SCENES.items() if isinstance(scene, OnQuads))
MANY_SURFACES = frozenset(  # whose wall has surfaces inside it unless fewer are asked for
    name
    for name, scene in SCENES.items()
    if any(setting.key == "surfaces" and setting.default is not None for setting in scene.settings)
)
# bodies of a pair that no strain measure is for
OF_SOLIDS = frozenset({"two-cylinders", "ring-on-layer", "tyre-on-drum", "half-spheres", "ironing"})
OF_FACES = frozenset(  # whose bodies meet one another, or themselves: no table of shell limits has a solid for two
    name for name, scene in SCENES.items() if any(setting.key == "pairing" for setting in scene.settings)
)
