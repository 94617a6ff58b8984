"""What a result states of a quantity on refined grids: its limit, grid by grid and load by load, or why it has none.

A shell of the shear stiffness S [N/mm] sinks in under a normal point force F as S lap w = -F delta has it, with
w = -F/(phi S) ln r over the angle phi of the wall around the point, without bound (:func:`studies.scenes.curves
.point_rise`). Elements of half the size add F/(phi S) ln 2, whatever the grid; what a quantity has of the deflection at
the point grows by as much. A force along the wall does the same in the wall: u = -F (3 - nu)/(4 phi G h) ln r (Kelvin's
of a sheet; at its rim, phi = pi, up to 20 % less than Flamant's; G h and nu of a laminate from its membrane stiffness).
How grids are refined does not enter here, and nothing is solved.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from formulations.geometry.surfaces import normal
from formulations.shell import ShellModel
from formulations.strains.quantities import E33
from studies.ask.request import Request
from studies.ask.scene import Scene, ShellSceneModel
from studies.output.atomic import Table
from studies.scenes.statics import StaticModel
from studies.solving.refinement.limits import Estimate
from studies.solving.refinement.nested import Sketch
from studies.solving.result import Result, unit_of

UNKNOWN: dict[str, float | None] = {"limit": None, "uncertainty": None}
HALVINGS = 10  # of the elements at a point load, whose growth has to stay within the error that is asked for
STEP = 1e-6  # of the largest displacement, for the slope of a quantity
FORCE = "_N"  # the unit
SHEAR = (slice(6, 8), slice(8, 10))  # 2E13 and 2E23 of both faces
MEMBRANE = (slice(0, 2), slice(2, 4), slice(4, 6))  # E11, E22, 2E12


def record_estimate(result: Result, quantity: str, estimate: Estimate, error: float) -> None:
    """The estimate as quantities, and the elements of the last grid as a table."""
    if isinstance(result.model, ShellSceneModel):
        result.tables["grid"] = [_elements(result.model, result.request)]
    result.quantities |= {
        "error_asked": error,
        f"extrapolated_{quantity}": estimate.limit,
        "uncertainty": estimate.uncertainty,
        "error_estimate": estimate.error,
        "error_low": estimate.low,
        "error_high": estimate.high,
    }


def record_grids(result: Result, rows: Sequence[dict[str, Any]]) -> None:
    """The results on the grids, a row each, as a table."""
    result.tables["refinement"] = [Table.of_rows(rows)]


def record_loads(result: Result, quantity: str, stated: Sequence[Estimate | str]) -> None:
    """The table ``loads``: limit and uncertainty at every load, where there are several."""
    if len(result.loads) < 2 or len(stated) != len(result.loads):
        return
    rows = []
    for step, at in zip(result.loads, stated, strict=True):
        known = {"limit": at.limit, "uncertainty": at.uncertainty} if isinstance(at, Estimate) else UNKNOWN
        rows.append({**step.load, quantity: step.seen[quantity], **known})
    result.tables["loads"] = [Table.of_rows(rows)]


def _elements(model: ShellSceneModel, request: Request) -> Table:
    """The elements of the last grid: their ends along a1 and a2, and how often they were cut."""
    grid = model.shell.discretisation.grid
    low, high = grid.centre - grid.half, grid.centre + grid.half
    levels = [level for level, _, _ in request.leaves] or np.zeros(len(low), int)
    ends = {f"a{axis + 1}_{name}": each[:, axis] for axis in (0, 1) for name, each in (("low", low), ("high", high))}
    return Table.of({**ends, "level": levels})


def default_quantity(scene: Scene, quantities: Mapping[str, Any]) -> str:
    """The force, the first quantity with a reference, or the first of all."""
    named = ["force_N", *(reference.quantity for reference in scene.references), *quantities]
    return next(name for name in named if name in quantities)


def growth(result: Result | Sketch, quantity: str) -> float:
    """How much a quantity of the last state changes with every halving of the elements at its point loads; 0: none."""
    name, model, end = quantity.removeprefix("limit_"), result.model, result.end
    if not isinstance(model, StaticModel) or model.shell.forces is None or end is None:
        return 0.0
    if unit_of(quantity) == FORCE:  # which is what the loads are
        return 0.0
    if name in model.without_rise:
        return 0.0
    state = end.point.solution
    step = STEP * float(np.max(np.abs(state.u), initial=0.0))

    def read(u: np.ndarray) -> float:
        observation = end.stage.observe(end.problem, replace(state, u=u), end.point.requested)
        return observation.quantities.get(name, np.nan)

    along = np.zeros((model.shell.discretisation.grid.n_nodes, 6))
    for node, sink in sinks(model.shell).items():  # their parts add up: the slope along all of them at once
        along[node] = np.repeat(sink, 2)
    size = float(np.max(np.abs(along)))
    if size == 0.0 or step == 0.0:
        return 0.0
    moved = state.u + step / size * model.shell.discretisation.map.restrict(along)
    grown = end.point.requested * size * float(np.log(2)) * (read(moved) - read(state.u)) / step
    return 0.0 if np.isnan(grown) else abs(grown)


def no_limit(result: Result | Sketch, quantity: str, error: float) -> str:
    """Why a quantity of the last state has no limit to a relative error under a point load; empty where it has."""
    grows, size = growth(result, quantity), abs(result.quantities.get(quantity, np.nan))
    if not HALVINGS * grows > error * size:
        return ""
    grown = f"it grows by {100 * grows / size:.2g} % with every halving of the elements"
    return f"{quantity} has no limit in a theory with shear under a point load: {grown}"


def sinks(shell: ShellModel) -> dict[int, np.ndarray]:
    """What nodes move by, (3,) [mm] in their frames, where elements are smaller by 1/e, of nodes with a force alone.

    That is beside no other node with one.
    """
    assert shell.forces is not None
    discretisation = shell.discretisation
    force = discretisation.map.placed(shell.forces).reshape(-1, 3, 2).sum(axis=-1)
    elements, loaded = discretisation.grid.elements, np.any(force != 0, axis=-1)
    alone = np.flatnonzero(loaded & ~np.isin(np.arange(len(force)), elements[loaded[elements].sum(axis=1) > 1]))
    at = discretisation.grid.nodes[alone].T
    normals = np.einsum("nix,nx->ni", discretisation.surface.frame(*at), normal(discretisation.surface, *at))
    D, faces = discretisation.stiffness_at(alone, shell.section), (-2, -1)
    stiffness = np.sqrt(np.prod([D[:, rows, rows].sum(faces) for rows in SHEAR], axis=0))[:, None]
    A = D - D[:, :, E33, None] * D[:, E33, None, :] / D[:, E33, E33, None, None]  # of a wall whose thickness is free
    one, two, shear = (A[:, rows, rows].sum(faces)[:, None] for rows in MEMBRANE)
    poisson = A[:, MEMBRANE[0], MEMBRANE[1]].sum(faces)[:, None] / np.sqrt(one * two)
    angle = (np.pi / 2 * np.bincount(elements.ravel(), minlength=len(force)))[alone, None]
    across = np.sum(force[alone] * normals, axis=-1, keepdims=True) * normals
    along = (force[alone] - across) * (3 - poisson) / (4 * shear)
    moved = (across / stiffness + along) / angle
    return dict(zip(alone.tolist(), moved, strict=True))
