"""What a change of any continuous setting does to every quantity of a solved path: derivatives, state by state.

The scene is built with the setting a little less and a little more, on the same grid; what that changes of residuals,
gaps and slips at the states of the path, while these are held, is the load of one linear solve each
(:mod:`studies.solving.derivatives.sides`). No solution is differenced. Derivatives are of the answer on its grid at the
end of its path, the other settings held. That they are right is the business of
:mod:`studies.solving.derivatives.taylor`.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from typing import Any

from contact.solvers.lcp_pivoting import LcpError
from contact.solvers.sparse import SingularMatrixError
from studies.ask.request import Request, UsageError
from studies.ask.scene import Scene
from studies.output.atomic import Table
from studies.output.terminal import columns
from studies.solving.derivatives.beside import differentiable, numbers_of
from studies.solving.derivatives.sides import Path, Values
from studies.solving.refinement.grids import on_one_grid
from studies.solving.result import Result

TABLE = "gradients"
GROWS, SHRINKS = 0, 1  # the side of a setting that one-sided derivatives are of


@dataclass(frozen=True)
class Derivative:
    """dJ/ds of a quantity J.

    below, above: of a setting that shrinks and grows; they differ where candidates touch without pressure.
    """

    quantity: str
    setting: str
    value: float
    setting_value: float
    below: float
    above: float

    @property
    def relative(self) -> float | None:
        """(dJ/J)/(ds/s): per cent for a per cent; None where one of them is zero, or sides differ."""
        if self.value == 0 or self.setting_value == 0 or self.below != self.above:
            return None
        return self.above * self.setting_value / self.value

    @property
    def row(self) -> dict[str, Any]:
        """As plain data."""
        named = {"quantity": self.quantity, "setting": self.setting, "value": self.value}
        return {**named, "below": self.below, "above": self.above, "relative": self.relative}


def parse_gradient(text: str, scene: Scene, request: Request) -> tuple[str, tuple[str, ...]]:
    """Quantity and settings of "QUANTITY:KEY,KEY", all continuous settings of the request for QUANTITY alone.

    Raises UsageError for a setting that the request does not have, or that is not continuous.
    """
    quantity, _, keys = text.partition(":")
    if not quantity:
        raise UsageError(f"--gradient {text!r} must be QUANTITY or QUANTITY:KEY,KEY")
    return quantity, differentiable(scene, request, [key for key in keys.split(",") if key])


def values_of(result: Result) -> Values:
    """What is differentiated: what is read off at the last load, and headline values that are not read there."""
    quantities = result.quantities | (result.loads[-1].quantities if result.loads else {})
    return {name: value for name, value in quantities.items() if name not in result.request.settings}


def check_quantities(result: Result, asked: Iterable[str]) -> None:
    """Raise UsageError for quantities that are not there."""
    has = values_of(result)
    unknown = ", ".join(quantity for quantity in asked if quantity not in has)
    if unknown:
        raise UsageError(f"--gradient {unknown}: there is no such quantity; there are {', '.join(sorted(has))}")


def of_quantities(
    scene: Scene,
    result: Result,
    asked: Sequence[tuple[str, Sequence[str]]],
    progress: Callable[[str], None] = lambda text: None,
) -> list[Derivative]:
    """Those of each quantity with its settings; of one that is not there, see :func:`check_quantities`, none."""
    derivatives = gradients(scene, result, list(dict.fromkeys(key for _, keys in asked for key in keys)), progress)
    pairs = {(quantity, key) for quantity, keys in asked for key in keys}
    return [each for each in derivatives if (each.quantity, each.setting) in pairs]


def gradients(
    scene: Scene, result: Result, keys: Sequence[str], progress: Callable[[str], None] = lambda text: None
) -> list[Derivative]:
    """Of all quantities of a solved path with these settings.

    Without a derivative, as at a limit point, or where the scene cannot be built beside the settings, the result has a
    remark. Raises UsageError where the path has not reached its end.
    """
    if not result.outcome.converged:
        raise UsageError(f"no derivatives without a converged answer: {result.reason or result.outcome.value}")
    scene, path, derivatives = on_one_grid(scene, result.request), Path(result), list[Derivative]()
    values = values_of(result)
    for key in keys:
        progress(f"derivatives with {key}")
        try:
            above = path.derivatives(scene, key, GROWS)
            below = path.derivatives(scene, key, SHRINKS) if path.one_sided else above
        except (SingularMatrixError, LcpError, ValueError) as error:
            result.remarks.append(f"no derivative with {key}: {error}")
            continue
        at = numbers_of(result.request.settings[key])[-1]
        derivatives += [
            Derivative(name, key, values[name], at, below[name], above[name]) for name in above if name in values
        ]
    return derivatives


def record(result: Result, derivatives: Sequence[Derivative]) -> None:
    """Into the result: of its headline values, but for those that the last load reads anew, and a table of all."""
    result.tables[TABLE] = [Table.of_rows([each.row for each in derivatives])]
    of_load, last = result.headline_loads, len(result.loads) - 1
    for each in derivatives:
        anew = of_load.get(each.quantity, last) < last and each.quantity in result.loads[-1].quantities
        if each.quantity in result.quantities and not anew:
            sides = {"value": each.above} if each.above == each.below else {"below": each.below, "above": each.above}
            of_settings = result.gradients.setdefault(each.quantity, {})
            of_settings[each.setting] = {**sides, "relative": each.relative}


def lines(derivatives: Sequence[Derivative], quantity: str) -> list[str]:
    """For people: a line a setting of this quantity, the strongest first."""
    mine = [each for each in derivatives if each.quantity == quantity]
    rows = [["setting", "value", f"d {quantity} / d setting", "% for 1 %"]]
    for each in sorted(mine, key=lambda each: -abs(each.relative or 0.0)):
        sides = f"{each.above:.6g}" if each.above == each.below else f"{each.below:.6g} below, {each.above:.6g} above"
        relative = "-" if each.relative is None else f"{each.relative:.4g}"
        rows.append([each.setting, f"{each.setting_value:.6g}", sides, relative])
    return list(columns(rows, right=range(4)))
