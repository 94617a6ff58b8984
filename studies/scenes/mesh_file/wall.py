"""The walls of a deck: their plies, and the axis from which their angles count."""

import math
from collections import Counter
from collections.abc import Iterator, Sequence

import numpy as np

from formulations.element.on_grid import Walls
from formulations.element.strain_operator import GAUSS, shape_functions
from formulations.section.laminate import Laminate, Ply
from studies.ask.request import UsageError
from studies.scenes.mesh_file.deck import Deck, Elastic, Layer, Section
from studies.scenes.mesh_file.surface import Mesh

SAME = 1e-9  # of 1: a length or a cosine that counts as zero
EVEN = 0.5  # of a unit tangent between nodes
MOST_TOLD = 4  # sections
UPRIGHT = 0.95  # cosine between axis and normal, above which the angle of a ply has no direction to count from


def plies_of(deck: Deck) -> list[tuple[Ply, ...]]:
    """Of all sections, from the inner face, on the negative side of the normal, outwards.

    Raises UsageError naming the constant.
    """
    turns = [deck.orientations[each.orientation][1] if each.orientation else 0.0 for each in deck.sections]
    return [
        tuple(_ply(deck, layer, math.radians(layer.angle + turn)) for layer in section.layers)
        for section, turn in zip(deck.sections, turns, strict=True)
    ]


def walls_told(deck: Deck, plies: list[tuple[Ply, ...]]) -> Iterator[str]:
    """A line for people of each of the first sections, and how many more there are."""
    counts = Counter(deck.section_of[number] for number in deck.elements)
    for (section, number), made in zip(list(deck.sections.items())[:MOST_TOLD], plies, strict=False):
        where = f" on {counts[number]} elements" if len(deck.sections) > 1 else ""
        if section.nodal:
            nodes = {node for each, of in deck.section_of.items() if of == number for node in deck.elements[each]}
            least, most = (of(deck.thickness[node] for node in nodes) for of in (min, max))
            yield f"thickness of the nodes {least:g} to {most:g} mm{where}, {section.layers[0].material}"
            continue
        of_plies = ", ".join(
            f"{layer.material} {layer.thickness:g} at {math.degrees(ply.angle):g}"
            for layer, ply in zip(section.layers, made, strict=True)
        )
        thickness = sum(layer.thickness for layer in section.layers)
        yield f"thickness {thickness:g} mm{where}, plies from inside (mm, degrees): {of_plies}"
    if len(deck.sections) > MOST_TOLD:
        yield f"and {len(deck.sections) - MOST_TOLD} more sections"


def walls_of(deck: Deck, mesh: Mesh, laminates: Sequence[Laminate]) -> Walls:
    """Of all elements, with the thickness of their section or of their nodes."""
    kind = np.array([deck.section_of[label] for label in mesh.labels.tolist()])
    nodal = np.array([section.nodal for section in deck.sections])[kind]
    of_section = np.array([laminate.thickness for laminate in laminates])[kind]
    return Walls(tuple(laminates), kind, np.where(nodal[:, None], mesh.thickness[mesh.elements], of_section[:, None]))


def _ply(deck: Deck, layer: Layer, angle: float) -> Ply:
    law = deck.materials[layer.material]
    assert law is not None  # checked when it was read
    try:
        if law.kind == "ISOTROPIC":
            return Ply.isotropic(law.values[0], law.values[1], layer.thickness)
        return _fibres(law, angle, layer.thickness)
    except ValueError as error:
        if isinstance(error, UsageError):
            raise
        law.card.refuse(f": {error}")


def _fibres(law: Elastic, angle: float, thickness: float) -> Ply:
    """The plane of a ply cannot tell 2 from 3 of a LAMINA."""
    if law.kind == "LAMINA":
        e1, e2, nu12, g12, g13, g23 = law.values
        return Ply(e1, e2, g12, g23, nu12, e2 / (2 * g23) - 1 if g23 > 0 else 0.0, angle, thickness, G_LN=g13)
    e1, e2, e3, nu12, nu13, nu23, g12, g13, g23 = law.values
    return Ply(e1, e2, g12, g23, nu12, nu23, angle, thickness, E_N=e3, G_LN=g13, nu_LN=nu13)


