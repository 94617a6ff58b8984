"""Dead loads over the area of a shell, and what the linear scenes share."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from formulations.discretisation import Discretisation
from formulations.element.mixed import SHEAR_ROWS
from formulations.element.strain_operator import GAUSS, N_GAUSS
from formulations.section.laminate import Laminate, Ply
from formulations.strains.quantities import N_E
from studies.ask.request import Request
from studies.ask.scene import SOLVER, Setting
from studies.scenes.element import ELEMENT
from studies.scenes.statics import LOAD_FRACTIONS

LOAD_FRACTION = replace(LOAD_FRACTIONS, default=(1.0,))
SHELL_SETTINGS = (
    Setting.positive("shear_correction", 1.0, "factor on the shear stiffness; 1000: Kirchhoff", 1e4),
    *ELEMENT,
    SOLVER,
)


@dataclass(frozen=True)
class ShearCorrected(Laminate):
    """A laminate whose stiffness against the mean transverse shear is multiplied by ``shear_correction``.

    The paper's section has none (factor 1). 5/6 is Reissner's for a homogeneous plate; a factor of 1000 makes a thin
    shell one of Kirchhoff, to tell what of a difference to a thin-shell reference is shear. The DIFFERENCE of the shear
    between the faces is left alone: it is the gradient of the thickness stretch, no shear force belongs to it.
    """

    shear_correction: float = 1.0

    def stiffness(self, section: str = "constant-s33") -> np.ndarray:
        """D (11, 11) [N/mm] of the laminate, the mean of the shears of both faces scaled on either side of D."""
        mean = np.kron(np.eye(2), np.full((2, 2), 0.5))
        scale = np.eye(N_E)
        scale[SHEAR_ROWS, SHEAR_ROWS] += (np.sqrt(self.shear_correction) - 1.0) * mean
        return scale @ super().stiffness(section) @ scale


def centred_laminate(request: Request, *plies: Ply) -> ShearCorrected:
    """The plies about their middle surface with the shear correction asked for."""
    thickness = sum(ply.thickness for ply in plies)
    return ShearCorrected(plies, -0.5 * thickness, request.number("shear_correction"))


def area_load(
    discretisation: Discretisation,
    density: Callable[[np.ndarray, np.ndarray], np.ndarray],
    shares: tuple[float, float] = (0.5, 0.5),
) -> np.ndarray:
    """Consistent nodal forces (N, 6) in the local frames: F_i^r = int N_r (p . e_i) dA with the area dA of mubar.

    ``density(a1, a2)``: dead force per area p, (..., 3) or (3,), in Cartesian components. ``shares`` go to the inner
    and to the outer face. p is projected on the frame at every Gauss point and does work on the displacement that the
    element interpolates there; projecting it at the nodes instead would differ by O(l^2).
    """
    grid = discretisation.grid
    a1, a2 = np.moveaxis(grid.points(GAUSS), -1, 0)
    p = np.broadcast_to(density(a1, a2), (*a1.shape, 3))
    local = np.einsum("...ij,...j->...i", discretisation.surface.frame(a1, a2), p)
    weight = discretisation.geometry.weight / N_GAUSS
    value = np.broadcast_to(discretisation.geometry.value, (len(weight), N_GAUSS, 4, 3, 3))
    nodal = np.einsum("e,egrij,egi->erj", weight, value, local, optimize=True)
    forces = np.zeros((grid.n_nodes, 6))
    for face, share in enumerate(shares):
        np.add.at(forces[:, face::2], grid.elements, share * nodal)
    return forces
