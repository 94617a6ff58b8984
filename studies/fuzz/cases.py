"""How a request is drawn from a number: scene, options, settings, grid, afresh or near a hard one.

With friction a coefficient is added, and ways of the foundation that reverse, stop and go on. A quarter of the requests
are one of the file hard_requests.txt with one thing changed. The file lists near-misses and findings of earlier
campaigns, a command a line, chosen by the largest ``hard`` in their tables; it is kept by hand. A case is still its
number: it chooses the request and the change.
"""

from __future__ import annotations

import math
import shlex
from dataclasses import replace
from pathlib import Path

import numpy as np

from contact.catalogue import ALGORITHMS
from formulations.shell import NEWTONS
from formulations.strains.catalogue import MEASURES
from studies.ask.request import Request
from studies.ask.scene import Scene, Setting, SettlingScene, SlidingScene, UsageError, has_contact
from studies.ask.settings import DRAG, MU, SLIDING, TOLERANCE, TURN, WAY, settings_of
from studies.fuzz.attempt import Asked
from studies.fuzz.values import drawn, generator
from studies.scenes import SCENES
from studies.scenes.benchmarks.quads import OnQuads

SCENE, FRICTION = "scene", "friction"  # kinds of a number that stands for a request
KINDS = {SCENE: 0.2, FRICTION: 0.15, "posed": 0.15, "matrices": 0.5}  # by what a case costs
SOLIDS = ("crushed-ring-solid", "tyre-solid", "two-cylinders", "ring-on-layer", "ironing")
GROUNDS = ("tyre-on-plate", "tyre-on-drum")
OFTEN = {"panel": 8, "tyre": 10, **dict.fromkeys((*SOLIDS, *GROUNDS), 1)}  # for their settings, or for their cost
RUBBED = {
    "panel": 10.0,
    "tyre": 8.0,
    "crushed-ring-solid": 0.3,
    "tyre-solid": 0.5,
    **dict.fromkeys(GROUNDS, 0.5),
}  # with friction; the others 1
WITH_CONTACT = 4  # the others, as often as a scene without
CHANGED = (0, 1, 2, 3, 4, 6, 8)  # how many settings leave their default
REPAIRED = 0.93  # share of refused requests that give settings back until they are taken
HUNG, REFINED = 0.25, 48  # share of scenes whose grid is refined in places, where it can be, and its most elements
LARGEST = {SCENE: 6, FRICTION: 4}  # elements along a side, of what may have as few as two
LONG = 0.12  # share of grids with many elements along one side and one or two across
SLIVERS = {1: {SCENE: (32, 64, 128), FRICTION: (16, 32)}, 2: {SCENE: (16, 32), FRICTION: (16,)}}  # by those across
TOGETHER = ({"E_MPa", "nu"},)  # keys that a scene with all of them wants both or neither
EVEN = ("tyre", "tyre-solid", *GROUNDS)  # meshes of even numbers, six at least

MUS = {  # share, powers of ten of its span
    "usual": (0.6, (-1.7, 0.2)),
    "tiny": (0.1, (-12.0, -4.0)),
    "large": (0.1, (0.2, 4.0)),
    "inf": (0.12, None),
    "0": (0.08, None),
}
WAYS = {"there": 0.15, "back": 0.25, "beyond": 0.25, "on": 0.1, "wandering": 0.25}
SIZES = {"drag_mm": (-4.0, 1.0), "turn_deg": (-3.0, 1.7)}  # powers of ten of the first stop
LARGER = {"tyre": 1.0}  # powers of ten by which the drags of a scene are longer
PRESSED = dict.fromkeys(EVEN, (-0.5, 1.3))  # powers of ten of a travel, where the default is many
DRAGGED, TURNED, ASLANT = 0.75, 0.5, 0.5


def kind_of(seed: int) -> str:
    """What sort of case a number is."""
    return str(generator(seed, "kind").choice(list(KINDS), p=list(KINDS.values())))


