"""The modes of an element with surfaces inside its wall.

The strains of every surface lie on modes xi1^r1 xi2^r2, mode by mode, then surface by surface::

    00: all six     01: E11, 2E13, 2E23, E33     10: E22, 2E13, 2E23, E33     11: E33

Those are the modes of :mod:`formulations.element.mixed` and, of 2E23 on 01 and 2E13 on 10, what differs from the mean
through the wall. The mean would lock in bending; without the rest nothing but E_aa, which costs little where elements
are long and surfaces close, would resist directors that alternate from node to node and from surface to surface.

No measure, no law and no displacement may enter here.
"""

from itertools import pairwise

import numpy as np

from formulations.element.strain_operator import GAUSS
from formulations.geometry.grid import CORNERS
from formulations.section.sampling import IN_VOIGT

ROWS_OF_MODE = {(0, 0): (0, 1, 2, 3, 4, 5), (0, 1): (0, 3, 4, 5), (1, 0): (1, 3, 4, 5), (1, 1): (5,)}
POWERS, ROWS = list(ROWS_OF_MODE), list(ROWS_OF_MODE.values())
N_ROWS, N_OF_SURFACE = len(IN_VOIGT), sum(map(len, ROWS))
FACTORS = np.array([3.0 ** (r1 + r2) for r1, r2 in POWERS])
ON_GAUSS, ON_CORNERS = (np.array([at[:, 0] ** r1 * at[:, 1] ** r2 for r1, r2 in POWERS]) for at in (GAUSS, CORNERS))
E33 = N_ROWS - 1  # the last row of every mode
OF_E33 = np.cumsum([len(rows) for rows in ROWS]) - 1


def mode_slices(T: int) -> list[slice]:
    """Where the modes of T surfaces lie among 15 T."""
    ends = np.cumsum([0, *(T * len(rows) for rows in ROWS)]).tolist()
    return [slice(start, end) for start, end in pairwise(ends)]


def strains_at(strains: np.ndarray, at: np.ndarray) -> np.ndarray:
    """Strains (e, p, T, 6) of mode strains (e, 15 T) at p points where the modes have the values ``at`` (4, p)."""
    T = strains.shape[1] // N_OF_SURFACE
    strain = np.zeros((len(strains), at.shape[1], T, N_ROWS))
    for rows, values, block in zip(ROWS, at, mode_slices(T), strict=True):
        of_mode = strains[:, None, block].reshape(len(strains), 1, T, len(rows))
        for column, row in enumerate(rows):
            strain[..., row] += values[:, None] * of_mode[..., column]
    return strain


def by_mode(of_surfaces: np.ndarray) -> np.ndarray:
    """(e, 15 T, ...) of (e, T, 15, ...)."""
    n, _, _, *rest = of_surfaces.shape
    parts = np.split(of_surfaces, OF_E33[:-1] + 1, axis=2)
    return np.concatenate([part.reshape(n, -1, *rest) for part in parts], axis=1)


def by_surface(modes: np.ndarray, T: int) -> np.ndarray:
    """(e, T, 15) of (e, 15 T)."""
    return np.concatenate([modes[:, block].reshape(len(modes), T, -1) for block in mode_slices(T)], axis=2)


def on_every_surface(block: slice, mode: int, column: int) -> slice:
    """One row of a mode."""
    return slice(block.start + column, block.stop, len(ROWS[mode]))
