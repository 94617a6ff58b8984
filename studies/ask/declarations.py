"""What a scene declares: values to compare with, ladders of meshes, its picture, its limit, and all that together."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

from studies.ask.model import SceneModel
from studies.ask.request import Request, Settings
from studies.ask.settings import Setting

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
