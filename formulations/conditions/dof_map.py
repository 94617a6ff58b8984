"""Supports as a map: every face displacement is an unknown, the negative of one, held at zero, or carried by others.

Symmetry planes and clamps hold; a hinge at the mid-surface ties the two faces, v+ = -v-; an image moves as another node
does, seen through a symmetry; a hanging node moves as the edge it lies on. No stiffness enters here.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from scipy import sparse

from formulations.strains.quantities import N_V, displacement_index

MIDWAY = 1e-12  # of the wall, within which a surface lies midway between the faces


class AllHeldError(ValueError):
    """Supports that leave no displacement free."""


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
    """number (6N and more,): unknown of each displacement, -1 where held; sign, alike: +1 or -1, 0 where held.

    inside: fractions of the wall at which further surfaces lie; their displacements (N, len(inside), 3) follow those of
    the faces in number and sign. They are held where both faces are; at a hinge they are linear between the faces, as
    on a plate that turns, with factors in the place of signs. What speaks of (N, 6) speaks of the faces alone.
    carried (6N, 6N): v = carried w of the displacements w that number and sign give; None where nothing is carried. Its
    rows are those of the identity but for the carried displacements, whose columns are empty; their sign is 0.
    """

    number: np.ndarray
    sign: np.ndarray
    carried: sparse.csr_matrix | None = None
    inside: tuple[float, ...] = ()

    @classmethod
    def build(
        cls,
        fixed: np.ndarray,
        hinged: np.ndarray | None = None,
        images: Images | None = None,
        order: np.ndarray | None = None,
        carried: sparse.csr_matrix | None = None,
        inside: tuple[float, ...] = (),
    ) -> DofMap:
        """``fixed`` (N, 6) bool: held at zero.  ``hinged`` (N, 3) bool: mid-surface components held, rotation free.

        ``images``: take over the supports of the nodes they follow.  ``order`` (N,): the nodes in the order in which
        their unknowns are numbered, the order of the nodes unless given.  ``carried``: see :class:`DofMap`; whatever
        supports a carried displacement has must be those of what carries it.
        Raises AllHeldError when nothing is free, ValueError when a hinged component is also held on one face, or when
        an image follows an image.
        """
        n, m = len(fixed), len(inside)
        flat = np.hstack([np.arange(fixed.size).reshape(n, -1), fixed.size + np.arange(3 * m * n).reshape(n, -1)])
        both = fixed.reshape(n, 3, 2).all(axis=2)
        master, sign = flat.copy(), np.where(np.hstack([fixed, np.tile(both, m)]), 0.0, 1.0)
        if hinged is not None:
            for i in range(3):
                inner, outer = displacement_index(i, 0), displacement_index(i, 1)
                nodes = np.flatnonzero(hinged[:, i])
                if np.any(fixed[nodes][:, [inner, outer]]):
                    raise ValueError(f"component {i + 1} is hinged and held at the same node")
                for column, z in ((outer, 1.0), *((N_V + 3 * j + i, z) for j, z in enumerate(inside))):
                    master[nodes, column] = master[nodes, inner]
                    sign[nodes, column] = 0.0 if abs(1 - 2 * z) < MIDWAY else 1 - 2 * z
        if images is not None:
            follows = images.nodes != images.of
            if np.isin(images.of[follows], images.nodes[follows]).any():
                raise ValueError("an image follows an image")
            signs = np.hstack([np.repeat(images.signs, 2, axis=1), np.tile(images.signs, m)])
            sign[images.nodes] = np.where(
                follows[:, None], signs * sign[images.of], np.where(signs < 0, 0.0, sign[images.nodes])
            )
            master[images.nodes] = master[images.of]
        if carried is not None:
            sign[(np.bincount(carried.indices, minlength=fixed.size) == 0).reshape(sign.shape)] = 0.0
        followed, signs = (np.append(each[:, :N_V], each[:, N_V:]) for each in (master, sign))
        own = (followed == np.arange(flat.size)) & (signs != 0)
        if not own.any():
            raise AllHeldError("every displacement is held: nothing to solve")
        free = (flat if order is None else flat[order]).ravel()
        free = free[own[free]]
        unknown = np.full(flat.size, -1)
        unknown[free] = np.arange(len(free))
        return cls(np.where(signs != 0, unknown[followed], -1), signs, carried, inside)

    @property
    def n(self) -> int:
        """Number of unknowns."""
        return int(self.number.max()) + 1

    @property
    def n_faces(self) -> int:
        """6 N: how many of the displacements are those of the faces."""
        return len(self.number) * N_V // (N_V + 3 * len(self.inside))

    @property
    def held(self) -> np.ndarray:
        """(N, 6) bool: displacements held at zero, or at a prescribed value."""
        return (self.sign[: self.n_faces] == 0).reshape(-1, N_V)

    @property
    def constrained(self) -> np.ndarray:
        """(6N and more,) bool: another multiple of an unknown than 1, or carried by several."""
        return self._several | ((self.sign != 0) & (self.sign != 1))

    @property
    def _several(self) -> np.ndarray:
        return np.zeros(len(self.sign), bool) if self.carried is None else np.diff(self.carried.indptr) != 1

    @property
    def hinged(self) -> np.ndarray:
        """(N, 6) bool: displacements of both faces of a component held midway between them."""
        number, sign = (each[: self.n_faces].reshape(-1, 3, 2) for each in (self.number, self.sign))
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
        number, sign = self.number[: self.n_faces], self.sign[: self.n_faces]
        return (sign * np.append(forces, 0.0)[number]).reshape(-1, N_V)

    def everywhere(self, u: np.ndarray, prescribed: np.ndarray | None = None) -> np.ndarray:
        """All displacements, flat, from the unknowns (n,); ``prescribed`` (N, 6) of the faces, between them linear."""
        v = self.sign * np.append(u, 0.0)[self.number]
        if prescribed is None:
            return v
        follows = self.held.reshape(-1, 3, 2).all(axis=2) | self.hinged[:, ::2]
        return v + np.append(prescribed, np.where(follows[:, None], self.between(prescribed), 0.0))

    def between(self, v: np.ndarray) -> np.ndarray:
        """Displacements (N, len(inside), 3) of the surfaces inside, linear between those of the faces, (N, 6)."""
        outer = np.array(self.inside)[:, None]
        inner_face, outer_face = np.moveaxis(v.reshape(-1, 1, 3, 2), -1, 0)
        return np.asarray((1 - outer) * inner_face + outer * outer_face)

    def on_faces(self, forces: np.ndarray) -> np.ndarray:
        """Forces (N, 6) that do the work of flat ones where displacements are linear between the faces."""
        inside = forces[self.n_faces :].reshape(-1, len(self.inside), 3)
        outer = np.array(self.inside)
        shares = np.einsum("fj,nji->nif", np.stack([1 - outer, outer]), inside)
        return np.asarray(forces[: self.n_faces].reshape(-1, N_V) + shares.reshape(-1, N_V))

    def restrict(self, full: np.ndarray) -> np.ndarray:
        """The unknowns (n,) of displacements that obey the map, flat, or (N, 6) and linear between: undoes expand."""
        if full.size < len(self.number):
            full = np.append(full, self.between(full))
        u = np.zeros(self.n)
        own = np.flatnonzero((self.number >= 0) & (np.abs(self.sign) == 1))
        u[self.number[own]] = self.sign[own] * full.ravel()[own]
        return u

    def restrict_nodal(self, full: np.ndarray) -> np.ndarray:
        """The same of displacements node by node, (N, 6 and more)."""
        return self.restrict(np.append(full[:, :N_V], full[:, N_V:]))

    def gather(self, full: np.ndarray) -> np.ndarray:
        """Generalised forces (n,) from forces on all displacements, flat, or on the faces alone, (N, 6)."""
        weights = self.sign[: full.size] * self.hand_on(full).ravel()
        return np.bincount(self.number[: full.size] + 1, weights=weights, minlength=self.n + 1)[1:]

    def matrix(self) -> sparse.csr_matrix:
        """The map as a sparse matrix (6N and more, n), whose places do not depend on the values of ``carried``."""
        carried = sparse.eye_array(len(self.number)) if self.carried is None else self.carried
        row, column, value = carried.tocoo().row, carried.tocoo().col, carried.tocoo().data
        on = self.number[column] >= 0
        entries = (value[on] * self.sign[column[on]], (row[on], self.number[column[on]]))
        return sparse.csr_matrix(entries, shape=(len(self.number), self.n))

    def carrying(self, carried: sparse.csr_matrix) -> DofMap:
        """The same map with other values of ``carried``."""
        return replace(self, carried=carried)
