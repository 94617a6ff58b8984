"""Grids of one request that grow finer: its mesh cut everywhere, or the leaves of a tree by Dörfler's criterion.

A scene whose grid takes no leaves is refined everywhere, by its mesh. A coordinate with one element is not cut, for
nothing varies along it, until the stress drives elements that would be too long for it.
"""

from __future__ import annotations

from contextlib import suppress
from dataclasses import dataclass, replace

import numpy as np

from formulations.element.quad_geometry import QuadGeometry
from formulations.geometry.grid import TensorGrid
from formulations.geometry.quadtree import DEEPEST, Quadtree
from formulations.shell import ShellModel
from studies.ask.request import Leaves, Request
from studies.ask.scene import Scene, UsageError
from studies.scenes.element import tree_over
from studies.scenes.plugins import built
from studies.solving.refinement.grids import several_elements
from studies.solving.result import Result

SHARE = 0.5  # of the sum of all indicators, marked at a time
GROWTH = 2.0  # of the number of elements from one tree to the next, at the least
FLAT = 1.0  # k l^2/h of an element, above which no node may hang on it: the arc of its edge would still lock
PART = 1 / 4  # of the indicator of an element that its parts have in all: an order of the size, on both sides
WORTH = 0.8  # of error times elements of the grid cut everywhere, above which hanging nodes are not worth their price


@dataclass(frozen=True, eq=False)
class Family:
    """Grids of a request: its mesh, halved ``times``, or the leaves of a tree over it.

    mirrored: leaves are kept symmetric under a1 -> -a1, as the seams of a half need.  shell: on the coarsest grid.
    """

    request: Request
    tree: Quadtree | None
    mirrored: bool = False
    times: int = 0
    shell: ShellModel | None = None

    @classmethod
    def of(cls, scene: Scene, request: Request) -> Family:
        """The coarsest grid."""
        shell = getattr(built(scene, request), "shell", None)
        if not isinstance(shell, ShellModel) or not isinstance(shell.discretisation.grid, TensorGrid):
            return cls(request, None)
        if isinstance(shell.discretisation.geometry, QuadGeometry) or shell.discretisation.wall is not None:
            return cls(request, None)  # quadrilaterals and surfaces inside the wall have no hanging nodes
        grid = shell.discretisation.grid
        tree = tree_over(request, *grid.lines, periodic=grid.periodic)
        mirrored = bool(np.any(shell.discretisation.map.sign < 0)) and grid.lines[0][0] < 0
        family = cls(request, tree, mirrored, shell=shell)
        finer = getattr(built(scene, family.everywhere().asked), "shell", None)
        taken = isinstance(finer, ShellModel) and len(finer.discretisation.grid.elements) > len(grid.elements)
        return family if taken else cls(request, None)

    @property
    def asked(self) -> Request:
        """The request with this grid."""
        if self.tree is None:
            cut = several_elements(self.request)
            n1, n2 = (n * 2**self.times if many else 1 for n, many in zip(self.request.mesh, cut, strict=True))
            return replace(self.request, mesh=(n1, n2))
        if not np.any(self.tree.leaves[:, 0]):
            return self.request
        return replace(self.request, leaves=tuple((int(level), int(i), int(j)) for level, i, j in self.tree.leaves))

    def everywhere(self) -> Family:
        """Every element cut."""
        if self.tree is None:
            return replace(self, times=self.times + 1)
        return replace(self, tree=self.tree.everywhere())

    def shortened(self, scene: Scene, result: Result) -> Family:
        """The same grid, its mesh finer along a coordinate where elements of a result have modes by themselves.

        result: on this grid, or on that with all elements cut. It stays where the scene takes no such mesh.
        """
        parts = parts_of(result)
        if max(parts) == 1:
            return self
        n1, n2 = self.request.mesh
        with suppress(UsageError):
            finer = Family.of(scene, replace(self.request, mesh=(n1 * parts[0], n2 * parts[1])))
            if self.tree is None or finer.tree is None or not np.any(self.tree.leaves[:, 0]):
                return replace(finer, times=self.times)
            leaves = self._leaves_in(parts, finer.tree.cut)
            return replace(finer, tree=replace(finer.tree, leaves=finer.tree.sorted(leaves)))
        return self

    def _leaves_in(self, parts: tuple[int, int], cut: tuple[bool, bool]) -> np.ndarray:
        """The leaves with so many more cells along a1 and a2, these along the coordinates that are ``cut``."""
        assert self.tree is not None
        children: list[Leaves] = []
        for level, *corner in self.tree.leaves.tolist():
            times = [n << level * (now - was) for n, now, was in zip(parts, cut, self.tree.cut, strict=True)]
            first, second = (range(k * n, (k + 1) * n) for k, n in zip(corner, times, strict=True))
            children.append(tuple((level, i, j) for i in first for j in second))
        return np.concatenate([np.array(each, np.intp) for each in children])

    def refined(self, eta: np.ndarray) -> Family:
        """Elements cut by Dörfler's criterion for the indicators eta (E,), foreseen for the parts, up to GROWTH.

        All of them, where the error that is foreseen for these elements is no smaller than it would be for as many of
        grids that are cut everywhere.
        """
        assert self.tree is not None
        tree, everywhere = self.tree, self.everywhere()
        assert everywhere.tree is not None
        worth = WORTH * PART * eta.sum() * len(everywhere.tree.leaves)
        while len(tree.leaves) < GROWTH * len(self.tree.leaves):
            marked = dorfler(eta, SHARE) | self._curved(tree)
            if self.mirrored:
                marked |= marked[_mirror(tree)]
            marked &= tree.leaves[:, 0] < DEEPEST - 1  # they are cut once more where all are
            if not marked.any():
                break
            finer = tree.refined(marked)
            parents = tree.parents(finer)
            parts = np.bincount(parents)
            eta = (eta * np.where(parts > 1, PART / parts, 1.0))[parents]
            tree = finer
        deepest = np.any(self.tree.leaves[:, 0] == DEEPEST - 1)  # all of them cannot be cut twice
        return replace(self, tree=tree) if deepest or eta.sum() * len(tree.leaves) < worth else everywhere

    def _curved(self, tree: Quadtree) -> np.ndarray:
        """Elements (E,) too curved along a direction that is cut for a node to hang on them."""
        assert self.shell is not None
        surface, laminate = self.shell.discretisation.surface, self.shell.discretisation.laminate
        grid = tree.grid()
        geometry = surface.geometry(*grid.centre.T)
        bent = np.abs(geometry.k) * (2 * grid.half * geometry.A) ** 2 / laminate.thickness
        return np.any((bent > FLAT) & np.array(tree.cut) & (np.sum(tree.cut) > 1), axis=1)


