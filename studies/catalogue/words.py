"""A model in words: its reference surface, its supports and its loads, read from what it is made of."""

from __future__ import annotations

import inspect
import math
from collections.abc import Iterator
from dataclasses import dataclass, fields, is_dataclass
from itertools import product

import numpy as np

from contact.obstacles.foundation import RigidPlane
from formulations.discretisation import Discretisation
from formulations.geometry.surfaces import Plate, Surface, SurfaceOfRevolution
from formulations.shell import ShellModel
from formulations.solid import SolidDiscretisation

Values = dict[str, float]
TORUS = "x = (r cos a2, r sin a2, z), r = {axis_radius:.6g} + {radial:.6g} cos a1, z = {axial:.6g} sin a1; a1, a2 [rad]"
HYPERBOLOID = "r² = {waist:.6g}² + {slope:.6g} z², z = a1 [mm], turned about z by a2 [rad]"
POINTS, FORCES = 6, 4  # that are listed one by one
SMALL = 1e-9  # of the size of a body, of the largest force
FACES = ("inner", "outer")


@dataclass(frozen=True)
class Shape:
    """kind: its name.  formula: its points from a1 and a2.  axes: the unit of a1 and of a2."""

    kind: str
    formula: str
    axes: tuple[str, str]


def shape_of(surface: Surface) -> Shape:
    """The words; of a surface from outside, the name of its class and the first line that it says of itself."""
    if isinstance(surface, Plate):
        return Shape("plane", "x = a1, y = a2, z = 0 [mm]", ("mm", "mm"))
    if isinstance(surface, SurfaceOfRevolution):
        made_by, _, _ = surface.meridian.__qualname__.partition(".")
        sizes = inspect.getclosurevars(surface.meridian).nonlocals
        known = {"_straight": _straight, "elliptic_torus": _torus, "hyperboloid": _hyperboloid}.get(made_by)
        if known is not None:
            return known({name: float(value) for name, value in sizes.items()})
    title = (inspect.getdoc(type(surface)) or type(surface).__name__).splitlines()[0]
    return Shape(type(surface).__name__, title, ("", ""))


def _straight(sizes: Values) -> Shape:
    r0, dr, dz = sizes["r0"], sizes["dr"], sizes["dz"]
    if dr == 0:
        equation = f"x = ({r0:.6g} cos a2, {r0:.6g} sin a2, a1), a1 [mm], a2 [rad]"
        return Shape(f"circular cylinder of radius {r0:.6g} mm", equation, ("mm", "rad"))
    if dz == 0:
        return Shape("plane in polar coordinates", "x = (a1 cos a2, a1 sin a2, 0), a1 [mm], a2 [rad]", ("mm", "rad"))
    angle = math.degrees(math.atan2(dr, dz))
    equation = f"r = {dr:.6g} a1, z = {dz:.6g} a1, a1 [mm], turned about z by a2 [rad]"
    return Shape(f"circular cone of half angle {angle:.6g} deg", equation, ("mm", "rad"))


def _torus(sizes: Values) -> Shape:
    formula = TORUS.format(**sizes)
    round_tube = sizes["radial"] == sizes["axial"]
    if sizes["axis_radius"] == 0 and round_tube:
        return Shape(f"sphere of radius {sizes['radial']:.6g} mm", formula, ("rad", "rad"))
    tube = f"{sizes['radial']:.6g}" if round_tube else f"{sizes['radial']:.6g} by {sizes['axial']:.6g}"
    named = f"torus: tube of radius {tube} mm, its centre {sizes['axis_radius']:.6g} mm from the axis"
    return Shape(named, formula, ("rad", "rad"))


def _hyperboloid(sizes: Values) -> Shape:
    return Shape(f"hyperboloid of one sheet, waist {sizes['waist']:.6g} mm", HYPERBOLOID.format(**sizes), ("mm", "rad"))


def edges_of(shell: Discretisation) -> Iterator[tuple[str, int, np.ndarray]]:
    """Name, axis and nodes of each edge; a closed coordinate has none."""
    grid = shell.grid
    for axis, end in product((0, 1), (0, 1)):
        if axis == 0 or not grid.periodic:
            value = float(grid.ends[axis, end])
            yield f"a{axis + 1} = {value:.6g}", axis, grid.on_line(axis, value)


def supports(shell: Discretisation) -> Iterator[tuple[str, str]]:
    """Where, and what is held there."""
    held, middle = shell.map.held.reshape(-1, 3, 2), shell.map.held_middle
    covered, covered_middle = np.zeros_like(held), np.zeros_like(middle)
    for name, axis, nodes in edges_of(shell):
        own, own_middle = _of_edge(shell, axis, nodes)
        covered[nodes] |= own
        covered_middle[nodes] |= own_middle
        yield f"edge {name}", pattern(own, own_middle, axis)
    if shell.grid.periodic:
        yield "a2", "closed: the last line is the first"
    covered_middle |= covered.all(axis=2)
    more = np.flatnonzero(((held & ~covered).any(axis=2) | (middle & ~covered_middle)).any(axis=1))
    for node in more[:POINTS]:
        at = ", ".join(f"a{i + 1} = {value:.6g}" for i, value in enumerate(shell.grid.nodes[node]))
        yield f"point {at}", components(held[node] & ~covered[node], middle[node] & ~covered_middle[node])
    if len(more) > POINTS:
        yield f"{len(more) - POINTS} more points", "as the ones before"


