"""The surface of a deck: its nodes counted from 0, the orientation of its quadrilaterals, nodal normals, folds.

A director for each node follows a smooth surface alone: folds and edges of three elements are refused, and so are
neighbours of opposite orientation.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from formulations.geometry.quad_cuts import cut, nodal_normals, unit
from studies.ask.request import UsageError
from studies.scenes.mesh_file.deck import Deck
from studies.scenes.mesh_file.keywords import listed
from studies.scenes.mesh_file.local_axes import axes_of

NO_AREA = 1e-12  # of the longest side of an element squared
LAID = 0.35  # sine of the largest angle by which a normal is laid into a plane of symmetry


@dataclass(frozen=True, eq=False)
class Mesh:
    """numbers (N,), labels (E,): of nodes and elements in the deck.  middle (N, 3): positions.  elements (E, 4).

    areas (E, 3): area vectors, half the cross product of the diagonals.  normals (N, 3): of unit length.
    axes (N, 3, 3): rows are the directions of degrees of freedom and forces.  given (N,) bool: normals that the deck
    has.  thickness (N,): of nodes, no number where they say none.  unused: nodes of no element, which are left out.
    """

    file: str
    numbers: np.ndarray
    labels: np.ndarray
    middle: np.ndarray
    elements: np.ndarray
    areas: np.ndarray
    normals: np.ndarray
    axes: np.ndarray
    given: np.ndarray
    thickness: np.ndarray
    unused: int

    @classmethod
    def of(cls, deck: Deck) -> Mesh:
        """Normals are those of :func:`nodal_normals` where the deck has none; raises UsageError."""
        labels = np.array(list(deck.elements))
        numbers, elements = np.unique(np.array(list(deck.elements.values())), return_inverse=True)
        elements = elements.reshape(-1, 4)
        middle = np.array([deck.nodes[number] for number in numbers.tolist()])
        areas = _areas(middle[elements])
        given = np.isin(numbers, list(deck.normals))
        unused = len(deck.nodes) - len(numbers)
        axes, normals = axes_of(deck, numbers, middle), np.zeros_like(middle)
        thickness = np.array([deck.thickness.get(number, np.nan) for number in numbers.tolist()])
        mesh = cls(deck.path.name, numbers, labels, middle, elements, areas, normals, axes, given, thickness, unused)
        mesh._check_elements()
        mesh._edges()
        return replace(mesh, normals=mesh._nodal_normals(deck))

    def cut(self, n: int, smooth_deg: float) -> tuple[Mesh, np.ndarray, np.ndarray]:
        """Each element in n x n, the nodes (M, 4) here that every node there lies between, some of them twice, and its
        shares of them (M, 4).

        Its parts have the label of an element, and new nodes numbers above all others.
        """
        fine = cut(self.middle, self.normals, self.elements, n, smooth_deg)
        nearest = np.take_along_axis(fine.around, np.argmax(fine.shares, axis=1)[:, None], axis=1)
        new = len(fine.middle) - len(self.numbers)
        return (
            replace(
                self,
                numbers=np.append(self.numbers, self.numbers.max() + 1 + np.arange(new)),
                labels=np.repeat(self.labels, n**2),
                middle=fine.middle,
                elements=fine.elements,
                areas=_areas(fine.middle[fine.elements]),
                normals=fine.normals,
                axes=np.concatenate([self.axes, np.tile(np.eye(3), (new, 1, 1))]),
                given=np.append(self.given, np.zeros(new, bool)),
                thickness=np.where(fine.shares > 0, fine.shares * self.thickness[fine.around], 0.0).sum(axis=1),
            ),
            np.where(fine.shares > 0, fine.around, nearest),
            fine.shares,
        )

    def at(self, nodes: list[int]) -> np.ndarray:
        """Places of nodes of the deck; those of no element are left out."""
        numbers = np.asarray(nodes, dtype=np.int64)
        return np.searchsorted(self.numbers, numbers[np.isin(numbers, self.numbers)])

    def _check_elements(self) -> None:
        corners = self.middle[self.elements]
        sides = np.roll(corners, -1, axis=1) - corners
        size = np.max(np.sum(sides**2, axis=-1), axis=1)
        turns = np.einsum("erx,ex->er", np.cross(np.roll(sides, 1, axis=1), sides), self.areas)
        flat = np.linalg.norm(self.areas, axis=1) <= NO_AREA * size
        bad = np.flatnonzero(flat | np.any(turns <= 0, axis=1))
        if len(bad):
            raise UsageError(
                f"{self.file}: elements with an angle of 180 degrees or more, or without an area: "
                f"{listed(self.labels[bad].tolist())}"
            )

    def _edges(self) -> tuple[np.ndarray, np.ndarray]:
        """Of the edges between two elements: both nodes (k, 2) and both elements (k, 2); raises UsageError."""
        start, end = self.elements.ravel(), np.roll(self.elements, -1, axis=1).ravel()
        low, high = np.minimum(start, end), np.maximum(start, end)
        order = np.lexsort((high, low))
        low, high, forwards, element = low[order], high[order], (start < end)[order], order // 4
        same = (low[1:] == low[:-1]) & (high[1:] == high[:-1])
        third = np.flatnonzero(same[1:] & same[:-1])
        if len(third):
            edge = self._edge(low[third[0]], high[third[0]])
            raise UsageError(f"{self.file}: more than two elements meet at the edge {edge}, which no surface does")
        first = np.flatnonzero(same)
        against = first[forwards[first] == forwards[first + 1]]
        if len(against):
            i = against[0]
            one, other = self.labels[element[i]], self.labels[element[i + 1]]
            edge = self._edge(low[i], high[i])
            raise UsageError(
                f"{self.file}: elements {one} and {other} go round against each other at the edge {edge}: reverse the "
                "order of the nodes of one, until all normals of a part point to the same side"
            )
        return np.stack([low[first], high[first]], axis=-1), np.stack([element[first], element[first + 1]], axis=-1)

    def _edge(self, one: int, other: int) -> str:
        return f"of nodes {self.numbers[one]} and {self.numbers[other]}"

    def check_folds(self, largest_deg: float) -> None:
        """Raise UsageError where the normals of neighbours are further apart than that."""
        nodes, elements = self._edges()
        normals = unit(self.areas)[elements]
        angle = np.degrees(np.arccos(np.clip(np.sum(normals[:, 0] * normals[:, 1], axis=-1), -1, 1)))
        if len(angle) and angle.max() > largest_deg:
            worst = int(np.argmax(angle))
            folds = np.count_nonzero(angle > largest_deg)
            raise UsageError(
                f"{self.file}: a fold of {angle[worst]:.3g} degrees at the edge {self._edge(*nodes[worst])}, {folds} "
                f"in all above fold_deg = {largest_deg:g}: one director for each node follows smooth surfaces alone"
            )

    def _nodal_normals(self, deck: Deck) -> np.ndarray:
        total = np.zeros_like(self.middle)
        for corner in range(4):
            np.add.at(total, self.elements[:, corner], self.areas)
        known = self.numbers[self.given].tolist()
        given = np.array([unit(np.array(deck.normals[number])).sum(axis=0) for number in known]).reshape(-1, 3)
        against = np.sum(given * total[self.given], axis=-1) <= 0
        if against.any():
            raise UsageError(
                f"{self.file}: normals that do not point to the side of their elements, at nodes "
                f"{listed(np.array(known)[against].tolist())}"
            )
        total[self.given] = unit(given)
        normals = nodal_normals(self.middle, self.elements, total, self.given)
        none = np.linalg.norm(normals, axis=-1) == 0
        if none.any():
            lost = listed(self.numbers[none].tolist())
            raise UsageError(f"{self.file}: nodes whose elements have no normal in common: {lost}")
        return unit(normals)

    def in_planes(self, across: np.ndarray) -> Mesh:
        """With the normals at nodes on planes of symmetry laid into these; across (N, 3) bool: own axes normal to them.

        So half a surface has the normals of the whole: the mean over an element and its image.
        """
        normals = self.along_axes(self.normals)
        near = across & ~self.given[:, None] & (np.abs(normals) <= LAID)
        laid = np.einsum("nix,ni->nx", self.axes, np.where(near, 0.0, normals))
        return replace(self, normals=unit(np.where(near.any(axis=1)[:, None], laid, self.normals)))

    def along_axes(self, x: np.ndarray) -> np.ndarray:
        """Components (N, 3) along the axes of each node, of vectors x (N, 3)."""
        return np.einsum("nix,nx->ni", self.axes, x)


def _areas(corners: np.ndarray) -> np.ndarray:
    """Area vectors (E, 3) of quadrilaterals (E, 4, 3)."""
    return np.asarray(0.5 * np.cross(corners[:, 2] - corners[:, 0], corners[:, 3] - corners[:, 1]))
