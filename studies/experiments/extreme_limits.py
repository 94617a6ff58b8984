"""How far each measure and each algorithm goes: the last extreme that converges and is certified, and how right it is.

A limit is a way from an ordinary value of one setting to a bound. It is walked in equal steps of the logarithm until a
solve fails, then halved between the last that did not and the first that did, so that it is the first failure on the
way that is found, and not one behind it. What is found is compared with something that no other solve of the same
setting has made: a closed form where there is one.
"""

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import product
from typing import Any

import numpy as np

from contact.catalogue import ALGORITHMS
from contact.continuation.load_stepping import SMALLEST
from formulations.strains.catalogue import MEASURES
from studies.experiments import Row, tabulated
from studies.experiments.extremes import CONVERGED, UNTOUCHED, Found, attempt
from studies.scenes.benchmarks import pagano
from studies.scenes.benchmarks.sze import L, circular_arc
from studies.scenes.closed_forms.contact import flattened_ring, pinched_ring
from studies.scenes.closed_forms.elasticity import middle_deflection
from studies.scenes.complete import Cell
from studies.scenes.contact.ring import RADIUS, THIN

SCAN = 6  # steps of the logarithm between the ordinary value and the bound
RESOLUTION = 10.0**0.1  # of a limit: the ratio of the first value that fails to the last that does not, or the inverse
RIGHT = 0.01  # relative error that counts as right
SMALL, FLAT = 1e-3, 0.283  # travel over the radius: displacements are small to a thousandth of them, the ring is flat
GOOD = (CONVERGED, UNTOUCHED)
MEASURE, ALGORITHM = "measure", "algorithm"
Seen = Mapping[str, float]
Solve = Callable[[Cell, float], Found]


@dataclass(frozen=True)
class Limit:
    """A setting of a scene on its way to an extreme.

    unit: that a value is shown over, so that the number shown has no unit but ``symbol``'s.  error: relative, of what a
    cell has given; ``reference`` says against what.  smallest: step, as a part of the whole, that a solve may cut to.
    """

    name: str
    symbol: str
    scene: str
    mesh: str
    key: str
    start: float
    bound: float
    error: Callable[[Cell, Seen, Solve], float]
    reference: str
    settings: Mapping[str, str]
    smallest: float = SMALLEST
    unit: float = 1.0
    contact: str = "semismooth"
    shown: Callable[[float], float] | None = None

    def cell(self, measure: str, contact: str, value: float) -> Cell:
        """The request at a value of the setting."""
        options = {"mesh": self.mesh, "measure": measure, "contact": contact}
        settings = {**self.settings, self.key: f"{value:.4g}"}  # so that a command reproduces it
        return Cell(f"{self.name} {measure} {contact} {value:.4g}", self.scene, options, settings)

    def told(self, value: float) -> float:
        """A value as the table has it."""
        return self.shown(value) if self.shown else float(f"{value:.4g}") / self.unit


# --- what is exact --------------------------------------------------------------------------------------------------


def ring_error(cell: Cell, seen: Seen, solve: Solve) -> float:
    """Of P R^2/(EI): the elastica once the ring is flat, the ring of small displacements up to SMALL; NaN between."""
    travel = float(cell.settings["delta_mm"]) / RADIUS
    if SMALL < travel < FLAT:
        return float("nan")
    exact = pinched_ring(travel) if travel <= SMALL else flattened_ring(1 - travel)[0]
    return abs(seen["P_R2_over_EI"] / exact - 1)


def arc_error(cell: Cell, seen: Seen, solve: Solve) -> float:
    """Distance of the tip from the circular arc, over the length of the strip."""
    shortening, deflection = circular_arc(float(cell.settings["load_fraction"]))
    return math.hypot(seen["tip_shortening_mm"] - shortening, seen["tip_deflection_mm"] - deflection) / L


def elasticity_error(cell: Cell, seen: Seen, solve: Solve) -> float:
    """Of the deflection of Pagano's plate: three-dimensional elasticity, from ply to ply."""
    S, plies = float(cell.settings["S"]), pagano.cross_plies(float(cell.settings["E_ratio"]))
    exact = 100 * pagano.E_T * middle_deflection(plies, S * pagano.H, 3 * S * pagano.H, 1.0) / (pagano.H * S**4)
    return abs(seen["w_bar"] / exact - 1)


def units_error(cell: Cell, seen: Seen, solve: Solve) -> float:
    """Of the force: the same panel in four steps and in other units, so that no number is rounded alike."""
    options, settings = {**cell.options, "steps": 4}, {**cell.settings, "length_unit": "3", "stress_unit": "7"}
    other = solve(replace(cell, options=options, settings=settings), SMALLEST)
    return abs(seen["force_N"] / other.quantities["force_N"] - 1) if other.kind in GOOD else float("nan")


def flat_angle(travel: float) -> float:
    """Largest rotation [deg] of the flattened ring: that of the section at the end of the flat part."""
    return math.degrees(flattened_ring(1 - travel / RADIUS)[1])


# --- the limits -----------------------------------------------------------------------------------------------------

PINCHED, ELASTICA = "ring of small displacements, closed form", "inextensible elastica, closed form"
ELASTICITY, UNITS = "three-dimensional elasticity, closed form", "the same panel in other units and in four steps"
NEAR, FAR = {"delta_mm": "0.01"}, {"delta_mm": "50"}


