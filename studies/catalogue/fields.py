"""fields.vtu read back, and the surface of the body in it as quadrilaterals: what a picture of it needs."""

from __future__ import annotations

import base64
import re
import zlib
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import product
from pathlib import Path
from xml.etree import ElementTree

import numpy as np

HEAD = 44  # letters of the head of a block: four whole numbers of 8 bytes
TYPES = {"Float64": np.float64, "Int64": np.int64}
# where the nodes of a hexahedron of VTK lie along its axes, 0, 1 or 2
CORNERS_8 = ((0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1))
PLACES_27 = (
    *((0, 0, 0), (2, 0, 0), (2, 2, 0), (0, 2, 0), (0, 0, 2), (2, 0, 2), (2, 2, 2), (0, 2, 2)),
    *((1, 0, 0), (2, 1, 0), (1, 2, 0), (0, 1, 0), (1, 0, 2), (2, 1, 2), (1, 2, 2), (0, 1, 2)),
    *((0, 0, 1), (2, 0, 1), (2, 2, 1), (0, 2, 1)),
    *((0, 1, 1), (2, 1, 1), (1, 0, 1), (1, 2, 1), (1, 1, 0), (1, 1, 2), (1, 1, 1)),
)


@dataclass(frozen=True, eq=False)
class Fields:
    """points (N, 3) at rest; cells (e, 8 or 27); data (N,) or (N, 3) by name."""

    points: np.ndarray
    cells: np.ndarray
    data: dict[str, np.ndarray]


def read_fields(path: Path) -> Fields:
    """What :mod:`studies.store.vtu` has written."""
    piece = ElementTree.parse(path).getroot().find("UnstructuredGrid/Piece")
    assert piece is not None
    arrays = {part.tag: {str(each.get("Name")): _array(each) for each in part} for part in piece}
    points, topology = arrays["Points"]["Points"], arrays["Cells"]
    return Fields(points, topology["connectivity"].reshape(len(topology["offsets"]), -1), arrays["PointData"])


def _array(element: ElementTree.Element) -> np.ndarray:
    text = re.sub(r"\s", "", element.text or "")
    values = np.frombuffer(zlib.decompress(base64.b64decode(text[HEAD:])), TYPES[str(element.get("type"))])
    width = int(element.get("NumberOfComponents") or 1)
    return values.reshape(-1, width) if width > 1 else values


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
