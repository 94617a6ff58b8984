"""A request with one setting a little more or less: which settings have a derivative, and by how much they are changed.

Nothing is solved here.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

from contact.sensitivity import STEP
from studies.ask.request import Request, UsageError, Value
from studies.ask.scene import Scene, Setting, SettlingScene, settings_beside
from studies.ask.settings import TOLERANCE

TURN = 30.0  # deg: an angle near zero is not a small one
CONTINUOUS = ("float", "floats", "path")


def differentiable(scene: Scene, request: Request, keys: Sequence[str] = ()) -> tuple[str, ...]:
    """The keys, by default all settings of the request that have a derivative; raises UsageError for one without."""
    known = {each.key: each for each in (*scene.settings, *settings_beside(scene)) if each.key != TOLERANCE.key}
    every = tuple(key for key, each in known.items() if key in request.settings and _varies(each, request))
    for key in keys:
        if key not in known:
            raise UsageError(f"{key} is not a setting of {scene.name} that could change; those are {', '.join(every)}")
        if key not in every:
            why = "has no value here" if key not in request.settings else "is not continuous"
            raise UsageError(f"{key} {why}: there is no derivative; there is for {', '.join(every)}")
    return tuple(keys) or every


def _varies(setting: Setting, request: Request) -> bool:
    return setting.kind in CONTINUOUS and all(map(math.isfinite, numbers_of(request.settings[setting.key])))


def numbers_of(value: Value) -> tuple[float, ...]:
    """Of a setting, of which some have several."""
    return value if isinstance(value, tuple) else (float(value),)


def width_of(scene: Scene, request: Request, key: str, share: float = STEP) -> float:
    """A small change of a setting: a share of its value, less where it is close to a limit that it cannot have."""
    values = numbers_of(request.settings[key])
    size = max(map(abs, values))
    size = max(size, TURN) if key.endswith("_deg") else size or 1.0
    setting = next(each for each in (*scene.settings, *settings_beside(scene)) if each.key == key)
    limits = [end for end, is_open in ((setting.low, setting.open_low), (setting.high, setting.open_high)) if is_open]
    ways = [abs(value - end) for value in values for end in limits if math.isfinite(end)]
    return share * min([size, *ways])


def changed(scene: Scene, request: Request, key: str, by: float) -> Request:
    """The request with a setting changed, each of its values where it has several.

    Raises UsageError where its model is valid without the change alone, as a quarter of a tyre whose cords are not
    turned.
    """
    value = request.settings[key]
    moved: Value = tuple(each + by for each in value) if isinstance(value, tuple) else float(value) + by
    beside = replace(request, settings=request.settings.with_values(**{key: moved}))
    return scene.settle(beside) if isinstance(scene, SettlingScene) else beside
