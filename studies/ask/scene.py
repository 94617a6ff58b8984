"""What a scene is, and the door to all that the file of one needs.

A scene is a class in :mod:`studies.scenes`, alone in its file or beside its family, and a line in its catalogue. What
it declares is made of :mod:`studies.ask.settings` and :mod:`studies.ask.declarations`, what it builds is a
:mod:`studies.ask.model`.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Protocol, runtime_checkable

from studies.ask.declarations import BENCHMARKS
from studies.ask.declarations import CONTACT as CONTACT  # what the file of a scene needs beside this
from studies.ask.declarations import Declared as Declared
from studies.ask.declarations import Ladder as Ladder
from studies.ask.declarations import Reference as Reference
from studies.ask.declarations import Sheet as Sheet
from studies.ask.declarations import ShellLimit as ShellLimit
from studies.ask.model import Begun as Begun
from studies.ask.model import CurveStage as CurveStage
from studies.ask.model import MovingModel as MovingModel
from studies.ask.model import Observation as Observation
from studies.ask.model import PointedModel as PointedModel
from studies.ask.model import SceneModel as SceneModel
from studies.ask.model import ShellSceneModel as ShellSceneModel
from studies.ask.model import Stage as Stage
from studies.ask.model import Units as Units
from studies.ask.model import candidates_at as candidates_at
from studies.ask.model import moved as moved
from studies.ask.model import nodal_pressure as nodal_pressure
from studies.ask.request import Request as Request
from studies.ask.request import UsageError as UsageError
from studies.ask.request import Value
from studies.ask.settings import EPSILON as EPSILON
from studies.ask.settings import MU, SLIDING, TOLERANCE
from studies.ask.settings import SOLVER as SOLVER
from studies.ask.settings import Setting as Setting


class Scene(Protocol):
    """A catalogue entry."""

    @property
    def name(self) -> str:
        """Name in the catalogue."""

    @property
    def title(self) -> str:
        """One line for people."""

    @property
    def default_mesh(self) -> tuple[int, int]:
        """Elements along a1 and a2."""

    @property
    def settings(self) -> tuple[Setting, ...]:
        """The keys of --set."""

    @property
    def references(self) -> tuple[Reference, ...]:
        """Values to compare with."""

    def build(self, request: Request) -> SceneModel:
        """Check what ranges alone cannot and build; raises UsageError."""


@runtime_checkable
class CompletingScene(Protocol):
    """A scene with settings that depend on one another."""

    def complete(self, settings: Mapping[str, Value]) -> dict[str, Value]:
        """Fill in what depends on other settings; raises UsageError on combinations that exclude each other."""


@runtime_checkable
class RefinedScene(Protocol):
    """A scene that names the grid from which a refinement to an error starts, where a quarter of its own is invalid."""

    @property
    def coarsest_mesh(self) -> tuple[int, int]:
        """Elements along a1 and a2."""


@runtime_checkable
class CutScene(Protocol):
    """A scene on a mesh of its own, whose elements are cut in n x n: its mesh is nxn, and 1x1 as it stands."""

    cut: bool


@runtime_checkable
class SlidingScene(Protocol):
    """A scene whose whole body lies on its foundation, so that this may be dragged and turned under it."""

    slides: bool


@runtime_checkable
class SettlingScene(Protocol):
    """A scene with more than the full model, or to which a part of the request does not apply."""

    @property
    def models(self) -> tuple[str, ...]:
        """The choices of --model; the first one is "auto"."""

    def settle(self, request: Request) -> Request:
        """The request as it will be solved, its model chosen; raises UsageError on what does not apply."""


def models_of(scene: Scene) -> tuple[str, ...]:
    """The choices of --model; of most scenes "auto" alone, a part by symmetry or the whole as their words have it."""
    return scene.models if isinstance(scene, SettlingScene) else ("auto",)


def has_contact(scene: Scene) -> bool:
    """Whether something may touch: the scene takes the regularisation of a contact condition."""
    return any(setting.key == EPSILON.key for setting in scene.settings)


def settings_beside(scene: Scene) -> tuple[Setting, ...]:
    """What every scene has beside its own settings and those of an algorithm.

    With contact there is friction; a foundation is dragged and turned where a whole body lies on it.
    """
    if not has_contact(scene):
        return (TOLERANCE,)
    return (TOLERANCE, MU, *(SLIDING if isinstance(scene, SlidingScene) else ()))


def ladders_of(scene: Scene) -> tuple[Ladder, ...]:
    """What a scene declares, with its name; none of one from outside that declares nothing."""
    declared: tuple[Ladder, ...] = getattr(scene, "ladders", ())
    return tuple(replace(each, name=each.name or scene.name, scene=scene.name) for each in declared)


def judged_of(scene: Scene) -> tuple[str, ...]:
    """The quantities that a scene is judged by, its headline first: those of its ladders, else of its references."""
    ladders = [each for each in ladders_of(scene) if each.family != BENCHMARKS]
    names = [name for ladder in ladders for name in ladder.quantities]
    return tuple(dict.fromkeys(names or [reference.quantity for reference in scene.references]))


def sheet_of(scene: Scene) -> Sheet:
    """The picture that a scene declares, or that of one that declares none."""
    sheet: Sheet = getattr(scene, "sheet", Sheet())
    return sheet
