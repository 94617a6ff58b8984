"""The grids of a request: the coarsest one, finer ones of the same shape, trees that are refined, and their requests.

A scene whose grid takes no leaves is refined everywhere, by its mesh. A coordinate with one element is not cut, for
nothing varies along it, until the stress drives elements that would be too long for it.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from itertools import product
from typing import Any, Protocol, runtime_checkable

import numpy as np

from formulations.element.quad_geometry import QuadGeometry
from formulations.geometry.grid import TensorGrid
from formulations.geometry.quadtree import DEEPEST, Quadtree
from formulations.shell import ShellModel
from studies.ask.request import Leaves, Request
from studies.ask.scene import CutScene, RefinedScene, Scene, SettlingScene, UsageError
from studies.scenes import SCENES
from studies.scenes.complete import complete
from studies.scenes.element import tree_over
from studies.scenes.plugins import built
from studies.solving.result import Result

COARSER = 4  # the default mesh over the coarsest one
FEWEST = 4  # elements along a coordinate, below which it is not made coarser
NEAR = 2  # how far from the elements that are wanted those of a grid may be, where a scene does not take them
SHARE = 0.5  # of the sum of all indicators, marked at a time
GROWTH = 2.0  # of the number of elements from one tree to the next, at the least
FLAT = 1.0  # k l^2/h of an element, above which no node may hang on it: the arc of its edge would still lock
PART = 1 / 4  # of the indicator of an element that its parts have in all: an order of the size, on both sides
WORTH = 0.8  # of error times elements of the grid cut everywhere, above which hanging nodes are not worth their price


@runtime_checkable
class AdaptedScene(Protocol):
    """A scene whose grid lines may follow an estimate of the error, ``grading=adapted``."""

    def adapted(self, request: Request) -> Scene:
        """With the estimate, for grids of any number of elements; raises UsageError where it fails."""


def on_one_grid(scene: Scene, request: Request) -> Scene:
    """The scene whose lines, where they follow an estimate of the error, follow that of this request ever after."""
    if isinstance(scene, AdaptedScene) and request.settings.get("grading") == "adapted":
        return scene.adapted(request)
    return scene


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
            cut = _several(self.request)
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


def element_size(request: Request) -> float:
    """Of the elements along the coordinates that have several, over that of a single one."""
    several = [n for n in request.mesh if n > 1] or [1]
    return math.prod(several) ** (-1 / len(several))


def ways(request: Request) -> int:
    """Coordinates that have several elements."""
    return sum(_several(request))


def _several(request: Request) -> tuple[bool, bool]:
    """Which coordinates are cut: those with several elements, or both of a mesh of its own as it stands."""
    n1, n2 = request.mesh
    return (n1 > 1, n2 > 1) if max(n1, n2) > 1 else (True, True)


def several(scene: Scene) -> tuple[bool, bool]:
    """Along which coordinates answers vary: its own mesh, or the coarsest one that it names, has several elements."""
    coarse = scene.coarsest_mesh if isinstance(scene, RefinedScene) else scene.default_mesh
    n1, n2 = map(max, scene.default_mesh, coarse)
    return n1 > 1, n2 > 1


def alone(scene: Scene, mesh: tuple[int, int]) -> str:
    """The coordinate with one element, which no finer grid cuts, though answers vary along it; empty without one."""
    if isinstance(scene, CutScene) or max(mesh) == 1:
        return ""
    short = [n == 1 and many for n, many in zip(mesh, several(scene), strict=True)]
    return f"a{short.index(True) + 1}" if any(short) else ""


def quarter(scene: Scene) -> tuple[int, int]:
    """A quarter of the default mesh both ways, two at the least where answers vary; of a mesh of its own that."""
    if isinstance(scene, CutScene):
        return 1, 1
    cut = zip(scene.default_mesh, several(scene), strict=True)
    n1, n2 = (max(2, n // COARSER) if many else 1 for n, many in cut)
    return n1, n2


def near(scene: Scene, request: Request, times: float) -> Request | None:
    """The request with so many times the elements along each coordinate, or nearly; None where there is no such grid.

    A coordinate with one element keeps it, and none is made coarser than FEWEST. A mesh of its own stays as it is.
    """
    if isinstance(scene, CutScene):
        return _cut(scene, request, times)
    target = [n if n == 1 else max(n * times, min(n, FEWEST)) for n in request.mesh]
    around = [[n] if n == 1 else _around(want) for n, want in zip(request.mesh, target, strict=True)]
    for mesh in sorted(
        product(*around), key=lambda mesh: sum(abs(n / w - 1) for n, w in zip(mesh, target, strict=True))
    ):
        candidate = replace(request, mesh=(mesh[0], mesh[1]))
        try:
            built(scene, candidate)
        except UsageError:
            continue
        return candidate if mesh != request.mesh else None
    return None


def _cut(scene: Scene, request: Request, times: float) -> Request | None:
    """The same of a scene on a mesh of its own: its elements in so many times the parts, a whole number of them."""
    parts = request.mesh[0]
    new_parts = max(round(parts * times), parts + 1) if times > 1 else parts // round(1 / times)
    candidate = replace(request, mesh=(new_parts, new_parts))
    try:
        return None if new_parts < 1 or not isinstance(scene, SettlingScene) else scene.settle(candidate)
    except UsageError:
        return None


def _around(target: float) -> list[int]:
    return [n for n in range(round(target) - NEAR, round(target) + NEAR + 1) if n > 1]


def coarsest(
    name: str, given: Mapping[str, object], mesh: str | Sequence[int] | None = None, **options: Any
) -> tuple[Scene, Request]:
    """The scene and its request on the grid from which a refinement sets out; ``complete`` of scenes says how.

    mesh: by default what the scene names, or a quarter of its own both ways. Where lines could be crowded where the
    scene expects what decides its answers, they are not: refinement finds that out.
    """
    scene = SCENES.get(name)
    if scene is not None:
        mesh = mesh or coarsest_mesh(scene)
        if any(setting.key == "grading" for setting in scene.settings):
            given = {"grading": "uniform", **given}
    return complete(name, given, mesh, **options)


def coarsest_mesh(scene: Scene) -> tuple[int, int]:
    """A quarter of the default mesh both ways, or what the scene names."""
    return scene.coarsest_mesh if isinstance(scene, RefinedScene) else quarter(scene)


def first_grid(
    name: str, given: Mapping[str, object], mesh: str | Sequence[int] | None = None, **options: Any
) -> tuple[Scene, Request]:
    """The scene and its request on the first grid of a cascade, as :func:`studies.scenes.complete.complete`.

    mesh: by default a quarter of that of the scene both ways. Lines that may follow an estimate of the error do, unless
    their grading is given: errors of contact scatter less on them. Raises UsageError for a mesh with one element along
    a coordinate along which answers vary.
    """
    scene = SCENES.get(name)
    if isinstance(scene, AdaptedScene) and "grading" not in given:
        with suppress(UsageError):  # where there is no estimate the lines are those of the scene
            n1, n2 = scene.default_mesh
            _, request = complete(
                name, {**given, "grading": "adapted"}, mesh or (n1 // 2 & ~1, n2 // 2 & ~1), **options
            )
            return scene.adapted(request), _cut_as_it_varies(scene, request)
    if scene is None or mesh is not None:
        asked, request = complete(name, given, mesh, **options)
        return asked, _cut_as_it_varies(asked, request)
    completed = complete(name, given, quarter(scene), **options)
    try:
        built(scene, completed[1])
    except UsageError:  # a scene may take no such mesh
        return coarsest(name, given, mesh, **options)
    return completed


def _cut_as_it_varies(scene: Scene, request: Request) -> Request:
    """The request; raises UsageError where finer grids of it leave out a coordinate along which answers vary."""
    if axis := alone(scene, request.mesh):
        raise UsageError(f"mesh {request.mesh_text} has one element along {axis}, which finer grids keep: give several")
    return request
