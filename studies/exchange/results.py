"""Results of another program, step by step: read from CSV, or from the printed output of CalculiX.

CSV has one header and numbers; its first column is the key of the problem, ``load_fraction`` or ``delta_mm``:

- a field: ``node`` and ``ux_mm, uy_mm, uz_mm``, a row a node and load; nodes are numbered as in the deck and the sheet;
- a curve: a row a load, with any of the scene's quantities by their names, ``plane_force_N`` (of the plane on the part
  that is modelled), ``reaction_x_N, reaction_y_N, reaction_z_N`` (of the supports on the body, loads that stand on them
  left out) and ``strain_energy_Nmm``.

Nothing is judged here.
"""

from __future__ import annotations

import io
import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
import pandas as pd

from contact.interchange.untrusted import MOST, read_bytes
from studies.ask.request import UsageError
from studies.exchange.problem import Problem

FIELD = ("ux_mm", "uy_mm", "uz_mm")
NODE = "node"
PLANE_FORCE, STRAIN_ENERGY = "plane_force_N", "strain_energy_Nmm"
GROWTH = "inflated_equator_outer_mm"  # of a tyre that is inflated alone
REACTION = ("reaction_x_N", "reaction_y_N", "reaction_z_N")
MOST_LOADS, MOST_COLUMNS = 1000, 1000
PRINTED = ".dat"  # how the printed output of CalculiX ends
WIDTHS = {"displacements": 4, "total force": 3, "total internal energy": 1}  # numbers of a line, of what is read
_BLOCK = re.compile(r"^ *(\w.*?)(?: \(.*\))? for set (\w+) and time +(\S+)", re.MULTILINE)  # kind, set, time


@dataclass(frozen=True, eq=False)
class Found:
    """At one load: quantities by name, and displacements (N, 3) [mm] of the nodes, NaN where none is given."""

    load: float
    quantities: Mapping[str, float] = field(default_factory=dict)
    u: np.ndarray | None = None


def read_results(path: Path, problem: Problem) -> list[Found]:
    """By growing load; raises UsageError for a file that is none of these, OSError for one that is not there."""
    try:
        text = read_bytes(path).decode("utf-8", "replace")
    except ValueError as error:
        raise UsageError(f"{path} has no results: {error}") from None
    entries = _printed(text, problem) if path.suffix == PRINTED else list(_csv(path, text, problem))
    if not 0 < len(entries) <= MOST_LOADS:
        raise UsageError(
            f"{path} has {f'results at {len(entries)} loads, more than {MOST_LOADS}' if entries else 'no results'}"
        )
    return sorted(entries, key=lambda each: each.load)


def _csv(path: Path, text: str, problem: Problem) -> Iterator[Found]:
    head = text.partition("\n")[0].count(",") + 1
    if head > MOST_COLUMNS or text.count(",") > MOST:
        raise UsageError(f"{path} is not a table of numbers: it has {head} columns, {text.count(',')} values")
    try:
        table = pd.read_csv(io.StringIO(text)).rename(columns=str.strip)
        values = table.astype(float)
    except (ValueError, OverflowError, pd.errors.ParserError) as error:
        raise UsageError(f"{path} is not a table of numbers: {str(error).splitlines()[0]}") from None
    if problem.key not in values:
        raise UsageError(f"{path} has no column {problem.key!r}; it has {', '.join(map(str, values.columns))[:200]}")
    if not np.all(np.isfinite(values[problem.key])):
        raise UsageError(f"{path}: {problem.key} must be finite numbers")
    for load, rows in values.groupby(problem.key):
        if NODE in values:
            yield Found(float(str(load)), u=_field(path, rows, problem))
        elif len(rows) > 1:
            raise UsageError(f"{path} has {len(rows)} rows with {problem.key} = {load}; a curve has one")
        else:
            quantities = {str(name): float(rows[name].iloc[0]) for name in rows if name != problem.key}
            yield Found(float(str(load)), {name: value for name, value in quantities.items() if np.isfinite(value)})


