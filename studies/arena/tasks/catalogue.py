"""The graded tasks as data: the run that fails, what may be chosen, what is required, and what a secret draws.

A configuration is a task with the settings that are drawn; the open one has those of its run. What is known of the
answer without solving it are closed forms and the references of scenes, by name: each is a function of the request
alone, whose last load counts. Nothing is solved here, and nothing knows what a submission has found.
"""

from __future__ import annotations

import math
import tomllib
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

from studies.arena.held_out import generator
from studies.ask.request import Request, UsageError
from studies.scenes.benchmarks import shallow_cap
from studies.scenes.benchmarks.pagano import E_T, cross_plies
from studies.scenes.benchmarks.sze import circular_arc
from studies.scenes.closed_forms.contact import flattened_ring, plate_contact, strip_contact
from studies.scenes.closed_forms.elasticity import middle_deflection
from studies.scenes.closed_forms.marguerre_cap import classical_pressure
from studies.scenes.complete import STEP_KEYS, Cell, closest
from studies.scenes.contact.ring import RADIUS
from studies.scenes.faces.face_patch import SIDE

Exact = Callable[[Request, str], float]  # of a quantity by its name


def _load(request: Request) -> float:
    return request.numbers("load_fraction")[-1]


def _arc(request: Request, quantity: str) -> float:
    """Shortening [mm] of the strip that is bent into an arc."""
    return circular_arc(_load(request))[0]


def _plies(request: Request, quantity: str) -> float:
    """100 E_T w/(q0 h S^4), h = q0 = 1, from the equations of elasticity of each ply."""
    S, plies = request.number("S"), cross_plies(request.number("E_ratio"))
    return 100 * E_T * middle_deflection(plies, S, request.number("aspect") * S, 1.0) / S**4


def _plate(request: Request, quantity: str) -> float:
    """Radius of the disc of contact over that of the plate."""
    return plate_contact(64 * _load(request))[0]


def _ring(request: Request, quantity: str) -> float:
    """P R^2/(E I) of the inextensible ring."""
    return flattened_ring(1 - request.numbers("delta_mm")[-1] / RADIUS)[0]


def _cap(request: Request, quantity: str) -> float:
    """First limit point over the classical pressure."""
    lam = request.number("shallowness")
    h = shallow_cap.thickness(lam)
    snap, _ = shallow_cap.shallow_cap(lam).snap(4 * h)
    return snap / classical_pressure(shallow_cap.E, shallow_cap.NU, shallow_cap.RADIUS, h)


def _strip(request: Request, quantity: str) -> float:
    """Force on half of the strip over D g/a^3."""
    return strip_contact(24 * _load(request), request.number("lam_over_a")).half_force


def _coulomb(request: Request, quantity: str) -> float:
    """mu N [N] with N = p A: what friction is at the most."""
    return request.number("mu") * request.numbers("pressure_MPa")[-1] * SIDE**2


def _springs(request: Request, quantity: str) -> float:
    """p/epsilon [mm]: the mean penetration, by equilibrium, which the largest is not below."""
    return request.numbers("pressure_MPa")[-1] / request.number("epsilon")


def _of_scene(request: Request, quantity: str) -> float:
    """The least uncertain reference of the scene at the last load; NaN where there is none."""
    at = {key: value[-1] if isinstance(value, tuple) else value for key, value in request.settings.items()}
    there = {**request.settings, "measure": request.measure, **{key: at[key] for key in STEP_KEYS if key in at}}
    references = closest(request.scene, there, (quantity,))
    return references[quantity].value if references else math.nan


EXACT: Mapping[str, Exact] = {
    "the circular arc": _arc,
    "linear elasticity of the plies": _plies,
    "Kirchhoff's plate": _plate,
    "the elastica": _ring,
    "the shallow-shell equations": _cap,
    "Timoshenko's strip": _strip,
    "Coulomb's law": _coulomb,
    "pressure over epsilon": _springs,
    "the reference of the scene": _of_scene,
}


OPTIONS = ("measure", "contact", "newton", "mesh", "model", "steps")  # of a run; all else is a setting
HIDDEN = 2  # configurations that a secret draws of each task
DIGITS = 4  # of a number that is drawn
FILE = Path(__file__).with_name("tasks.toml")
Text = Mapping[str, str]


