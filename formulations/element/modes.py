"""The modes xi1^r1 xi2^r2 of the mixed element and the strains that each carries (the 2004 paper, eqs 10-13).

Nothing is sampled, projected or integrated here.
"""

from __future__ import annotations

import numpy as np

from formulations.element.strain_operator import GAUSS, N_GAUSS
from formulations.strains.quantities import E33, N_E

# Strain rows carried by each mode (r1, r2); the order of the modes is the order of the 22 mode strains.
MODES = {
    (0, 0): tuple(range(N_E)),
    (0, 1): (0, 1, 6, 7, 10),
    (1, 0): (2, 3, 8, 9, 10),
    (1, 1): (10,),
}
MODE_ROWS = [(mode, row) for mode, rows in MODES.items() for row in rows]
MODE_WEIGHTS = np.array([3.0 ** -(r1 + r2) for (r1, r2), _ in MODE_ROWS])
N_M = len(MODE_WEIGHTS)
E33_MODES = [m for m, (_, row) in enumerate(MODE_ROWS) if row == E33]


def mode_index(mode: tuple[int, int], row: int) -> int:
    """Place of a strain on a mode among the 22."""
    return MODE_ROWS.index((mode, row))


def _on_gauss() -> np.ndarray:
    """(4, 22, 11): the strains at the Gauss points that belong to the modes."""
    at_gauss = np.zeros((N_GAUSS, N_M, N_E))
    for m, ((r1, r2), row) in enumerate(MODE_ROWS):
        at_gauss[:, m, row] = GAUSS[:, 0] ** r1 * GAUSS[:, 1] ** r2
    return at_gauss


ON_GAUSS = _on_gauss()
