"""What may be varied on a scene: strain measures, options of the element as the scene declares them, models.

A variant is the request of the reference with one thing changed, on the same mesh. Contact algorithms are no variants:
they give the same values, and are tried (:mod:`studies.solving.choosing.trials`). Nothing is solved here.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field, replace

from formulations.strains.catalogue import MEASURES
from studies.ask.request import Request, Settings, Value
from studies.ask.scene import Scene, SettlingScene, UsageError
from studies.scenes.element import OPTIONS, PRESETS

MEASURE, ELEMENT, MODEL = "measure", "element", "model"
AXES = (MEASURE, ELEMENT, MODEL)
REFERENCE = "exact"  # the measure that neglects nothing


@dataclass(frozen=True)
class Variant:
    """One thing changed: its axis, its name, the request, and what a command line says for it.

    refused: why it does not apply, if it does not.
    """

    axis: str
    name: str
    request: Request
    options: dict[str, str] = field(default_factory=dict)
    settings: dict[str, str] = field(default_factory=dict)
    refused: str = ""


def variants(scene: Scene, reference: Request) -> Iterator[Variant]:
    """All of them, axis by axis; reference: the request of the exact measure, on any mesh."""
    for name in MEASURES:
        if name != reference.measure:
            yield _checked(scene, Variant(MEASURE, name, replace(reference, measure=name), {"measure": name}))
    yield from (_checked(scene, each) for each in _elements(scene, reference))
    if isinstance(scene, SettlingScene):
        yield from _models(scene, reference)


def _elements(scene: Scene, reference: Request) -> Iterator[Variant]:
    """Presets, and each option changed alone, no combination twice."""
    declared = {setting.key for setting in scene.settings}
    own = {key: reference.settings[key] for key, *_ in OPTIONS if key in declared}
    seen = [own]
    presets: list[tuple[str, dict[str, Value], dict[str, str]]] = [
        (name, {**own, **values}, {"element": name}) for name, values in PRESETS.items() if "element" in declared
    ]
    alone: list[tuple[str, dict[str, Value], dict[str, str]]] = [
        (f"{key}={choice}", {**own, key: choice}, {key: choice})
        for key, choices, _ in OPTIONS
        if key in own
        for choice in choices
    ]
    for name, values, said in presets + alone:
        if values not in seen:
            seen.append(values)
            settings = Settings({**reference.settings, **values})
            yield Variant(ELEMENT, name, replace(reference, settings=settings), settings=said)


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
        scene.build(variant.request)
    except UsageError as error:
        return replace(variant, refused=str(error))
    return variant
