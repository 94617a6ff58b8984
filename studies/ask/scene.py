"""What a scene is, and the door to all that the file of one needs.

A scene is a class in :mod:`studies.scenes`, alone in its file or beside its family, and a line in its catalogue. What
it declares is made of :mod:`studies.ask.settings` and of what stands here, what it builds is a
:mod:`studies.ask.model`.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from typing import Protocol, runtime_checkable

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
from studies.ask.request import Settings, Value
from studies.ask.request import UsageError as UsageError
from studies.ask.settings import EPSILON as EPSILON
from studies.ask.settings import MU, SLIDING, TOLERANCE
from studies.ask.settings import SOLVER as SOLVER
from studies.ask.settings import Setting as Setting

ROTATIONS, SNAP, LINEAR = "large rotations", "snap through", "linear shells"  # the families, whose pictures they are in
CLOSED, CONTACT, TYRE = "closed forms", "contact", "tyre"
BENCHMARKS = "benchmarks"  # with the element of the paper, at every load of the published tables
FULL = {"load_fraction": "1"}
# A free edge has a layer as wide as the wall is thick, where twist turns into shear: even lines meet it on one mesh of
# many, and the order changes there.
EDGES = {**FULL, "lines": "edges"}
CANCEL = "two errors of different order and opposite sign cancel on these meshes"
BEAM, ROOF = "cantilever under an end force", "roof under its weight"  # cases of the table of shell limits
BENT, CRUSHED, PRESSED = "ring made oval", "crushed ring", "strip on an obstacle"
LONG = ("64x1", "128x1", "256x1", "512x1")  # where nothing varies along a2


@dataclass(frozen=True)
class Reference:
    """A value to compare with: quantity name as in the result, where it is valid, its kind and source.

    kind: "printed" (in the source itself), "read" (in a public transcription), "computed" (independent program),
    "exact" (closed form), "refined" (limit of grids of ours beyond those that it judges). uncertainty: relative.
    """

    quantity: str
    value: float
    at: Mapping[str, float | str]
    kind: str
    source: str
    uncertainty: float


@dataclass(frozen=True)
class Ladder:
    """A scene on meshes from coarse to fine; the size of their elements falls as 1 over the first number.

    quantities: what is judged; the first one of a scene's first ladder is its headline.  measure, settings: as for
    ``footprint solve``.  at: the step where quantities are read, KEY=VALUE; without one, the last step.
    coarser: what is solved in the place of the finest mesh where that is left out and only two would be left.
    causes: why quantities by name are not in an asymptotic range.  whole: settings at the load that the scene is known
    for, where the ladder stops before it, its own load on the way.  name: that of its scene unless another is given.
    """

    family: str
    meshes: tuple[str, ...]
    quantities: tuple[str, ...]
    measure: str = "exact"
    settings: Mapping[str, str] = field(default_factory=dict)
    at: str = ""
    coarser: tuple[str, ...] = ()
    causes: Mapping[str, str] = field(default_factory=dict)
    whole: Mapping[str, str] = field(default_factory=dict)
    name: str = ""
    scene: str = ""

    def climbed(self, *, finest: bool) -> tuple[str, ...]:
        """Its meshes, with the finest or without."""
        return self.meshes if finest else (*self.coarser, *self.meshes[:-1])


def meshes(n1: int, n2: int, count: int = 4) -> tuple[str, ...]:
    """A mesh and those of half the elements' size, a quarter, ..."""
    return tuple(f"{n1 * 2**k}x{n2 * 2**k}" for k in range(count))


@dataclass(frozen=True)
class Sheet:
    """The picture of a scene: from where it is seen, and what is solved for it.

    up: what points upwards, "x", "-x" or "z"; azimuth, elevation [deg] of the viewer around it and above the horizon.
    mesh: where the default one is more, or less, than a picture shows.  settings: instead of what the first ladder asks
    for.  model: another than "auto".  listed: whether the campaigns with pictures of all scenes solve it.
    """

    up: str = "z"
    azimuth: float = -55.0
    elevation: float = 26.0
    mesh: str = ""
    settings: Mapping[str, str] = field(default_factory=dict)
    model: str = ""
    listed: bool = True


@dataclass(frozen=True)
class ShellLimit:
    """The case of the table of shell limits that a scene is, or that comes nearest to it.

    ratio: the thickness of its wall in the terms of that case, from its settings.  same: whether it is that very case.
    only_with: a setting without which it is not.  solid: the scene of its solid, if there is one.  quantities: of the
    case, by how those of the scene begin; any other is judged by the headline of the case.
    """

    case: str
    ratio: Callable[[Settings], float]
    same: bool = True
    only_with: str = ""
    solid: str = ""
    quantities: Mapping[str, str] = field(default_factory=dict)


def thickness_over(length: float, thickness: float | str) -> Callable[[Settings], float]:
    """A wall of some thickness, or of one that is a setting, over a length."""
    return lambda settings: (settings.number(thickness) if isinstance(thickness, str) else thickness) / length


class Declared(ABC):
    """A scene of ours: what it declares of itself, and what most scenes declare alike."""

    name: str
    title: str
    default_mesh: tuple[int, int]
    settings: tuple[Setting, ...]
    references: tuple[Reference, ...] = ()
    quantities: Mapping[str, str]
    ladders: tuple[Ladder, ...] = ()
    sheet: Sheet = Sheet()
    shell_limit: ShellLimit | None = None

    @abstractmethod
    def build(self, request: Request) -> SceneModel:
        """Check what ranges alone cannot and build; raises UsageError."""


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
