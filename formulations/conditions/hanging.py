"""Hanging nodes: what carries their displacements, and where the forces on them go.

The ends b, c of an edge carry its middle a, face by face. Where components in the local frames are interpolated,
v_a = (v_b + v_c)/2 is conforming; where Cartesian displacements are, v_a = T_a (T_b^T v_b + T_c^T v_c)/2, the rows of T
being the directions of a frame. No stiffness enters here.
"""

from __future__ import annotations

import numpy as np
from scipy import sparse

from formulations.geometry.grid import Grid
from formulations.geometry.surfaces import Surface
from formulations.strains.quantities import N_V


def carried(grid: Grid, surface: Surface, interpolation: str) -> sparse.csr_matrix | None:
    """v = carried w, (6N, 6N), of the displacements w of the nodes that do not hang; None where none hangs."""
    if grid.hanging is None:
        return None
    whole = sparse.kron(grid.hanging.shares, sparse.eye(N_V), format="csr")
    if interpolation == "isoparametric":
        frames = surface.frame(*grid.nodes.T)  # (N, i, x)
        turn: sparse.csr_matrix = sparse.csr_matrix(sparse.block_diag([np.kron(frame, np.eye(2)) for frame in frames]))
        # of the hanging alone: the rows of all others stay exactly those of the identity
        hangs = sparse.diags(np.isin(np.arange(grid.n_nodes), grid.hanging.nodes).repeat(N_V).astype(float))
        whole = whole - hangs @ whole + hangs @ (turn @ whole @ turn.T)
    whole = sparse.csr_matrix(whole)
    whole.eliminate_zeros()
    return whole
