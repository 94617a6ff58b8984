"""States as output: a file for ParaView a requested load, with units, and tables of nodes and candidates.

What a model writes of a state is kept; gap, contact and strains are added to it. Of a model from outside that writes a
file of its own kind, that file is all. What a store keeps of a cell does not enter here, nor how accurate a state is.
"""

from __future__ import annotations

import tempfile
from collections.abc import Collection, Sequence
from dataclasses import dataclass
from functools import partial
from itertools import pairwise
from pathlib import Path

import numpy as np

from formulations.strains.quantities import STRAINS
from studies.ask.scene import PointedModel, SceneModel, ShellSceneModel, candidates_at
from studies.output.atomic import Table, write_by, write_text
from studies.output.vtu import FIELDS, Grid, read_vtu, write_vtu
from studies.scenes.walk import Seen, shown, state_of

SERIES = "fields.pvd"
UNITS = {"Points": "mm", "displacement": "mm", "pressure": "MPa", "gap": "mm"}
UNITS_OF = {"H_": "N/mm", "S_": "MPa", "E": "1", "2E": "1"}  # by how a name begins


def write(
    directory: Path, model: SceneModel, loads: Sequence[Seen], last: Seen | None, known: Collection[str]
) -> list[str]:
    """fields.vtu of the last state, at rest where there is none, and of several loads a file each and fields.pvd.

    nodes.csv has the last state, contact.csv every load, where something may touch and it is not ``known`` already.
    Returns the names.
    """
    at_end = next((at_load for at_load in loads if last is not None and at_load.state is last.state), last)
    series = {f"fields_{number}.vtu": at_load for number, at_load in enumerate(loads, 1)} if len(loads) > 1 else {}
    named = {FIELDS if at_load is at_end else name: at_load for name, at_load in series.items()}
    tables: dict[str, list[Table]] = {"nodes.csv": [], "contact.csv": []}
    for name, at_load in {**named, FIELDS: at_end}.items():
        points = _Points.of(model, at_load)
        if points is None:
            write_by(directory / name, partial(shown(model, at_load).write_fields, state=state_of(model, at_load)))
            continue
        write_by(directory / name, points.write)
        if name == FIELDS:
            tables["nodes.csv"] = [points.table()]
        if at_load is not None and at_load in loads and np.any(points.candidate >= 0):
            tables["contact.csv"].append(points.touching(at_load.load))
    made = [*named] if at_end in named.values() else [*named, FIELDS]
    if series:
        write_text(directory / SERIES, _collection([at_load.load[1] for at_load in loads], list(named)))
        made.append(SERIES)
    for name, parts in tables.items():
        if parts and name not in known:
            Table.stacked(parts).write(directory / name)
            made.append(name)
    return made


@dataclass(frozen=True, eq=False)
class _Points:
    """What a model writes of a state, and what is added to it.

    candidate, node, gap, active (P,): of its points, -1 for no candidate.  cells: mean strains of elements.
    """

    grid: Grid
    candidate: np.ndarray
    node: np.ndarray
    gap: np.ndarray
    active: np.ndarray
    cells: dict[str, np.ndarray]

    @classmethod
    def of(cls, model: SceneModel, seen: Seen | None) -> _Points | None:
        """None of a model from outside that is neither a shell nor a solid of ours."""
        there, state = shown(model, seen), state_of(model, seen)
        of_node = _candidates(there)
        if of_node is None:
            return None
        candidate, node = of_node
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / FIELDS
            there.write_fields(path, state)
            grid = read_vtu(path)
        m = int(candidate.max(initial=-1)) + 1
        gaps = np.zeros(0) if seen is None else seen.gap()
        if m == 0 or len(gaps) != m or len(state.active) != m:  # before the first contact
            candidate = np.full(len(candidate), -1)
        gap = np.append(gaps, np.nan)[candidate]
        active = np.append(state.active, False)[candidate]
        strains = there.shell.mean_strains(state.u).T if isinstance(there, ShellSceneModel) else ()
        return cls(grid, candidate, node, gap, active.astype(np.int64), dict(zip(STRAINS, strains, strict=False)))

    def write(self, path: Path) -> None:
        """As a file of VTK."""
        of_cells = {name for name in self.grid.data if name.startswith(tuple(UNITS_OF)) or name in ("ply", "body")}
        points = {name: values for name, values in self.grid.data.items() if name not in of_cells}
        cells = {name: self.grid.data[name] for name in self.grid.data if name in of_cells}
        if np.any(self.candidate >= 0):
            points |= {"gap": self.gap, "in_contact": self.active}
        names = [*points, *cells, *self.cells, "Points"]
        units = {name: unit for name in names if (unit := unit_of(name))}
        write_vtu(path, self.grid.points, self.grid.cells, points, {**cells, **self.cells}, units)

    def table(self) -> Table:
        """Every node: where it was, and how it has moved."""
        axes, data = "xyz", self.grid.data
        columns = {"node": self.node, **({"face": data["face"].astype(int)} if "face" in data else {})}
        columns |= {f"{axis}_mm": self.grid.points[:, i] for i, axis in enumerate(axes)}
        columns |= {f"u{axis}_mm": data["displacement"][:, i] for i, axis in enumerate(axes)}
        if np.any(self.candidate >= 0):
            columns |= {"pressure_MPa": data["pressure"], "gap_mm": self.gap, "active": self.active}
        return Table.of(columns)

    def touching(self, load: tuple[str, float]) -> Table:
        """Every candidate at a load: where it is, pressure, gap and whether it touches."""
        at = self.candidate >= 0
        x = self.grid.points + self.grid.data["displacement"]
        columns = {load[0]: load[1], "node": self.node[at], "pressure_MPa": self.grid.data["pressure"][at]}
        columns |= {"gap_mm": self.gap[at], "active": self.active[at]}
        return Table.of(columns | {f"{axis}_mm": x[at, i] for i, axis in enumerate("xyz")})


def unit_of(name: str) -> str:
    """Of an array of a file; empty for numbers without one."""
    return UNITS.get(name) or next((unit for begin, unit in UNITS_OF.items() if name.startswith(begin)), "")


def _candidates(model: SceneModel) -> tuple[np.ndarray, np.ndarray] | None:
    """The candidate (P,) that each point of a model's file is, -1 for none, and the node that it is."""
    if isinstance(model, ShellSceneModel):
        of_node = model.candidate_of_node
        none = np.full(len(of_node), -1)
        faces = [none, of_node] if model.touching_face else [of_node, none]
        return np.concatenate(faces), np.tile(np.arange(len(of_node)), 2)
    if isinstance(model, PointedModel):
        return model.candidate_of_point
    body = getattr(getattr(model, "body", None), "discretisation", None)
    if body is None:
        return None
    from formulations.solid.body import SolidDiscretisation  # no shell loads it

    if not isinstance(body, SolidDiscretisation):
        return None
    n = len(body.mesh.x)
    return candidates_at(getattr(model, "nodes", np.zeros(0, int)), n), np.arange(n)


def _collection(times: Sequence[float], files: Sequence[str]) -> str:
    """A series as ParaView reads it; a load that comes again has its place in the order for a time."""
    if any(b <= a for a, b in pairwise(times)):
        times = range(1, len(files) + 1)
    sets = [f'<DataSet timestep="{t:.12g}" part="0" file="{name}"/>' for t, name in zip(times, files, strict=True)]
    head = '<?xml version="1.0"?>\n<VTKFile type="Collection" version="0.1">\n<Collection>'
    return "\n".join([head, *sets, "</Collection>\n</VTKFile>"]) + "\n"
