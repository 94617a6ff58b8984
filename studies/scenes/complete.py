"""From the input of a user, or a cell of a campaign, to a request: every default filled in, every value checked;
and the references of its scene that are valid for it, at a load.
"""

import importlib.util
import math
from collections.abc import Container, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

from contact.catalogue import ALGORITHMS
from formulations.section.laminate import LINEAR
from formulations.shell import NEWTONS
from formulations.strains.catalogue import MEASURES
from studies.ask.request import Request, Settings, Value, names_for, text_of
from studies.ask.scene import (
    EPSILON,
    CompletingScene,
    Reference,
    Scene,
    Setting,
    SettlingScene,
    UsageError,
    has_contact,
    models_of,
    settings_beside,
)
from studies.ask.settings import STEPS, completed, parameters_of, rubbing, settings_of, without_friction
from studies.scenes import SCENES
from studies.scenes.plugins import use_options

LARGEST_MESH = 250_000


@dataclass(frozen=True)
class Cell:
    """A labelled request: ``label`` is for people, ``options`` are those of ``footprint solve``.

    artefacts: its fields and tables are kept beside its record.  group: the list that it is of.
    expected: why it is expected to fail, if so.
    """

    label: str
    scene: str
    options: dict[str, Any] = field(default_factory=dict)
    settings: dict[str, str] = field(default_factory=dict)
    artefacts: bool = True
    expected: str = ""
    group: str = ""

    def resolved(self) -> tuple[Scene, Request]:
        """The scene and the request; raises UsageError for an invalid one."""
        return complete(self.scene, self.settings, **self.options)

    @property
    def command(self) -> str:
        """The command with the answer of the cell; it starts from coarser grids, so that its iterations differ."""
        arguments = [f"--{key} {value}" for key, value in self.options.items()]
        arguments += [f"--set {key}={value}" for key, value in self.settings.items()]
        return " ".join(["footprint solve", self.scene, *arguments, *use_options(), "--out DIR"])


def complete(
    scene_name: str, given: Mapping[str, object], mesh: str | Sequence[int] | None = None, **options: Any
) -> tuple[Scene, Request]:
    """The scene and the resolved request; raises UsageError with one line.

    given, mesh: text, or Python's values.  options: measure, contact, newton, model, steps.
    """
    scene = SCENES.get(scene_name) if isinstance(scene_name, str) else None
    if scene is None:
        raise UsageError(
            f"scene {scene_name!r} must be one of {names_for(scene_name, SCENES, 'footprint list scenes')}"
        )
    known = {setting.key: setting for setting in (*scene.settings, *settings_beside(scene))}
    if has_contact(scene):
        known |= {setting.key: setting for setting in settings_of(options.get("contact", Request.contact))}
    for key in given:
        if key not in known:
            has = names_for(key, known, " ".join(["footprint show", scene_name, *use_options()]))
            raise UsageError(f"{scene_name} has no setting {key!r}; it has {has}")
    chosen = completed({key: known[key].parse(value) for key, value in given.items()})
    if rubbing(chosen):
        known = _with_friction(known, given, options.get("contact", Request.contact))
    settings = _with_defaults(known, chosen)
    if isinstance(scene, CompletingScene):
        settings = scene.complete(settings)
    if STEPS.key in options:
        options[STEPS.key] = STEPS.parse(options[STEPS.key])
    request = Request(scene_name, mesh=_mesh(mesh, scene), **options)
    for name, value, choices in (
        ("measure", request.measure, MEASURES),
        ("contact", request.contact, ALGORITHMS),
        ("newton", request.newton, NEWTONS),
        ("model", request.model, models_of(scene)),
    ):
        if not isinstance(value, str) or value not in choices:
            alone = f": {scene_name} has no other" if len(choices) == 1 else ""
            raise UsageError(f"{name} {value!r} must be one of {', '.join(choices)}{alone}")
    if settings.get("solver") == "pardiso" and importlib.util.find_spec("pypardiso") is None:
        raise UsageError("solver 'pardiso' needs the extra mkl: pip install -e '.[mkl]' in the checkout of Footprint")
    if has_contact(scene) and EPSILON.key not in settings:
        settings[EPSILON.key] = ALGORITHMS[request.contact]().epsilon
    request = replace(request, settings=Settings(settings))
    return scene, scene.settle(request) if isinstance(scene, SettlingScene) else replace(request, model="full")


