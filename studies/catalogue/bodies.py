"""The models of the sheets' cells, built and not solved, and the tables that pictures of them are drawn from.

Bodies are drawn at rest and deformed, with supports and loads on them.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import product

import numpy as np
import pandas as pd

from contact.obstacles.foundation import RigidPlane
from formulations.section.laminate import Laminate
from formulations.shell import ShellModel
from formulations.solid import SolidDiscretisation
from formulations.solid.ties import TiedSolid
from studies.ask.request import Request
from studies.ask.scene import Scene, SceneModel
from studies.catalogue.words import arrows, middle_of
from studies.output.vtu import CORNERS_8, PLACES_27, read_vtu
from studies.run.answers import Answers
from studies.run.lists import SHEETS, sheet_cell
from studies.scenes import SCENES
from studies.scenes.complete import Cell
from studies.scenes.contact import crushed_ring
from studies.scenes.contact.base import ContactModel
from studies.scenes.contact.crushed_ring_solid import SolidRingModel
from studies.scenes.faces.model import FacesModel
from studies.scenes.faces.solids import PlacedSolid
from studies.scenes.manufactured.scene import ManufacturedModel, carrying
from studies.scenes.tyre.model import checked_wall
from studies.scenes.tyre.press import PressedTyre

POINTS = ("label", "scene", "point", "x", "y", "z", "ux", "uy", "uz", "pressure")
QUADS = ("label", "a", "b", "c", "d")
MARKS = ("scene", "kind", "x", "y", "z", "dx", "dy", "dz")
DIGITS = 6
Mark = tuple[str, np.ndarray]  # kind, and a point with a direction (6,)


@dataclass(frozen=True, eq=False)
class Built:
    """The model of a cell.

    body: the shell under load fraction 1, or its last load, or the solid; None for another kind of model.
    foundation: what it is pressed on.  normal: of a rigid plane, from the body to it.
    """

    cell: Cell
    scene: Scene
    request: Request
    model: SceneModel
    body: ShellModel | SolidDiscretisation | None
    foundation: object | None

    @property
    def normal(self) -> np.ndarray | None:
        """Of a plane."""
        return self.foundation.normal if isinstance(self.foundation, RigidPlane) else None

    @property
    def laminate(self) -> Laminate | None:
        """Of its wall."""
        if isinstance(self.body, ShellModel):
            return self.body.discretisation.laminate
        if isinstance(self.model, SolidRingModel):
            return crushed_ring.ring(self.request)[1]
        if (solid := _first_solid(self.model)) is not None:
            return solid.laminate
        return checked_wall(self.request.settings)[0] if isinstance(self.model, PressedTyre) else None


def built_models() -> Iterator[Built]:
    """Of every scene of the catalogue."""
    yield from map(built, SCENES)


def built(name: str) -> Built:
    """Of one scene."""
    cell = sheet_cell(name)
    scene, request = cell.resolved()
    model = scene.build(request)
    return Built(cell, scene, request, model, _body(model), _foundation(model, request))


def _body(model: SceneModel) -> ShellModel | SolidDiscretisation | None:
    if isinstance(model, ContactModel):
        return (model.body_at or model.shell.scaled)(1.0 if model.key == "load_fraction" else model.targets[-1])
    if isinstance(model, ManufacturedModel):
        return carrying(model.shell, model.exact_at(1.0), model.loaded)
    if (first := _first_solid(model)) is not None:
        return first.solid.discretisation
    body = getattr(model, "shell", None) or getattr(model, "body", None)
    if isinstance(body, ShellModel):
        return body
    solid = getattr(body, "discretisation", None)
    return solid if isinstance(solid, SolidDiscretisation) else None


def _first_solid(model: SceneModel) -> TiedSolid | None:
    """Of bodies whose faces meet, where none is a shell."""
    if not isinstance(model, FacesModel) or hasattr(model, "shell"):
        return None
    first = model.bodies_at(model.targets[-1]).parts[0]
    return first.solid if isinstance(first, PlacedSolid) else None


def _foundation(model: SceneModel, request: Request) -> object | None:
    if isinstance(model, ContactModel):
        return model.plane_at(model.targets[-1])
    if isinstance(model, SolidRingModel):
        return crushed_ring.plate(request, request.numbers("delta_mm")[-1])
    return model.foundation if isinstance(model, PressedTyre) else None


def drawn_bodies(answers: Answers) -> tuple[pd.DataFrame, pd.DataFrame]:
    """POINTS of the skin [mm, MPa], and QUADS of their numbers, of all cells of the sheets that have fields."""
    points, quads = [], []
    for label, row in answers.planned.items():
        answer = answers.get(label) if row.get("group") == SHEETS else None
        if answer is None or not (answer.files / "fields.vtu").exists():
            continue
        fields = read_vtu(answer.files / "fields.vtu")
        faces = skin(fields.cells)
        used, numbers = np.unique(faces, return_inverse=True)
        values = np.column_stack([fields.points, fields.data["displacement"], fields.data["pressure"]])[used]
        body = pd.DataFrame(rounded(values), columns=POINTS[3:])
        points.append(body.assign(label=label, scene=row["scene"], point=np.arange(len(used)))[list(POINTS)])
        quads.append(pd.DataFrame(numbers.reshape(-1, 4), columns=QUADS[1:]).assign(label=label)[list(QUADS)])
    return _table(points, POINTS), _table(quads, QUADS)


def skin(cells: np.ndarray) -> np.ndarray:
    """The quadrilaterals (q, 4) of nodes that bound the body: faces of one cell alone, those of 27 nodes in four."""
    quads = np.concatenate([cells[:, list(face)] for face in _faces(cells.shape[1])])
    _, first, count = np.unique(np.sort(quads, axis=1), axis=0, return_index=True, return_counts=True)
    return quads[np.sort(first[count == 1])]


def _faces(nodes: int) -> Iterator[tuple[int, ...]]:
    """Local nodes of the quadrilaterals on the six faces of a cell."""
    places = CORNERS_8 if nodes == len(CORNERS_8) else PLACES_27
    number = {place: i for i, place in enumerate(places)}
    last = max(place[0] for place in places)
    for axis, side in product(range(3), (0, last)):
        one, two = (each for each in range(3) if each != axis)
        for i, j in product(range(last), repeat=2):
            corners = ((i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1))
            yield tuple(number[_place({axis: side, one: a, two: b})] for a, b in corners)


def _place(along: dict[int, int]) -> tuple[int, int, int]:
    return along[0], along[1], along[2]


def marks(built: Sequence[Built]) -> pd.DataFrame:
    """MARKS: a symbol a row; held and hinged points with their direction, forces and couples by their own length."""
    tables = []
    for each in built:
        kinds, values = zip(*_marks(each), strict=True)
        own = pd.DataFrame(rounded(np.array(values)), columns=MARKS[2:])
        tables.append(own.assign(scene=each.cell.scene, kind=kinds)[list(MARKS)])
    return _table(tables, MARKS)


def _marks(built: Built) -> Iterator[Mark]:
    if isinstance(built.body, ShellModel):
        yield from _shell_marks(built.body)
    elif isinstance(built.body, SolidDiscretisation):
        yield from _solid_marks(built.body)
    if built.normal is not None:
        yield "plane", _row(np.zeros(3), built.normal)


def _shell_marks(shell: ShellModel) -> Iterator[Mark]:
    body = shell.discretisation
    at, frame = middle_of(body), body.surface.frame(*body.grid.nodes.T)
    held, middle = body.map.held.reshape(-1, 3, 2), body.map.held_middle
    for node in np.flatnonzero(held.any(axis=(1, 2)) | middle.any(axis=1)):
        if held[node].all():
            yield "clamped", _row(at[node], np.zeros(3))
            continue
        if middle[node].all():
            yield "hinged", _row(at[node], np.zeros(3))
            continue
        for i in range(3):
            if held[node, i].any() or middle[node, i]:
                yield "held" if held[node, i].all() else "middle held", _row(at[node], frame[node, i])
    for each in arrows(shell):
        for point, along in zip(each.at, each.along, strict=True):
            yield each.kind, _row(point, along)
    if shell.pressure is not None and shell.pressure.value:
        for point, normal in zip(at, frame[:, 2], strict=True):
            yield "pressure", _row(point, np.sign(shell.pressure.value) * normal)


def _solid_marks(solid: SolidDiscretisation) -> Iterator[Mark]:
    for node in np.flatnonzero(solid.fixed.any(axis=1)):
        if solid.fixed[node].all():
            yield "clamped", _row(solid.mesh.x[node], np.zeros(3))
            continue
        for i in np.flatnonzero(solid.fixed[node]):
            yield "held", _row(solid.mesh.x[node], np.eye(3)[i])


def _row(at: np.ndarray, along: np.ndarray) -> np.ndarray:
    return np.concatenate([at, along])


def rounded(values: np.ndarray) -> np.ndarray:
    """Columns to six digits of their largest value: more is not seen."""
    sizes = np.abs(values).max(axis=0, initial=0.0)
    places = [DIGITS - 1 - math.floor(math.log10(size)) if size > 0 else 0 for size in sizes]
    columns = [np.round(column, place) for column, place in zip(values.T, places, strict=True)]
    return np.stack(columns, axis=-1) + 0.0


def _table(parts: list[pd.DataFrame], columns: Sequence[str]) -> pd.DataFrame:
    return pd.concat(parts, ignore_index=True) if parts else pd.DataFrame(columns=list(columns))
