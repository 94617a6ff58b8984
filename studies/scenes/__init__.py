"""The catalogue of scenes: one file a scene, one line here."""

from __future__ import annotations

from studies.scene import Scene
from studies.scenes.cantilever import Cantilever
from studies.scenes.hemisphere import Hemisphere
from studies.scenes.tyre import Tyre

SCENES: dict[str, Scene] = {scene.name: scene for scene in (Tyre(), Cantilever(), Hemisphere())}
