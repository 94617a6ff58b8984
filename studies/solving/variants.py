"""What may be varied on a scene, and a variant on the grids of the reference, coarse to fine.

A variant is the request of the reference with one thing changed, on the same mesh: its strain measure, the surfaces
through its wall, how two faces meet, an option of the element as the scene declares them, its model. Each path starts
from the one on the grid before, where it is that of one shell. Contact algorithms are not variants: they give the same
values, and are tried (:mod:`studies.solving.trials`). What is enough is not decided here
(:mod:`studies.solving.verdict`).
"""

from __future__ import annotations

import math
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace

from formulations.section.sampling import Sampling
from formulations.shell import BENDINGS, ShellModel
from formulations.strains.catalogue import MEASURES
from studies.ask.request import PartError, Request, Settings, UsageError, Value
from studies.ask.scene import CompletingScene, Scene, SettlingScene
from studies.scenes.element import BENDING, COARSE, ON_MESHES, OPTIONS, PRESETS
from studies.solving.refinement.nested import LOOSE, Sketch, sketch

MEASURE, SURFACES, FACES, ELEMENT, MODEL = "measure", "surfaces", "faces", "element", "model"
OF_FACES = ("pairing", "slave", "faces")  # settings that say how two faces meet
REFERENCE = "exact"  # the measure that neglects nothing
FEWEST = 4  # grids, each with twice the unknowns of the last, that say anything of a limit
FAILURES = 2  # grids in a row on which a path is not followed, after which no other is tried


@dataclass(frozen=True)
class Variant:
    """One thing changed: its axis, its name, the request, and its settings on a command line.

    refused: why it does not apply, if it does not.  wall: its surfaces, where they are not those of the reference.
    """

    axis: str
    name: str
    request: Request
    options: dict[str, str] = field(default_factory=dict)
    settings: dict[str, str] = field(default_factory=dict)
    refused: str = ""
    wall: str = ""


def variants(scene: Scene, reference: Request, given: Collection[str] = ()) -> Iterator[Variant]:
    """All of them, axis by axis; reference: request of the exact measure, on any mesh.  given: settings asked for."""
    for name in MEASURES:
        if name != reference.measure:
            yield _checked(scene, Variant(MEASURE, name, replace(reference, measure=name), {"measure": name}))
    for setting in scene.settings:
        for choice in setting.choices if setting.key in OF_FACES else ():
            if choice != reference.settings[setting.key]:
                changed = {setting.key: str(choice)}
                variant = Variant(FACES, f"{setting.key}={choice}", _with(reference, changed), settings=changed)
                yield _checked(scene, variant)
    yield from (_checked(scene, each) for each in _elements(scene, reference, given))
    if isinstance(scene, SettlingScene):
        yield from _models(scene, reference)


def richer_walls(scene: Scene, reference: Request) -> Iterator[Variant]:
    """More and more surfaces than the reference has, where the scene knows them; of elements that bend along chords.

    Of several plies in each: a polynomial over all of them may change nothing where the plies matter.
    """
    offered = [choice for setting in scene.settings if setting.key == SURFACES for choice in setting.choices]
    shell = getattr(scene.build(reference), "shell", None)
    if not offered or not isinstance(shell, ShellModel):
        return
    body = shell.discretisation
    several, here = len(body.laminate.plies) > 1, 2 + len(body.map.inside)
    chords = {BENDING.key: BENDINGS[0]} if BENDING.key in reference.settings else {}
    for name in offered:
        if name.endswith("/ply") == several and len(Sampling.of(body.laminate, name).at) > here:
            changed = {SURFACES: name, **chords}
            yield _checked(scene, Variant(SURFACES, name, _with(reference, changed), settings=changed))


def beside_wall(variant: Variant, wall: Variant) -> Variant:
    """A variant of the request of a wall with more surfaces, whose settings a command needs, too."""
    return replace(variant, settings={**wall.settings, **variant.settings}, wall=wall.settings.get(SURFACES, ""))


def _elements(scene: Scene, reference: Request, given: Collection[str]) -> Iterator[Variant]:
    """Presets, and each option changed alone, no combination twice.

    A command names a preset, unless one of the options was given: what is given comes before a preset.
    """
    declared = {setting.key for setting in scene.settings}
    chord = {BENDING.key: BENDINGS[0]} if BENDING.key in declared else {}
    base = {key: reference.settings[key] for key, *_ in OPTIONS if key in declared}
    base |= {key: reference.settings.get(key, value) for key, value in chord.items()}
    combinations, by_name = [base], "element" in declared and not {*base} & {*given}
    known = PRESETS | (COARSE if chord else {}) if "element" in declared else {}
    for name, preset in known.items():
        values = {**base, **chord, **preset}
        if values not in combinations:
            combinations.append(values)
            differing = {key: str(value) for key, value in values.items() if value != base[key]}
            request = _with(reference, preset, BENDING.key) if by_name else _with(reference, differing)
            yield Variant(ELEMENT, name, request, settings={"element": name} if by_name else differing)
    for key, choices, _ in OPTIONS:
        for choice in choices if key in base else ():
            values = {**base, key: choice}
            if choice not in ON_MESHES and values not in combinations:
                combinations.append(values)
                yield Variant(ELEMENT, f"{key}={choice}", _with(reference, {key: choice}), settings={key: choice})


