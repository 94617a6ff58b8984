"""Requests by their meshes: the coarsest one of a scene, the first of a cascade, and those of coarser and finer grids.

A coordinate with one element is not cut, for nothing varies along it. What grids do by themselves is in
:mod:`studies.solving.refinement.adaptive_grids`.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import replace
from itertools import product
from typing import Any, Protocol, runtime_checkable

from studies.ask.request import Request
from studies.ask.scene import CutScene, RefinedScene, Scene, SettlingScene, UsageError
from studies.scenes import SCENES
from studies.scenes.complete import complete
from studies.scenes.plugins import built

COARSER = 4  # the default mesh over the coarsest one
FEWEST = 4  # elements along a coordinate, below which it is not made coarser
NEAR = 2  # how far from the elements that are wanted those of a grid may be, where a scene does not take them


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


def element_size(request: Request) -> float:
    """Of the elements along the coordinates that have several, over that of a single one."""
    several = [n for n in request.mesh if n > 1] or [1]
    return math.prod(several) ** (-1 / len(several))


def ways(request: Request) -> int:
    """Coordinates that have several elements."""
    return sum(several_elements(request))


def several_elements(request: Request) -> tuple[bool, bool]:
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