def _ring(name: str, symbol: str, key: str, start: float, bound: float, reference: str, **more: Any) -> Limit:
    return Limit(name, symbol, "ring", "1x32", key, start, bound, ring_error, reference, **{"settings": {}, **more})


LAMINATED = Limit(
    *("largest ratio of moduli", "E_L/E_T [-]", "pagano", "8x8", "E_ratio", 10.0, 1e7, elasticity_error, ELASTICITY),
    {"S": "1000"},
)
FIBRES = replace(
    LAMINATED, scene="panel", mesh="4x4", bound=1e9, error=units_error, reference=UNITS, settings={"gamma_deg": "30"}
)
TRAVEL = "travel over thickness [-]"
SHORTEST = _ring("smallest travel", TRAVEL, "delta_mm", 1e-2, 1e-14, PINCHED, unit=THIN)
LONGEST = _ring("largest travel", TRAVEL, "delta_mm", 30.0, 80.0, ELASTICA, unit=THIN)
EPSILON = _ring("stiffest ε", "ε [MPa/mm]", "epsilon", 1e4, 1e20, ELASTICA, settings=FAR, contact="regularised")
THIN_NEAR = _ring("thinnest shell", "h/R [-]", "h_mm", 1.0, 1e-4, PINCHED, settings=NEAR, unit=RADIUS)
THIN_FAR = replace(THIN_NEAR, settings=FAR, reference=ELASTICA)
ROLLED = Limit(
    *("largest rotation in one step", "rotation [deg]", "sze-moment", "16x1", "load_fraction", 0.01, 10.0, arc_error),
    *("circular arc, closed form", {}, 1.0),
    shown=lambda fraction: 360 * float(f"{fraction:.4g}"),
)
FLATTENED = replace(LONGEST, name=ROLLED.name, symbol=ROLLED.symbol, smallest=1.0, shown=flat_angle)
LIMITS: dict[str, tuple[Limit, ...]] = {
    MEASURE: (THIN_NEAR, ROLLED, SHORTEST, LONGEST, EPSILON, LAMINATED),
    ALGORITHM: (THIN_FAR, FLATTENED, SHORTEST, LONGEST, EPSILON, FIBRES),
}


# --- the search -----------------------------------------------------------------------------------------------------


def search(good: Callable[[float], bool], start: float, bound: float) -> tuple[float | None, float | None]:
    """The last value from ``start`` towards ``bound`` at which all is good, and the first at which it is not.

    None for the first where the start itself is not, for the second where the bound is reached. Values are spaced
    evenly in the logarithm and then halved there, down to RESOLUTION.
    """
    last = None
    for value in np.geomspace(start, bound, SCAN + 1):
        if not good(value):
            break
        last = float(value)
    else:
        return bound, None
    if last is None:
        return None, start
    while max(value / last, last / value) > RESOLUTION:
        middle = math.sqrt(value * last)
        last, value = (middle, value) if good(middle) else (last, middle)
    return last, float(value)


@tabulated
def limits_table(
    measures: Sequence[str] = tuple(MEASURES), algorithms: Sequence[str] = tuple(ALGORITHMS), solve: Solve = attempt
) -> Iterator[Row]:
    """A row for each limit of each measure and of each algorithm.

    value: the last that converges and is certified, NaN without one; bound: it was reached.  right: the last that is
    within RIGHT, too.  error, error_ordinary: relative, at ``value`` and at the ordinary one.  fails, kind, reason: the
    next value on the way, which fails, and how.
    """
    for part, names in ((MEASURE, measures), (ALGORITHM, algorithms)):
        for name, limit in product(names, LIMITS[part]):
            pair = (name, limit.contact) if part == MEASURE else ("exact", name)
            yield {"part": part, "name": name, **_found(limit, *pair, solve)}


def _found(limit: Limit, measure: str, contact: str, solve: Solve) -> Row:
    seen: dict[float, Found] = {}

    def good(value: float) -> bool:
        if value not in seen:
            seen[value] = solve(limit.cell(measure, contact, value), limit.smallest)
        return seen[value].kind in GOOD

    def error(value: float | None) -> float:
        if value is None or not good(value):
            return float("nan")
        return limit.error(limit.cell(measure, contact, value), seen[value].quantities, solve)

    last, fails = search(good, limit.start, limit.bound)
    right = search(lambda value: error(value) <= RIGHT, limit.start, limit.bound)[0]

    def shown(value: float | None) -> float:
        return float("nan") if value is None else limit.told(value)

    row = {"limit": limit.name, "symbol": limit.symbol, "value": shown(last), "bound": fails is None}
    row |= {"right": shown(right)}
    row |= {"error": error(last), "error_ordinary": error(limit.start if last is not None else None)}
    row |= {"ordinary": limit.told(limit.start), "searched_to": limit.told(limit.bound), "fails": shown(fails)}
    why = seen[fails] if fails is not None else Found("")
    cell = limit.cell(measure, contact, limit.start if last is None else last)
    return row | {"kind": why.kind, "reason": why.reason, "reference": limit.reference, "command": cell.command}