def _field(path: Path, rows: pd.DataFrame, problem: Problem) -> np.ndarray:
    missing = [name for name in FIELD if name not in rows]
    if missing:
        raise UsageError(f"{path} has no column {missing[0]!r}; a field has {', '.join((NODE, *FIELD))}")
    count, nodes = len(problem.bricks.x), rows[NODE].to_numpy()
    wrong = nodes[(nodes != np.floor(nodes)) | (nodes < 1) | (nodes > count)]
    if len(wrong):
        raise UsageError(f"{path}: node = {wrong[0]:g} must be a whole number in [1, {count}]; is the mesh the same?")
    u = np.full((count, 3), np.nan)
    u[nodes.astype(int) - 1] = rows[list(FIELD)].to_numpy()
    return u


def _printed(text: str, problem: Problem) -> list[Found]:
    """Of a deck of ours: whole steps, one a unit of time."""
    blocks: dict[int, dict[str, np.ndarray]] = {}
    heads = list(_BLOCK.finditer(text))
    for head, end in zip(heads, [*(head.start() for head in heads), len(text)][1:], strict=True):
        if head[1] not in WIDTHS:
            continue
        rows = [line.split() for line in text[head.end() : end].splitlines() if _numeric(line)]
        try:
            values, time = np.array(rows, float), float(head[3])
        except ValueError:
            values, time = np.zeros((0, 0)), 0.0
        if not np.all(np.isfinite(values)) or not np.isfinite(time):
            raise UsageError(f"the printed output has no finite numbers within {head[1]} at time {head[3]}")
        if not len(values) or values.ndim != 2 or values.shape[1] != WIDTHS[head[1]]:
            raise UsageError(f"the printed output ends or breaks within {head[1]} for set {head[2]}")
        blocks.setdefault(round(time) - 1, {})[f"{head[1]} {head[2]}"] = values
    steps = {i: tables for i, tables in blocks.items() if 0 <= i < len(problem.steps)}
    touched = _touched(steps, problem)
    return [_of_step(problem, i, tables, touched) for i, tables in steps.items() if problem.steps[i].load is not None]


def _numeric(line: str) -> bool:
    return bool(line.strip()) and line.strip()[0] in "-.0123456789"


def _touched(steps: Mapping[int, Mapping[str, np.ndarray]], problem: Problem) -> float | None:
    """n.x of the crown after the first step, as the other program has it: where the plane touches first."""
    if problem.crown is None or problem.plane is None or 0 not in steps:
        return None
    u = _displacements(steps[0], problem)
    return float((problem.bricks.x + u)[problem.crown] @ problem.plane.normal)


def _of_step(problem: Problem, i: int, tables: Mapping[str, np.ndarray], touched: float | None) -> Found:
    """Forces on held nodes are printed with the loads that stand there.

    Strain energy is taken of linear steps alone: in others it comes to twice the work of the loads (CalculiX 2.20),
    however small the increments.
    """
    step = problem.steps[i]
    assert step.load is not None
    load, quantities = step.load, {}
    if touched is not None and step.offset is not None:
        load = touched - step.offset
    u = _displacements(tables, problem)
    if "total internal energy BODY" in tables and not problem.nonlinear and problem.plane is None:
        quantities[STRAIN_ENERGY] = float(tables["total internal energy BODY"][0, 0])
    pressure = problem.pressure_forces(step, u)
    if "total force HELD" in tables and pressure is not None:
        standing = (step.forces + pressure)[problem.supports.nodes].sum(axis=0)
        quantities |= dict(zip(REACTION, map(float, tables["total force HELD"][0] - standing), strict=True))
    if "total force PLANE" in tables and problem.plane is not None:
        quantities[PLANE_FORCE] = -float(tables["total force PLANE"][0] @ problem.plane.normal)
    if problem.crown is not None and problem.plane is None:
        outwards = problem.bricks.x[problem.crown]
        quantities[GROWTH] = float(u[problem.crown] @ outwards / np.linalg.norm(outwards))
    return Found(load, quantities, u)


def _displacements(tables: Mapping[str, np.ndarray], problem: Problem) -> np.ndarray:
    u = np.full_like(problem.bricks.x, np.nan)
    rows = tables.get("displacements BODY")
    if rows is not None:
        nodes = rows[:, 0]
        if nodes.min() < 1 or nodes.max() > len(u):
            raise UsageError(f"the printed output has node {nodes.max():.0f}, the body {len(u)}; is the mesh the same?")
        u[nodes.astype(int) - 1] = rows[:, 1:]
    return u
