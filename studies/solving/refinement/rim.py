"""What the rim of a patch of contact leaves unknown of a reading, even where values on three grids agree.

The rim lies anywhere between the last node in contact and the next one, in another part of the element on every grid,
and grids whose errors come out alike by luck do not show it. So no limit is stated to less than ::

    max(LEAST n^-2 |J|, |J' - J|)

The first is the error that n elements along a coordinate have at the least: theirs of bilinear ones is of the order
(h/L)^2. The second is for what a model says to be read at the rim: J' is read off the same state with the forces of
the rim handed to the nodes inside it, as if the patch ended one element before. At a rim the wall is squeezed over
about its thickness, which changes what is read there as soon as elements show it, and not before: for such a reading
elements count in n as no shorter than LAYER thicknesses, however fine they are.
Nothing is solved, and no scene may enter here.
"""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping, Sequence
from dataclasses import replace
from functools import partial
from typing import Protocol, runtime_checkable

import numpy as np

from contact.problem import ContactProblem, ContactSolution
from studies.ask.scene import ShellSceneModel
from studies.scenes.walk import Visited
from studies.solving.refinement.grids import several_elements, ways
from studies.solving.refinement.nested import Sketch, touches

LAYER = 2.0  # one leaves a pressure at the edge of a strip false on 64 to 256 elements, 1.6 to 0.4 thicknesses long
LEAST = 3.0  # of (h/L)^2; 2 is enough on strips and plates at 106 loads, 3 on 94 others, 1 was too little at 3


@runtime_checkable
class RimModel(Protocol):
    """A model with quantities that are read at the rim, and so jump as it passes from node to node."""

    @property
    def at_rim(self) -> Collection[str]:
        """Their names."""


def rims_of(path: Sketch, rows: Sequence[Mapping[str, object]], finer: float = 1.0) -> list[dict[str, float]]:
    """By name, what the rim leaves unknown of the quantities of each row, in their units; none where nothing touches.

    rows: those at the loads of the path, then the headline values, of its end.  finer: size of the elements that they
    are of, over those of the path; what changes over one element does so as they do.
    """
    if not touches(path.end):
        return [{} for _ in rows]
    size, layer = finer * _size(path), _layer(path)
    visits = [*(path.visits[k] for k in path.loaded), path.end][-len(rows) :]
    return [
        {
            name: max(
                LEAST * (max(size, layer) if name in jumps else size) ** 2 * abs(value), finer * jumps.get(name, 0.0)
            )
            for name, value in row.items()
            if isinstance(value, float)
        }
        for row, jumps in zip(rows, map(partial(_jumps, path.model), visits), strict=True)
    ]


def _size(path: Sketch) -> float:
    """Of the elements over that of a single one over all: a mesh of its own has more of them than its request says."""
    if not isinstance(path.model, ShellSceneModel):
        return path.size
    return float(len(path.model.shell.discretisation.grid.elements) ** (-1 / max(ways(path.request), 1)))


def _layer(path: Sketch) -> float:
    """The size, in the unit of the other, of elements as long as LAYER thicknesses; 0 if nothing is read at a rim."""
    model = path.model
    if not isinstance(model, RimModel) or not isinstance(model, ShellSceneModel) or not model.at_rim:
        return 0.0
    body = model.shell.discretisation
    lengths = 2 * body.grid.half * body.surface.geometry(*body.grid.centre.T).A
    length = float(np.exp(np.mean(np.log(lengths[:, several_elements(path.request)]))))
    return _size(path) * LAYER * body.laminate.thickness / length


def _jumps(model: object, visited: Visited) -> dict[str, float]:
    """By how much what is read at the rim changes when that moves in by an element; inf where it is then not read."""
    if not isinstance(model, RimModel) or not isinstance(model, ShellSceneModel) or not model.at_rim:
        return {}
    at, state = visited.point.reached, visited.point.solution
    problem = visited.problem_at(at)
    shorter = _shorter(model, problem, state)
    if shorter is None:
        return {}
    whole, moved = (visited.stage.observe(problem, each, at).quantities for each in (state, shorter))
    changes = {name: abs(moved.get(name, math.nan) - whole[name]) for name in model.at_rim if name in whole}
    return {name: math.inf if math.isnan(change) else change for name, change in changes.items()}


def _shorter(model: ShellSceneModel, problem: ContactProblem, state: ContactSolution) -> ContactSolution | None:
    """The state with the forces of the rim on the nodes inside it; None where no node of a rim has one beside it."""
    elements = model.candidate_of_node[model.shell.discretisation.grid.elements]
    touching = np.append(state.active, False)[elements]
    split = np.any(touching, axis=1) & np.any((elements >= 0) & ~touching, axis=1)
    rim = np.zeros(len(state.active), bool)
    rim[elements[split][touching[split]]] = True
    outer, inner = (np.append(each, False)[elements] for each in (rim, state.active & ~rim))
    element, giver, taker = np.nonzero(outer[:, :, None] & inner[:, None])
    pairs = np.unique(np.stack([elements[element, giver], elements[element, taker]]), axis=1)
    if not pairs.size:
        return None
    force, weights = problem.nodal_forces(state.pressure), problem.weights
    takers = np.bincount(pairs[0], minlength=len(force))
    given = np.where(takers > 0, force, 0.0)
    moved = (
        force - given + np.bincount(pairs[1], weights=(given / np.maximum(takers, 1))[pairs[0]], minlength=len(force))
    )
    pressure = moved / np.where(weights > 0, weights, 1.0)
    return replace(state, pressure=pressure, active=state.active & (takers == 0))
