"""From a shell on a tensor grid to the body of bricks between its faces, with the same supports and loads.

One brick stands for one element of the shell, through each ply as many as wanted. Supports and loads are read from the
same scene on a mesh twice as fine, so that every node of a brick has its own. No scene is known here.
"""

from __future__ import annotations

import numpy as np

from formulations.discretisation import Discretisation
from formulations.geometry.grid import TensorGrid
from formulations.shell import ShellModel
from formulations.solid_mesh import SolidMesh
from studies.catalogue.supports import held_of
from studies.exchange.bricks import INNER, ON_FACE, OUTER, Bricks, serendipity
from studies.exchange.pressure import area_forces
from studies.exchange.problem import Supports, lattice, nearest
from studies.request import UsageError

EXCHANGED = (0, 3, 2, 1, 7, 6, 5, 4)  # the nodes of a face with a1 and a2 exchanged, as a left-handed brick has them


def tensor_grid(body: Discretisation) -> TensorGrid:
    """Its grid; raises UsageError where that is cut locally."""
    if not isinstance(body.grid, TensorGrid):
        raise UsageError("a grid with local cuts cannot be exported")
    return body.grid


def bricks_of(body: Discretisation, through: int) -> Bricks:
    """``through`` bricks through each ply, over every element of the shell."""
    grid = tensor_grid(body)
    mesh = SolidMesh.build(body.surface, *grid.lines, body.laminate, per_ply=through, periodic=grid.periodic)
    return Bricks.of(mesh)


def shell_nodes(body: Discretisation, bricks: Bricks) -> np.ndarray:
    """(n, 2) nodes of the bricks on the inner and on the outer face at the nodes of the shell's grid."""
    grid = tensor_grid(body)
    places = _places(grid, bricks.parameter)
    on_lines = np.all(places % 2 == 0, axis=1)
    found = np.full((grid.n_nodes, 2), -1)
    for side, level in enumerate((body.laminate.d_minus, body.laminate.d_plus)):
        nodes = np.flatnonzero(on_lines & np.isclose(bricks.parameter[:, 2], level))
        found[np.ravel_multi_index(tuple(places[nodes].T // 2), grid.node_shape), side] = nodes
    return found


def supports_of(fine: Discretisation, body: Discretisation, bricks: Bricks) -> Supports:
    """What the shell on the mesh twice as fine holds at the columns of nodes through the wall.

    What both faces hold, all nodes between them hold; what is held midway, the node there. Raises UsageError where no
    node is midway.
    """
    held, middle = held_of(fine)
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


def loads_of(fine: ShellModel, body: Discretisation, bricks: Bricks) -> tuple[np.ndarray, np.ndarray]:
    """Pressure (F,) [MPa] that follows the inner faces, and dead forces (N, 3) [N] on the nodes of the bricks.

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
            pressure, forces = np.zeros_like(pressure), area_forces(bricks, pressure)
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
    shell, pressure = fine.discretisation, fine.pressure
    assert pressure is not None
    carried, true = (np.broadcast_to(each, len(shell.grid.elements)) for each in _areas(fine))
    shape = tuple(2 * (len(line) - 1) for line in tensor_grid(body).lines)
    sums = (each.reshape(shape[0] // 2, 2, shape[1] // 2, 2).sum(axis=(1, 3)) for each in (carried, true))
    over, under = sums
    return np.asarray((over / under)[tuple(_cells(body, bricks, bricks.inner).T)])


def _areas(fine: ShellModel) -> tuple[np.ndarray, np.ndarray]:
    geometry = fine.discretisation.geometry
    assert fine.pressure is not None
    carried = geometry.weight if fine.pressure.area == "mid" else geometry.face_weight[:, 0]
    return carried, geometry.face_weight[:, 0]


def _places(grid: TensorGrid, parameter: np.ndarray) -> np.ndarray:
    """(N, 2) numbers of the lines of the lattice that nodes lie on; of a closed coordinate the last is the first."""
    found = np.stack([nearest(parameter[:, i], lattice(grid.lines[i])) for i in (0, 1)], axis=-1)
    if grid.periodic:
        found[:, 1] %= 2 * (len(grid.lines[1]) - 1)
    return found


def _cells(body: Discretisation, bricks: Bricks, elements: np.ndarray) -> np.ndarray:
    """(F, 2) numbers of the shell's elements along a1 and a2 under these bricks."""
    nodes = bricks.mesh.elements[elements]
    grid = tensor_grid(body)
    found = np.empty((len(elements), 2), int)
    middle = bricks.mesh.parameter[nodes[:, 13]]  # of 27, the one in the middle of the body
    for axis in (0, 1):
        found[:, axis] = np.searchsorted(grid.lines[axis], middle[:, axis]) - 1
    return found
