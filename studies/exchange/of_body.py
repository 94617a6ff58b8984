"""From a shell on a tensor grid, or from a solid, to a body of bricks with the same supports and loads.

Of a shell, one brick stands for one element, through each ply as many as wanted. Supports and loads are read from the
same scene on a mesh twice as fine, so that every node of a brick has its own. A solid keeps its own mesh. No scene is
known here.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import Generic, TypeVar

import numpy as np

from formulations.discretisation import Discretisation
from formulations.geometry.grid import TensorGrid
from formulations.section.laminate import Laminate
from formulations.section.laws import StVenantKirchhoff
from formulations.shell import ShellModel
from formulations.solid import SolidDiscretisation, SolidModel
from formulations.solid_mesh import SolidMesh
from studies.ask.request import UsageError
from studies.exchange.problem import INNER, ON_FACE, OUTER, Bricks, Supports, serendipity

Model = TypeVar("Model", ShellModel, SolidModel)
EXCHANGED = (0, 3, 2, 1, 7, 6, 5, 4)  # the nodes of a face with a1 and a2 exchanged, as a left-handed brick has them


def tensor_grid(body: Discretisation) -> TensorGrid:
    """Its grid; raises UsageError where that is cut locally."""
    if not isinstance(body.grid, TensorGrid):
        raise UsageError("a grid with local cuts cannot be exported")
    return body.grid


@dataclass(frozen=True, eq=False)
class Body(Generic[Model]):
    """Bricks, their supports and plies; nodes of a shell as :class:`.problem.Problem` has them.

    loads(model) -> pressure (F,) [MPa] that follows the inner faces, and dead forces (N, 3) [N] on the nodes of bricks;
    raises UsageError for loads that are neither.  model: of a shell, that on the mesh twice as fine.
    """

    bricks: Bricks
    supports: Supports
    laminate: Laminate
    shell: np.ndarray | None
    loads: Callable[[Model], tuple[np.ndarray, np.ndarray]]


def of_shell(body: Discretisation, fine: Discretisation, through: int) -> Body[ShellModel]:
    """``through`` bricks through each ply, over every element of the shell; ``fine``: on the mesh twice as fine.

    Raises UsageError for surfaces inside the wall: of them a deck has neither displacements nor laws.
    """
    if body.wall is not None:
        raise UsageError("surfaces: what is exported is a shell of two faces with the linear law")
    grid = tensor_grid(body)
    mesh = SolidMesh.build(body.surface, *grid.lines, body.laminate, per_ply=through, periodic=grid.periodic)
    bricks = Bricks.of(mesh)
    supports = _supports_of_shell(fine, body, bricks)
    return Body(bricks, supports, body.laminate, _shell_nodes(body, bricks), partial(_loads_of_shell, body, bricks))


def _shell_nodes(body: Discretisation, bricks: Bricks) -> np.ndarray:
    """(n, 2) nodes of the bricks on the inner and on the outer face at the nodes of the shell's grid."""
    grid = tensor_grid(body)
    places = _places(grid, bricks.parameter)
    on_lines = np.all(places % 2 == 0, axis=1)
    brick_nodes = np.full((grid.n_nodes, 2), -1)
    for side, level in enumerate((body.laminate.d_minus, body.laminate.d_plus)):
        nodes = np.flatnonzero(on_lines & np.isclose(bricks.parameter[:, 2], level))
        brick_nodes[np.ravel_multi_index(tuple(places[nodes].T // 2), grid.node_shape), side] = nodes
    return brick_nodes


def _supports_of_shell(fine: Discretisation, body: Discretisation, bricks: Bricks) -> Supports:
    """What the shell on the mesh twice as fine holds at the columns of nodes through the wall.

    What both faces hold, all nodes between them hold; what is held midway, the node there. Raises UsageError where no
    node is midway.
    """
    held, middle = fine.map.held.reshape(-1, 3, 2), fine.map.held_middle
    columns = np.ravel_multi_index(tuple(_places(tensor_grid(body), bricks.parameter).T), tensor_grid(fine).node_shape)
    a3, laminate = bricks.parameter[:, 2], body.laminate
    levels = (laminate.d_minus, laminate.d_plus, 0.5 * (laminate.d_minus + laminate.d_plus))
    inner, outer, midway = (np.isclose(a3, level, atol=1e-9 * laminate.thickness)[:, None] for level in levels)
    both = np.asarray(held.all(axis=2))
    if np.any(middle & ~both) and not np.any(midway & (middle & ~both)[columns]):
        raise UsageError("a support midway between the faces needs a node there: change --through")
    kept = both[columns] | (held[columns, :, 0] & inner) | (held[columns, :, 1] & outer) | (middle[columns] & midway)
    nodes = np.flatnonzero(kept.any(axis=1))
    axes = body.surface.frame(*bricks.parameter[nodes, :2].T)
    return Supports(nodes, axes, kept[nodes])


def _loads_of_shell(body: Discretisation, bricks: Bricks, fine: ShellModel) -> tuple[np.ndarray, np.ndarray]:
    """See :class:`Body`.

    The dead nodal forces of the shell on the mesh twice as fine do the same work on the bricks' own shape functions; a
    dead pressure is integrated over the bricks. By the area of the middle surface it is scaled by the ratio of the
    areas. Raises UsageError for loads that are neither.
    """
    if fine.couples is not None:
        raise UsageError("couples that turn with the director cannot be exported")
    if fine.prescribed is not None and np.any(fine.prescribed):
        raise UsageError("given displacements of supports cannot be exported")
    if fine.initial is not None and np.any(fine.initial):
        raise UsageError("initial stresses cannot be exported")
    shell = fine.discretisation
    nodal = np.zeros((shell.grid.n_nodes, 6)) if fine.forces is None else shell.map.placed(fine.forces)
    pressure, forces = np.zeros(len(bricks.inner)), np.zeros_like(bricks.x)
    if fine.pressure is not None:
        pressure = fine.pressure.value * _area_ratio(fine, body, bricks)
        if not fine.pressure.follower:
            pressure, forces = np.zeros_like(pressure), bricks.pressure_forces(pressure)
    frame = shell.surface.frame(*shell.grid.nodes.T)
    for side, face in enumerate((INNER, OUTER)):
        cartesian = np.einsum("ni,nix->nx", nodal[:, side::2], frame)
        _hand_over(forces, cartesian, shell.grid.nodes, body, bricks, face)
    return pressure, forces


def _hand_over(
    forces: np.ndarray, given: np.ndarray, at: np.ndarray, body: Discretisation, bricks: Bricks, face: int
) -> None:
    """Add forces (k, 3) at coordinates (k, 2) of a face to the nodes of the bricks there."""
    loaded = np.flatnonzero(given.any(axis=1))
    lines = tensor_grid(body).lines
    cell, local = np.empty((2, len(loaded)), int), np.empty((2, len(loaded)))
    for axis, line in enumerate(lines):
        value = at[loaded, axis]
        cell[axis] = np.clip(np.searchsorted(line, value, side="right") - 1, 0, len(line) - 2)
        low, high = line[cell[axis]], line[cell[axis] + 1]
        local[axis] = (2 * value - low - high) / (high - low)
    elements = bricks.on(face)
    order = np.full(tuple(len(line) - 1 for line in lines), -1)
    order[tuple(_cells(body, bricks, elements).T)] = elements
    owner = order[tuple(cell)]
    own = bricks.elements[owner][:, ON_FACE[face]]
    if bricks.mesh.orientation < 0:
        own = own[:, EXCHANGED]
    np.add.at(forces, own, serendipity(*local)[:, :, None] * given[loaded][:, None, :])


def _area_ratio(fine: ShellModel, body: Discretisation, bricks: Bricks) -> np.ndarray:
    """(F,) area that carries the pressure over that of the inner face, under every brick."""
    geometry, elements, pressure = fine.discretisation.geometry, fine.discretisation.grid.elements, fine.pressure
    assert pressure is not None
    inner = geometry.face_weight[:, 0]
    carrying = geometry.weight if pressure.area == "mid" else inner
    n1, n2 = (len(line) - 1 for line in tensor_grid(body).lines)
    over, under = (
        np.broadcast_to(each, len(elements)).reshape(n1, 2, n2, 2).sum(axis=(1, 3)) for each in (carrying, inner)
    )
    return np.asarray((over / under)[tuple(_cells(body, bricks, bricks.inner).T)])


def _places(grid: TensorGrid, parameter: np.ndarray) -> np.ndarray:
    """(N, 2) numbers of the lines, and of those midway between, that nodes lie on.

    Lines have even numbers, those midway odd ones; of a closed coordinate the last is the first.
    """
    along = (np.interp(parameter[:, i], line, np.arange(len(line))) for i, line in enumerate(grid.lines))
    numbers = np.rint(2 * np.stack(list(along), axis=-1)).astype(int)
    if grid.periodic:
        numbers[:, 1] %= 2 * (len(grid.lines[1]) - 1)
    return numbers


def _cells(body: Discretisation, bricks: Bricks, elements: np.ndarray) -> np.ndarray:
    """(F, 2) numbers of the shell's elements along a1 and a2 under these bricks."""
    middle = bricks.mesh.elements[elements][:, 13]  # of 27 nodes
    return np.asarray(_places(tensor_grid(body), bricks.mesh.parameter[middle]) // 2)


# --- solids -----------------------------------------------------------------------------------------------------------


def of_solid(solid: SolidDiscretisation, laminate: Laminate) -> Body[SolidModel]:
    """On its own mesh, held along the Cartesian axes.

    Raises UsageError for a law that is not linear between Green strain and the second stress.
    """
    if not all(isinstance(law, StVenantKirchhoff) for law in solid.laws):
        raise UsageError("law must be 'svk' in a deck: one of svk")
    bricks = Bricks.of(solid.mesh)
    kept = np.flatnonzero(bricks.of_mesh >= 0)
    held = solid.fixed[kept[np.argsort(bricks.of_mesh[kept])]]
    nodes = np.flatnonzero(held.any(axis=1))
    supports = Supports(nodes, np.broadcast_to(np.eye(3), (len(nodes), 3, 3)), held[nodes])
    return Body(bricks, supports, laminate, None, partial(_loads_of_solid, bricks))


def _loads_of_solid(bricks: Bricks, body: SolidModel) -> tuple[np.ndarray, np.ndarray]:
    """See :class:`Body`."""
    solid, pressure = body.discretisation, body.pressure
    forces = np.zeros(solid.fixed.size)
    if body.forces is not None:
        forces[solid.free] = body.forces
    nodal = bricks.without_centres(forces.reshape(-1, 3))
    value = np.full(len(bricks.inner), 0.0 if pressure is None else pressure.value)
    if pressure is None or pressure.follower:
        return value, nodal
    return np.zeros_like(value), nodal + bricks.pressure_forces(value)
