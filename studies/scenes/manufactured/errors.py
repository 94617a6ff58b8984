"""Distances between what a mesh has found and the exact solution, relative, in the norms that have orders.

No load and no solver enters here.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping

import numpy as np

from formulations.element.mixed import MODE_ROWS
from formulations.element.strain_operator import GAUSS, N_GAUSS
from formulations.shell import ShellModel
from formulations.strains.quantities import N_E
from studies.scenes.manufactured.solution import Solution

QUANTITIES: Mapping[str, str] = {
    "error_displacement": "relative L2 error of the displacements of both faces",
    "error_resultants": "relative error of the resultants in the elements",
    "error_mean_resultants": "relative error of the mean resultants of the elements",
    "error_energy": "relative error in the norm of energy",
}
ON_GAUSS = np.zeros((N_GAUSS, len(MODE_ROWS), N_E))  # strains at the Gauss points from the mode strains
for _mode, ((_r1, _r2), _row) in enumerate(MODE_ROWS):
    ON_GAUSS[:, _mode, _row] = GAUSS[:, 0] ** _r1 * GAUSS[:, 1] ** _r2


def errors(shell: ShellModel, u: np.ndarray, exact: Solution) -> dict[str, float]:
    """Relative errors of a state u (n,), by integrals over the mid surface.

    error_displacement: L2 norm of both faces.  error_resultants: L2 norm of H = D E at the Gauss points;
    error_mean_resultants: of the means of the elements, against the exact values at their centres.  error_energy: the
    energy norm sqrt(int dE D dE/2) of the strains at the Gauss points.
    """
    geometry, grid = shell.discretisation.geometry, shell.discretisation.grid
    points, weight, D = grid.points(GAUSS), geometry.weight[:, None], exact.stiffness
    modes = shell.mode_strains(u)
    displacement = interpolated(shell, u), exact.displacement(points)
    strains = np.einsum("gmn,em->egn", ON_GAUSS, modes), exact.strains(points)
    means = modes[:, :N_E], exact.strains(grid.centre)
    return {
        "error_displacement": relative(displacement, lambda u: weight * np.sum(u**2, axis=(-2, -1))),
        "error_resultants": relative(strains, lambda E: weight * np.sum((E @ D.T) ** 2, axis=-1)),
        "error_mean_resultants": relative(means, lambda E: geometry.weight * np.sum((E @ D.T) ** 2, axis=-1)),
        "error_energy": relative(strains, lambda E: weight * np.sum(E * (E @ D.T), axis=-1)),
    }


def relative(pair: tuple[np.ndarray, np.ndarray], square: Callable[[np.ndarray], np.ndarray]) -> float:
    """Norm of what was found less what is exact, over that of the exact; ``square``: the terms of its square."""
    found, exact = pair
    return float(np.sqrt(np.sum(square(found - exact)) / np.sum(square(exact))))


def interpolated(shell: ShellModel, u: np.ndarray) -> np.ndarray:
    """Cartesian displacements of both faces at the Gauss points, (E, 4, 2, 3)."""
    discretisation = shell.discretisation
    points = discretisation.grid.points(GAUSS)
    frame = discretisation.surface.frame(points[..., 0], points[..., 1])
    v = shell.displacements(u)[discretisation.grid.elements].reshape(-1, 4, 3, 2)
    value = np.broadcast_to(discretisation.geometry.value, (len(v), N_GAUSS, 4, 3, 3))
    return np.einsum("egrij,erjf,egix->egfx", value, v, frame, optimize=True)
