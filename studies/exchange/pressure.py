"""Nodal forces of a pressure on the inner faces of bricks, on their rest or on their deformed area."""

from __future__ import annotations

import numpy as np

from formulations.solid_mesh import SQUARE
from studies.exchange.bricks import CENTRE, INNER, RING, Bricks, serendipity
from studies.exchange.problem import LoadStep, Problem


def area_forces(bricks: Bricks, pressure: np.ndarray, u: np.ndarray | None = None) -> np.ndarray:
    """Forces (N, 3) [N]: int N_r p n dA of pressures p (F,) [MPa] over the inner faces, displaced by u (N, 3)."""
    mesh = bricks.mesh
    face = mesh.elements[bricks.inner][:, 0::3]
    ring = bricks.of_mesh[face[:, RING]]
    x = mesh.x.copy()
    if u is not None:
        x[face[:, RING]] += u[ring]
    x[face[:, len(RING) // 2]] = np.einsum("r,frx->fx", CENTRE, x[face[:, RING]])
    _, area = mesh.area_vectors(x, face)
    value = serendipity(*(2 * SQUARE.points - 1).T)
    forces = np.zeros_like(bricks.x)
    np.add.at(forces, ring, np.einsum("f,g,gr,fgx->frx", pressure, SQUARE.weights, value, area))
    return forces


def pressure_forces(problem: Problem, step: LoadStep, u: np.ndarray | None) -> np.ndarray | None:
    """Those of the pressure of a step, on the area displaced by u (N, 3) where displacements are large.

    None where u is wanted and not known at all nodes of the inner faces.
    """
    bricks = problem.bricks
    if not step.pressure.any():
        return np.zeros_like(bricks.x)
    if not problem.nonlinear:
        return area_forces(bricks, step.pressure)
    if u is None or not np.all(np.isfinite(u[bricks.face_nodes(INNER)])):
        return None
    return area_forces(bricks, step.pressure, u)
