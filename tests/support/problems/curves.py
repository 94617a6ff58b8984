"""Curves of displacements over loads, as points (n, 2)."""

from __future__ import annotations

import numpy as np


def distances(points: np.ndarray, line: np.ndarray) -> np.ndarray:
    """Distance of each point (p, 2) from the polyline (n, 2)."""
    chord = np.diff(line, axis=0)
    from_start = points[:, None] - line[:-1]
    part = np.clip(np.sum(from_start * chord, axis=-1) / np.sum(chord**2, axis=-1), 0, 1)
    return np.min(np.linalg.norm(from_start - part[..., None] * chord, axis=-1), axis=1)
