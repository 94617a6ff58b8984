"""Whether short waves on the wall of a pressed tyre still cost energy where the foundation does not hold it.

Cords of 510 MPa in rubber of 2 MPa: where the wall is bent beside the patch, its faces are compressed by more than the
shear of the rubber resists. Beyond that travel the problem has no length of its own (:mod:`formulations.short_waves`),
and the limit point of a pressed tyre moves down with every refinement of the grid.
"""

from __future__ import annotations

import numpy as np

from formulations.shell import ShellModel
from formulations.short_waves import short_waves
from studies.scenes.tyre.parts import Part

CLAMPED = 0.85  # of the clamp angle: beyond it the clamp decides


def beside_the_patch(shell: ShellModel, part: Part, u: np.ndarray, touching: np.ndarray) -> dict[str, float]:
    """Least stiffness of short waves [N/mm] over the elements without a node in contact, and where it is [deg].

    touching: nodes of the part's grid in contact.  The neighbourhood of the clamp is left out.
    """
    grid, own = part.grid, part.merging()
    held = np.zeros(grid.n_nodes, bool)
    held[touching] = True
    free = ~held[own][grid.elements].any(axis=1)
    free &= np.abs(grid.centre[:, 0]) < CLAMPED * np.max(np.abs(grid.nodes[:, 0]))
    least = short_waves(shell, u).least
    at = np.flatnonzero(free)[np.argmin(least[free])]
    psi, phi = np.rad2deg(np.abs(grid.centre[at]))
    return {"short_wave_N_mm": float(least[at]), "short_wave_psi_deg": float(psi), "short_wave_phi_deg": float(phi)}
