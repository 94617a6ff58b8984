"""The modes of an element with surfaces inside its wall.

The strains of every surface lie on modes xi1^r1 xi2^r2, mode by mode, then surface by surface::

    00: all six     01: E11, 2E13, 2E23, E33     10: E22, 2E13, 2E23, E33     11: E33

Those are the modes of :mod:`formulations.element.mixed` and, of 2E23 on 01 and 2E13 on 10, what differs from the mean
through the wall. The mean would lock in bending; without the rest nothing but E_aa, which costs little where elements
are long and surfaces close, would resist directors that alternate from node to node and from surface to surface.

No measure, no law and no displacement may enter here.

How the strains of an element with surfaces inside its wall count where its law is not linear, on all modes but 00.

They count by the lengths that are left, in the energy: with C = 1 + 2E of E11, E22 and E33 on 00 of the same surface,
E33 / C33 and 2E_a3 sqrt((C33 + C33^-2) / (2 C_aa)). The stiffness of a law against 2E_a3 is
(S_aa - S_33)/(C_aa - C_33), of neo-Hooke's mu/C_aa and, under a pressure p on a wall, p/(C_aa C33) more, which the
powers of C33 keep below. With mu alone a ring crushed to a stretch of 0.79 had 28 negative eigenvalues, and a sphere
blown up to twice its radius eight, none of which is one of the wall.

No measure and no law may enter here.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from formulations.element.modal import Stiffness
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


DIRECT, SHEARS = np.array([0, 1, E33]), (3, 4)
REST = [list(rows) for rows in ROWS[1:]]  # of the modes but 00


@dataclass(frozen=True, eq=False)
class Counted:
    """x = s E on the modes but 00; c (3 T,) are E11, E22 and E33 on 00, of every surface.

    strains (e, 15 T): E on 00, x on the rest.  scale, x (e, 9 T, 1): s and x.  slope, bend (e, 9 T, 3 T): the first
    and second derivatives of ln s, which is a sum of functions of one c each.
    """

    strains: np.ndarray
    scale: np.ndarray
    x: np.ndarray
    slope: np.ndarray
    bend: np.ndarray

    @classmethod
    def of(cls, strains: np.ndarray) -> Counted:
        """Of E (e, 15 T); NaN where nothing is left of a length."""
        n, T = len(strains), strains.shape[1] // N_OF_SURFACE
        c = strains[:, : N_ROWS * T].reshape(n, T, N_ROWS)[..., DIRECT]
        of_surfaces = _logarithm_of_shares(1.0 + 2.0 * np.where(c > -0.5, c, np.nan))
        by_row = [
            np.concatenate([each[:, :, rows].reshape(n, T * len(rows), -1) for rows in REST], axis=1)
            for each in of_surfaces
        ]
        onto = np.vstack([np.repeat(np.eye(T), len(rows), axis=0) for rows in REST])[..., None]
        slope, bend = ((onto * each[:, :, None]).reshape(n, len(onto), -1) for each in by_row[1:])
        scale, counted = np.exp(by_row[0]), strains.copy()
        counted[:, N_ROWS * T :] *= scale[..., 0]
        return cls(counted, scale, counted[:, N_ROWS * T :, None], slope, bend)

    def split(self, rows: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Of (e, 15 T, j), a copy of c (e, 3 T, j) and a view of what is not on 00."""
        n = rows.shape[1] // N_OF_SURFACE * N_ROWS
        return rows[:, self._places(n)], rows[:, n:]

    def ahead(self, change: np.ndarray) -> np.ndarray:
        """Change of E on 00 and x (e, 15 T, j) with that of E."""
        counted = change.copy()
        c, rest = self.split(counted)
        rest *= self.scale
        rest += self.x * np.matmul(self.slope, c)
        return counted

    def back(self, resultants: np.ndarray) -> np.ndarray:
        """dW/dE (e, 15 T, j) of those by E on 00 and x: the transpose."""
        counted = resultants.copy()
        _, rest = self.split(counted)
        self.add(counted, np.matmul(self.slope.swapaxes(1, 2), self.x * rest))
        rest *= self.scale
        return counted

    def add(self, rows: np.ndarray, of_c: np.ndarray) -> None:
        """Add what is of c (e, 3 T, j) to (e, 15 T, j)."""
        rows[:, self._places(rows.shape[1] // N_OF_SURFACE * N_ROWS)] += of_c

    @staticmethod
    def _places(n: int) -> np.ndarray:
        return (np.arange(0, n, N_ROWS)[:, None] + DIRECT).ravel()


@dataclass(frozen=True, eq=False)
class CountedStiffness(Stiffness):
    """By E, of blocks by E on 00 and x; resultants (e, 15 T, 1) are of these."""

    counted: Counted
    resultants: np.ndarray

    def times(self, strains: np.ndarray) -> np.ndarray:
        """(e, 15 T, j) of (e, 15 T, j)."""
        counted = self.counted
        ahead = counted.ahead(strains)
        product = counted.back(super().times(ahead))
        (c, _), (_, x), (_, rest), (_, G) = map(counted.split, (strains, ahead, product, self.resultants))
        rest += G * counted.scale * np.matmul(counted.slope, c)
        curved = np.matmul(counted.bend.swapaxes(1, 2), G * counted.x)
        counted.add(product, np.matmul(counted.slope.swapaxes(1, 2), G * x) + curved * c)
        return product


def _logarithm_of_shares(C: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """ln s (e, T, 6, 1) of the strains of a surface, and both its derivatives (e, T, 6, 3) by E11, E22, E33.

    C (e, T, 3): 1 + 2E of these.
    """
    value, slope, bend = (np.zeros((*C.shape[:2], N_ROWS, k)) for k in (1, 3, 3))
    of_normal = C[..., 2]
    square = of_normal**2
    value[..., E33, 0] = -np.log(of_normal)
    slope[..., E33, 2], bend[..., E33, 2] = -2 / of_normal, 4 / square
    grown = 0.5 * (of_normal + 1 / square)
    first, second = 0.5 * (1 - 2 / of_normal**3) / grown, 3 / square**2 / grown
    for a, row in enumerate(SHEARS):
        value[..., row, 0] = 0.5 * np.log(grown / C[..., a])
        slope[..., row, a], bend[..., row, a] = -1 / C[..., a], 2 / C[..., a] ** 2
        slope[..., row, 2], bend[..., row, 2] = first, 2 * (second - first**2)
    return value, slope, bend
