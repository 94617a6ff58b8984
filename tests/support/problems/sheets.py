"""Square sheets of patches."""

from __future__ import annotations

import numpy as np


def sheet(n1: int, n2: int, side: float, height: float, bent: float, *, up: bool) -> tuple[np.ndarray, np.ndarray]:
    """Points (k, 3) and patches (q, 4) of a square sheet z = height + bent (x^2 + y^2/2), which looks up or down."""
    x, y = (grid.ravel() for grid in np.meshgrid(*(np.linspace(-side, side, n + 1) for n in (n1, n2)), indexing="ij"))
    low = (np.arange(n1)[:, None] * (n2 + 1) + np.arange(n2)).ravel()
    quads = low[:, None] + np.array([0, n2 + 1, n2 + 2, 1])
    return np.stack([x, y, height + bent * (x**2 + y**2 / 2)], axis=-1), quads if up else quads[:, ::-1]
