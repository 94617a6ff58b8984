"""Recovery of smoother displacements, and what their strains say of the error of the elements.

Cubics through the nodal displacements on four lines, along one coordinate at a time, are closer to the truth than their
linear interpolation; their strains E*, taken by elements a few times shorter along that coordinate, are set against the
strains E of the elements in the norm of D::

    |dE|^2 = sum over the parts of the element of w dE . D dE,    dE = E* - E

This is the idea of Zienkiewicz and Zhu (IJNME 24 (1987) 337-357) with the displacements recovered, not the stresses: a
curved element that moves rigidly feels a strain of the order of its length squared (see
:class:`formulations.element.strain_operator.ElementGeometry`), its neighbours feel the same, and no average of strains
shows it. No contact and no scene may enter here.
"""

import numpy as np

from formulations.geometry.grid import TensorGrid
from formulations.geometry.transfer import Transfer
from formulations.shell import ShellModel
from formulations.strains.quantities import N_E

PARTS = 3  # of an element, along the coordinate


def refined(lines: np.ndarray) -> np.ndarray:
    """The lines with every interval cut in PARTS."""
    return np.interp(np.arange(PARTS * (len(lines) - 1) + 1) / PARTS, np.arange(len(lines)), lines)


def recovery_errors(
    shell: ShellModel, u: np.ndarray, finer: ShellModel, axis: int, around: tuple[TensorGrid, np.ndarray] | None = None
) -> np.ndarray:
    """The dE (E, PARTS, 11) of the displacements u of the shell.

    finer: the same shell on the grid whose lines along a_{axis+1} are :func:`refined`.  around: a grid that goes on
    beyond the seams of a part, and the displacements (N, 6) of its nodes; without one, cubics are one-sided there.
    """
    grid = shell.discretisation.grid
    assert isinstance(grid, TensorGrid)
    here, v = around or (grid, shell.nodal_displacements(u))
    smooth_v = Transfer(here, finer.discretisation.grid).nodal(v)
    smooth = finer.mean_strains(finer.discretisation.map.restrict_nodal(smooth_v))
    counts = [n - 1 + (axis_ == 1 and grid.periodic) for axis_, n in enumerate(grid.node_shape)]
    cut = smooth.reshape(counts[0], PARTS, counts[1], N_E) if axis == 0 else smooth.reshape(*counts, PARTS, N_E)
    parts = np.moveaxis(cut, axis + 1, 2).reshape(-1, PARTS, N_E)
    middles = np.zeros((PARTS, 2))
    middles[:, axis] = (2 * np.arange(PARTS) + 1) / PARTS - 1
    return parts - shell.strains_at(u, middles)


def energy_products(shell: ShellModel, first: np.ndarray, second: np.ndarray) -> np.ndarray:
    """|dE| |dE'| (E,) [N mm] of two fields of :func:`recovery_errors`, with the symmetric part of D."""
    D = shell.discretisation.laminate.stiffness(shell.section)
    weight = shell.discretisation.geometry.weight / PARTS
    squares = [weight * np.einsum("epi,ij,epj->e", d, 0.5 * (D + D.T), d) for d in (first, second)]
    return np.sqrt(np.maximum(squares[0], 0.0) * np.maximum(squares[1], 0.0))
