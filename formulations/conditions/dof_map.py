"""Supports as a signed map: every face displacement is an unknown, the negative of one, or held at zero.

Symmetry planes and clamps hold; a hinge at the mid-surface ties the two faces, v+ = -v-; an image moves as another node
does, seen through a symmetry. No stiffness enters here.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy import sparse

from formulations.strains.quantities import N_V, displacement_index


@dataclass(frozen=True, eq=False)
class Images:
    """Nodes (k,) that move as the nodes ``of`` (k,) do; signs (k, 3): +-1 on each local component, of both faces.

    A node may be its own image: what changes its sign is then held at zero.
    """

    nodes: np.ndarray
    of: np.ndarray
    signs: np.ndarray

    @property
    def followed(self) -> np.ndarray:
        """The nodes that others follow."""
        return np.unique(self.of[self.of != self.nodes])


@dataclass(frozen=True, eq=False)
class DofMap:
    """number (6N,): unknown of each face displacement, -1 where held; sign (6N,): +1 or -1, 0 where held."""

    number: np.ndarray
    sign: np.ndarray

    @classmethod
    def build(
        cls,
        fixed: np.ndarray,
        hinged: np.ndarray | None = None,
        images: Images | None = None,
        order: np.ndarray | None = None,
    ) -> DofMap:
        """``fixed`` (N, 6) bool: held at zero.  ``hinged`` (N, 3) bool: mid-surface components held, rotation free.

        ``images``: take over the supports of the nodes they follow.  ``order`` (N,): the nodes in the order in which
        their unknowns are numbered, the order of the nodes unless given.
        Raises ValueError when nothing is free, when a hinged component is also held on one face, or when an image
        follows an image.
        """
        master = np.arange(fixed.size).reshape(fixed.shape)
        sign = np.where(fixed, 0.0, 1.0)
        if hinged is not None:
            for i in range(3):
                inner, outer = displacement_index(i, 0), displacement_index(i, 1)
                nodes = np.flatnonzero(hinged[:, i])
                if np.any(fixed[nodes][:, [inner, outer]]):
                    raise ValueError(f"component {i + 1} is hinged and held at the same node")
                master[nodes, outer] = master[nodes, inner]
                sign[nodes, outer] = -1.0
        if images is not None:
            follows = images.nodes != images.of
            if np.isin(images.of[follows], images.nodes[follows]).any():
                raise ValueError("an image follows an image")
            signs = np.repeat(images.signs, 2, axis=1)
            sign[images.nodes] = np.where(
                follows[:, None], signs * sign[images.of], np.where(signs < 0, 0.0, sign[images.nodes])
            )
            master[images.nodes] = master[images.of]
        own = (master.ravel() == np.arange(fixed.size)) & (sign.ravel() != 0)
        if not own.any():
            raise ValueError("every displacement is held: nothing to solve")
        nodes = np.arange(len(fixed)) if order is None else order
        free = (N_V * nodes[:, None] + np.arange(N_V)).ravel()
        free = free[own[free]]
        unknown = np.full(fixed.size, -1)
        unknown[free] = np.arange(len(free))
        number = np.where(sign.ravel() != 0, unknown[master.ravel()], -1)
        return cls(number, sign.ravel())

    @property
    def n(self) -> int:
        """Number of unknowns."""
        return int(self.number.max()) + 1

    @property
    def held(self) -> np.ndarray:
        """(N, 6) bool: displacements held at zero, or at a prescribed value."""
        return (self.sign == 0).reshape(-1, N_V)

    @property
    def hinged(self) -> np.ndarray:
        """(N, 6) bool: displacements of both faces of a component held midway between them."""
        number, sign = self.number.reshape(-1, 3, 2), self.sign.reshape(-1, 3, 2)
        opposite = (number[..., 0] == number[..., 1]) & (sign[..., 0] * sign[..., 1] < 0)
        return np.repeat(opposite, 2, axis=1)

    def expand(self, u: np.ndarray) -> np.ndarray:
        """All face displacements (N, 6) from the unknowns (n,)."""
        return (self.sign * np.append(u, 0.0)[self.number]).reshape(-1, N_V)

    def restrict(self, full: np.ndarray) -> np.ndarray:
        """The unknowns (n,) of displacements (N, 6) that obey the map, the inverse of :meth:`expand`."""
        u = np.zeros(self.n)
        own = np.flatnonzero(self.number >= 0)
        u[self.number[own]] = self.sign[own] * full.ravel()[own]
        return u

    def gather(self, full: np.ndarray) -> np.ndarray:
        """Generalised forces (n,) from forces on all face displacements, the transpose of :meth:`expand`."""
        weights = self.sign * full.ravel()
        return np.bincount(self.number + 1, weights=weights, minlength=self.n + 1)[1:]

    def matrix(self) -> sparse.csr_matrix:
        """The map as a sparse matrix (6N, n)."""
        rows = np.flatnonzero(self.number >= 0)
        entries = (self.sign[rows], (rows, self.number[rows]))
        return sparse.coo_matrix(entries, shape=(len(self.number), self.n)).tocsr()
