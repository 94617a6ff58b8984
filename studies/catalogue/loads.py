"""Loads of a model in words and as arrows, read from the forces, pressures and couples that it carries."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, fields, is_dataclass

import numpy as np

from contact.obstacles.foundation import RigidPlane
from formulations.discretisation import Discretisation
from formulations.shell import ShellModel
from studies.catalogue.supports import edges_of

FEW = 4  # points that are told one by one
SMALL = 1e-9  # of the largest force


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
    if 0 < len(nodes) <= FEW and not _edge(body, nodes):
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
        said = f"{shell.pressure.value:.6g} MPa on the inner face, outwards, by the area of {area}; {way}"
        yield "pressure", said
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
    return (
        _vector(value) if isinstance(value, np.ndarray) else f"{value:.6g}" if isinstance(value, float) else str(value)
    )


def _loaded(forces: np.ndarray) -> np.ndarray:
    size = np.linalg.norm(forces, axis=1)
    return np.flatnonzero(size > SMALL * size.max(initial=0.0)) if size.any() else np.zeros(0, np.intp)


def _edge(body: Discretisation, nodes: np.ndarray) -> str:
    """The name of the edge whose nodes these are, all of them; nothing for others."""
    found = (name for name, _, own in edges_of(body) if len(nodes) > 1 and np.array_equal(np.sort(nodes), own))
    return next(found, "")


def _vector(values: np.ndarray) -> str:
    size = float(np.abs(values).max(initial=0.0))
    return "(" + ", ".join(f"{0.0 if abs(v) < 1e-9 * size else float(v):.6g}" for v in values) + ")"
