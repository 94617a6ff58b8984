"""Where solving stops: maps of outcomes over pairs of extremes, their boundaries located by bisection.

A point of a map is one small solve, followed by the judge. Its outcome is one of the classes below; a wrong answer is
what the algorithm calls converged and the judge does not certify.
"""

from __future__ import annotations

import math
import warnings
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from contact.catalogue import ALGORITHMS
from contact.continuation.load_stepping import SMALLEST
from contact.events import PathEnd
from contact.problem import Outcome
from studies.ask.request import Request
from studies.ask.scene import SceneModel, UsageError
from studies.ask.settings import configured
from studies.experiments import Row, tabulated
from studies.experiments.bisection import Located, distance, locate
from studies.scenes.complete import Cell, complete
from studies.scenes.plugins import use_options
from studies.scenes.walk import walk
from studies.solving.certificate import certificate
from studies.solving.result import UNSTABLE as NOT_STABLE

Point = tuple[int, int]  # row and column of a map
CONVERGED, UNTOUCHED, UNSTABLE = "converged", "converged, nothing touches", "converged, unstable"
WRONG, END, FAILED, REFUSED = "wrong", "end of the path", "not converged", "refused"
CRASHED = "crashed"
CLASSES = (CONVERGED, UNTOUCHED, UNSTABLE, WRONG, END, FAILED, REFUSED, CRASHED)
ENDS = (PathEnd.LIMIT_POINT, PathEnd.BIFURCATION)  # the tangent's word that there is nothing to follow


@dataclass(frozen=True)
class Axis:
    """A setting or option and its values along one side of a map, by default the algorithms; label: with its unit."""

    key: str
    label: str
    given: tuple[str, ...] = ()

    @classmethod
    def powers(cls, key: str, label: str, low: float, high: float, points: int) -> Axis:
        """Evenly spaced in the logarithm, from 10^low to 10^high."""
        return cls(key, label, tuple(f"{10.0**x:.6g}" for x in np.linspace(low, high, points)))

    @classmethod
    def even(cls, key: str, label: str, low: float, high: float, points: int) -> Axis:
        """Evenly spaced."""
        return cls(key, label, tuple(f"{round(x, 12) + 0.0:.6g}" for x in np.linspace(low, high, points)))

    @property
    def named(self) -> bool:
        """True when the values are names and have no order."""
        return self.key == "contact"

    @property
    def values(self) -> tuple[str, ...]:
        """All that are asked for."""
        return self.given or tuple(ALGORITHMS)


@dataclass(frozen=True)
class Found:
    """What one point gave: its class, why if it is a failure, and what its scene reads off the state."""

    kind: str
    reason: str = ""
    quantities: Mapping[str, float] = field(default_factory=dict)


@dataclass(frozen=True)
class Chart:
    """A map: y over x, one scene at fixed options and settings; stride: blocks to begin with."""

    name: str
    title: str
    scene: str
    x: Axis
    y: Axis
    options: Mapping[str, str] = field(default_factory=dict)
    settings: Mapping[str, str] = field(default_factory=dict)
    stride: int = 8

    @property
    def shape(self) -> tuple[int, int]:
        """Points along y and x."""
        return len(self.y.values), len(self.x.values)

    def cell(self, i: int, j: int) -> Cell:
        """The request of a point, row i and column j."""
        return self.point(self.x.values[j], self.y.values[i])

    def point(self, x: str, y: str) -> Cell:
        """The request at any values of both axes."""
        options, settings = dict(self.options), dict(self.settings)
        for axis, value in ((self.y, y), (self.x, x)):
            (options if axis.named else settings)[axis.key] = value
        unit = float(settings.get("stress_unit", 1)) / float(settings.get("length_unit", 1))
        epsilon = unit * ALGORITHMS[options.get("contact", Request.contact)]().epsilon
        if unit != 1 and math.isfinite(epsilon):  # the same problem in other units has the same spring in them
            settings.setdefault("epsilon", repr(epsilon))
        return Cell(f"{self.name} {x} {y}", self.scene, options, settings)

    def command(self, i: int, j: int) -> str:
        """The command that solves one point as the map did."""
        at = f"{self.x.values[j]},{self.y.values[i]}"
        return " ".join([f"footprint extremes {self.name} --at {at}", *use_options()])

    def located(self, at: Callable[[Cell], Found], *, whole: bool = False) -> tuple[Located, dict[Point, Found]]:
        """The map, and what the points that were asked for gave; whole: all of them, without a search."""
        points: dict[Point, Found] = {}

        def class_at(i: int, j: int) -> str:
            points[i, j] = at(self.cell(i, j))
            return points[i, j].kind

        return locate(class_at, self.shape, 1 if whole else self.stride, rows_apart=self.y.named), points


