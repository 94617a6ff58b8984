"""What a scene is: its settings with their ranges, its references, and the stages that a solve walks through.

A scene is one file in :mod:`studies.scenes` and one line in its catalogue. How stages are solved does not enter here.
"""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import pairwise
from pathlib import Path
from typing import Any, Protocol, Self, runtime_checkable

import numpy as np

from contact import parameters
from contact.continuation.arc_length import ArcLength, Trace
from contact.continuation.equilibrium_curve import ArcPoint
from contact.continuation.load_stepping import follow
from contact.continuation.power_series import Expand
from contact.continuation.pressed_curve import PressedCurve
from contact.continuation.series_path import PowerSeries
from contact.parameters import Parameter
from contact.problem import ContactAlgorithm, ContactProblem, ContactSolution, Linearise, Outcome
from formulations.shell import ShellModel
from studies.ask.request import Request, Value, text_of
from studies.ask.request import UsageError as UsageError  # scenes are what raises it
from studies.output.atomic import Table
from studies.output.vtu import write_fields

UNITS = ("mm", "MPa", "deg", "N")  # a key ends in its unit; all others count


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
    choices: tuple[str, ...] = ()
    presets: Mapping[str, Mapping[str, Value]] = field(default_factory=dict)
    unit: str = ""
    otherwise: str = ""

    def __post_init__(self) -> None:
        ending = self.key.rpartition("_")[2]
        by_key = ending if ending in UNITS else "-" if self.kind == "choice" else "1"
        object.__setattr__(self, "unit", self.unit or by_key)

    @classmethod
    def one_of(cls, key: str, choices: Iterable[str], default: str | None, meaning: str, **more: Any) -> Setting:
        """A word."""
        return cls(key, default, meaning, "choice", choices=tuple(choices), **more)

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
        words = {
            "int": "a whole number in",
            "float": "a number in",
            "floats": "increasing numbers in",
            "path": "numbers, from 0 on no two alike in a row, in",
        }[self.kind]
        return f"{words} {left}{text_of(self.low)}, {text_of(self.high)}{right}"

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
            if value not in self.choices:
                raise wrong
            return str(value)
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


@dataclass(frozen=True)
class Reference:
    """A value to compare with: quantity name as in the result, where it holds, its kind and source.

    kind: "printed" (in the source itself), "read" (in a public transcription), "computed" (independent program),
    "exact" (closed form), "refined" (limit of grids of ours beyond those that it judges). uncertainty: relative.
    """

    quantity: str
    value: float
    at: Mapping[str, float | str]
    kind: str
    source: str
    uncertainty: float


@dataclass(frozen=True, eq=False)
class Observation:
    """What a scene reads off a converged state: an entry of ``steps`` (or None), headline values, rows of tables.

    said: of a mode, for people.
    tables: made when they are asked for; who only wants the values does not wait for them.
    """

    step: dict[str, Any] | None
    quantities: dict[str, float] = field(default_factory=dict)
    tables: Callable[[], dict[str, Table]] = dict
    said: str = ""


Begun = tuple[Callable[[float], ContactProblem], ContactSolution]  # problem_at(t), and the solution to start from


@dataclass(frozen=True)
class Units:
    """Those of a problem: how many of its lengths are a mm, and of its stresses a MPa."""

    length: float = 1.0
    stress: float = 1.0

    @property
    def force(self) -> float:
        """How many of its forces are a N."""
        return self.stress * self.length**2


@dataclass(frozen=True, eq=False)
class Stage:
    """One path of problems.

    begin(previous) -> (problem_at(t), starting solution); targets: the values of t to report, the path starts at 0;
    observe(problem, state, t) -> Observation.  whole(u): the unknowns of the model from those of the stage, when it
    solves a smaller problem on the way.  see_mode(state, mode): what is seen of a mode (n,) at the end of the path.
    units: of the problem; what is observed is in mm, MPa and N.  rubs(t): the share in [0, 1] of the coefficient of
    friction that acts at t.
    """

    name: str
    begin: Callable[[ContactSolution | None], Begun]
    targets: Sequence[float]
    observe: Callable[[ContactProblem, ContactSolution, float], Observation]
    whole: Callable[[np.ndarray], np.ndarray] | None = field(default=None, kw_only=True)
    see_mode: Callable[[ContactSolution, np.ndarray], Observation] | None = field(default=None, kw_only=True)
    units: Units = field(default=Units(), kw_only=True)
    rubs: Callable[[float], float] = field(default=lambda t: 1.0, kw_only=True)

    def lifted(self, solution: ContactSolution) -> ContactSolution:
        """The solution in the unknowns of the model."""
        return solution if self.whole is None else replace(solution, u=self.whole(solution.u))


