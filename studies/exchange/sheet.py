"""A problem as a neutral sheet in JSON, and its body with supports and loads as a VTU.

Nodes and elements are numbered from 1, as in the deck. No syntax of another program may enter here.
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np

from formulations.section.laminate import Ply
from studies.exchange.problem import INNER, LATTICE, OUTER, SWAPPED, LoadStep, Problem, isotropic
from studies.output.atomic import plain
from studies.output.vtu import PLACES_27, write_vtu
from studies.scenes import SCENES

FORMAT = "footprint-problem 1"
UNITS = {"length": "mm", "force": "N", "stress": "MPa", "angle": "rad"}


def sheet(problem: Problem) -> dict[str, Any]:
    """Everything, as plain data.

    elements: 20 nodes each, corners below, corners above, edges below, above, between.  element_axes: e1 and e2 at the
    centres, from which the angle of a ply counts.  supports: along rows of ``axes`` a node does not move where
    ``held``.  faces: (element, face), 1 below and 2 above.  steps: all loads at their end.
    """
    bricks, request = problem.bricks, problem.request
    supports, plane = problem.supports, problem.plane
    return {
        "format": FORMAT,
        "units": UNITS,
        "scene": request.scene,
        "title": problem.title,
        "measure": request.measure,
        "mesh": list(request.mesh),
        "model": request.model,
        "settings": dict(request.settings),
        "nonlinear": problem.nonlinear,
        "nodes": bricks.x.tolist(),
        "elements": (bricks.elements + 1).tolist(),
        "element_ply": (bricks.ply + 1).tolist(),
        "element_axes": bricks.frame[:, :2].tolist(),
        "faces": {
            "inner": [[int(i) + 1, INNER] for i in bricks.inner],
            "outer": [[int(i) + 1, OUTER] for i in bricks.outer],
        },
        "plies": [_ply(each) for each in problem.materials],
        "supports": {
            "nodes": (supports.nodes + 1).tolist(),
            "axes": supports.axes.tolist(),
            "held": supports.held.tolist(),
        },
        "plane": None if plane is None else {"normal": plane.normal.tolist(), "start_mm": plane.start},
        "touched_mm": problem.touched,
        "crown": None if problem.crown is None else problem.crown + 1,
        "shell_nodes": None if problem.shell is None else (problem.shell + 1).tolist(),
        "key": problem.key,
        "steps": [_step(problem, each) for each in problem.steps],
        "references": [_reference(each) for each in SCENES[request.scene].references],
    }


def _ply(ply: Ply) -> dict[str, Any]:
    names = ("11", "22", "33"), ("12", "13", "23"), ("12", "13", "23")
    values = zip(("E", "nu", "G"), names, (ply.moduli, ply.poisson, ply.shears), strict=True)
    constants = {f"{kind}_{ij}": value for kind, own, each in values for ij, value in zip(own, each, strict=True)}
    return {**constants, "angle": ply.angle, "thickness_mm": ply.thickness, "isotropic": isotropic(ply)}


def _step(problem: Problem, step: LoadStep) -> dict[str, Any]:
    elements, loaded = problem.bricks.inner + 1, np.flatnonzero(step.forces.any(axis=1))
    pressed = np.flatnonzero(step.pressure)
    return {
        "name": step.name,
        problem.key: step.load,
        "following_pressure_MPa": [[int(elements[i]), float(step.pressure[i])] for i in pressed],
        "forces_N": [[int(i) + 1, *map(float, step.forces[i])] for i in loaded],
        "plane_offset_mm": step.offset,
    }


def _reference(reference: Any) -> dict[str, Any]:
    return {**vars(reference), "at": dict(reference.at)}


def write_sheet(path: Path, problem: Problem) -> None:
    """The sheet as strict JSON on one line a key."""
    lines = (f"{json.dumps(key)}: {json.dumps(plain(value), allow_nan=False)}" for key, value in sheet(problem).items())
    path.write_text("{\n" + ",\n".join(lines) + "\n}\n", encoding="utf-8")


def write_body(path: Path, problem: Problem) -> None:
    """Triquadratic hexahedra; "node" and "element" are the numbers of the deck, 0 for a node that it does not have.

    Points: "held" counts directions, "force" [N] of the last step.  Cells: "ply" from 1, its axis 1 as "fibre_x" to
    "fibre_z", "pressure" [MPa] on its inner face in the last step.
    """
    bricks, mesh, last = problem.bricks, problem.bricks.mesh, problem.steps[-1]
    order = np.array(PLACES_27)[:, [0, 1, 2] if mesh.orientation > 0 else SWAPPED] @ LATTICE
    held = np.zeros(len(bricks.x))
    held[problem.supports.nodes] = problem.supports.held.sum(axis=1)
    angle = np.array([ply.angle for ply in problem.materials])[bricks.ply][:, None]
    fibre = np.cos(angle) * bricks.frame[:, 0] + np.sin(angle) * bricks.frame[:, 1]
    pressure = np.zeros(len(bricks.elements))
    pressure[bricks.inner] = last.pressure
    there = bricks.of_mesh >= 0
    points = {
        "node": np.where(there, bricks.of_mesh + 1.0, 0.0),
        "held": np.where(there, held[bricks.of_mesh], 0.0),
        "force": np.where(there[:, None], last.forces[bricks.of_mesh], 0.0),
    }
    cells = {
        "element": np.arange(1.0, len(bricks.elements) + 1),
        "ply": bricks.ply + 1.0,
        **{f"fibre_{axis}": fibre[:, i] for i, axis in enumerate("xyz")},
        "pressure": pressure,
    }
    write_vtu(path, mesh.x, mesh.elements[:, order], points, cells)
