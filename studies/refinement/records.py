"""What rounds have found as quantities and tables of a result. Nothing is solved or decided here."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from studies.refinement.limits import Estimate
from studies.refinement.rounds import Round, estimate
from studies.request import Request
from studies.result import Result
from studies.scene import ShellSceneModel
from studies.store.tables import Table

UNKNOWN: dict[str, float | None] = {"limit": None, "uncertainty": None}


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
