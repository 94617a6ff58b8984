"""Derivatives by differences, fitted orders, rotations."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
import pandas as pd

from formulations.shell import ShellModel

CENTRAL_8 = ((1, 4 / 5), (2, -1 / 5), (3, 4 / 105), (4, -1 / 280))  # weights of the 8th-order central difference


def central_difference(f: Callable[[float], np.ndarray], step: float) -> np.ndarray:
    """df/dt at t = 0, error of the order step^8."""
    return sum(weight * (f(j * step) - f(-j * step)) for j, weight in CENTRAL_8) / step


def fitted_order(sizes: Sequence[float], errors: Sequence[float]) -> float:
    """Slope of log(error) over log(size) by least squares; every error must be positive and finite."""
    errors = np.asarray(errors, float)
    assert np.all(errors > 0)
    assert np.all(np.isfinite(errors))
    return float(np.polyfit(np.log(sizes), np.log(errors), 1)[0])


def difference_order(shell: ShellModel, u: np.ndarray, du: np.ndarray) -> float:
    """Order of central differences of the residual against the tangent; 2 where they agree to rounding."""
    exact, steps = shell.linearise(u).tangent @ du, 0.08 * 2.0 ** -np.arange(6)
    errors = [np.abs((shell.residual(u + s * du) - shell.residual(u - s * du)) / (2 * s) - exact).max() for s in steps]
    return 2.0 if errors[-1] <= 1e-9 * np.abs(exact).max() else fitted_order(steps, errors)


def orders(table: pd.DataFrame, by: Sequence[str], number: str, errors: Sequence[str]) -> pd.DataFrame:
    """Orders of the columns ``errors`` over the column ``number``, a row for each case that ``by`` tells apart."""
    cases = table.groupby(list(by), sort=False)
    rows = [{name: -fitted_order(own[number], own[name].abs()) for name in errors} for _, own in cases]
    return pd.DataFrame(rows)


def rotation(axis: np.ndarray, angle: float) -> np.ndarray:
    """Rotation matrix about the axis (Rodrigues)."""
    x, y, z = axis / np.linalg.norm(axis)
    K = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.eye(3) + np.sin(angle) * K + (1 - np.cos(angle)) * K @ K
