"""Requests near hard ones: one of the file hard_requests.txt with one thing changed.

The file lists near-misses and findings of earlier campaigns, a command a line, chosen by the largest ``hard`` in their
tables; it is kept by hand. A case is still its number: it chooses the request and the change.
"""

from __future__ import annotations

import shlex
from dataclasses import replace
from pathlib import Path

import numpy as np

from contact.catalogue import ALGORITHMS
from formulations.strains.catalogue import MEASURES
from studies.ask.scene import has_contact
from studies.ask.settings import DRAG, MU, TURN, settings_of
from studies.fuzz.cases import FRICTION, Asked, asked_of
from studies.fuzz.values import drawn, generator
from studies.scenes import SCENES

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
    scene, *words = shlex.split(command)
    pairs = list(zip(words[::2], words[1::2], strict=True))
    options = {word.removeprefix("--"): value for word, value in pairs if word != "--set"}
    settings = dict(value.split("=", 1) for word, value in pairs if word == "--set")
    return Asked(scene, options, settings)


def changed(asked: Asked, seed: int) -> Asked:
    """With one thing changed."""
    rng = generator(seed, "change")
    ways = (_number, _number, _value, _option, _stops, _fewer)
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


def _stops(asked: Asked, seed: int, rng: np.random.Generator) -> Asked:
    """A way of the foundation goes back, or is turned round."""
    keys = [key for key in PATHS if key in asked.settings]
    if not keys:
        return _number(asked, seed, rng)
    key = str(rng.choice(keys))
    stops = _numbers(asked.settings[key])
    on = [*stops, -stops[-1] or stops[0] / 2] if rng.random() < 0.5 else [-stop + 0.0 for stop in stops]
    return asked.with_settings(**{key: ",".join(f"{stop:.4g}" for stop in on)})


def _fewer(asked: Asked, seed: int, rng: np.random.Generator) -> Asked:
    """One setting less; friction stays."""
    keys = [key for key in asked.settings if key != MU.key]
    if not keys:
        return _value(asked, seed, rng)
    lost = str(rng.choice(keys))
    return replace(asked, settings={key: value for key, value in asked.settings.items() if key != lost})


def _numbers(text: str) -> list[float]:
    """Of a value; none where it is a word, or infinite."""
    try:
        found = [float(part) for part in text.split(",")]
    except ValueError:
        return []
    return found if np.all(np.isfinite(found)) else []
