"""Loads along grid lines: consistent nodal forces of dead tractions, and the lengths that share out couples.

Lines may be curved and unequally divided. Forces are data, (N, 6) in the local frames; what follows the shell is in
:mod:`formulations.loads.pressure`.
"""

from collections.abc import Callable

import numpy as np

from formulations.discretisation import Discretisation
from formulations.geometry.grid import QuadGrid

Traction = Callable[[np.ndarray, np.ndarray], np.ndarray]
_POINTS = np.array([-1.0, 1.0]) / np.sqrt(3.0)
_SHAPE = 0.5 * np.stack([1 - _POINTS, 1 + _POINTS], axis=-1)  # (point, end)


def edge_force(
    discretisation: Discretisation,
    axis: int,
    value: float,
    traction: Traction,
    shares: tuple[float, float] = (0.5, 0.5),
) -> np.ndarray:
    """Nodal forces (N, 6) of a dead traction on the line a_{axis+1} = value: F^r = int N_r t ds.

    ``traction(a1, a2)``: force per length of the mid surface t (..., 3) [N/mm] in Cartesian components. ``shares`` go
    to the inner and to the outer face; (-1, 1) with a tangential t is a dead couple of t h. Two Gauss points an
    element. A curvilinear element interpolates components in the turning frame, so t is taken in the frame at every
    Gauss point; an isoparametric one interpolates Cartesian components, so the nodal sum is. Raises ValueError when
    the grid has no such line.
    """
    ends, a1, a2, length = _segments(discretisation, axis, value)
    t = np.broadcast_to(traction(a1, a2), (*a1.shape, 3))
    surface, nodes = discretisation.surface, discretisation.grid.nodes
    if discretisation.geometry.interpolation != "curvilinear":
        at_ends = surface.frame(nodes[ends, 0], nodes[ends, 1])
        nodal = np.einsum("eg,gr,erix,egx->eri", length, _SHAPE, at_ends, t)
    else:
        nodal = np.einsum("eg,gr,egix,egx->eri", length, _SHAPE, surface.frame(a1, a2), t)
    forces = np.zeros((len(nodes), 6))
    for face, share in enumerate(shares):
        np.add.at(forces[:, face::2], ends, share * nodal)
    return forces


def edge_lengths(discretisation: Discretisation, axis: int, value: float) -> tuple[np.ndarray, np.ndarray]:
    """Nodes (m,) of the line a_{axis+1} = value and the lengths int N_r ds (m,) of the mid surface they carry.

    A couple of M per length is ``Couples(nodes, M * lengths, axes, h)``. Raises ValueError when there is no such line.
    """
    ends, _, _, length = _segments(discretisation, axis, value)
    full = np.bincount(ends.ravel(), weights=(length @ _SHAPE).ravel(), minlength=discretisation.grid.n_nodes)
    nodes = np.unique(ends)
    return nodes, full[nodes]


def _segments(
    discretisation: Discretisation, axis: int, value: float
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Nodes (s, 2) of the line's element sides; a1, a2 (s, 2) of their Gauss points and lengths (s, 2) of these.

    Of an inner line the sides of the elements before it, so that every side counts once. ds = A_g (1 + k_g dbar) da_g.
    """
    grid, laminate = discretisation.grid, discretisation.laminate
    along = 1 - axis
    slack = 1e-9 * float(np.ptp(grid.nodes[:, axis]))
    after, before = (np.abs(grid.centre[:, axis] + s * grid.half[:, axis] - value) <= slack for s in (-1, 1))
    which, corners = (before, ((1, 2), (3, 2))) if before.any() else (after, ((0, 3), (0, 1)))
    if not which.any():
        raise ValueError(f"the grid has no line a{axis + 1} = {value:g}")
    a = np.full((2, int(which.sum()), 2), value)
    middle, half = grid.centre[which, along], grid.half[which, along]
    if isinstance(grid, QuadGrid):  # the rectangle around an element is longer than its side
        ends = grid.corners[which][:, corners[axis], along]
        middle, half = ends.mean(axis=1), 0.5 * np.abs(ends[:, 1] - ends[:, 0])
    a[along] = middle[:, None] + half[:, None] * _POINTS
    geometry = discretisation.surface.geometry(a[0], a[1])
    d_bar = 0.5 * (laminate.d_minus + laminate.d_plus)
    stretch = geometry.A[..., along] * (1 + geometry.k[..., along] * d_bar)
    return grid.elements[which][:, corners[axis]], a[0], a[1], half[:, None] * stretch
