"""Scenes of a kind, by what they declare.

The algorithms that enter through the open door: their files, and what counts the steps of their own.
"""

from __future__ import annotations

from pathlib import Path

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


FOLDER = Path(__file__).parents[2] / "studies/arena/solvers"
FILES = {name: FOLDER / f"{name}.py" for name in ("barrier", "interior_point", "proximal")}
SPENT = {
    "barrier": "barrier_iterations",
    "interior-point": "interior_point_iterations",
    "proximal": "proximal_iterations",
}
NAMES = tuple(SPENT)
EXACT_ONLY = ("barrier", "proximal")  # epsilon must be infinite
