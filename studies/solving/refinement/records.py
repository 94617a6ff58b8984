"""Rounds, what they say of the limit of a quantity, and how results keep what grids have come to.

Each round solves on a grid and on the one with all its elements cut, T and T'. Bilinear elements converge with the
square of their size, so that a round says of the limit::

    L = J' + (J' - J)/3

and two rounds with different grids say how well: L is within ::

    u = max(SAFETY |L - L_before|, |J' - J|/3, rim/2)

of the limit. The second term is all that Richardson's law adds: with nodes that hang on coarse elements T may be off by
more than four times what T' is. The third is half of what the rim of a patch of contact, which jumps from node to node,
has done from T to T'. A first round alone knows |J' - J|.
Nothing is solved here.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from studies.ask.request import Request
from studies.ask.scene import ShellSceneModel
from studies.output.atomic import Table
from studies.solving.refinement.limits import SAFETY, Estimate
from studies.solving.refinement.richardson import correction
from studies.solving.result import Result

UNKNOWN: dict[str, float | None] = {"limit": None, "uncertainty": None}


@dataclass(frozen=True)
class Round:
    """A quantity on a grid and on the one with all elements cut, and their unknowns.

    seconds: CPU time of the round; finer_seconds, own_seconds: of the finer grid and of the other alone, which may be
    that of the round before.  rim: what the rim of a patch of contact adds to the indicators.
    """

    value: float
    finer: float
    unknowns: int
    finer_unknowns: int
    seconds: float
    finer_seconds: float
    rim: float = 0.0
    own_seconds: float = 0.0

    @property
    def limit(self) -> float:
        """Richardson's for the order 2."""
        return self.finer + correction((2.0, 1.0), (self.value, self.finer))


def estimate(rounds: Sequence[Round]) -> Estimate:
    """What all rounds so far say of the limit."""
    last = rounds[-1]
    step = abs(last.finer - last.value)
    within = step if len(rounds) == 1 else max(SAFETY * abs(last.limit - rounds[-2].limit), step / 3, last.rim / 2)
    scale = abs(last.limit) or np.finfo(float).tiny
    return Estimate(last.limit, within / scale, abs(last.finer - last.limit) / scale)


def record_estimate(result: Result, quantity: str, found: Estimate, error: float) -> None:
    """The estimate as quantities, and the elements of the last grid as a table."""
    if isinstance(result.model, ShellSceneModel):
        result.tables["grid"] = [_elements(result.model, result.request)]
    result.quantities |= {
        "error_asked": error,
        f"extrapolated_{quantity}": found.limit,
        "uncertainty": found.uncertainty,
        "error_estimate": found.error,
        "error_low": found.low,
        "error_high": found.high,
    }


def record_rounds(result: Result, quantity: str, rounds: Sequence[Round]) -> None:
    """The rounds as a table."""
    record_grids(result, [{"quantity": quantity, **vars(each), "limit": each.limit} for each in rounds])


def record_grids(result: Result, rows: Sequence[dict[str, Any]]) -> None:
    """What grids have come to, a row each, as a table."""
    result.tables["refinement"] = [Table.of_rows(rows)]


def at_loads(coarse: Result, fine: Result, quantity: str, last: Round) -> list[Round]:
    """The round at every requested load; the rim of the last is taken to have the same part in all."""
    seen = [[step.seen.get(quantity) for step in result.loads] for result in (coarse, fine)]
    if fine.end is None or fine.end.trace is not None or None in seen[0] + seen[1]:
        return []
    pairs = zip(*seen, strict=True)
    return [replace(last, value=a, finer=b, rim=last.rim * abs(b / (last.finer or 1.0))) for a, b in pairs]


def record_loads(result: Result, quantity: str, stated: Sequence[Estimate | str]) -> None:
    """The table ``loads``: limit and uncertainty at every load, where there are several."""
    if len(result.loads) < 2 or len(stated) != len(result.loads):
        return
    rows = []
    for step, at in zip(result.loads, stated, strict=True):
        known = {"limit": at.limit, "uncertainty": at.uncertainty} if isinstance(at, Estimate) else UNKNOWN
        rows.append({**step.load, quantity: step.seen[quantity], **known})
    result.tables["loads"] = [Table.of_rows(rows)]


def of_rounds(rounds: Sequence[Sequence[Round]]) -> list[Estimate | str]:
    """The estimates of every load from the rounds of all loads; none where a round does not have them."""
    return [estimate(each) for each in zip(*rounds, strict=True)] if all(rounds) else []


def _elements(model: ShellSceneModel, request: Request) -> Table:
    """The elements of the last grid: their ends along a1 and a2, and how often they were cut."""
    grid = model.shell.discretisation.grid
    low, high = grid.centre - grid.half, grid.centre + grid.half
    levels = [level for level, _, _ in request.leaves] or np.zeros(len(low), int)
    ends = {f"a{axis + 1}_{name}": each[:, axis] for axis in (0, 1) for name, each in (("low", low), ("high", high))}
    return Table.of({**ends, "level": levels})
