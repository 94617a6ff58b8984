"""A case as plain data, and how a request is drawn from a number: scene, options, settings, grid."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from contact.catalogue import ALGORITHMS
from formulations.shell import NEWTONS
from formulations.strains.catalogue import MEASURES
from studies.algorithm_settings import TOLERANCE, settings_of
from studies.campaigns.cell import Cell
from studies.complete import complete
from studies.friction.settings import SLIDING
from studies.fuzz.paths import rubbing
from studies.fuzz.values import drawn, generator
from studies.refinement.trees import Family
from studies.request import Request
from studies.scene import Scene, Setting, SettlingScene, UsageError, has_contact
from studies.scenes import SCENES

SCENE, FRICTION = "scene", "friction"  # kinds of a number that stands for a request
KINDS = {SCENE: 0.2, FRICTION: 0.15, "posed": 0.15, "matrices": 0.5}  # by what a case costs
OFTEN = {"panel": 8, "tyre": 10, "crushed-ring-solid": 1, "tyre-solid": 1}  # for their settings, or for their cost
RUBBED = {"panel": 10.0, "tyre": 8.0, "crushed-ring-solid": 0.3, "tyre-solid": 0.5}  # with friction; the others 1
WITH_CONTACT = 4  # the others, as often as a scene without
CHANGED = (0, 1, 2, 3, 4, 6, 8)  # how many settings leave their default
REPAIRED = 0.93  # share of refused requests that give settings back until they are taken
HUNG, REFINED = 0.25, 48  # share of scenes whose grid is refined in places, where it can be, and its most elements
LARGEST = {SCENE: 6, FRICTION: 4}  # elements along a side, of what may have as few as two
LONG = 0.12  # share of grids with many elements along one side and one or two across
SLIVERS = {1: {SCENE: (32, 64, 128), FRICTION: (16, 32)}, 2: {SCENE: (16, 32), FRICTION: (16,)}}  # by those across
TOGETHER = ({"E_MPa", "nu"},)  # keys that a scene with all of them wants both or neither
EVEN = ("tyre", "tyre-solid")  # meshes of even numbers, six at least


@dataclass(frozen=True)
class Asked:
    """A request as it is asked for; refined: its grid is cut in places, by a choice of the case's number."""

    scene: str
    options: Mapping[str, str] = field(default_factory=dict)
    settings: Mapping[str, str] = field(default_factory=dict)
    refined: bool = False

    @property
    def command(self) -> str:
        """The command that solves it; a grid that is refined by hand has none."""
        cell = Cell("", self.scene, dict(self.options), dict(self.settings))
        return cell.command + (" (refined in places)" if self.refined else "")

    def with_options(self, **options: str) -> Asked:
        """Other options."""
        return replace(self, options={**self.options, **options})

    def with_settings(self, **settings: str) -> Asked:
        """Other settings."""
        return replace(self, settings={**self.settings, **settings})

    def request(self, seed: int) -> tuple[Scene, Request]:
        """Resolved; raises UsageError."""
        options: dict[str, Any] = {**self.options}
        if "steps" in options:
            options["steps"] = int(options["steps"])
        scene, request = complete(self.scene, self.settings, **options)
        return scene, _refined(scene, request, seed) if self.refined else request


def kind_of(seed: int) -> str:
    """What sort of case a number is."""
    return str(generator(seed, "kind").choice(list(KINDS), p=list(KINDS.values())))


