"""Degrees of freedom 1 to 6 of a deck as supports of both faces, where these say the same.

A displacement that is held alone is held midway between the faces: the director turns. A rotation vector w moves the
tip of the director by w x n against its foot; rotations are held where the components of that motion which are then
zero are zero on both faces, and nothing else is. So a plane of symmetry, its three degrees held, and a clamp are exact;
a support that turns the two faces together, as of rotations alone, is refused.

Loads of a deck on the shell: forces, moments, pressures and the displacements of supports. No card enters here.

A deck with its elements cut: supports, loads and sets of its nodes and elements are carried over.

A degree of freedom is held at a new node where it is at all nodes of the deck that it lies between, both ends of an
edge or four corners, along one and the same axis: what an element of the deck cannot move stays. Forces stay on their
nodes, pressures on the parts of their elements, sets have the nodes they had. What a new node bears is shared by the
sets of the nodes between which it lies, as it shares their motion.
"""

from dataclasses import dataclass, replace

import numpy as np

from formulations.conditions.boundary import Supports
from formulations.element.strain_operator import ElementGeometry
from formulations.geometry.grid import Grid
from formulations.loads import Pressure
from studies.ask.request import UsageError
from studies.scenes.mesh_file.deck import Deck
from studies.scenes.mesh_file.local_axes import Held, axes_of, carried
from studies.scenes.mesh_file.surface import Mesh
from studies.scenes.statics import Loads

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
            f"{mesh.file}: degrees {degrees} at node {mesh.numbers[node]}, whose normal is ({normal}): a support must "
            "hold displacements only, all six degrees, or those of a plane of symmetry in which the normal lies"
        )
    return both


ABOUT_NORMAL = 1e-6  # of a moment: a smaller part of it is rounding


@dataclass(frozen=True, eq=False, kw_only=True)
class PressureOnElements(Pressure):
    """Pressure [MPa] that differs from element to element: value times ``shares`` (E,)."""

    shares: np.ndarray

    def weights(self, geometry: ElementGeometry) -> np.ndarray:
        """Area times share that each Gauss point carries, (E, 4)."""
        return super().weights(geometry) * self.shares[:, None]


def loads_of(deck: Deck, mesh: Mesh, height: np.ndarray, measure: str, *, follower: bool) -> Loads:
    """All of them; height (N,): of the wall at the nodes. Half of each force is on either face.

    A moment M is a couple of dead forces +-(M x n)/h on the faces. Raises UsageError for one about the normal n, and
    for a measure that is not linear: as the director turns, the couple loses its lever.
    """
    loads = Loads()
    if deck.forces:
        couple = mesh.along_axes(_couples(deck, mesh, measure) / height[:, None])
        half = 0.5 * mesh.along_axes(forces_of(deck, mesh))
        loads["forces"] = np.stack([half - couple, half + couple], axis=-1).reshape(len(half), 6)
    if deck.pressures:
        shares = np.array([deck.pressures.get(number, 0.0) for number in mesh.labels.tolist()])
        loads["pressure"] = PressureOnElements(1.0, follower, shares=shares)
    moved = moved_of(deck, mesh)
    if moved.any():
        loads["prescribed"] = np.repeat(moved, 2, axis=1)
    return loads


def forces_of(deck: Deck, mesh: Mesh) -> np.ndarray:
    """(N, 3) Cartesian [N]."""
    return _along(deck, mesh, 1)


def moments_of(deck: Deck, mesh: Mesh) -> np.ndarray:
    """(N, 3) Cartesian [N mm]."""
    return _along(deck, mesh, 4)


def _couples(deck: Deck, mesh: Mesh, measure: str) -> np.ndarray:
    """M x n (N, 3) of the moments."""
    moments = moments_of(deck, mesh)
    if moments.any() and measure != "linear":
        why = "as the director turns, forces on both faces lose their lever"
        raise UsageError(f"{mesh.file}: moments are supported with the measure linear only: {why}")
    about = np.abs(np.sum(moments * mesh.normals, axis=1)) > ABOUT_NORMAL * np.linalg.norm(moments, axis=1)
    if about.any():
        normal = ", ".join(f"{x + 0.0:.3g}" for x in mesh.normals[about][0])
        node = f"the moment on node {mesh.numbers[about][0]} turns about the normal ({normal})"
        raise UsageError(f"{mesh.file}: {node}, about which the shell has no stiffness")
    return np.cross(moments, mesh.normals)


def _along(deck: Deck, mesh: Mesh, first: int) -> np.ndarray:
    """(N, 3) Cartesian: the loads of three degrees from the first on."""
    loads = np.zeros_like(mesh.middle)
    for node, components in deck.forces.items():
        for degree, value in components.items():
            if first <= degree < first + 3:
                loads[mesh.at([node])] += value * mesh.axes[mesh.at([node]), degree - first]
    return loads


DEGREES = range(1, 7)


def cut_in(deck: Deck, mesh: Mesh, parts: int, smooth_deg: float) -> tuple[Deck, Mesh]:
    """Deck and mesh with each element in ``parts`` x ``parts``, see :meth:`Mesh.cut`."""
    if parts == 1:
        return deck, mesh
    fine, around, shares = mesh.cut(parts, smooth_deg)
    n_nodes = len(mesh.numbers)
    held = Held(np.zeros((n_nodes, len(DEGREES)), bool), moved_of(deck, mesh))
    for node, degrees in deck.degrees.items():
        held.degrees[np.ix_(mesh.at([node]), np.array(sorted(degrees)) - 1)] = True
    systems, between = carried(deck, mesh.middle, mesh.axes, held, around[n_nodes:], shares[n_nodes:])
    new = fine.numbers[n_nodes:].tolist()
    known = {new[i]: {int(j) + 1 for j in np.flatnonzero(between.degrees[i])} for i in _with(between.degrees)}
    moved = {new[i]: dict(enumerate(between.at[i].tolist(), 1)) for i in _with(between.at != 0)}
    turned = {new[i]: int(systems[i]) for i in np.flatnonzero(systems >= 0)}
    supports = {
        name: of | _shared(of, mesh, around[n_nodes:], shares[n_nodes:], new) for name, of in deck.supports.items()
    }
    deck = replace(
        deck,
        supports=supports,
        degrees={**deck.degrees, **known},
        moved={**deck.moved, **moved},
        systems={**deck.systems, **turned},
    )
    fine = replace(fine, axes=axes_of(deck, fine.numbers, fine.middle))
    return deck, fine.in_planes(planes_of(deck, fine))


def _shared(
    of: dict[int, float], mesh: Mesh, around: np.ndarray, shares: np.ndarray, new: list[int]
) -> dict[int, float]:
    """What a set that has shares of nodes of the deck has of new ones, between the nodes ``around`` (M, 4)."""
    own = np.array([of.get(number, 0.0) for number in mesh.numbers.tolist()])
    total = np.sum(own[around] * shares, axis=1)
    return {new[i]: float(total[i]) for i in np.flatnonzero(total)}


def borne_by(deck: Deck, mesh: Mesh) -> dict[str, np.ndarray]:
    """The share (N,) of the forces of supports at all nodes that each of several named sets bears; none of one."""
    several = deck.supports if len(deck.supports) > 1 else {}
    return {name: np.array([of.get(node, 0.0) for node in mesh.numbers.tolist()]) for name, of in several.items()}


def _with(each: np.ndarray) -> list[int]:
    """Rows in which anything is true."""
    return list(np.flatnonzero(each.any(axis=1)).tolist())
