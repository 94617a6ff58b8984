"""Unstructured grids as files of VTK (XML, binary, compressed), for ParaView and its like.

https://docs.vtk.org/en/latest/vtk_file_formats/vtkxml_file_format.html. What the points and cells are does not enter.
"""

from __future__ import annotations

import base64
import sys
import zlib
from collections.abc import Iterator, Mapping
from pathlib import Path

import numpy as np

CELLS = {8: 12, 27: 29}  # nodes of a hexahedron -> its type: VTK_HEXAHEDRON, VTK_TRIQUADRATIC_HEXAHEDRON
FAST = 1  # of the compression: the last bits of a float are noise, more effort leaves the file as long
Data = Mapping[str, np.ndarray]


def write_vtu(path: Path, points: np.ndarray, cells: np.ndarray, point_data: Data, cell_data: Data) -> None:
    """points (N, 3); cells (e, 8) or (e, 27): their nodes in VTK's order; data (N,), (N, 3) and (e,) by name."""
    path.write_text("\n".join(_lines(points, cells, point_data, cell_data)) + "\n", encoding="ascii")


def _lines(points: np.ndarray, cells: np.ndarray, point_data: Data, cell_data: Data) -> Iterator[str]:
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
            yield from _array(name, values)
        yield f"</{part}>"
    yield "</Piece>\n</UnstructuredGrid>\n</VTKFile>"


def _array(name: str, values: np.ndarray) -> Iterator[str]:
    """One block: the count of blocks, their size, that of the last one, the compressed size, then the data."""
    data = np.ascontiguousarray(values).tobytes()
    packed = zlib.compress(data, FAST)
    head = np.array([1, len(data), len(data), len(packed)], np.uint64).tobytes()
    kind = {"f": "Float64", "i": "Int64"}[values.dtype.kind]
    components = f' NumberOfComponents="{values.shape[1]}"' if values.ndim > 1 else ""
    yield f'<DataArray type="{kind}" Name="{name}"{components} format="binary">'
    yield (base64.b64encode(head) + base64.b64encode(packed)).decode("ascii")
    yield "</DataArray>"
