"""Motions of single elements that no shear resists: what would resist them, and in which elements a state drives them.

The mixed element has 2E12 on the mode 00 alone. So v_g = a xi1 xi2 of its faces, along a side of the length b, costs no
shear; E_gg on its linear mode resists it, with M (2, 2) of both faces ~ D/b^2, and the stress along the other side, of
the length l, drives it by its geometric stiffness G ~ H/l^2. Where the drive rho, the largest eigenvalue of -M^-1 G, is
above 1, such motions release energy, though the shell's would not. For nu = 0 this is a strain of (l/b)^2/3 in membrane
compression, where the faces move apart, and of 1.73 (l/b)^2 of the face in bending. Elements cut in n along b have
rho/n^2. Where elements are curved, or too large for the state, they are driven together with others at less.

Such motions alternate: neighbours along l share the nodes, so that the shear that is left out, gamma xi_g, has opposite
signs in them. Its alternating part, with the stiffness D of 2E12::

    1/2 sum over neighbours of w (gamma' - gamma)/2 . D (gamma' - gamma)/2

costs them three times all of it, which stops them below strains of 6 G/E, and beside point loads, where they lack other
shears, too (those of a semi-cylinder on 16 x 8 elements stop between 1.5 and 3 times). Of a wave over n elements it is
the share sin^2(pi/n) of the whole, of (gamma' + gamma)/2 and it: a motion alternates that no eight elements resolve.
Measured: up to 0.14 of roofs just beyond their limit points on 8 x 8 elements, 0.94 to 1 of strips and hemispheres with
elements 10 to 60 times longer than wide, 0.2 and 0.85 of a tyre on 8 x 8 elements, which is stable on finer ones.

Sources: Wriggers, Reese, CMAME 135 (1996) 201-209; Armero, IJNME 49 (2000) 1-40, on hourglass modes of enhanced and
mixed elements under compression. No contact and no count of eigenvalues may enter here.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy import sparse

from formulations.element.mixed import N_M
from formulations.element.strain_operator import GAUSS, N_DOF, N_GAUSS, mid_lines
from formulations.geometry.grid import CORNERS, Grid, QuadGrid, TensorGrid
from formulations.geometry.nested_dissection import dissection, each_last
from formulations.geometry.surfaces import NodalSurface
from formulations.shell import ShellModel
from formulations.strains.quantities import N_E, N_Q, N_V, STRAINS

SHEAR = [STRAINS.index(name) for name in ("2E12-", "2E12+")]
SHARE = np.sin(np.pi / 8) ** 2  # of the shear that is left out, above which a motion alternates
ALTERNATING = CORNERS.prod(axis=1)  # xi1 xi2 at the corners
LOW, HIGH = ((0, 3), (0, 1)), ((1, 2), (3, 2))  # corners of the first and the last side of an element along a1, a2


@dataclass(frozen=True, eq=False)
class ElementModes:
    """What the elements of a shell leave out of the tangent at u (n,)."""

    shell: ShellModel
    u: np.ndarray

    @cached_property
    def stiffness(self) -> tuple[sparse.csc_matrix, sparse.csc_matrix]:
        """(n, n) of the alternating shear that motions along a1 and along a2 lack [N/mm]."""
        first, second = (sparse.csc_matrix(gamma.T @ (D @ gamma)) for gamma, _, D in self._shear)
        return first, second

    @cached_property
    def order(self) -> np.ndarray | None:
        """Unknowns (n,) in an order in which the tangent with all of that fills in least; None where none is known.

        The shear couples neighbours: no single line of nodes separates them.
        """
        grid, dof_map = self.shell.discretisation.grid, self.shell.discretisation.map
        shape = grid.node_shape if isinstance(grid, TensorGrid | QuadGrid) else None
        if shape is None or not self.shell.ordered:
            return None
        parts = np.split(dof_map.number, [dof_map.n_faces])
        number = np.hstack([each.reshape(grid.n_nodes, -1) for each in parts])
        first = np.full(dof_map.n + 1, grid.n_nodes)  # node of each unknown; the last one is none
        np.minimum.at(first, number, np.arange(grid.n_nodes)[:, None])
        follows = (first[number] != np.arange(grid.n_nodes)[:, None]) & (number >= 0)
        tied = np.union1d(np.flatnonzero(follows.any(axis=1)), first[number[follows]])  # they share unknowns
        nodes = dissection(shape, periodic=grid.periodic, last=tied, lines=2)
        unknowns = number[nodes].ravel()
        return each_last(unknowns[unknowns >= 0])

    def alternating(self, modes: np.ndarray) -> int:
        """How many of the motions that the modes (n, k) span alternate."""
        share = np.zeros(2 * modes.shape[1:])
        for alternating, mean, D in self._shear:
            a, m = alternating @ modes, mean @ modes
            share += (1 - SHARE) * a.T @ (D @ a) - SHARE * m.T @ (D @ m)
        return int(np.sum(np.linalg.eigvalsh(share) > 0))

    @cached_property
    def drive(self) -> np.ndarray:
        """rho (E, 2) of motions along a1 and along a2, 0 where the stress holds them."""
        shell, h = self.shell, _hourglass(self.shell, self.u)
        unstressed = np.zeros((len(h), N_M))
        if shell.initial is not None:
            unstressed[:, :N_E] -= shell.initial
        whole, M = (_along(h, shell.element_contributions(self.u, memory)[2]) for memory in (None, unstressed))
        rho = np.linalg.eigvals(np.linalg.solve(M, M - whole)).real.max(axis=-1)
        return np.asarray(np.maximum(rho, 0.0))

    @property
    def cuts(self) -> tuple[int, int]:
        """In how many parts elements are to be cut along a1 and a2 to have rho < 1."""
        first, second = (int(np.sqrt(worst)) + 1 for worst in self.drive.max(axis=0))
        return first, second

    @property
    def aspect(self) -> float:
        """Of the elements with rho > 1: the largest length along a motion over the other; 0 where there are none."""
        grid, surface = self.shell.discretisation.grid, self.shell.discretisation.surface
        if isinstance(surface, NodalSurface):
            length = 0.5 * np.linalg.norm(mid_lines(surface.middle[grid.elements]), axis=-1)
        else:
            length = grid.half * surface.geometry(*grid.centre.T).A
        return float(np.max((length / length[:, ::-1])[self.drive > 1], initial=0.0))

    @cached_property
    def _shear(self) -> tuple[tuple[sparse.csr_matrix, sparse.csr_matrix, sparse.csr_matrix], ...]:
        return _shear_left_out(self.shell, self.u, 0), _shear_left_out(self.shell, self.u, 1)


def _hourglass(shell: ShellModel, u: np.ndarray) -> np.ndarray:
    """Displacements (E, 2, 2, 24): xi1 xi2 along the deformed sides a1 and a2, of the faces - and +."""
    q = _gradients(shell, u).mean(axis=1)
    h = np.zeros((len(q), 2, 2, len(CORNERS), N_V))
    for axis in (0, 1):
        for face in (0, 1):
            lam, om, th = (q[:, 6 * axis + 2 * row + face] for row in range(3))
            side = np.stack([*((1 + lam, om) if axis == 0 else (om, 1 + lam)), -th], axis=-1)
            h[:, axis, face, :, face::2] = ALTERNATING[:, None] * side[:, None]
    return h.reshape(len(q), 2, 2, N_DOF)


def _along(h: np.ndarray, tangent: np.ndarray) -> np.ndarray:
    """Symmetric part of h K h (E, 2, 2, 2) of element tangents (E, 24, 24)."""
    K = np.einsum("eafi,eij,eagj->eafg", h, tangent, h, optimize=True)
    return np.asarray(0.5 * (K + K.swapaxes(-1, -2)))


def _shear_left_out(
    shell: ShellModel, u: np.ndarray, axis: int
) -> tuple[sparse.csr_matrix, sparse.csr_matrix, sparse.csr_matrix]:
    """Of 2E12 on xi_{axis+1}: half the difference and the mean (2 k, n) of each two neighbours across, and w D."""
    discretisation, B = shell.discretisation, _shear_modes(shell, u, axis)
    columns = np.repeat(discretisation.dofs, len(SHEAR), axis=0).ravel()
    shape = (len(SHEAR) * len(B), N_V * discretisation.grid.n_nodes)
    rows = sparse.csr_matrix((B.ravel(), columns, N_DOF * np.arange(shape[0] + 1)), shape=shape)
    gamma = rows @ discretisation.at(shell.displacements(u)).map.matrix()
    pairs = neighbours(discretisation.grid, 1 - axis)
    one, other = (
        sparse.csr_matrix(gamma[(len(SHEAR) * side[:, None] + np.arange(len(SHEAR))).ravel()]) for side in pairs.T
    )
    weight, D = discretisation.geometry.weight[pairs].mean(axis=1), discretisation.stiffness(shell.section)
    D = D if D.ndim == 2 else D.mean(axis=1)[pairs].mean(axis=1)
    D = D[..., SHEAR, :][..., SHEAR]
    blocks = weight[:, None, None] * (0.5 * (D + D.swapaxes(-1, -2)))
    places = np.arange(len(blocks) + 1)
    resists = sparse.csr_matrix(sparse.bsr_matrix((blocks, places[:-1], places), shape=2 * (len(SHEAR) * len(blocks),)))
    return sparse.csr_matrix((other - one) / 2), sparse.csr_matrix((other + one) / 2), resists


def _shear_modes(shell: ShellModel, u: np.ndarray, axis: int) -> np.ndarray:
    """Change (E, 2, 24) of 2E12 of both faces on xi_{axis+1} in each element by its displacements."""
    slope = shell.measure.gradient(_gradients(shell, u))[..., SHEAR, :]
    Q = shell.discretisation.geometry.Q.reshape(-1, N_GAUSS, N_Q, N_DOF)
    on_mode = 3 * GAUSS[:, axis] / N_GAUSS
    return np.asarray(np.einsum("p,epfq,epqi->efi", on_mode, slope, Q, optimize=True))


def neighbours(grid: Grid, axis: int) -> np.ndarray:
    """Pairs (k, 2) of elements, one behind the other along a_{axis+1}, that have a whole side in common."""
    first, last = (np.sort(grid.elements[:, side[axis]], axis=1) @ (grid.n_nodes, 1) for side in (LOW, HIGH))
    _, behind, before = np.intersect1d(first, last, return_indices=True)
    return np.stack([before, behind], axis=-1)


def _gradients(shell: ShellModel, u: np.ndarray) -> np.ndarray:
    """q (E, 4, 15) at the Gauss points, that of the interpolated positions included."""
    geometry, dofs = shell.discretisation.geometry, shell.discretisation.dofs
    v = shell.displacements(u).reshape(-1)[dofs]
    q = np.matmul(geometry.Q, v[..., None]).reshape(-1, N_GAUSS, N_Q)
    return q if geometry.offset is None else q + geometry.offset