# --- one point ------------------------------------------------------------------------------------------------------


def attempt(cell: Cell, smallest: float = SMALLEST) -> Found:
    """Solve one point and judge it; whatever it raises is its class.  smallest: step that it may cut to, 1 for none."""
    with warnings.catch_warnings(), np.errstate(all="ignore"):
        warnings.simplefilter("ignore")
        try:
            scene, request = complete(cell.scene, cell.settings, **cell.options)
            return _followed(scene.build(request), request, smallest)
        except UsageError as error:
            return Found(REFUSED, str(error))
        except MemoryError:
            raise  # of the process that makes the map
        except Exception as error:  # a crash is a finding of these maps, whatever it is
            return Found(CRASHED, f"{type(error).__name__}: {error}")


def _followed(model: SceneModel, request: Request, smallest: float) -> Found:
    algorithm = configured(request.contact, request.settings)
    failures: list[str] = []
    why: list[str] = []
    stable: dict[str, Any] = {}
    for visited in walk(model.stages(), algorithm, request.steps, smallest=smallest):
        point = visited.point
        if not visited.converged:
            refused = f"{request.contact} does not apply: " if point.outcome is Outcome.REFUSED else ""
            return _failed(point.outcome, refused + visited.said, point.end.kind if point.end else None)
        tolerance = request.number("tolerance")
        verdict = certificate(visited.problem, point.solution, algorithm.epsilon, tolerance, visited.passed)
        failures, why, stable = failures + verdict["failures"], why + verdict["diagnosis"], verdict["stability"]
        if failures and visited.ends_stage:
            names, reasons = (", ".join(dict.fromkeys(words)) for words in (failures, why))
            return Found(WRONG, f"the judge finds {names} beyond its bounds: {reasons}")
    if stable["word"] == NOT_STABLE:
        return Found(UNSTABLE, f"the equilibrium is unstable; {stable['sentence']}")
    touched = visited.state.active.any()
    seen = visited.stage.observe(visited.problem, point.solution, point.requested).quantities
    return Found(CONVERGED if touched else UNTOUCHED, "", seen)


def _failed(outcome: Outcome, reason: str, end: PathEnd | None) -> Found:
    """The class of a path that does not arrive."""
    kind = REFUSED if outcome is Outcome.REFUSED else END if end in ENDS else FAILED
    return Found(kind, reason or outcome.value)


# --- the maps -------------------------------------------------------------------------------------------------------

POWERS, EVEN = Axis.powers, Axis.even
SMALL, TYRE, LYING = {"mesh": "4x4"}, {"mesh": "8x12", "model": "half"}, {"shape": "plate"}
H, TRAVEL, BALL, INFLATION = "h/R [-]", "travel of the plane [mm]", "radius of the ball [mm]", "p R/(E h) [-]"
BY = Axis("contact", "algorithm")
THIN, THINNESS = (POWERS("h_over_R", H, -6, -1, points) for points in (17, 33))
EPSILON = POWERS("epsilon", "ε [MPa/mm]", -2, 16, 33)
LENGTHS = POWERS("length_unit", "units in a mm [-]", -12, 12, 33)
STRESSES = POWERS("stress_unit", "units in a MPa [-]", -12, 12, 33)
ASPECT = POWERS("aspect", "length over width of an element [-]", 0, 4, 17)
NU = Axis("nu", "Poisson ratio ν [-]", tuple(f"{0.5 - 10.0**x:.6g}" for x in np.linspace(-1, -4, 17)))
UNEVEN = Axis("irregular", "unevenness [-]", tuple(f"{1 - 10.0**x:.6g}" for x in np.linspace(0, -4, 17)))  # to 0.9999


def _panel(name: str, title: str, x: Axis, y: Axis, settings: Mapping[str, str] | None = None, **more: str) -> Chart:
    return Chart(name, title, "panel", x, y, {**SMALL, **more}, settings or {})