def asked_of(seed: int, kind: str = SCENE) -> Asked:
    """The request of a number, of the kind SCENE or FRICTION, mostly one that is taken."""
    asked, kept = first_asked(seed, kind)
    return _repaired(asked, seed, kept)


def first_asked(seed: int, kind: str) -> tuple[Asked, int]:
    """The request of a number, whether it is taken or not, and how many of its first settings are of friction."""
    rng = generator(seed, "scene")
    weights = np.array([_weight(name, kind) for name in SCENES])
    name = str(rng.choice(list(SCENES), p=weights / weights.sum()))
    scene, options = SCENES[name], {"mesh": _mesh(name, kind, seed)}
    rubbed = _friction(name, scene, seed) if kind == FRICTION else {}
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
    return Asked(name, options, settings, refined), len(rubbed)


def _friction(name: str, scene: Scene, seed: int) -> dict[str, str]:
    """Settings of friction: always a coefficient, drags and turns where the scene takes them."""
    mu = _coefficient(seed)
    settings = {MU.key: mu}
    if name in PRESSED:
        settings["delta_mm"] = f"{10 ** generator(seed, 'press').uniform(*PRESSED[name]):.3g}"
    if mu == "0" or not isinstance(scene, SlidingScene):
        return settings
    rng = generator(seed, "slides")
    if rng.random() < DRAGGED:
        settings[DRAG.key] = _stops(DRAG.key, LARGER.get(name, 0.0), seed)
        if rng.random() < ASLANT:
            settings[WAY.key] = str(int(rng.integers(-180, 181)))
    if rng.random() < TURNED:
        settings[TURN.key] = _stops(TURN.key, 0.0, seed)
    return settings


def _coefficient(seed: int) -> str:
    rng = generator(seed, f"value of {MU.key}")
    kind = str(rng.choice(list(MUS), p=[share for share, _ in MUS.values()]))
    span = MUS[kind][1]
    return kind if span is None else f"{10 ** rng.uniform(*span):.3g}"


def _stops(key: str, longer: float, seed: int) -> str:
    """A way from 0, no two stops of which are alike in a row."""
    rng = generator(seed, f"value of {key}")
    size = 10 ** (rng.uniform(*SIZES[key]) + longer)
    share = float(rng.uniform(0.1, 2))
    way = str(rng.choice(list(WAYS), p=list(WAYS.values())))
    stops = {
        "there": [1.0],
        "back": [1.0, 0.0],
        "beyond": [1.0, -share],
        "on": [1.0, 1.0 + share, 1.0 + 2 * share],
        "wandering": list(np.cumsum(rng.normal(size=int(rng.integers(2, 5))))),
    }[way]
    sign = float(rng.choice([-1.0, 1.0]))
    return ",".join(f"{sign * size * stop + 0.0:.4g}" for stop in stops)


def _weight(name: str, kind: str) -> float:
    """How often a scene is drawn; never one on any quadrilaterals, so that numbers keep their cases."""
    if isinstance(SCENES[name], OnQuads):
        return 0.0
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
    requests, settings = [asked], dict(asked.settings)
    while len(settings) > kept:
        settings.popitem()
        requests.append(replace(asked, settings=dict(settings)))
    bare = {key: value for key, value in asked.options.items() if key in ("mesh", "contact")}
    plain = Asked(asked.scene, {"mesh": asked.options["mesh"]})
    return [*requests, replace(asked, options=bare, settings=settings), replace(plain, settings=settings), plain]


# --- near hard requests -----------------------------------------------------------------------------------------------

COMMANDS = tuple(Path(__file__).with_name("hard_requests.txt").read_text(encoding="utf-8").splitlines())
NEAR = 0.25  # share of the requests that are near a hard one
WIDE = 0.5  # powers of ten by which a number is changed
PATHS = (DRAG.key, TURN.key)


