"""What each element adds to the error of a quantity, from the same state on a grid and on the next finer one.

With dE the strains on the finer grid less those here, dE_z those of the dual displacements, w areas, and the pressures
p, p_z and gaps g, g_z of both problems::

    J - J_h = sum over parts of w (dE . D dE_z + p_z dg + p dg_z),    eta: the same with |dE|_D |dE_z|_D and |..|

the dual-weighted residual, with the finer grid for the truth: pressures of one grid meet gaps of the other where the
rim of the patch moves. So it is where strains are those of the displacements. Projected ones depend on the grid in
other ways, too, and so do surfaces: the sum is 1.9 (J' - J) on Pagano's plate, and 0.12 (J' - J) on Scordelis and Lo's
roof. It says where to cut, and falls as the error does; how large that is, it does not say. No scene may enter here.
"""

from __future__ import annotations

import numpy as np

from formulations.element.mixed import MODE_ROWS
from formulations.geometry.grid import CORNERS
from formulations.strains.quantities import N_E
from studies.solving.refinement.goal import OnGrid


def indicators(coarse: OnGrid, fine: OnGrid, parents: np.ndarray) -> tuple[np.ndarray, float]:
    """eta (E,) of the coarse elements [unit of J], and what the rim of the patch has of their sum.

    parents: the coarse element that each fine one is a part of.
    """
    grid, parts = coarse.shell.discretisation.grid, fine.shell.discretisation.grid
    xi = (parts.centre - grid.centre[parents]) / grid.half[parents]
    D = fine.shell.discretisation.laminate.stiffness(fine.shell.section)
    norms = []
    for here, there in zip(_strains(coarse), _strains(fine), strict=True):
        d = there[:, :N_E] - _at(here[parents], xi)
        norms.append(np.sqrt(np.maximum(np.einsum("ei,ij,ej->e", d, 0.5 * (D + D.T), d), 0.0)))
    weight, rim = fine.shell.discretisation.geometry.weight, np.abs(_at_rim(coarse, fine, parents))
    eta = np.bincount(parents, weights=weight * (norms[0] * norms[1] + rim), minlength=len(grid.elements))
    return eta.astype(float), float(weight @ rim)


def dorfler(eta: np.ndarray, share: float) -> np.ndarray:
    """The fewest elements (E,) bool whose eta add up to a share of all (Dörfler, SIAM J. Numer. Anal. 33 (1996))."""
    order = np.argsort(-eta, kind="stable")
    count = int(np.searchsorted(np.cumsum(eta[order]), share * eta.sum())) + 1
    marked = np.zeros(len(eta), bool)
    marked[order[:count]] = True
    return marked


def _at_rim(coarse: OnGrid, fine: OnGrid, parents: np.ndarray) -> np.ndarray:
    """p_z dg + p dg_z (e,) of the fine elements [unit of J/mm^2]."""
    grid, parts = coarse.shell.discretisation.grid, fine.shell.discretisation.grid
    xi = (parts.points(CORNERS) - grid.centre[parents][:, None]) / grid.half[parents][:, None]
    shares = 0.25 * np.prod(1 + xi[:, :, None] * CORNERS, axis=-1)  # (e, corner, corner of the parent)
    pressure, gap, dual_pressure, dual_gap = (
        (there, here)
        for there, here in zip(
            np.einsum("ecr,ker->kec", shares, coarse.contact[:, grid.elements[parents]]),
            fine.contact[:, parts.elements],
            strict=True,
        )
    )
    met = dual_pressure[1] * (gap[0] - gap[1]) + pressure[0] * (dual_gap[1] - dual_gap[0])
    return np.asarray(met.mean(axis=-1))


def _strains(at: OnGrid) -> tuple[np.ndarray, np.ndarray]:
    """Mode strains (E, 22) of the displacements, and their change along the dual ones."""
    return at.shell.mode_strains(at.u), at.shell.strain_change(at.u, at.z)


def _at(modes: np.ndarray, xi: np.ndarray) -> np.ndarray:
    """The strains (k, 11) at the points xi (k, 2) of elements with the mode strains (k, 22)."""
    found = np.zeros((len(modes), N_E))
    for m, ((r1, r2), row) in enumerate(MODE_ROWS):
        found[:, row] += modes[:, m] * xi[:, 0] ** r1 * xi[:, 1] ** r2
    return found