def _of_edge(shell: Discretisation, axis: int, nodes: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """What all of an edge holds, without what only its corners hold for the edges that cross it.

    An edge of one element is nothing but corners: of what those hold, all is its own where they are clamped, else what
    the crossing edges do not hold all along.
    """
    held, middle = shell.map.held.reshape(-1, 3, 2), shell.map.held_middle
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
    known_name = known.get((tuple(map(bool, both)), tuple(map(bool, half))))
    alone = bool((held.any(axis=1) == both).all())
    return known_name if known_name and alone else components(held, middle)


def _only(*which: int) -> tuple[bool, ...]:
    return tuple(i in which for i in range(3))


def components(held: np.ndarray, middle: np.ndarray) -> str:
    """What is held at a point, component by component."""
    names, parts = ("along a1", "along a2", "along the normal"), []
    for i, name in enumerate(names):
        faces = [face for face, one in zip(FACES, held[i], strict=True) if one]
        if faces:
            parts.append(f"{' and '.join(faces)} face {name}")
        elif middle[i]:
            parts.append(f"middle {name}")
    return "held: " + "; ".join(parts)


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


@dataclass(frozen=True, eq=False)
class Arrows:
    """Forces (k, 3) [N] at points (k, 3) of the middle surface; kind: "force", or "couple" with its moments [N mm]."""

    kind: str
    at: np.ndarray
    along: np.ndarray


def middle_of(shell: Discretisation) -> np.ndarray:
    """Points (N, 3) midway between the faces."""
    inner, outer = shell.positions()
    return 0.5 * (inner + outer)


def nodal_forces(shell: ShellModel) -> np.ndarray:
    """Dead forces (N, 3) on both faces together, Cartesian; those on what is held are not there."""
    body = shell.discretisation
    if shell.forces is None:
        return np.zeros((body.grid.n_nodes, 3))
    local = body.map.placed(shell.forces)
    frame = body.surface.frame(*body.grid.nodes.T)
    return np.einsum("ni,nix->nx", local[:, 0::2] + local[:, 1::2], frame)


def arrows(shell: ShellModel) -> Iterator[Arrows]:
    """What is drawn."""
    body, forces = shell.discretisation, nodal_forces(shell)
    loaded = _loaded(forces)
    if len(loaded):
        yield Arrows("force", middle_of(body)[loaded], forces[loaded])
    if shell.couples is not None:
        nodes = shell.couples.nodes
        frame = body.surface.frame(*body.grid.nodes[nodes].T)
        moments = shell.couples.moments[:, None] * np.einsum("ni,nix->nx", shell.couples.axes, frame)
        yield Arrows("couple", middle_of(body)[nodes], moments)


def loads(shell: ShellModel) -> Iterator[tuple[str, str]]:
    """Kind, and how much of it where."""
    body, forces = shell.discretisation, nodal_forces(shell)
    nodes = _loaded(forces)
    at = middle_of(body)
    if 0 < len(nodes) <= FORCES and not _edge(body, nodes):
        for node in nodes:
            yield "point force", f"{_vector(forces[node])} N at {_vector(at[node])} mm, shared by both faces"
    elif len(nodes):
        edge, total = _edge(body, nodes), _vector(forces.sum(axis=0))
        if edge:
            yield "line force", f"{total} N in all along the edge {edge}, dead"
        else:
            density = np.linalg.norm(forces, axis=1)[nodes] / body.nodal_areas("mid")[nodes]
            usual = f"{float(np.median(density)):.6g} N/mm² in the median of the nodes"
            yield "area load", f"{total} N in all on what is not held, {usual}, dead"
    if shell.pressure is not None and shell.pressure.value:
        way = "follows the wall" if shell.pressure.follower else "keeps its direction"
        area = {"mid": "the middle surface", "face": "the inner face"}[shell.pressure.area]
        text = f"{shell.pressure.value:.6g} MPa on the inner face, outwards, by the area of {area}; {way}"
        yield "pressure", text
    if shell.couples is not None:
        moment = float(np.abs(shell.couples.moments).sum())
        edge = _edge(body, shell.couples.nodes)
        yield "couple", f"{moment:.6g} N mm in all along the edge {edge}, turns with the director"
    if shell.prescribed is not None and np.any(shell.prescribed):
        moved = np.flatnonzero(np.any(shell.prescribed != 0, axis=1))
        most = float(np.abs(shell.prescribed).max())
        where = _edge(body, moved) or "held edges"
        yield "given displacement", f"of {len(moved)} nodes on {where}, up to {most:.6g} mm"


def obstacle(foundation: object) -> str:
    """A rigid foundation with its sizes."""
    if isinstance(foundation, RigidPlane):
        return f"rigid plane n.x = {foundation.offset:.6g} mm, n = {_vector(foundation.normal)}, without friction"
    known = fields(foundation) if is_dataclass(foundation) else ()
    sizes = (f"{each.name} {_value(getattr(foundation, each.name))}" for each in known)
    return f"rigid {type(foundation).__name__.lower()}: {', '.join(sizes)}; without friction"


def _value(value: object) -> str:
    if isinstance(value, np.ndarray):
        return _vector(value)
    return f"{value:.6g}" if isinstance(value, float) else str(value)


def _loaded(forces: np.ndarray) -> np.ndarray:
    size = np.linalg.norm(forces, axis=1)
    return np.flatnonzero(size > SMALL * size.max(initial=0.0)) if size.any() else np.zeros(0, np.intp)


def _edge(body: Discretisation, nodes: np.ndarray) -> str:
    """The name of the edge whose nodes these are, all of them; nothing for others."""
    names = (name for name, _, own in edges_of(body) if len(nodes) > 1 and np.array_equal(np.sort(nodes), own))
    return next(names, "")


def _vector(values: np.ndarray) -> str:
    size = float(np.abs(values).max(initial=0.0))
    return "(" + ", ".join(f"{0.0 if abs(v) < 1e-9 * size else float(v):.6g}" for v in values) + ")"
