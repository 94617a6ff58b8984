"""Random values of settings, drawn from their records: near the default, far from it, on the bounds of the range.

Every value is drawn by a generator of its own, seeded by the number of the case and a name: a setting that is added to
a scene leaves the values of the others as they are.
"""

from __future__ import annotations

import math
import re
import zlib

import numpy as np

from studies.ask.request import text_of
from studies.ask.scene import Setting, UsageError

NEAR, FAR = 4.0, 1e3  # factors from the default, down and up
HOW = {"near": 0.65, "far": 0.25, "bound": 0.1}
INFINITE = 0.5  # share of it, where infinity is a value
WIDEST = 1e6  # a range without an end is taken to here
HAIR = 1e-9  # inside an open bound
SPANS = {  # from which a value near is taken, where the default says nothing of it: it is zero, or another's
    **{"irregular": (0.0, 0.9), "inflation": (-0.2, 0.5), "nu": (-0.5, 0.49), "p0_MPa": (-0.02, 0.3)},
    **{"epsilon": (1e1, 1e7), "E_MPa": (5.0, 100.0), "foundation_radius_mm": (20.0, 1000.0)},
    **{"E_ratio": (1.0, 100.0), "c": (1e-2, 1e4)},
}
MOST = {"per_ply": 2, "plies": 5, "order": 6}  # of what makes a problem large
LARGE = ("adapted",)  # choices that solve larger problems of their own before the one asked for
LEAST = {"arc_step": 1e-3}  # of what makes a path long


def generator(seed: int, name: str) -> np.random.Generator:
    """That of a name within a case."""
    return np.random.default_rng([seed, zlib.crc32(name.encode())])


def drawn(setting: Setting, seed: int) -> str:
    """A value as it is written after KEY=, one that the setting takes."""
    rng = generator(seed, f"value of {setting.key}")
    if setting.kind == "choice":
        return str(rng.choice([choice for choice in setting.choices if choice not in LARGE]))
    how = str(rng.choice(list(HOW), p=list(HOW.values())))
    if setting.kind == "floats":
        count = int(rng.integers(1, 4))
        return text_of(tuple(sorted({float(_short(setting, _number(setting, how, rng))) for _ in range(count)})))
    if setting.infinite and rng.random() < INFINITE:
        return "inf"
    number = _number(setting, how, rng)
    if setting.kind == "int":
        return str(min(round(number), MOST.get(setting.key, round(number))))
    return _short(setting, number)


def _number(setting: Setting, how: str, rng: np.random.Generator) -> float:
    low, high = _ends(setting)
    if how == "bound":
        return float(rng.choice([low, high]))
    middle, span = _default(setting), SPANS.get(setting.key)
    if how == "near" and span is not None:
        value = _between(*span, rng)
    elif middle:
        factor = NEAR if how == "near" else FAR
        value = middle * factor ** rng.uniform(-1, 1)
        if setting.unit == "deg" and low < 0:  # an angle has no size
            value = rng.uniform(low, high)
    else:
        value = _between(low, high, rng)
    return float(np.clip(value, low, high))


def _between(low: float, high: float, rng: np.random.Generator) -> float:
    """Even in the logarithm over more than two decades, even in the number otherwise."""
    if low > 0 and high / low > 100:
        return float(low * (high / low) ** rng.uniform())
    return float(rng.uniform(low, high))


def _ends(setting: Setting) -> tuple[float, float]:
    """The least and the largest value that the setting takes, no further than WIDEST."""
    size = max(abs(_default(setting) or 1.0), 1.0) * WIDEST
    low, high = max(setting.low, -size), min(setting.high, size)
    hair = HAIR * (high - low)
    if setting.open_low and low == setting.low:
        low += min(hair, HAIR)
    low = LEAST.get(setting.key, low)
    return low, high - (min(hair, HAIR) if setting.open_high and high == setting.high else 0.0)


def _default(setting: Setting) -> float | None:
    """The default as a number, the largest of several; of one that the scene works out, the last number it names."""
    if isinstance(setting.default, tuple):
        return float(setting.default[-1])
    if isinstance(setting.default, int | float):
        return None if math.isinf(setting.default) else float(setting.default)
    named = re.findall(r"\d+(?:\.\d+)?", setting.otherwise)
    return float(named[-1]) if named else None


def _short(setting: Setting, number: float) -> str:
    """Four digits, or all where the range ends between the two."""
    short = f"{number:.4g}"
    try:
        setting.parse(short)
    except UsageError:
        return repr(number)
    return short