def _with(reference: Request, changed: Mapping[str, Value], without: str = "") -> Request:
    settings = {key: value for key, value in reference.settings.items() if key != without}
    return replace(reference, settings=Settings({**settings, **changed}))


def _models(scene: SettlingScene, reference: Request) -> Iterator[Variant]:
    for name in scene.models:
        if name in ("auto", reference.model):
            continue
        try:
            settled = scene.settle(replace(reference, model=name))
        except UsageError as error:
            yield Variant(MODEL, name, reference, refused=str(error))
            continue
        if settled.model == name:
            yield Variant(MODEL, name, settled, {"model": name})


def _checked(scene: Scene, variant: Variant) -> Variant:
    """The variant, refused where the scene is not built with it."""
    try:
        if isinstance(scene, CompletingScene):
            scene.complete(variant.request.settings)
        scene.build(scene.settle(variant.request) if isinstance(scene, SettlingScene) else variant.request)
    except UsageError as error:
        return replace(variant, refused=str(error))
    return variant


@dataclass(eq=False)
class Ladder:
    """The reference, or a variant, on grids; ``paths`` are those that were followed to their end.

    seen: grids that were tried.  lost: those in a row on which the path was not followed.  said: why no more are tried.
    waits: the mesh that there was no time for.
    """

    variant: Variant
    paths: list[Sketch] = field(default_factory=list)
    seen: int = 0
    lost: int = 0
    said: str = ""
    waits: str = ""

    def climb(self, scene: Scene, beside: Sketch, seconds: float) -> None:
        """Follow the path on one grid more: that of the reference's path ``beside`` it, which is its first start.

        seconds: of CPU time that it may take.
        """
        request = replace(self.variant.request, mesh=beside.request.mesh)
        self.seen, self.waits = self.seen + 1, ""
        try:
            path = sketch(scene, request, self.paths[-1] if self.paths else beside, LOOSE, seconds=seconds)
        except (UsageError, PartError) as error:
            path, self.said = None, str(error)
        if path is not None:
            self.rest()
            self.paths.append(path)
            self.lost = 0
            return
        self.lost += 1
        if self.lost >= FAILURES and not self.said:
            self.said = f"its path does not reach its last load on {beside.mesh}"

    def rest(self) -> None:
        """Keep of the last path its values alone: nothing is started from it any more."""
        self.paths[-1:] = [path.values_only for path in self.paths[-1:]]

    @property
    def turn(self) -> int:
        """The order: first those without a grid, those that have begun, those with one grid, those with enough."""
        return 0 if self.seen == 0 else 3 if self.seen >= FEWEST else 1 if self.seen > 1 else 2

    def next_of(self, along: Ladder) -> Sketch | None:
        """The reference's path on the grid that is tried next, if there is one."""
        return along.paths[self.seen] if self.seen < len(along.paths) else None

    def begun(self, along: Ladder) -> Sequence[Sketch]:
        """The reference's paths on the grids that come next at one go."""
        return along.paths[self.seen : FEWEST if self.turn == 2 else self.seen + 1]

    def price(self, along: Ladder, quantity: str, error: float) -> float:
        """The seconds of the next grid, times 1 and the distance from the reference over ``error`` on the last one."""
        path = self.next_of(along)
        seconds = 0.0 if path is None else self.foreseen(along, [path])
        if not self.paths:
            return seconds
        value, other = (each.quantities.get(quantity, math.nan) for each in (self.paths[-1], self._beside(along)))
        apart = abs(value - other) / (abs(other) or math.ulp(0.0))
        return seconds * (1 + (apart / error if math.isfinite(apart) else 0.0))

    def foreseen(self, along: Ladder, beside: Sequence[Sketch]) -> float:
        """CPU seconds on the grids of these paths of the reference, which takes so much more there than on the last."""
        seconds = sum(each.seconds for each in beside)
        return seconds * self.paths[-1].seconds / self._beside(along).seconds if self.paths else seconds

    def _beside(self, along: Ladder) -> Sketch:
        """The reference's path on the last grid."""
        return next(each for each in along.paths if each.request.mesh == self.paths[-1].request.mesh)

    def values(self, quantity: str) -> list[float]:
        """What was read off, by grid."""
        return [float(each.quantities.get(quantity, math.nan)) for each in self.paths]
