"""Degrees of freedom 1 to 6 of a deck as supports of both faces, where these say the same.

A displacement that is held alone is held midway between the faces: the director turns. A rotation vector w moves the
tip of the director by w x n against its foot; rotations are held where the components of that motion which are then
zero are zero on both faces, and nothing else is. So a plane of symmetry, its three degrees held, and a clamp are exact;
a support that turns the two faces together, as of rotations alone, is refused.
"""

import numpy as np

from formulations.conditions.boundary import Supports
from formulations.geometry.grid import Grid
from studies.ask.request import UsageError
from studies.scenes.mesh_file.deck import Deck
from studies.scenes.mesh_file.surface import Mesh

ALL = frozenset(range(1, 7))
LEVEL = 1e-9  # of a unit normal: a smaller component counts as zero


def planes_of(deck: Deck, mesh: Mesh) -> np.ndarray:
    """(N, 3) bool: axes of a node normal to a plane of symmetry that a node lies on, by what is held there."""
    across = np.zeros((len(mesh.numbers), 3), bool)
    for degrees, nodes in _alike(deck, mesh).items():
        if degrees != ALL:
            for i in range(3):
                j, k = (i + 1) % 3, (i + 2) % 3
                across[nodes, i] = {i + 1, j + 4, k + 4} <= degrees
    return across


def moved_of(deck: Deck, mesh: Mesh) -> np.ndarray:
    """(N, 3) displacements of supports, along the axes of each node."""
    moved = np.zeros_like(mesh.middle)
    for node, values in deck.moved.items():
        for degree, value in values.items():
            moved[mesh.at([node]), degree - 1] = value
    return moved


def supports_of(deck: Deck, mesh: Mesh, grid: Grid) -> Supports:
    """Those of all nodes; raises UsageError for what the faces cannot do."""
    supports = Supports.none(grid)
    for degrees, nodes in _alike(deck, mesh).items():
        moved = [i for i in range(3) if i + 1 in degrees]
        turned = [i for i in range(3) if i + 4 in degrees]
        if degrees == ALL:
            supports = supports.clamped(nodes)
            continue
        supports = supports.hinged(nodes, moved)
        if not turned:
            continue
        both = np.array([_on_both_faces(mesh, node, moved, turned) for node in nodes.tolist()])
        for i in range(3):
            supports = supports.hold(nodes[both[:, i]], (i,))
    return supports


def _alike(deck: Deck, mesh: Mesh) -> dict[frozenset[int], np.ndarray]:
    """Nodes by the degrees that are held."""
    groups = dict[frozenset[int], list[int]]()
    for node, degrees in deck.degrees.items():
        groups.setdefault(frozenset(degrees), []).append(node)
    return {degrees: mesh.at(nodes) for degrees, nodes in groups.items()}


def _on_both_faces(mesh: Mesh, node: int, moved: list[int], turned: list[int]) -> list[bool]:
    """Components that are to be held on both faces; raises UsageError where that says more or less than the deck."""
    n = mesh.axes[node] @ mesh.normals[node]
    n = np.where(np.abs(n) < LEVEL, 0.0, n)
    turning = np.cross(np.eye(3), n).T  # (3, 3): motion of the tip from w
    free = [i for i in range(3) if i not in turned]
    still = [bool(np.any(turning[i]) and not np.any(turning[i, free])) for i in range(3)]
    both = [still[i] and i in moved for i in range(3)]
    along = np.eye(3)[both]
    across = along - np.outer(along @ n, n)  # less what stretches the director
    left = 2 - (np.linalg.matrix_rank(across) if len(across) else 0)
    allowed = np.linalg.matrix_rank(turning[:, free]) if free else 0
    if left != allowed or np.any(along @ n):
        degrees = ", ".join(str(i) for i in [*(i + 1 for i in moved), *(i + 4 for i in turned)])
        normal = ", ".join(f"{x + 0.0:.3g}" for x in mesh.normals[node])
        raise UsageError(
            f"{mesh.file}: degrees {degrees} at node {mesh.numbers[node]}, whose normal is ({normal}): understood are "
            "displacements alone, all six degrees, and planes of symmetry in which the normal lies"
        )
    return both