def asked_of(seed: int, kind: str = SCENE) -> Asked:
    """The request of a number, of the kind SCENE or FRICTION."""
    rng = generator(seed, "scene")
    weights = np.array([_weight(name, kind) for name in SCENES])
    name = str(rng.choice(list(SCENES), p=weights / weights.sum()))
    scene, options = SCENES[name], {"mesh": _mesh(name, kind, seed)}
    rubbed = rubbing(name, scene, seed) if kind == FRICTION else {}
    slides = any(setting.key in rubbed for setting in SLIDING)  # whole bodies alone
    for option, choices, usual in (
        ("measure", MEASURES, 0.5),
        ("newton", NEWTONS, 0.7),
        ("model", scene.models if isinstance(scene, SettlingScene) and not slides else (), 0.6),
        ("steps", ("1", "2", "3", "4"), 0.6 if rubbed else 0.8),
        ("contact", ALGORITHMS if has_contact(scene) else (), 0.1),
    ):
        chosen = generator(seed, option)
        if choices and chosen.random() > usual:
            options[option] = str(chosen.choice(list(choices)))
    own = settings_of(options.get("contact", Request.contact)) if has_contact(scene) else ()
    known = (*scene.settings, TOLERANCE, *own)
    settings = {**rubbed, **_settings(known, seed)}  # given back from the last one on
    refined = rng.random() < HUNG and math.prod(map(int, options["mesh"].split("x"))) <= REFINED
    return _repaired(Asked(name, options, settings, refined), seed, kept=len(rubbed))


def _weight(name: str, kind: str) -> float:
    """How often a scene is drawn."""
    if kind == FRICTION:
        return RUBBED.get(name, 1.0) if has_contact(SCENES[name]) else 0.0
    return float(OFTEN.get(name, WITH_CONTACT if has_contact(SCENES[name]) else 1))


def _settings(known: tuple[Setting, ...], seed: int) -> dict[str, str]:
    """Some of the settings with values of their own."""
    count = int(generator(seed, "how many").choice(CHANGED))
    order = sorted(known, key=lambda setting: generator(seed, f"turn of {setting.key}").random())
    chosen = {setting.key for setting in order[:count]}
    for keys in TOGETHER:
        if chosen & keys and keys <= {setting.key for setting in known}:
            chosen |= keys
    return {setting.key: drawn(setting, seed) for setting in known if setting.key in chosen}


def _mesh(name: str, kind: str, seed: int) -> str:
    rng, default = generator(seed, "mesh"), SCENES[name].default_mesh
    if name in EVEN:
        return f"6x{rng.choice([6, 8])}"
    if rng.random() < LONG:
        across = 1 if 1 in default else 2
        sides = [str(rng.choice(SLIVERS[across][kind])), str(across)]
        return "x".join(sides if default[0] > 1 and (default[1] == 1 or rng.random() < 0.5) else sides[::-1])
    return "x".join("1" if n == 1 and rng.random() < 0.9 else str(rng.integers(2, LARGEST[kind] + 1)) for n in default)


def _repaired(asked: Asked, seed: int, kept: int) -> Asked:
    """Mostly a request that is taken: options and settings are given back one by one until it is.

    kept: how many of the settings are given back only where nothing else helps.
    """
    rng = generator(seed, "repair")
    if rng.random() > REPAIRED:
        return asked
    for fewer in _fewer(asked, kept):
        try:
            scene, request = fewer.request(seed)
            scene.build(request)
        except UsageError:
            continue
        except Exception:  # a finding: it is left for whoever solves it
            return fewer
        return fewer
    return asked


def _fewer(asked: Asked, kept: int) -> list[Asked]:
    """The request, and with less and less of it."""
    found, settings = [asked], dict(asked.settings)
    while len(settings) > kept:
        settings.popitem()
        found.append(replace(asked, settings=dict(settings)))
    bare = {key: value for key, value in asked.options.items() if key in ("mesh", "contact")}
    plain = Asked(asked.scene, {"mesh": asked.options["mesh"]})
    return [*found, replace(asked, options=bare, settings=settings), replace(plain, settings=settings), plain]


def _refined(scene: Scene, request: Request, seed: int) -> Request:
    """The request with a tree over its mesh, where its grid takes one."""
    family, rng = Family.of(scene, request), generator(seed, "leaves")
    if family.tree is None:
        return request
    return family.refined(rng.random(len(family.tree.leaves)) ** 4).asked
