"""A deck with its elements cut: supports, loads and sets of its nodes and elements are carried over.

A degree of freedom is held at a new node where it is at all nodes of the deck that it lies between, both ends of an
edge or four corners, along one and the same axis: what an element of the deck cannot move stays. Forces stay on their
nodes, pressures on the parts of their elements, sets have the nodes they had.
"""

from dataclasses import replace

import numpy as np

from studies.scenes.mesh_file.deck import Deck
from studies.scenes.mesh_file.local_axes import Held, axes_of, carried
from studies.scenes.mesh_file.supports import moved_of, planes_of
from studies.scenes.mesh_file.surface import Mesh

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
    deck = replace(
        deck,
        degrees={**deck.degrees, **known},
        moved={**deck.moved, **moved},
        systems={**deck.systems, **turned},
    )
    fine = replace(fine, axes=axes_of(deck, fine.numbers, fine.middle))
    return deck, fine.in_planes(planes_of(deck, fine))


def _with(each: np.ndarray) -> list[int]:
    """Rows in which anything is true."""
    return list(np.flatnonzero(each.any(axis=1)).tolist())