def request_of(seed: int, kind: str) -> Asked:
    """The request of a number: drawn afresh, or near a hard one."""
    parents = [asked for asked in map(parsed, COMMANDS) if (MU.key in asked.settings) == (kind == FRICTION)]
    rng = generator(seed, "near")
    if rng.random() > NEAR or not parents:
        return asked_of(seed, kind)
    return changed(parents[rng.integers(len(parents))], seed)


def parsed(command: str) -> Asked:
    """The request of a command: scene, --OPTION VALUE and --set KEY=VALUE."""
    scene, *arguments = shlex.split(command)
    pairs = list(zip(arguments[::2], arguments[1::2], strict=True))
    options = {word.removeprefix("--"): value for word, value in pairs if word != "--set"}
    settings = dict(value.split("=", 1) for word, value in pairs if word == "--set")
    return Asked(scene, options, settings)


def changed(asked: Asked, seed: int) -> Asked:
    """With one thing changed."""
    rng = generator(seed, "change")
    ways = (_number, _number, _value, _option, _turned, _less)
    return ways[rng.integers(len(ways))](asked, seed, rng)


def _number(asked: Asked, seed: int, rng: np.random.Generator) -> Asked:
    """Every number of a setting by the same factor."""
    keys = [key for key in asked.settings if _numbers(asked.settings[key])]
    if not keys:
        return _option(asked, seed, rng)
    key, factor = str(rng.choice(keys)), 10 ** rng.uniform(-WIDE, WIDE)
    return asked.with_settings(**{key: ",".join(f"{factor * n:.4g}" for n in _numbers(asked.settings[key]))})


def _value(asked: Asked, seed: int, rng: np.random.Generator) -> Asked:
    """A setting of the scene, drawn afresh."""
    known = SCENES[asked.scene].settings
    setting = known[rng.integers(len(known))]
    return asked.with_settings(**{setting.key: drawn(setting, seed)})


def _option(asked: Asked, seed: int, rng: np.random.Generator) -> Asked:
    """Another algorithm, measure, number of steps or grid."""
    n1, n2 = (int(n) for n in asked.options["mesh"].split("x"))
    finer = (n1 if n1 == 1 else n1 + 2, n2) if rng.random() < 0.5 else (n1, n2 if n2 == 1 else n2 + 2)
    choices = [("measure", str(rng.choice(list(MEASURES)))), ("steps", str(rng.integers(1, 5)))]
    choices.append(("mesh", "x".join(map(str, finer))))
    if has_contact(SCENES[asked.scene]):
        choices += 3 * [("contact", str(rng.choice(list(ALGORITHMS))))]
    name, value = choices[rng.integers(len(choices))]
    own = {setting.key for setting in settings_of(asked.options.get("contact", ""))} if name == "contact" else set()
    kept = {key: text for key, text in asked.settings.items() if key not in own}
    return replace(asked.with_options(**{name: value}), settings=kept)


def _turned(asked: Asked, seed: int, rng: np.random.Generator) -> Asked:
    """A way of the foundation goes back, or is turned round."""
    keys = [key for key in PATHS if key in asked.settings]
    if not keys:
        return _number(asked, seed, rng)
    key = str(rng.choice(keys))
    stops = _numbers(asked.settings[key])
    on = [*stops, -stops[-1] or stops[0] / 2] if rng.random() < 0.5 else [-stop + 0.0 for stop in stops]
    return asked.with_settings(**{key: ",".join(f"{stop:.4g}" for stop in on)})


def _less(asked: Asked, seed: int, rng: np.random.Generator) -> Asked:
    """One setting less; friction stays."""
    keys = [key for key in asked.settings if key != MU.key]
    if not keys:
        return _value(asked, seed, rng)
    lost = str(rng.choice(keys))
    return replace(asked, settings={key: value for key, value in asked.settings.items() if key != lost})


def _numbers(text: str) -> list[float]:
    """Of a value; none where it is a word, or infinite."""
    try:
        numbers = [float(part) for part in text.split(",")]
    except ValueError:
        return []
    return numbers if np.all(np.isfinite(numbers)) else []
