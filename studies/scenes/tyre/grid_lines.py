"""Grid lines of a tyre: equally spaced, finer in a fixed patch, or spaced as an estimate of the error asks.

Every choice is symmetric about 0 with a node at (0, 0), as the parts of a tyre need it.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from formulations.geometry.grid import graded_lines
from studies.ask.scene import Setting, UsageError

GRADINGS = ("patch", "uniform", "adapted")
SPACING = "spacing of the grid lines: finer in the patch, uniform, or by error estimate"
GRADING = Setting.one_of("grading", GRADINGS, "patch", SPACING)
GROWTH = 1.6  # neighbouring elements differ by no more
STEEPEST = 0.99 * float(np.log(GROWTH))  # |dh/dx| of the size, whose exp is the ratio of neighbours; 1 % for sampling
FLOOR = 0.1  # of the mean error density: a coarse grid does not see all that its largest elements miss
FINE = 4000  # samples of a size along a line


def tyre_lines(mesh: tuple[int, int], clamp_deg: float, grading: str = "patch") -> tuple[np.ndarray, np.ndarray]:
    """Grid lines psi, phi [rad] of an N x M mesh, "uniform" or "patch", that in the proportions of 42x40.

    psi: 12, 18, 12 elements between -clamp, -0.375 clamp, 0.375 clamp, clamp; phi: 11, 18, 11 between -180, -22.5,
    22.5, 180 degrees. Raises UsageError unless both numbers are even, so that a node lies at (0, 0), and at least 6.
    """
    n1, n2 = checked_mesh(mesh)
    if grading == "uniform":
        return _centred(np.linspace(-clamp_deg, clamp_deg, n1 + 1)), _centred(np.linspace(-180, 180, n2 + 1))
    side1, side2 = round(n1 * 12 / 42), round(n2 * 11 / 40)
    middle = 0.375 * clamp_deg
    psi = graded_lines([-clamp_deg, -middle, middle, clamp_deg], [side1, n1 - 2 * side1, side1])
    phi = graded_lines([-180, -22.5, 22.5, 180], [side2, n2 - 2 * side2, side2])
    return _centred(psi), _centred(phi)


def _centred(lines: np.ndarray) -> np.ndarray:
    """Lines in rad of those in degrees; the middle one is 0 to the last digit, for it is an edge of a quarter."""
    return np.deg2rad(0.5 * (lines - lines[::-1]))


def checked_mesh(mesh: tuple[int, int]) -> tuple[int, int]:
    """The mesh; raises UsageError unless both numbers are even and at least 6."""
    n1, n2 = mesh
    if n1 % 2 or n2 % 2 or min(mesh) < 6:
        raise UsageError(f"mesh {n1}x{n2}: both numbers must be even and at least 6")
    return n1, n2


@dataclass(frozen=True, eq=False)
class LineSize:
    """Wanted element size along one half [0, end] of a line, up to a factor, and what an element size costs.

    at (k,): coordinates from 0 to end; shape (k,): the size there, any unit.  error [N]: C in an error C/n^2 when n
    elements are spaced so over both halves.
    """

    at: np.ndarray
    shape: np.ndarray
    error: float

    @classmethod
    def equidistributing(cls, lines: np.ndarray, errors: np.ndarray) -> LineSize:
        """From the errors (n,) [N] of the elements between lines (n + 1,), symmetric about 0 or from there on.

        An element of the size h with the error density e h^2 costs e h^3: the least sum for a given number of elements
        has h ~ e^(-1/3), and is (int e^(1/3) dx)^3/n^2. The two halves are added, and a kernel of [1, 2, 1] smooths e.
        """
        h = np.diff(lines)
        density = errors / h**3
        if lines[0] < -1e-12:
            density, h = (density + density[::-1])[len(h) // 2 :], h[len(h) // 2 :]
        around = np.concatenate([density[:1], density, density[-1:]])
        density = 0.25 * around[:-2] + 0.5 * density + 0.25 * around[2:]
        wanted = np.maximum(density, FLOOR * float(density @ h) / float(np.sum(h)))
        middles = np.cumsum(h) - 0.5 * h
        at = np.linspace(0.0, float(lines[-1]), FINE)
        shape = np.exp(-np.interp(at, middles, np.log(wanted)) / 3)
        error = 4 * float(np.trapezoid(1 / shape, at)) ** 2 * float(density @ (h * wanted ** (-2 / 3)))
        return cls(at, shape, error)

    @classmethod
    def mean(cls, sizes: Sequence[LineSize]) -> LineSize:
        """Geometric mean: where the rim happens to lie between the lines of one grid averages out."""
        shapes = np.array([size.shape / size.shape.mean() for size in sizes])
        errors = np.array([size.error for size in sizes])
        return cls(sizes[0].at, np.exp(np.log(shapes).mean(axis=0)), float(np.exp(np.log(errors).mean())))

    def lines(self, n: int, largest: float) -> np.ndarray:
        """The n + 1 lines from -end to end; neighbours differ by no more than 1.6, sizes stay below ``largest``.

        The size is the largest below c times the wanted one whose slope stays below STEEPEST; c such that n fit.
        """

        def number(c: float) -> np.ndarray:
            size = _gentle(np.minimum(c * self.shape, largest), self.at)
            steps = 0.5 * (1 / size[1:] + 1 / size[:-1]) * np.diff(self.at)
            return np.append(0.0, np.cumsum(steps))

        low, high = -60.0, 60.0  # of ln c: the number falls with it
        for _ in range(100):
            middle = 0.5 * (low + high)
            low, high = (middle, high) if number(float(np.exp(middle)))[-1] > n / 2 else (low, middle)
        count = number(float(np.exp(high)))
        half = np.interp(np.linspace(0.0, count[-1], n // 2 + 1), count, self.at)
        half[-1] = self.at[-1]
        return np.concatenate([-half[:0:-1], half])


def _gentle(size: np.ndarray, at: np.ndarray) -> np.ndarray:
    """The largest function below ``size`` (k,) with a slope of at most STEEPEST at the equally spaced points."""
    rise = STEEPEST * (at - at[0])
    forwards = np.minimum.accumulate(size - rise) + rise
    return np.minimum.accumulate((forwards + rise)[::-1])[::-1] - rise
