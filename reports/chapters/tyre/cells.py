"""The tyres that pages compare, by what was asked for: keywords of ``store.find`` and ``store.select``; and how."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

from reports.figures.maps import at_delta, different_nodes
from reports.store.cells import Cell

Asked = dict[str, Any]
DELTA = 20.0  # mm, the travel of the printed table
CURVES = (10.0, 15.0, DELTA)  # mm, travels of the cell PAPER that are drawn; without them there is no page
TO_DELTA = (5, 10, 15, DELTA)

ELEMENT: Asked = {"scene": "tyre", "membrane": "compatible", "thickness_strain": "projected"}  # the paper's
USUAL: Asked = {"contact": "semismooth", "newton": "mixed", "epsilon": math.inf}  # the other algorithms' yardstick
WHOLE: Asked = {**ELEMENT, "model": "full", "plies": 4, "section": "constant-s33"}
PAPER: Asked = {**WHOLE, **USUAL, "mesh": "42x40", "measure": "exact", "delta_mm": (5, 10, 15, *range(20, 28))}
ISOTROPIC_FINE: Asked = {**ELEMENT, "mesh": "84x80", "model": "full", "plies": 1, "delta_mm": TO_DELTA}
PLIES = {"angle plies": 4, "isotropic": 1}  # by their words in the table tyre_models

HALF: Asked = {**ELEMENT, "model": "half", "plies": 4}  # under a turn by 180 degrees


def change(cell: Cell, other: Cell, quantity: str = "force_N", delta: float = DELTA) -> float:
    """Relative difference of a quantity at a travel: cell over other, less one; NaN when one did not get there."""
    return cell.value(quantity, delta_mm=delta) / other.value(quantity, delta_mm=delta) - 1.0


def sets_unlike(cell: Cell, other: Cell, deltas: Sequence[float]) -> list[int | None]:
    """Nodes in contact at each travel in only one of two cells; None where one of them did not get there."""
    there = [all(each.find_step(delta_mm=delta) is not None for each in (cell, other)) for delta in deltas]
    contact = [each.table("contact") for each in (cell, other)] if any(there) else []
    return [
        different_nodes(*(at_delta(each, delta) for each in contact)) if reached else None
        for delta, reached in zip(deltas, there, strict=True)
    ]