def parts_of(result: Result) -> tuple[int, int]:
    """In how many parts elements are to be cut along a1 and a2; (1, 1) where cuts do not help.

    So that the stress of the last state drives none, and none have modes of their own at any load.
    """
    if result.end is None or result.end.problem.element_modes is None:
        return 1, 1
    overlooked = result.end.problem.element_modes(result.end.point.solution.u)
    counted = [step.certificate.get("stability", {}).get("cuts", (1, 1)) for step in result.loads]
    one, other = (max(each) for each in zip(overlooked.cuts, *counted, strict=True))
    return (1, 1) if min(one, other) > 1 else (one, other)


def _mirror(tree: Quadtree) -> np.ndarray:
    """The leaf (E,) at -a1 of each leaf of a tree that is symmetric about a1 = 0."""
    level, i, j = tree.leaves.T
    across = ((len(tree.lines[0]) - 1) << level * tree.cut[0]) - 1 - i
    order, mirrored = np.lexsort((j, i, level)), np.lexsort((j, across, level))
    image = np.empty(len(level), np.intp)
    image[mirrored] = order
    return image


def dorfler(eta: np.ndarray, share: float) -> np.ndarray:
    """The fewest elements (E,) bool whose eta add up to a share of all (Dörfler, SIAM J. Numer. Anal. 33 (1996))."""
    order = np.argsort(-eta, kind="stable")
    count = int(np.searchsorted(np.cumsum(eta[order]), share * eta.sum())) + 1
    marked = np.zeros(len(eta), bool)
    marked[order[:count]] = True
    return marked