def _with_friction(known: Mapping[str, Setting], given: Mapping[str, object], contact: str) -> dict[str, Setting]:
    """Those that the algorithm has with friction, too; raises UsageError where another one is given."""
    lost = without_friction(contact)
    for key in lost:
        if key in given:
            has = ", ".join(each.key for each in parameters_of(contact) if each.key not in lost)
            raise UsageError(f"{key} = {given[key]}: with friction {contact} has {has} only")
    return {key: setting for key, setting in known.items() if key not in lost}


def _with_defaults(known: Mapping[str, Setting], given: Mapping[str, Value]) -> dict[str, Value]:
    """Given values, before what a preset stands for, before defaults; the name of a preset is resolved away."""
    settings = {key: setting.default for key, setting in known.items() if setting.default is not None} | dict(given)
    for key, setting in known.items():
        if setting.presets:
            settings = {**setting.presets[str(settings.pop(key))], **settings}
    return settings


def _mesh(mesh: str | Sequence[int] | None, scene: Scene) -> tuple[int, int]:
    if mesh is None:
        return scene.default_mesh
    text = mesh if isinstance(mesh, str) else "x".join(map(text_of, mesh)) if isinstance(mesh, Iterable) else repr(mesh)
    parts = text.lower().split("x")
    if len(parts) != 2 or not all(part.isascii() and part.isdigit() for part in parts):
        raise UsageError(f"mesh {text!r} must be N1xN2 with two whole numbers, e.g. 42x40")
    n1, n2 = (int(part) for part in parts)
    if min(n1, n2) < 1 or n1 * n2 > LARGEST_MESH:
        raise UsageError(f"mesh {text!r} must have at least 1 and in all at most {LARGEST_MESH} elements")
    usual1, usual2 = scene.default_mesh
    if (usual1 == 1 == n2 and min(usual2, n1) > 1) or (usual2 == 1 == n1 and min(usual1, n2) > 1):
        usual = f"by default {usual1}x{usual2}: is {n2}x{n1} meant?"
        raise UsageError(f"mesh {text!r} has one element along {scene.name}, {usual}")
    return n1, n2


UNSAID: Mapping[str, float | str] = {"law": LINEAR, "mu": 0.0}  # of what does not name them
# what grows along a path; all else that a reference names is a setting
STEP_KEYS = ("load_fraction", "delta_mm", "way_mm")


def holding(scene: str, there: Mapping[str, Any]) -> Iterator[Reference]:
    """The references of a scene that are valid for these settings, this measure and this load.

    Those of value zero are left out: errors are relative. One that names neither law nor mu is of the linear law
    without friction. A campaign may bring scenes of its own, which are not loaded here.
    """
    where = {**UNSAID, **there}
    for reference in SCENES[scene].references if scene in SCENES else ():
        at = {**UNSAID, **reference.at}
        if reference.value != 0.0 and all(_same(where.get(key), value) for key, value in at.items()):
            yield reference


def closest(scene: str, there: Mapping[str, Any], quantities: Container[str]) -> dict[str, Reference]:
    """Of the references that are valid there, the least uncertain one of each of these quantities."""
    best: dict[str, Reference] = {}
    for reference in holding(scene, there):
        if reference.quantity in quantities:
            known = best.get(reference.quantity, reference)
            best[reference.quantity] = min(known, reference, key=lambda each: each.uncertainty)
    return best


def _same(there: Value | None, at: float | str) -> bool:
    if isinstance(there, int | float) and isinstance(at, int | float):
        return math.isclose(there, at, rel_tol=1e-9, abs_tol=1e-12)
    return there == at
