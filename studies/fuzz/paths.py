"""What friction adds to a drawn request: a coefficient, and ways of the foundation that reverse, stop and go on.

How a request is drawn otherwise is in :mod:`studies.fuzz.cases`; nothing is solved or judged here.
"""

from __future__ import annotations

import numpy as np

from studies.friction.settings import DRAG, MU, TURN, WAY
from studies.fuzz.values import generator
from studies.scene import Scene, SlidingScene

MUS = {  # share, powers of ten of its span
    "usual": (0.6, (-1.7, 0.2)),
    "tiny": (0.1, (-12.0, -4.0)),
    "large": (0.1, (0.2, 4.0)),
    "inf": (0.12, None),
    "0": (0.08, None),
}
WAYS = {"there": 0.15, "back": 0.25, "beyond": 0.25, "on": 0.1, "wandering": 0.25}
SIZES = {"drag_mm": (-4.0, 1.0), "turn_deg": (-3.0, 1.7)}  # powers of ten of the first stop
LARGER = {"tyre": 1.0}  # powers of ten by which the drags of a scene are longer
PRESSED = {"tyre": (-0.5, 1.3), "tyre-solid": (-0.5, 1.3)}  # powers of ten of a travel, where the default is many
DRAGGED, TURNED, ASLANT = 0.75, 0.5, 0.5


def rubbing(name: str, scene: Scene, seed: int) -> dict[str, str]:
    """Settings of friction: always a coefficient, drags and turns where the scene takes them."""
    mu = _coefficient(seed)
    found = {MU.key: mu}
    if name in PRESSED:
        found["delta_mm"] = f"{10 ** generator(seed, 'press').uniform(*PRESSED[name]):.3g}"
    if mu == "0" or not isinstance(scene, SlidingScene):
        return found
    rng = generator(seed, "slides")
    if rng.random() < DRAGGED:
        found[DRAG.key] = _stops(DRAG.key, LARGER.get(name, 0.0), seed)
        if rng.random() < ASLANT:
            found[WAY.key] = str(int(rng.integers(-180, 181)))
    if rng.random() < TURNED:
        found[TURN.key] = _stops(TURN.key, 0.0, seed)
    return found


def _coefficient(seed: int) -> str:
    rng = generator(seed, f"value of {MU.key}")
    kind = str(rng.choice(list(MUS), p=[share for share, _ in MUS.values()]))
    span = MUS[kind][1]
    return kind if span is None else f"{10 ** rng.uniform(*span):.3g}"


def _stops(key: str, longer: float, seed: int) -> str:
    """A way from 0, no two stops of which are alike in a row."""
    rng = generator(seed, f"value of {key}")
    size = 10 ** (rng.uniform(*SIZES[key]) + longer)
    share = float(rng.uniform(0.1, 2))
    way = str(rng.choice(list(WAYS), p=list(WAYS.values())))
    stops = {
        "there": [1.0],
        "back": [1.0, 0.0],
        "beyond": [1.0, -share],
        "on": [1.0, 1.0 + share, 1.0 + 2 * share],
        "wandering": list(np.cumsum(rng.normal(size=int(rng.integers(2, 5))))),
    }[way]
    sign = float(rng.choice([-1.0, 1.0]))
    return ",".join(f"{sign * size * stop + 0.0:.4g}" for stop in stops)
