"""The settings of a solve: what one is, and those that stand beside a scene's own: friction's and the algorithm's.

Nothing is solved here.
"""

from __future__ import annotations

import math
from collections.abc import Collection, Iterable, KeysView, Mapping
from dataclasses import dataclass, field
from itertools import pairwise
from typing import Any

import numpy as np

from contact import parameters
from contact.algorithms.base import frictionless_parameters, require_friction
from contact.catalogue import ALGORITHMS
from contact.newton.solves import RESIDUAL_TOLERANCE
from contact.parameters import Parameter
from contact.problem import ContactAlgorithm
from studies.ask.request import UsageError, Value, text_of

UNITS = ("mm", "MPa", "deg", "N")  # a key ends in its unit; all others count
KINDS = ("float", "int", "choice", "floats", "path")


@dataclass(frozen=True)
class Setting:
    """A key of ``--set KEY=VALUE`` with its meaning, unit, range and default.

    help: its meaning, for people.  kind: "float", "int", "choice", "floats" (comma-separated, increasing) or "path"
    (comma-separated, from 0 to each in turn, back and forth).
    low, high: range of each number, the bounds included unless ``open_low``/``open_high``; infinity only where
    ``infinite``.  default None: the scene works it out, and ``otherwise`` says how.  presets: what each choice stands
    for, values of other keys; it gives way to those that are given.  unit: by default what the key ends in.
    """

    key: str
    default: Value | None
    help: str
    kind: str = "float"
    low: float = -math.inf
    high: float = math.inf
    open_low: bool = False
    open_high: bool = False
    infinite: bool = False
    choices: Collection[str] = ()
    presets: Mapping[str, Mapping[str, Value]] = field(default_factory=dict)
    unit: str = ""
    otherwise: str = ""

    def __post_init__(self) -> None:
        if self.kind not in KINDS:
            raise ValueError(f"setting {self.key!r}: kind {self.kind!r} must be one of {', '.join(KINDS)}")
        ending = self.key.rpartition("_")[2]
        by_key = ending if ending in UNITS else "-" if self.kind == "choice" else "1"
        object.__setattr__(self, "unit", self.unit or by_key)

    @classmethod
    def one_of(cls, key: str, choices: Iterable[str], default: str | None, meaning: str, **more: Any) -> Setting:
        """A word."""
        listed = choices if isinstance(choices, KeysView) else tuple(choices)  # a catalogue: parts from outside join it
        return cls(key, default, meaning, "choice", choices=listed, **more)

    @classmethod
    def positive(cls, key: str, default: Value | None, meaning: str, high: float = math.inf, **more: Any) -> Setting:
        """A number above 0 and up to ``high``."""
        return cls(key, default, meaning, low=0, high=high, open_low=True, **more)

    @classmethod
    def of(cls, parameter: Parameter, default: Value | None, otherwise: str = "") -> Setting:
        """The parameter of an algorithm as a setting."""
        values = {name: value for name, value in vars(parameter).items() if name != "frictionless"}
        return cls(help=values.pop("meaning"), default=default, otherwise=otherwise, **values)

    @property
    def range_text(self) -> str:
        """The allowed values in words."""
        if self.kind == "choice":
            return "one of " + ", ".join(self.choices)
        left = "(" if self.open_low or math.isinf(self.low) else "["
        right = ")" if self.open_high or (math.isinf(self.high) and not self.infinite) else "]"
        form = {
            "int": "a whole number in",
            "float": "a number in",
            "floats": "increasing numbers in",
            "path": "numbers, the first not 0, no two successive equal, in",
        }[self.kind]
        return f"{form} {left}{text_of(self.low)}, {text_of(self.high)}{right}"

    @property
    def default_text(self) -> str:
        """The default as it is written after KEY=, or how the scene works it out."""
        if self.default is None:
            return self.otherwise
        return text_of(self.default)

    def parse(self, value: object) -> Value:
        """The value of a text or of Python's numbers and sequences; raises UsageError naming it and the range."""
        wrong = UsageError(f"{self.key} = {value!r} must be {self.range_text}")
        if self.kind == "choice":
            word = text_of(value)
            if word not in self.choices:
                raise wrong
            return word
        parts = value.split(",") if isinstance(value, str) else np.atleast_1d(np.asarray(value, dtype=object)).tolist()
        try:
            numbers = tuple(float(part) for part in parts if not isinstance(part, bool))
        except (TypeError, ValueError):
            raise wrong from None
        if len(numbers) != len(parts) or not numbers or not all(self._inside(number) for number in numbers):
            raise wrong
        if self.kind == "floats":
            if any(b <= a for a, b in pairwise(numbers)):
                raise wrong
            return numbers
        if self.kind == "path":
            if any(a == b for a, b in pairwise((0.0, *numbers))):
                raise wrong
            return numbers
        if len(numbers) != 1 or (self.kind == "int" and numbers[0] != int(numbers[0])):
            raise wrong
        return int(numbers[0]) if self.kind == "int" else numbers[0]

    def _inside(self, number: float) -> bool:
        above = number > self.low if self.open_low else number >= self.low
        below = number < self.high if self.open_high else number <= self.high
        return above and below and (self.infinite or math.isfinite(number))  # NaN is neither above nor below


