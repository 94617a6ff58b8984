"""Stresses through the wall of a shell with surfaces inside it: by the law, and across the wall by equilibrium.

The law gives all six from the strains of an element. Those across the wall, S13, S23 and S33, are small sums of large
parts there, and jump from ply to ply where the surfaces are few; equilibrium gives them from the stresses in the plane,

    g S13(d) = - int (g S11,1 + S12,2) dd,    g^2 S23(d) = - int (g^2 S12,1 + g S22,2) dd,
    g S33(d) = - p g(d-) - int (g S13,1 + S23,2 - k S22) dd,    g = 1 + k d

from the inner face on, where S_a3 = 0 and S33 = -p, in a wall of the curvature k along a2; ,a are derivatives by
lengths of the reference surface. Both are printed side by side; where they agree either is good. For small
displacements of a plate or a circular cylinder on a tensor grid; derivatives are differences between elements. Nothing
is solved here.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.integrate import cumulative_simpson

from formulations.geometry.grid import TensorGrid
from formulations.shell import ShellModel

POINTS = 9  # in a ply, both sides included
S11, S22, S12, S13, S23, S33 = range(6)


@dataclass(frozen=True, eq=False)
class WallStresses:
    """Means over the elements at distances d (P,) in the plies ply (P,), along the coordinates.

    law (E, P, 6) [MPa]: 11, 22, 12, 13, 23, 33.  equilibrium (E, P, 3) [MPa]: 13, 23, 33.
    """

    d: np.ndarray
    ply: np.ndarray
    law: np.ndarray
    equilibrium: np.ndarray

    @classmethod
    def of(cls, shell: ShellModel, u: np.ndarray, pressure: float = 0.0) -> WallStresses:
        """At the displacements u; pressure [MPa]: on the inner face. Raises ValueError for walls of another shape."""
        discretisation = shell.discretisation
        grid, wall = discretisation.grid, discretisation.wall
        if wall is None:
            raise ValueError("stresses through the wall need surfaces inside it")
        shape = discretisation.surface.geometry(*grid.centre.T)
        k = shape.k[0, 1]
        if not isinstance(grid, TensorGrid) or np.any(shape.k != [0, k]) or np.any(shape.B):
            raise ValueError("equilibrium through the wall is that of a plate or a cylinder on a tensor grid")
        sampling = wall.sampling
        plies = len(sampling.laminate.plies)
        inside = np.linspace(0.0, 1.0, POINTS)
        d = np.array([low + inside * (high - low) for low, high in sampling.ends])
        taken = np.array([sampling.taken(ply, d[ply]) for ply in range(plies)])
        law = shell.wall_stresses(u, taken).reshape(len(grid.elements), plies * POINTS, 6)
        field = law.reshape(*(len(line) - 1 for line in grid.lines), plies, POINTS, 6)
        centres = [0.5 * length * (line[1:] + line[:-1]) for line, length in zip(grid.lines, shape.A[0], strict=True)]
        transverse = np.zeros((*field.shape[:-1], 3))
        g = 1 + k * d
        for a, row in ((0, (S11, S12)), (1, (S12, S22))):
            along = _divergence(g * field[..., row[0]], field[..., row[1]], centres)
            transverse[..., a] = _through(g**a * along, d) / g ** (a + 1)
        inwards = _divergence(g * transverse[..., 0], transverse[..., 1], centres) - k * field[..., S22]
        transverse[..., 2] = (_through(inwards, d) - pressure * g[0, 0]) / g
        ply = np.repeat(np.arange(plies), POINTS)
        return cls(d.ravel(), ply, law, transverse.reshape(len(law), -1, 3))


def _divergence(first: np.ndarray, second: np.ndarray, centres: list[np.ndarray]) -> np.ndarray:
    """first,1 + second,2 (n1, n2, ...) between elements; where there is one element, nothing varies."""
    total = np.zeros_like(first)
    for axis, (field, x) in enumerate(zip((first, second), centres, strict=True)):
        if len(x) > 1:
            total += np.asarray(np.gradient(field, x, axis=axis, edge_order=2 if len(x) > 2 else 1))
    return total


def _through(divergence: np.ndarray, d: np.ndarray) -> np.ndarray:
    """- int of the divergence (..., plies, POINTS) from the inner face to the distances d (plies, POINTS)."""
    integral, start = np.empty_like(divergence), np.zeros(divergence.shape[:-2])
    for ply, at in enumerate(d):
        integral[..., ply, :] = start[..., None] - cumulative_simpson(divergence[..., ply, :], x=at, initial=0.0)
        start = integral[..., ply, -1]
    return integral
