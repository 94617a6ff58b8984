"""Supports of a model in words, read from what it holds: the four edges, then single points that hold more."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import product

import numpy as np

from formulations.discretisation import Discretisation
from formulations.solid import SolidDiscretisation

Held = tuple[np.ndarray, np.ndarray]  # (N, 3, 2) bool: components on either face, and (N, 3) midway between the faces
FEW = 6  # points that are listed one by one
SMALL = 1e-9  # of the size of a body
FACES = ("inner", "outer")


def held_of(shell: Discretisation) -> Held:
    """What is held at every node; what both faces hold, the middle does, too."""
    held = shell.map.held.reshape(-1, 3, 2)
    return held, np.asarray(shell.map.hinged.reshape(-1, 3, 2).all(axis=2) | held.all(axis=2))


def edges_of(shell: Discretisation) -> Iterator[tuple[str, int, np.ndarray]]:
    """Name, axis and nodes of each edge; a closed coordinate has none."""
    grid = shell.grid
    for axis, end in product((0, 1), (0, 1)):
        if axis == 0 or not grid.periodic:
            value = float(grid.ends[axis, end])
            yield f"a{axis + 1} = {value:.6g}", axis, grid.on_line(axis, value)


def supports(shell: Discretisation) -> Iterator[tuple[str, str]]:
    """Where, and what is held there."""
    held, middle = held_of(shell)
    told, told_middle = np.zeros_like(held), np.zeros_like(middle)
    for name, axis, nodes in edges_of(shell):
        own, own_middle = _of_edge(shell, axis, nodes)
        told[nodes] |= own
        told_middle[nodes] |= own_middle
        yield f"edge {name}", pattern(own, own_middle, axis)
    if shell.grid.periodic:
        yield "a2", "closed: the last line is the first"
    told_middle |= told.all(axis=2)
    more = np.flatnonzero(((held & ~told).any(axis=2) | (middle & ~told_middle)).any(axis=1))
    for node in more[:FEW]:
        at = ", ".join(f"a{i + 1} = {value:.6g}" for i, value in enumerate(shell.grid.nodes[node]))
        yield f"point {at}", components(held[node] & ~told[node], middle[node] & ~told_middle[node])
    if len(more) > FEW:
        yield f"{len(more) - FEW} more points", "as the ones before"


def _of_edge(shell: Discretisation, axis: int, nodes: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """What all of an edge holds, without what only its corners hold for the edges that cross it.

    An edge of one element is nothing but corners: of what those hold, all is its own where they are clamped, else what
    the crossing edges do not hold all along.
    """
    held, middle = held_of(shell)
    across = shell.grid.nodes[nodes, 1 - axis]
    inside = nodes[(across > across.min()) & (across < across.max())]
    if len(inside) or (axis == 0 and shell.grid.periodic):
        own = inside if len(inside) else nodes
        return held[own].all(axis=0), middle[own].all(axis=0)
    both, both_middle = held[nodes].all(axis=0), middle[nodes].all(axis=0)
    if both.all():
        return both, both_middle
    crossing = [line for _, other, line in edges_of(shell) if other != axis]
    return both & ~np.all([held[line].all(axis=0) for line in crossing], axis=0), both_middle & ~np.all(
        [middle[line].all(axis=0) for line in crossing], axis=0
    )


def pattern(held: np.ndarray, middle: np.ndarray, axis: int) -> str:
    """What an edge a_{axis+1} = constant holds; (3, 2) and (3,) bool."""
    both, across = np.asarray(held.all(axis=1)), 1 - axis
    half = np.asarray(middle & ~both)
    along, normal = f"a{across + 1}", f"a{axis + 1}"
    known = {
        (_only(), _only()): "free",
        (_only(0, 1, 2), _only()): "clamped: neither face moves",
        (_only(axis), _only()): f"plane of symmetry: neither face moves along {normal}",
        (_only(), _only(across, 2)): f"diaphragm: the middle moves neither along {along} nor along the normal",
        (_only(across), _only(2)): f"hard diaphragm: neither face moves along {along}, the middle not along the normal",
        (_only(), _only(0, 1, 2)): "hinged: the middle does not move, the director turns",
    }
    found = known.get((tuple(map(bool, both)), tuple(map(bool, half))))
    alone = bool((held.any(axis=1) == both).all())
    return found if found and alone else components(held, middle)


def _only(*which: int) -> tuple[bool, ...]:
    return tuple(i in which for i in range(3))


def components(held: np.ndarray, middle: np.ndarray) -> str:
    """What is held at a point, component by component."""
    names, said = ("along a1", "along a2", "along the normal"), []
    for i, name in enumerate(names):
        faces = [face for face, one in zip(FACES, held[i], strict=True) if one]
        if faces:
            said.append(f"{' and '.join(faces)} face {name}")
        elif middle[i]:
            said.append(f"middle {name}")
    return "held: " + "; ".join(said)


def solid_supports(solid: SolidDiscretisation) -> Iterator[tuple[str, str]]:
    """The same of a solid: every Cartesian component, by the plane that its held nodes lie in."""
    clamped = solid.fixed.all(axis=1)
    if clamped.any():
        yield f"{int(clamped.sum())} nodes", "clamped: nothing moves"
    for i, name in enumerate("xyz"):
        nodes = np.flatnonzero(solid.fixed[:, i] & ~clamped)
        if len(nodes):
            yield _plane(solid.mesh.x, nodes), f"does not move along {name}"


def _plane(x: np.ndarray, nodes: np.ndarray) -> str:
    size = float(np.ptp(x, axis=0).max())
    flat = [i for i in range(3) if np.ptp(x[nodes, i]) < SMALL * size]
    means = [float(x[nodes, i].mean()) for i in flat]
    level = [f"{'xyz'[i]} = {0.0 if abs(v) < SMALL * size else v:.6g} mm" for i, v in zip(flat, means, strict=True)]
    return f"nodes on {level[0]}" if level else "all nodes" if len(nodes) == len(x) else f"{len(nodes)} nodes"
