"""Supports as a map: every face displacement is an unknown, the negative of one, held at zero, or carried by others.

Symmetry planes and clamps hold; a hinge at the mid-surface ties the two faces, v+ = -v-; an image moves as another node
does, seen through a symmetry; a hanging node moves as the edge it lies on. No stiffness enters here.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

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
    """number (6N,): unknown of each face displacement, -1 where held; sign (6N,): +1 or -1, 0 where held.

    carried (6N, 6N): v = carried w of the displacements w that number and sign give; None where nothing is carried. Its
    rows are those of the identity but for the carried displacements, whose columns are empty; their sign is 0.
    """

    number: np.ndarray
    sign: np.ndarray
    carried: sparse.csr_matrix | None = None

    @classmethod
    def build(
        cls,
        fixed: np.ndarray,
        hinged: np.ndarray | None = None,
        images: Images | None = None,
        order: np.ndarray | None = None,
        carried: sparse.csr_matrix | None = None,
    ) -> DofMap:
        """``fixed`` (N, 6) bool: held at zero.  ``hinged`` (N, 3) bool: mid-surface components held, rotation free.

        ``images``: take over the supports of the nodes they follow.  ``order`` (N,): the nodes in the order in which
        their unknowns are numbered, the order of the nodes unless given.  ``carried``: see :class:`DofMap`; whatever
        supports a carried displacement has must be those of what carries it.
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
        if carried is not None:
            sign.ravel()[np.bincount(carried.indices, minlength=fixed.size) == 0] = 0.0
        own = (master.ravel() == np.arange(fixed.size)) & (sign.ravel() != 0)
        if not own.any():
            raise ValueError("every displacement is held: nothing to solve")
        nodes = np.arange(len(fixed)) if order is None else order
        free = (N_V * nodes[:, None] + np.arange(N_V)).ravel()
        free = free[own[free]]
        unknown = np.full(fixed.size, -1)
        unknown[free] = np.arange(len(free))
        number = np.where(sign.ravel() != 0, unknown[master.ravel()], -1)
        return cls(number, sign.ravel(), carried)

    @property
    def n(self) -> int:
        """Number of unknowns."""
        return int(self.number.max()) + 1

    @property
    def held(self) -> np.ndarray:
        """(N, 6) bool: displacements held at zero, or at a prescribed value."""
        return (self.sign == 0).reshape(-1, N_V)

    @property
    def constrained(self) -> np.ndarray:
        """(6N,) bool: the negative of an unknown, or carried by several."""
        return self._several | (self.sign < 0)

    @property
    def _several(self) -> np.ndarray:
        return np.zeros(len(self.sign), bool) if self.carried is None else np.diff(self.carried.indptr) != 1

    @property
    def hinged(self) -> np.ndarray:
        """(N, 6) bool: displacements of both faces of a component held midway between them."""
        number, sign = self.number.reshape(-1, 3, 2), self.sign.reshape(-1, 3, 2)
        opposite = (number[..., 0] == number[..., 1]) & (sign[..., 0] * sign[..., 1] < 0)
        return np.repeat(opposite, 2, axis=1)

    @property
    def held_middle(self) -> np.ndarray:
        """(N, 3) bool: components held midway between the faces; what both faces hold, the middle does, too."""
        return np.asarray((self.hinged | self.held).reshape(-1, 3, 2).all(axis=2))

    def of_elements(self, dofs: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray] | None:
        """The elements (f,) with a constrained displacement, the numbers (f, m) of the unknowns that move them, and C.

        dofs (E, d): displacements of the elements; v = C u, C (f, d, m). A displacement that follows one unknown keeps
        its own column; the unknowns that carry others stand behind. A number is -1 where there is none.
        """
        elements = np.flatnonzero(self.constrained[dofs].any(axis=1))
        if not len(elements):
            return None
        d = dofs.shape[1]
        rows = self.matrix()[dofs[elements].ravel()].tocoo()
        each, own, alone = rows.row // d, rows.row % d, ~self._several[dofs[elements].ravel()][rows.row]
        pairs, which = np.unique(np.stack([each, rows.col])[:, ~alone], axis=1, return_inverse=True)
        first = np.searchsorted(pairs[0], np.arange(len(elements)))
        column = own.copy()
        column[~alone] = d + which.ravel() - first[each[~alone]]
        number = np.full((len(elements), 1 + int(column.max(initial=d - 1))), -1)
        C = np.zeros((len(elements), d, number.shape[1]))
        number[each, column], C[each, own, column] = rows.col, rows.data
        return elements, number, C

    def carry(self, full: np.ndarray) -> np.ndarray:
        """Displacements (N, 6) with what is carried replaced by what carries it."""
        return full if self.carried is None else (self.carried @ full.ravel()).reshape(full.shape)

    def hand_on(self, forces: np.ndarray) -> np.ndarray:
        """Forces (N, 6) on the displacements with those on carried ones handed to what carries them."""
        return forces if self.carried is None else (self.carried.T @ forces.ravel()).reshape(forces.shape)

    def expand(self, u: np.ndarray) -> np.ndarray:
        """All face displacements (N, 6) from the unknowns (n,)."""
        return self.carry(self.placed(u))

    def placed(self, forces: np.ndarray) -> np.ndarray:
        """Forces (n,) on the unknowns at the displacements (N, 6) that follow them, none at carried ones."""
        return (self.sign * np.append(forces, 0.0)[self.number]).reshape(-1, N_V)

    def restrict(self, full: np.ndarray) -> np.ndarray:
        """The unknowns (n,) of displacements (N, 6) that obey the map, the inverse of :meth:`expand`."""
        u = np.zeros(self.n)
        own = np.flatnonzero(self.number >= 0)
        u[self.number[own]] = self.sign[own] * full.ravel()[own]
        return u

    def gather(self, full: np.ndarray) -> np.ndarray:
        """Generalised forces (n,) from forces on all face displacements, the transpose of :meth:`expand`."""
        weights = self.sign * self.hand_on(full).ravel()
        return np.bincount(self.number + 1, weights=weights, minlength=self.n + 1)[1:]

    def matrix(self) -> sparse.csr_matrix:
        """The map as a sparse matrix (6N, n); the places of its entries do not depend on the values of ``carried``."""
        carried = sparse.eye_array(len(self.number)) if self.carried is None else self.carried
        row, column, value = carried.tocoo().row, carried.tocoo().col, carried.tocoo().data
        on = self.number[column] >= 0
        entries = (value[on] * self.sign[column[on]], (row[on], self.number[column[on]]))
        return sparse.csr_matrix(entries, shape=(len(self.number), self.n))

    def carrying(self, carried: sparse.csr_matrix) -> DofMap:
        """The same map with other values of ``carried``."""
        return replace(self, carried=carried)