def first_axes(deck: Deck, mesh: Mesh) -> np.ndarray:
    """(N, 3) unit tangents at the nodes: the axis of the orientation, or the global x axis, laid on the surface.

    Where all plies are isotropic any tangents serve that turn little within an element, and another axis, or a tangent
    carried from one normal to all others, stands in. Raises UsageError without any.
    """
    with_fibres = [section for section in deck.sections if not _isotropic(deck, section)]
    names = {section.orientation for section in with_fibres or deck.sections}
    axes = {deck.orientations[name][0] if name else (1.0, 0.0, 0.0) for name in names}
    if with_fibres and len(axes) > 1:
        where = deck.words("*ORIENTATION", "sections")
        raise UsageError(f"{mesh.file}: plies count from {len(axes)} axes, only one axis is supported: {where}")
    axis = np.array(min(axes))
    if not np.any(axis):
        raise UsageError(f"{mesh.file}: an orientation has no first axis")
    if not with_fibres:
        nearest = mesh.normals[np.argmax(mesh.normals, axis=0)]
        tried = [_laid(axis, mesh), _carried(mesh), *(_laid(each, mesh) for each in (*np.eye(3), *nearest))]
        best = max(tried, key=lambda tangents: _evenness(tangents, mesh))
        if _evenness(best, mesh) < EVEN:
            raise UsageError(f"{mesh.file}: found no direction along all of the surface, as on some closed ones")
        return best
    steep = np.abs(mesh.normals @ axis) > UPRIGHT * np.linalg.norm(axis)
    if steep.any():
        node = mesh.numbers[np.flatnonzero(steep)[0]]
        raise UsageError(f"{mesh.file}: the axis of the plies is nearly normal to the shell at node {node}")
    return _laid(axis, mesh)


def _isotropic(deck: Deck, section: Section) -> bool:
    return all(law.kind == "ISOTROPIC" for layer in section.layers if (law := deck.materials[layer.material]))


def _laid(axis: np.ndarray, mesh: Mesh) -> np.ndarray:
    """The axis less its part along the normals; anything where nothing is left."""
    tangents = axis - (mesh.normals @ axis)[:, None] * mesh.normals
    length = np.linalg.norm(tangents, axis=-1, keepdims=True)
    least = np.eye(3)[np.argmin(np.abs(mesh.normals), axis=-1)]
    tangents = np.where(length > SAME, tangents, np.cross(mesh.normals, least))
    return np.asarray(tangents / np.linalg.norm(tangents, axis=-1, keepdims=True))


def _carried(mesh: Mesh) -> np.ndarray:
    """A tangent at the mean normal m, turned about m x n by the angle from m to n; anything where n = -m.

    With k = m x n: t + k x t + k x (k x t)/(1 + m.n). Source: Rodrigues' formula.
    """
    mean = mesh.areas.sum(axis=0)
    mean = mean / np.linalg.norm(mean) if np.any(mean) else mesh.normals[0]
    tangent = np.cross(mean, np.eye(3)[np.argmin(np.abs(mean))])
    k, c = np.cross(mean, mesh.normals), mesh.normals @ mean
    turned = tangent + np.cross(k, tangent) + np.cross(k, np.cross(k, tangent)) / np.maximum(1 + c, SAME)[:, None]
    turned -= np.sum(turned * mesh.normals, axis=-1, keepdims=True) * mesh.normals
    length = np.linalg.norm(turned, axis=-1, keepdims=True)
    return np.asarray(np.where(length > SAME, turned / np.maximum(length, SAME), _laid(np.ones(3), mesh)))


def _evenness(tangents: np.ndarray, mesh: Mesh) -> float:
    """The shortest that unit tangents, or those at right angles to them, get between the nodes of an element."""
    both = np.stack([tangents, np.cross(mesh.normals, tangents)], axis=1)[mesh.elements]
    between = np.einsum("gr,erax->egax", shape_functions(GAUSS)[0], both)
    return float(np.linalg.norm(between, axis=-1).min())
