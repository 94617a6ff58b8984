"""Axes in which a deck holds and loads a node: the global ones, or those of a *TRANSFORM."""

from dataclasses import dataclass

import numpy as np

from studies.ask.request import UsageError
from studies.scenes.mesh_file.deck import Deck, Transform
from studies.scenes.mesh_file.keywords import Card, shown

LEVEL = 1e-9  # of a unit vector: a smaller part counts as zero
MOST = 100  # *TRANSFORM of a deck


def transform(deck: Deck, card: Card) -> None:
    """Axes of the degrees of freedom and the forces of a set of nodes."""
    card.knows("NSET", "TYPE")
    kind = card.parameters.get("TYPE", "R")
    if kind not in ("R", "C"):
        card.refuse(f", TYPE={shown(kind)} is not supported; it must be R or C")
    row = card.only_row()
    row.at_most(6)
    a, b = ((row.real(i, 0.0), row.real(i + 1, 0.0), row.real(i + 2, 0.0)) for i in (0, 3))
    apart = np.array(b) - np.array(a) if kind == "C" else np.cross(_unit(np.array(a)), _unit(np.array(b)))
    if not LEVEL < np.abs(apart).max() < np.inf:
        row.refuse("these two points make no axes")
    if len(deck.transforms) == MOST:
        card.refuse(f"is one of more than {MOST}")
    for node in deck.members_of(card, card.parameter("NSET"), {}, deck.node_sets, "node"):
        if deck.systems.setdefault(node, len(deck.transforms)) != len(deck.transforms):
            card.refuse(f"is the second one of node {node}")
    deck.transforms.append(Transform(kind == "C", a, b))


def axes_at(deck: Deck, system: int, x: np.ndarray) -> np.ndarray:
    """(N, 3, 3) at positions x (N, 3) by its number in the deck, rows are the axes; system -1 is the global one.

    Rectangular: x' through a, x'-y' through a and b. Cylindrical about the line through a and b: radial, tangential,
    axial; on that line rows are NaN.
    """
    if system < 0:
        return np.broadcast_to(np.eye(3), (len(x), 3, 3))
    transform = deck.transforms[system]
    a, b = np.array(transform.a), np.array(transform.b)
    if not transform.cylindrical:
        first = _unit(a)
        third = _unit(np.cross(first, _unit(b)))
        return np.broadcast_to(np.stack([first, np.cross(third, first), third]), (len(x), 3, 3))
    along = _unit(b - a)
    away = x - a - ((x - a) @ along)[:, None] * along
    size = np.linalg.norm(away, axis=-1, keepdims=True)
    scale = np.abs(x - a).max(axis=-1, keepdims=True)
    first = np.where(size > LEVEL * scale, away / np.where(size > 0, size, 1.0), np.nan)
    return np.stack([first, np.cross(along, first), np.broadcast_to(along, x.shape)], axis=1)


def axes_of(deck: Deck, numbers: np.ndarray, x: np.ndarray) -> np.ndarray:
    """(N, 3, 3) at the nodes of these numbers, at positions x (N, 3); raises UsageError on the line of a cylinder."""
    axes = np.tile(np.eye(3), (len(x), 1, 1))
    systems = np.array([deck.systems.get(number, -1) for number in numbers.tolist()])
    for system in np.unique(systems[systems >= 0]).tolist():
        nodes = systems == system
        axes[nodes] = axes_at(deck, system, x[nodes])
    lost = np.flatnonzero(np.isnan(axes).any(axis=(1, 2)))
    if len(lost):
        raise UsageError(f"{deck.path.name}: node {numbers[lost[0]]} lies on the axis of its *TRANSFORM, TYPE=C")
    return axes


@dataclass(frozen=True, eq=False)
class Held:
    """Degrees (N, 6) bool that are held at nodes, and at which displacements (N, 3), in axes of the nodes."""

    degrees: np.ndarray
    at: np.ndarray


def carried(
    deck: Deck, x: np.ndarray, axes: np.ndarray, held: Held, around: np.ndarray, shares: np.ndarray
) -> tuple[np.ndarray, Held]:
    """Number of the system (M,) of new nodes, and what is held there; they have shares (M, 4) of the nodes ``around``.

    x (N, 3), axes (N, 3, 3): of the nodes of the deck. A degree is held where its axis is held at all nodes around,
    whatever axes these have; of all systems of the deck that with the most is taken. Displacements are bilinear.
    """
    parts = [held.degrees[:, :3].astype(float), held.degrees[:, 3:].astype(float)]
    planes = [np.einsum("nix,ni,niy->nxy", axes, each, axes) for each in parts]
    moved = np.einsum("nix,ni->nx", axes, held.at)
    n = len(around)
    best, supports = np.full(n, -1), Held(np.zeros((n, 6), bool), np.zeros((n, 3)))
    for system in range(-1, len(deck.transforms)):
        local = axes_at(deck, system, x)
        off = [np.linalg.norm(local - np.einsum("nix,nxy->niy", local, plane), axis=-1) for plane in planes]
        both = np.all((np.concatenate(off, axis=-1) < LEVEL)[around], axis=1)  # false where an axis is NaN
        more = both.sum(axis=1) > supports.degrees.sum(axis=1)
        along = np.einsum("nix,nx->ni", local, moved)[around[more]]
        best[more], supports.degrees[more] = system, both[more]
        supports.at[more] = np.where(both[more, :3], np.einsum("mr,mri->mi", shares[more], along), 0.0)
    return best, supports


def _unit(x: np.ndarray) -> np.ndarray:
    """Along x (3,), zero where x is, however large."""
    x = x / (np.abs(x).max() or 1.0)
    return np.asarray(x / (np.linalg.norm(x) or 1.0))