EPSILON = Setting.of(parameters.EPSILON, None, otherwise="that of the algorithm")
SOLVER = Setting.of(parameters.SOLVER, "auto")
TOLERANCE = Setting.of(parameters.TOLERANCE, RESIDUAL_TOLERANCE)
MU = Setting("mu", None, "Coulomb's coefficient of friction", low=0, infinite=True, otherwise="0: no friction")
DRAG = Setting(
    "drag_mm",
    None,
    "positions of the foundation along its surface, in turn, after it has pressed",
    "path",
    otherwise="no drag",
)
WAY = Setting("drag_deg", None, "direction of the drag in the tangent plane", low=-360, high=360, otherwise="0")
STEPS = Setting("steps", 1, "load steps between two requested loads", "int", low=1, high=10_000)
TURN = Setting(
    "turn_deg", None, "angles of the foundation about its normal, in turn, after the drag", "path", otherwise="no turn"
)
SLIDING = (DRAG, WAY, TURN)


def completed(settings: Mapping[str, Value]) -> dict[str, Value]:
    """The settings without a coefficient of 0: that of no friction; raises UsageError on a drag without one."""
    if settings.get(MU.key, 0.0) != 0.0:
        return dict(settings)
    vain = [setting.key for setting in SLIDING if setting.key in settings]
    if vain:
        raise UsageError(f"{vain[0]} needs a coefficient of friction: mu above 0")
    return {key: value for key, value in settings.items() if key != MU.key}


def rubbing(settings: Mapping[str, Value]) -> bool:
    """Whether a request has friction."""
    return MU.key in settings


def parameters_of(contact: str) -> tuple[Setting, ...]:
    """All parameters of an algorithm as settings, with its own defaults."""
    algorithm = ALGORITHMS[contact]
    return tuple(Setting.of(parameter, getattr(algorithm, parameter.key)) for parameter in algorithm.parameters)


def settings_of(contact: str) -> tuple[Setting, ...]:
    """Those that no scene has; none for an unknown name."""
    shared = {parameter.key for parameter in parameters.SHARED}
    every = parameters_of(contact) if contact in ALGORITHMS else ()
    return tuple(setting for setting in every if setting.key not in shared)


def without_friction(contact: str) -> tuple[str, ...]:
    """Those that no scene has and that the algorithm has without friction alone."""
    return frictionless_parameters(ALGORITHMS[contact]) if contact in ALGORITHMS else ()


def own_keys() -> tuple[str, ...]:
    """Of the settings that some algorithm of the catalogue has for itself."""
    return tuple(dict.fromkeys(setting.key for contact in ALGORITHMS for setting in settings_of(contact)))


def configured(contact: str, settings: Mapping[str, Value]) -> ContactAlgorithm:
    """The algorithm with those of the settings that it has; raises ValueError for a value that it cannot have.

    With a coefficient of friction among them it has to know friction, and so has each of its settings.
    """
    kind = ALGORITHMS[contact]
    algorithm = kind(**{each.key: settings[each.key] for each in kind.parameters if each.key in settings})
    if rubbing(settings):
        require_friction(algorithm)
    return algorithm
