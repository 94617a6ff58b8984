"""A sentence on what plain and mixed Newton need to reach the full load of the hemisphere."""

from __future__ import annotations

from reports.formats import NOTHING
from reports.store.cells import Cell
from reports.store.tables import Store

WHOLE = {"scene": "hemisphere", "mesh": "16x16", "load_fraction": 1, "membrane": "compatible", "lines": "even"}
STEPS = 20  # of plain Newton
ELEMENT = {"interpolation": "curvilinear", "thickness_strain": "projected"}


def newton_sentence(store: Store) -> str:
    """The hemisphere's whole load by mixed Newton in one step, and by plain Newton in twenty."""
    mixed, plain = (
        store.find(**WHOLE, **ELEMENT, newton=newton, steps=steps) for newton, steps in (("mixed", 1), ("plain", STEPS))
    )
    return (
        f"Mixed Newton, which keeps the stress resultants of the last linear step in the tangent, takes the hemisphere "
        f"to its full load in one step and {_iterations(mixed)} iterations, plain Newton in {STEPS} steps and "
        f"{_iterations(plain)}."
    )


def _iterations(cell: Cell) -> str:
    return str(cell.result["counters"]["newton_iterations"]) if cell.converged else NOTHING
