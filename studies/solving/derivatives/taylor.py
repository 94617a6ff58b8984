"""The judge of derivatives: solutions with the setting a little less and more, differenced on a ladder of steps.

It does not use how a derivative was computed. With J at s +- h on three steps h, each half of the last, the central
differences are extrapolated (Richardson), and the remainder of Taylor's first order, J(s + h) - J(s) - h dJ/ds, has to
fall with h^2: with a wrong derivative it falls with h. Two extrapolations may agree by chance where the digits of J are
all that is left in them; of these the even differences tell, J(s + h) + J(s - h) - 2 J(s), which fall by four from step
to step whatever the derivative. Steps are cut until all solutions of a ladder have the contact set, and the states of
friction, of the answer: beyond a change of them J has another derivative.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Any

import numpy as np

from studies.ask.request import Request
from studies.ask.scene import Scene
from studies.output.atomic import Table
from studies.scenes.walk import Visited
from studies.solving.derivatives.beside import changed, width_of
from studies.solving.derivatives.gradient import Derivative, values_of
from studies.solving.derivatives.sides import Values
from studies.solving.refinement.grids import on_one_grid
from studies.solving.result import Result, unit_of
from studies.solving.solve import solve

TABLE = "gradient_check"
LARGEST = 2.0**-9  # of a setting, the first step of the first ladder
RUNGS = 3
CUT = 8.0  # from ladder to ladder
LADDERS = 4
EXACT = 1e-12  # residual of the solutions, relative to the forces in balance
ENOUGH = 1e-6  # relative
SEEN = 1e-4  # doubt up to which differences that agree within it confirm
NOTHING = 1e-9  # per cent for a per cent, of the largest quantity in that unit: a negligible change
SOLVED_TO = 1e-11  # relative digits of a quantity of such a solution
CONFIRMED, WRONG, UNDECIDED = "confirmed", "wrong", "not decided"


@dataclass(frozen=True)
class Check:
    """What differences say of a derivative: extrapolated, with ``doubt`` of their own; order: of Taylor's remainder.

    nothing: size below which a derivative is negligible.
    """

    derivative: Derivative
    differences: float | None
    doubt: float | None
    order: float | None
    why: str = ""
    nothing: float = 0.0

    @property
    def one_sided(self) -> bool:
        """Whether it is one-sided, where central differences have no limit."""
        return self.derivative.above != self.derivative.below

    @property
    def error(self) -> float | None:
        """Of the derivative, relative to the larger of both, where they can be distinguished."""
        if self.differences is None:
            return None
        size = max(abs(self.derivative.above), abs(self.differences))
        return abs(self.derivative.above - self.differences) / size if size > 0 else 0.0

    @property
    def word(self) -> str:
        """The verdict."""
        if self.error is None or self.doubt is None or self.differences is None:
            return UNDECIDED
        if self.error <= ENOUGH or abs(self.derivative.above - self.differences) <= self.nothing:
            return CONFIRMED
        if self.error > self.doubt:
            return WRONG
        return CONFIRMED if self.doubt <= SEEN else UNDECIDED

    @property
    def row(self) -> dict[str, Any]:
        """As plain data."""
        named = {key: getattr(self.derivative, key) for key in ("quantity", "setting", "above")}
        figures = {"differences": self.differences, "error": self.error, "doubt": self.doubt, "order": self.order}
        return {**named, **figures, "verdict": self.word, "why": self.why}


def check(
    scene: Scene, result: Result, derivatives: Sequence[Derivative], progress: Callable[[str], None] = lambda text: None
) -> list[Check]:
    """Of all derivatives of a result, setting by setting."""
    scene = on_one_grid(scene, result.request)
    exact = _exact(scene, result.request)
    checked, sizes = list[Check](), _sizes(exact)
    for key in dict.fromkeys(each.setting for each in derivatives):
        progress(f"differences with {key}")
        mine = [each for each in derivatives if each.setting == key]
        checked += _decided(scene, exact, mine, key, sizes)
    return checked


def record(result: Result, checked: Sequence[Check]) -> None:
    """As a table of the result."""
    result.tables[TABLE] = [Table.of_rows([each.row for each in checked])]


@dataclass(frozen=True)
class Rung:
    """A step h of the setting, and the quantities at s - h and s + h."""

    h: float
    low: Values
    high: Values


def _exact(scene: Scene, request: Request) -> Result:
    return solve(scene, replace(request, settings=request.settings.with_values(tolerance=EXACT)))


def _decided(
    scene: Scene, exact: Result, mine: Sequence[Derivative], key: str, sizes: Mapping[str, float]
) -> list[Check]:
    """By the ladder that has the least doubt of each, down to one that confirms all or to the last."""
    values, best = values_of(exact), list[Check]()
    unit = width_of(scene, exact.request, key, 1.0)
    for k in range(LADDERS):
        rungs, why = _rungs(scene, exact, key, LARGEST / CUT**k * unit)
        tried = [_checked(each, values, sizes, unit, rungs, why) for each in mine]
        best = [min(pair, key=_doubt) for pair in zip(best, tried, strict=True)] if best else tried
        if all(each.word == CONFIRMED or each.one_sided for each in best):
            break
    return best


def _doubt(check: Check) -> float:
    return math.inf if check.doubt is None else check.doubt


def _rungs(scene: Scene, exact: Result, key: str, first: float) -> tuple[list[Rung], str]:
    states, rungs = _states(exact.visits), list[Rung]()
    for rung in range(RUNGS):
        h, ends = first / 2**rung, list[Values]()
        for by in (-h, h):
            try:
                beside = solve(scene, changed(scene, exact.request, key, by))
            except ValueError as error:  # nothing can be built there
                return [], f"no answer with {key} {by:+.2g}: {error}"
            if not beside.outcome.converged:
                return [], f"no answer with {key} {by:+.2g}: {beside.reason or beside.outcome.value}"
            if not _same(states, _states(beside.visits)):
                return [], f"the contact set changes within {abs(by):.2g} of {key}"
            ends.append(values_of(beside))
        rungs.append(Rung(h, *ends))
    return rungs, ""


def _states(visits: Sequence[Visited]) -> list[np.ndarray]:
    """Of all candidates where stages end, with friction at all requested points: which touch, and how."""
    solutions = [each.point.solution for each in visits if each.ends_stage or each.point.solution.friction is not None]
    return [each.active if each.friction is None else each.friction.state for each in solutions]


def _same(these: Sequence[np.ndarray], those: Sequence[np.ndarray]) -> bool:
    return len(these) == len(those) and all(map(np.array_equal, these, those))


def _sizes(exact: Result) -> dict[str, float]:
    """The largest value of each unit: of what is nothing beside it rounding is left alone."""
    sizes = dict[str, float]()
    for name, value in values_of(exact).items():
        unit = unit_of(name)
        sizes[unit] = max(sizes.get(unit, 1.0 if unit == name else 0.0), abs(value))
    return sizes


def _checked(
    derivative: Derivative, values: Values, sizes: Mapping[str, float], width: float, ladder: Sequence[Rung], why: str
) -> Check:
    """Extrapolated central differences, and how much of them is truncation and rounding."""
    name, slope = derivative.quantity, derivative.above
    if slope != derivative.below:
        why = "a candidate touches without pressure: sides differ"
    if why or any(name not in end for rung in ladder for end in (rung.low, rung.high)):
        return Check(derivative, None, None, None, why or "not every solution has it")
    central = [(rung.high[name] - rung.low[name]) / (2 * rung.h) for rung in ladder]
    once = [(4 * fine - coarse) / 3 for coarse, fine in pairwise(central)]
    twice = (16 * once[1] - once[0]) / 15
    size, unit = max(abs(twice), abs(slope)), sizes[unit_of(derivative.quantity)]
    noise = max(SOLVED_TO * unit, _noise(ladder, name, values[name]))
    doubt = abs(once[1] - once[0]) + noise / ladder[-1].h
    left = [abs(rung.high[name] - values[name] - rung.h * slope) for rung in ladder[:2]]
    order = math.log2(left[0] / left[1]) if min(left) > SOLVED_TO * unit else None
    return Check(derivative, twice, doubt / size if size > 0 else 0.0, order, nothing=NOTHING * unit / width)


def _noise(ladder: Sequence[Rung], name: str, value: float) -> float:
    """By how much half the even differences miss their fall by four, in the unit of J."""
    even = [(rung.low[name] + rung.high[name]) / 2 - value for rung in ladder]
    return max(abs(coarse - 4 * fine) for coarse, fine in pairwise(even))


def lines(checked: Sequence[Check]) -> list[str]:
    """For people: how many are confirmed, and each that is not."""
    count = sum(each.word == CONFIRMED for each in checked)
    measurable = [each for each in checked if each.word == CONFIRMED and abs(each.derivative.above) > each.nothing]
    worst = max((each.error or 0.0 for each in measurable), default=0.0)
    report = [f"derivatives: {count} of {len(checked)} confirmed by solutions beside, to {worst:.1g}"]
    for each in checked:
        if each.word != CONFIRMED:
            one, other = each.derivative, "" if each.differences is None else f", by differences {each.differences:.6g}"
            report.append(
                f"{each.word}: d {one.quantity} / d {one.setting} {one.above:.6g}{other}"
                + (f"; {each.why}" if each.why else "")
            )
    return report