@dataclass(frozen=True)
class Need:
    """A value by name, and what it must be: in [least, most], and within so much of the reference ``of``, relative.

    bound: the reference that no value passes: none is above it where a least one is asked for, none below it where a
    largest one is.
    """

    name: str
    least: float = -math.inf
    most: float = math.inf
    of: str = ""
    within: float = 0.0
    bound: str = ""

    @property
    def text(self) -> str:
        """What is required, in words."""
        ends = (("at least", self.least), ("at most", self.most))
        words = [f"{word} {end:g}" for word, end in ends if math.isfinite(end)]
        words += [f"within {100 * self.within:g} % of {self.of}"] if self.of else []
        return f"{self.name} {' and '.join(words)}"

    @property
    def limited(self) -> bool:
        """Whether what is known bounds it."""
        return bool(self.bound or self.of) and (math.isfinite(self.least) or math.isfinite(self.most))

    def beyond(self, request: Request) -> str:
        """Why no answer to the request can have it; empty where one may."""
        name = self.bound or self.of
        if not name:
            return ""
        limit = EXACT[name](request, self.name)
        room = self.within * abs(limit)
        if limit + room < self.least:
            return f"{self.name} is at most {limit + room:.4g}, by {name}"
        return f"{self.name} is at least {limit - room:.4g}, by {name}" if limit - room > self.most else ""

    def missed(self, values: Mapping[str, float], request: Request) -> str:
        """How the values of an answer miss it; empty where they have it."""
        value = values.get(self.name, math.nan)
        if math.isnan(value):
            return f"{self.name} is not known"
        if not self.least <= value <= self.most:
            return f"{self.name} is {value:.4g}"
        off = value / EXACT[self.of](request, self.name) - 1 if self.of else 0.0
        return "" if abs(off) <= self.within else f"{self.name} is {value:.4g}, {100 * off:+.2g} % off"


@dataclass(frozen=True)
class GradedTask:
    """A task; see ``tasks.toml`` for its parts.  says: what is at stake, in one sentence."""

    id: str
    says: str
    scene: str
    run: Text
    choose: Mapping[str, Sequence[float]]
    hidden: Mapping[str, Sequence[Any]]
    needs: tuple[Need, ...]

    def cell(self, chosen: Text, drawn: Text) -> Cell:
        """The run with what is chosen and drawn instead; raises UsageError."""
        settings = {**self.run, **chosen, **drawn}
        options: dict[str, Any] = {key: settings.pop(key) for key in OPTIONS if key in settings}
        if "steps" in options:
            if not options["steps"].isdecimal():
                raise UsageError(f"steps = {options['steps']!r} must be a whole number")
            options["steps"] = int(options["steps"])
        return Cell(self.id, self.scene, options, settings)

    def check(self, chosen: Text) -> None:
        """Raise UsageError for what may not be chosen, or what the scene does not admit."""
        for key, value in chosen.items():
            if key not in self.choose:
                raise UsageError(f"{key[:40]!r} may not be chosen; {', '.join(self.choose)} may")
            among = self.choose[key]
            if among and not all(among[0] <= each <= among[1] for each in _numbers(value)):
                raise UsageError(f"{key} = {value!r} must be in [{among[0]:g}, {among[1]:g}]")
        self.cell(chosen, {}).resolved()

    def beyond(self, drawn: Text) -> str:
        """Why no choice can meet it, at the upper end of each range that may be chosen; empty where one may."""
        if not any(need.limited for need in self.needs):
            return ""
        ends = {key: f"{among[1]:g}" for key, among in self.choose.items() if among}
        _, request = self.cell(ends, drawn).resolved()
        return next(filter(None, (need.beyond(request) for need in self.needs)), "")

    def missed(self, values: Mapping[str, float], request: Request) -> str:
        """What an answer misses; empty where it has all."""
        return next(filter(None, (need.missed(values, request) for need in self.needs)), "")

    def drawn(self, key: bytes) -> list[Text]:
        """The settings of the hidden configurations of a secret."""
        return [self._draw(generator(key, f"task {self.id} {k}")) for k in range(HIDDEN)]

    def _draw(self, rng: np.random.Generator) -> Text:
        def one(among: Sequence[Any]) -> str:
            if isinstance(among[0], str):
                return str(rng.choice(np.array(among)))
            return f"{math.exp(rng.uniform(*np.log(among))):.{DIGITS}g}"

        return {key: one(among) for key, among in self.hidden.items()}

    @property
    def lines(self) -> Iterator[str]:
        """The task for a terminal."""
        yield f"{self.id}: {self.says}"
        yield f"  {self.cell({}, {}).command}"
        choices, hidden = (
            "; ".join(f"{key} {_among(among)}".rstrip() for key, among in each.items())
            for each in (self.choose, self.hidden)
        )
        yield f"  choose {choices}"
        yield f"  hidden {hidden}"
        yield f"  needs {'; '.join(need.text for need in self.needs)}"


def _among(among: Sequence[Any]) -> str:
    """A range or a list of words; empty for all that the scene admits."""
    if among and isinstance(among[0], str):
        return f"of {', '.join(among)}"
    return f"in [{among[0]:g}, {among[1]:g}]" if among else ""


def _numbers(text: str) -> list[float]:
    """The numbers of a text; NaN, which is in no range, for text that is not a number."""
    try:
        return [float(each) for each in text.split(",")]
    except ValueError:
        return [math.nan]


@cache
def tasks() -> Mapping[str, GradedTask]:
    """All tasks by their id."""
    tables = tomllib.loads(FILE.read_text(encoding="utf-8"))
    return {
        name: GradedTask(id=name, needs=tuple(Need(**need) for need in task.pop("needs")), **task)
        for name, task in tables.items()
    }
