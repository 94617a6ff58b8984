"""Files of VTK as another program reads them."""

from __future__ import annotations

from pathlib import Path

import meshio
import numpy as np
import pytest

from studies.output.vtu import write_vtu


@pytest.mark.parametrize(("nodes", "kind"), [(8, "hexahedron"), (27, "hexahedron27")])
def test_meshio_reads_every_bit_back(nodes: int, kind: str, rng: np.random.Generator, tmp_path: Path) -> None:
    points = rng.normal(size=(90, 3)) * [1e-300, 1.0, 1e300]
    cells = rng.permuted(np.tile(np.arange(90), (5000, 1)), axis=1)[:, :nodes]  # more than a block of 32 kB
    point_data = {"displacement": rng.normal(size=(90, 3)), "pressure": rng.normal(size=90)}
    cell_data = {"H_11-": rng.normal(size=(5000, 2))[:, 0]}  # strided
    write_vtu(tmp_path / "fields.vtu", points, cells, point_data, cell_data)
    read = meshio.read(tmp_path / "fields.vtu")
    (block,) = read.cells
    assert block.type == kind
    np.testing.assert_array_equal(block.data, cells)
    np.testing.assert_array_equal(read.points, points)
    assert read.point_data.keys() == point_data.keys()
    assert read.cell_data.keys() == cell_data.keys()
    for name, values in point_data.items():
        np.testing.assert_array_equal(read.point_data[name], values)
    np.testing.assert_array_equal(read.cell_data["H_11-"][0], cell_data["H_11-"])


def test_another_kind_of_cell_is_refused(tmp_path: Path) -> None:
    with pytest.raises(KeyError):
        write_vtu(tmp_path / "fields.vtu", np.zeros((4, 3)), np.zeros((1, 4), int), {}, {})
