"""Unstructured grids as files of VTK (XML, binary, compressed), for ParaView and its like; and such files read back.

https://docs.vtk.org/en/latest/vtk_file_formats/vtkxml_file_format.html. Which arrays a body has is no concern of this
room: :mod:`studies.ask.layers`.
"""

from __future__ import annotations

import base64
import re
import sys
import zlib
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from types import MappingProxyType

import numpy as np

CELLS = {8: 12, 27: 29}  # nodes of a hexahedron -> its type: VTK_HEXAHEDRON, VTK_TRIQUADRATIC_HEXAHEDRON
FIELDS = "fields.vtu"  # of a result
FAST = 1  # of the compression: the last bits of a float are noise, more effort leaves the file as long
HEAD = 44  # letters of the head of a block: four whole numbers of 8 bytes in base 64
ARRAY = re.compile(
    rb'<DataArray type="(Float64|Int64)" Name="([^"\n]{1,60})"(?: NumberOfComponents="(\d{1,9})")?[^>\n]{0,200}>\n'
    rb"([A-Za-z0-9+/=]*)\n(?:<InformationKey[^\n]{0,200}\n)?</DataArray>"
)
# where the nodes of a hexahedron lie along its axes, 0, 1 or 2, in VTK's order: corners, edges, faces, centre
CORNERS_8 = ((0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1))
PLACES_27 = (
    *((0, 0, 0), (2, 0, 0), (2, 2, 0), (0, 2, 0), (0, 0, 2), (2, 0, 2), (2, 2, 2), (0, 2, 2)),
    *((1, 0, 0), (2, 1, 0), (1, 2, 0), (0, 1, 0), (1, 0, 2), (2, 1, 2), (1, 2, 2), (0, 1, 2)),
    *((0, 0, 1), (2, 0, 1), (2, 2, 1), (0, 2, 1)),
    *((0, 1, 1), (2, 1, 1), (1, 0, 1), (1, 2, 1), (1, 1, 0), (1, 1, 2), (1, 1, 1)),
)
Data = Mapping[str, np.ndarray]


def write_vtu(
    path: Path,
    points: np.ndarray,
    cells: np.ndarray,
    point_data: Data,
    cell_data: Data,
    units: Mapping[str, str] = MappingProxyType({}),
) -> None:
    """points (N, 3); cells (e, 8) or (e, 27): their nodes in VTK's order; data (N,), (N, 3) and (e,) by name.

    units: of arrays by name, "Points" among them, as VTK's own key UNITS_LABEL.
    """
    path.write_text("\n".join(_lines(points, cells, point_data, cell_data, units)) + "\n", encoding="ascii")


def _lines(
    points: np.ndarray, cells: np.ndarray, point_data: Data, cell_data: Data, units: Mapping[str, str]
) -> Iterator[str]:
    count, nodes = cells.shape
    topology = {
        "connectivity": cells.astype(np.int64).ravel(),
        "offsets": nodes * np.arange(1, count + 1, dtype=np.int64),
        "types": np.full(count, CELLS[nodes], np.int64),
    }
    kind = f'type="UnstructuredGrid" version="1.0" byte_order="{sys.byteorder.title()}Endian" header_type="UInt64"'
    yield f'<?xml version="1.0"?>\n<VTKFile {kind} compressor="vtkZLibDataCompressor">\n<UnstructuredGrid>'
    yield f'<Piece NumberOfPoints="{len(points)}" NumberOfCells="{count}">'
    parts = {"Points": {"Points": points}, "Cells": topology, "PointData": point_data, "CellData": cell_data}
    for part, arrays in parts.items():
        yield f"<{part}>"
        for name, values in arrays.items():
            yield from _array(name, values, units.get(name, ""))
        yield f"</{part}>"
    yield "</Piece>\n</UnstructuredGrid>\n</VTKFile>"


def _array(name: str, values: np.ndarray, unit: str) -> Iterator[str]:
    """One block: the count of blocks, their size, that of the last one, the compressed size, then the data."""
    data = np.ascontiguousarray(values).tobytes()
    packed = zlib.compress(data, FAST)
    head = np.array([1, len(data), len(data), len(packed)], np.uint64).tobytes()
    kind = {"f": "Float64", "i": "Int64"}[values.dtype.kind]
    components = f' NumberOfComponents="{values.shape[1]}"' if values.ndim > 1 else ""
    yield f'<DataArray type="{kind}" Name="{name}"{components} format="binary">'
    yield (base64.b64encode(head) + base64.b64encode(packed)).decode("ascii")
    if unit:  # behind the data: readers take these from where the element begins
        yield f'<InformationKey name="UNITS_LABEL" location="vtkDataArray">{unit}</InformationKey>'
    yield "</DataArray>"


@dataclass(frozen=True)
class PackedArray:
    """An array of a file as it stands there: its type, how many components a row has (0: no rows), its text."""

    dtype: np.dtype
    components: int
    text: bytes

    def unpacked(self, most: int = 0) -> bytes:
        """Its bytes, no more than ``most`` of them unless that is 0; raises ValueError for what is no such text."""
        try:
            return zlib.decompressobj().decompress(base64.b64decode(self.text[HEAD:], validate=True), most)
        except zlib.error as error:
            raise ValueError(str(error)) from None

    @property
    def values(self) -> np.ndarray:
        """The array (n,), or (n, components)."""
        values = np.frombuffer(self.unpacked(), self.dtype)
        return values.reshape(-1, self.components) if self.components else values


def packed_arrays(text: bytes) -> dict[str, PackedArray]:
    """The arrays of a file that :func:`write_vtu` has written, by name."""
    return {
        name.decode("ascii", "replace"): PackedArray(np.dtype(kind.decode().lower()), int(width or 0), packed)
        for kind, name, width, packed in ARRAY.findall(text)
    }


@dataclass(frozen=True, eq=False)
class Grid:
    """points (N, 3); cells (e, 8 or 27): their nodes; data by name: (N,) or (N, 3) of points, (e,) of cells."""

    points: np.ndarray
    cells: np.ndarray
    data: dict[str, np.ndarray]


def read_vtu(path: Path) -> Grid:
    """What :func:`write_vtu` has written."""
    arrays = {name: packed.values for name, packed in packed_arrays(path.read_bytes()).items()}
    points, nodes, ends, _ = (arrays.pop(name) for name in ("Points", "connectivity", "offsets", "types"))
    return Grid(points, nodes.reshape(len(ends), -1), arrays)