CHARTS: tuple[Chart, ...] = (
    _panel("thin-travel", "Thinness against travel, beyond the clamp", POWERS("delta_mm", TRAVEL, -2, 1.5, 17), THIN),
    _panel(
        *("inflation-travel", "Pressure, outside and inside, against travel"),
        *(POWERS("delta_mm", TRAVEL, -2, 1, 17), EVEN("inflation", INFLATION, -1, 3, 17)),
    ),
    _panel(
        *("fibres-angle", "Stiff fibres against their angle"),
        *(EVEN("gamma_deg", "angle of the fibres γ [deg]", 0, 90, 17), POWERS("E_ratio", "E_L/E_T [-]", 0, 6, 17)),
    ),
    _panel("nu-thin", "Incompressible against thin", NU, THIN),
    _panel("epsilon-thin", "Regularisation against thinness", EPSILON, THINNESS, contact="regularised"),
    _panel("aspect-irregular", "Long elements against an uneven mesh", ASPECT, UNEVEN),
    _panel(
        *("ball-travel", "A small ball against its travel"),
        *(POWERS("ball_mm", BALL, -2, 2, 17), POWERS("delta_mm", "travel of the ball [mm]", -2, 0.5, 17)),
        {"foundation": "ball"},
    ),
    Chart(
        *("tyre-pressure", "The tyre: pressure against the cord angle", "tyre"),
        *(EVEN("gamma_deg", "cord angle γ [deg]", 0, 90, 17), EVEN("p0_MPa", "pressure inside [MPa]", -0.05, 0.35, 17)),
        *(TYRE, {"element": "paper", "delta_mm": "5"}),
    ),
    _panel("epsilon", "Regularisation, by algorithm", EPSILON, BY),
    _panel("length-unit", "The unit of length, by algorithm", LENGTHS, BY),
    _panel("stress-unit", "The unit of stress, by algorithm", STRESSES, BY),
    _panel("touch", "From exact touch, by algorithm", POWERS("delta_mm", TRAVEL, -18, 0, 65), BY, LYING),
    _panel(
        *("everywhere", "Contact everywhere, by algorithm"),
        *(POWERS("inflation", INFLATION, -8, 0, 33), BY),
        {**LYING, "delta_mm": "0"},
    ),
    _panel(
        *("one-node", "One node under a ball, by algorithm"),
        *(POWERS("ball_mm", BALL, -3, 3, 33), BY),
        {"foundation": "ball", "delta_mm": "0.5"},
    ),
)
PAIRS = tuple(chart for chart in CHARTS if not chart.y.named)  # by algorithm, `extremes_limits` has the boundaries
# cheap enough to be solved at all of their points: they are shown so, and the search is compared with that
WHOLE = ("ball-travel", "one-node", "length-unit")


def chart_of(name: str) -> Chart:
    """The map of a name; raises UsageError."""
    charts = [chart for chart in CHARTS if chart.name == name]
    if not charts:
        raise UsageError(f"map {name!r} must be one of {', '.join(chart.name for chart in CHARTS)}")
    return charts[0]


@tabulated
def check_table(names: Sequence[str] = WHOLE, at: Callable[[Cell], Found] = attempt) -> Iterator[Row]:
    """Maps beside all of their points: how far the boundary is from the true one, and how many points are unlike."""
    for chart in map(chart_of, names):
        where, points = chart.located(at)
        whole = np.full(chart.shape, "", dtype=object)
        for i, j in np.ndindex(chart.shape):
            whole[i, j] = (points.get((i, j)) or at(chart.cell(i, j))).kind
        cells, unlike = distance(where.classes, whole, rows_apart=chart.y.named), int(np.sum(where.classes != whole))
        yield {"map": chart.name, "points": whole.size, "distance": cells, "unlike": unlike}


@tabulated
def extremes_table(charts: Sequence[Chart] = PAIRS, at: Callable[[Cell], Found] = attempt) -> Iterator[Row]:
    """All points of maps, one row each: indices, values, class, and whether it was asked for."""
    for chart in charts:
        where, points = chart.located(at, whole=chart.name in WHOLE)
        for (i, j), kind in np.ndenumerate(where.classes):
            row = {"map": chart.name, "i": i, "j": j, "y": chart.y.values[i], "x": chart.x.values[j], "class": kind}
            own = points.get((i, j))
            row["asked"] = own is not None
            yield row if own is None else row | {"reason": own.reason, "command": chart.command(i, j)}


@tabulated
def axes_table(charts: Sequence[Chart] = PAIRS) -> Iterator[Row]:
    """What the maps are of, one row a map."""
    for chart in charts:
        axes = {"x_label": chart.x.label, "y_label": chart.y.label, "y_named": chart.y.named}
        yield {"map": chart.name, "title": chart.title, **axes}
