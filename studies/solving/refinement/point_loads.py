"""Deflections that have no limit: how much a quantity still grows with every halving under a point load.

A shell of the shear stiffness S [N/mm] sinks in under a normal point force F as S lap w = -F delta has it, with
w = -F/(phi S) ln r over the angle phi of the wall around the point, without bound (:func:`studies.scenes.curves
.point_rise`). Elements of half the size add F/(phi S) ln 2, whatever the grid; what a quantity has of the deflection at
the point grows by as much. Other loads and how grids are refined do not enter here.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from formulations.shell import ShellModel
from studies.scenes.curves import CurveModel
from studies.scenes.statics import StaticModel
from studies.solving.refinement.nested import Sketch
from studies.solving.result import Result

HALVINGS = 10  # of the elements at a point load, whose growth has to stay within the error that is asked for
STEP = 1e-6  # of the largest displacement, for the slope of a quantity
SHEAR = (slice(6, 8), slice(8, 10))  # 2E13 and 2E23 of both faces


def growth(result: Result | Sketch, quantity: str) -> float:
    """How much a quantity of the last state changes with every halving of the elements at its point loads; 0: none."""
    name, model, end = quantity.removeprefix("limit_"), result.model, result.end
    if not isinstance(model, StaticModel) or model.shell.forces is None or end is None:
        return 0.0
    if isinstance(model, CurveModel) and name in (key.replace("_mm", "_even_mm") for key in model.rises):
        return 0.0  # it is what is left without the growth
    state = end.point.solution
    step = STEP * float(np.max(np.abs(state.u), initial=0.0))

    def read(u: np.ndarray) -> float:
        seen = end.stage.observe(end.problem, replace(state, u=u), end.point.requested)
        return seen.quantities.get(name, np.nan)

    total = 0.0
    for node, sink in sinks(model.shell).items():
        along = np.zeros((model.shell.discretisation.grid.n_nodes, 6))
        along[node, 4:] = 1.0
        moved = state.u + step * model.shell.discretisation.map.restrict(along)
        total += end.point.requested * sink * float(np.log(2)) * (read(moved) - read(state.u)) / step
    return 0.0 if np.isnan(total) else abs(total)


def no_limit(result: Result | Sketch, quantity: str, error: float) -> str:
    """Why a quantity of the last state has no limit to a relative error under a point load; empty where it has."""
    grows, size = growth(result, quantity), abs(result.quantities.get(quantity, np.nan))
    if not HALVINGS * grows > error * size:
        return ""
    grown = f"it grows by {100 * grows / size:.2g} % with every halving of the elements"
    return f"{quantity} has no limit in a theory with shear under a point load: {grown}"


def sinks(shell: ShellModel) -> dict[int, float]:
    """F/(phi S) [mm] of the nodes that carry normal forces alone, beside no other node that does."""
    assert shell.forces is not None
    discretisation = shell.discretisation
    force = discretisation.map.placed(shell.forces)[:, 4:].sum(axis=1)
    elements, loaded = discretisation.grid.elements, force != 0
    D = discretisation.laminate.stiffness(shell.section)
    stiffness = float(np.sqrt(np.prod([D[rows, rows].sum() for rows in SHEAR])))
    alone = loaded & ~np.isin(np.arange(len(force)), elements[loaded[elements].sum(axis=1) > 1])
    angle = np.pi / 2 * np.bincount(elements.ravel(), minlength=len(force))
    return {int(node): float(force[node] / (angle[node] * stiffness)) for node in np.flatnonzero(alone)}
