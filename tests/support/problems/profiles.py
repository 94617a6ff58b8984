"""The height of a profile, written down otherwise than by its pieces."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np


def rounded_height(corners: list[tuple[float, float]], radius: float) -> Callable[[np.ndarray], np.ndarray]:
    """Height t(s) of the same profile written with circles found by their touching both lines, flanks under 90."""
    v = [np.array(c, float) for c in corners]
    far = 50.0
    points = [v[0] - [far, 0], *v, v[-1] + [far, 0]]
    parts = []
    for before, at, after in zip(points[:-2], points[1:-1], points[2:], strict=True):
        a, b = (before - at) / np.linalg.norm(before - at), (after - at) / np.linalg.norm(after - at)
        bisector = (a + b) / np.linalg.norm(a + b)
        centre = at + radius / math.sqrt((1 - a @ b) / 2) * bisector  # sine of half the inner angle
        touch = sorted([(at + ((centre - at) @ a) * a)[0], (at + ((centre - at) @ b) * b)[0]])
        parts.append((touch, centre, np.sign(-bisector[1])))

    def height(s: np.ndarray) -> np.ndarray:
        t = np.interp(s, [p[0] for p in points], [p[1] for p in points])
        for (low, high), centre, sign in parts:
            on = (s >= low) & (s <= high)
            t[on] = centre[1] + sign * np.sqrt(np.maximum(radius**2 - (s[on] - centre[0]) ** 2, 0))
        return t

    return height