@dataclass(frozen=True, eq=False)
class CurveStage(Stage, ABC):
    """A path traced through limit points, by arc length or by power series, until its last target is first reached.

    summarise(points): headline values of the whole curve; ``observe`` sees every point of it.
    """

    continuation: ArcLength | PowerSeries
    summarise: Callable[[Sequence[ArcPoint]], dict[str, float]]

    @abstractmethod
    def trace(self, begun: Begun, algorithm: ContactAlgorithm, tell: Callable[[float], None]) -> Trace:
        """The curve from where the stage begins; its first point is that."""


@dataclass(frozen=True, eq=False)
class ArcStage(CurveStage):
    """The curve of a body without contact from rest, t the factor of its load.

    linearise: the model without its load; load (n,): the dead force at t = 1.  expand: its recurrence for power series.
    """

    linearise: Linearise
    load: np.ndarray
    expand: Expand

    def trace(self, begun: Begun, algorithm: ContactAlgorithm, tell: Callable[[float], None]) -> Trace:
        """No contact: no algorithm. Who asks for the first limit point alone has what was asked for at it."""
        if isinstance(self.continuation, PowerSeries):
            found = self.continuation.trace(self.linearise, self.expand, self.load, self.targets, tell)
        else:
            found = self.continuation.trace(self.linearise, self.load, self.targets, tell)
        asked = self.continuation.to_limit and found.outcome is Outcome.LIMIT_POINT
        return replace(found, outcome=Outcome.CONVERGED) if asked else found


@dataclass(frozen=True, eq=False)
class PressedStage(CurveStage):
    """The curve of a body that a foundation presses, t its travel.

    first: travel up to which plain steps lead; from there on by arc length to the targets beyond.
    """

    continuation: ArcLength
    first: float

    def trace(self, begun: Begun, algorithm: ContactAlgorithm, tell: Callable[[float], None]) -> Trace:
        """With the contact of the algorithm."""
        problem_at, start = begun
        (point,) = follow(problem_at, 0.0, [self.first], algorithm, start)
        rest = ArcPoint(start.u, 0.0, pressure=start.pressure, active=start.active)
        if not point.outcome.converged:
            said = str(point.solution.history[-1].get("event", point.outcome.value))
            return Trace(
                (rest,), point.outcome, said, dict(point.solution.counters), list(map(dict, point.solution.history))
            )
        curve, begin = PressedCurve.through(problem_at, self.first, point.solution, algorithm)
        curve.tally.add(point.solution)
        beyond = [target for target in self.targets if target > self.first]
        trace = self.continuation.along(curve, begin, beyond, tell)
        return replace(trace, points=(rest, *trace.points))


class SceneModel(Protocol):
    """A scene built for one request."""

    @property
    def n_unknowns(self) -> int:
        """Number of unknowns."""

    def stages(self) -> Iterator[Stage]:
        """The paths to follow, in order."""

    def write_fields(self, path: Path, state: ContactSolution) -> None:
        """Write the fields of a state for ParaView and its like."""


def candidates_at(nodes: np.ndarray, n: int) -> np.ndarray:
    """(n,) the contact candidate that each of n nodes is, -1 for none.  nodes: of the candidates."""
    candidate = np.full(n, -1)
    candidate[nodes] = np.arange(len(nodes))
    return candidate


def nodal_pressure(solution: ContactSolution, candidate: np.ndarray) -> np.ndarray:
    """Contact pressure at nodes that are these candidates (-1: none); zero before the first state with any."""
    if not len(solution.pressure):
        return np.zeros(len(candidate))
    return np.append(solution.pressure, 0.0)[candidate]


class ShellSceneModel:
    """What the models of all shell scenes share."""

    shell: ShellModel

    @property
    def n_unknowns(self) -> int:
        """Number of unknowns."""
        return self.shell.discretisation.n_free

    @property
    def candidate_of_node(self) -> np.ndarray:
        """(N,) the contact candidate that each node of the grid is or mirrors, -1 for none."""
        return np.full(self.shell.discretisation.grid.n_nodes, -1)

    def outer_pressure(self, solution: ContactSolution) -> np.ndarray:
        """Contact pressure (N,) at the grid's nodes; zero where nothing is touched, and before the first contact."""
        return self.shell.discretisation.grid.carried(nodal_pressure(solution, self.candidate_of_node))

    def moved(self, t: float) -> Self:
        """With its supports where they are at the parameter t of its last stage."""
        return self

    def write_fields(self, path: Path, state: ContactSolution) -> None:
        """One layer of hexahedra between the two faces."""
        write_fields(path, self.shell, state.u, self.outer_pressure(state))


def moved(model: SceneModel, t: float) -> SceneModel:
    """The model whose fields are those at the parameter t of its last stage."""
    return model.moved(t) if isinstance(model, ShellSceneModel) else model


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
    """A scene that names the grid from which a refinement to an error sets out, where a quarter of its own is none."""

    @property
    def coarsest_mesh(self) -> tuple[int, int]:
        """Elements along a1 and a2."""


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


def has_contact(scene: Scene) -> bool:
    """Whether something may touch: the scene takes the regularisation of a contact condition."""
    return any(setting.key == EPSILON.key for setting in scene.settings)
