"""fields.vtu: the shell as one layer of hexahedra between its two faces, for ParaView and its like."""

from __future__ import annotations

from pathlib import Path

import meshio
import numpy as np

from formulations.quantities import STRAINS
from formulations.shell import ShellModel


def write_fields(path: Path, shell: ShellModel, u: np.ndarray, pressure: np.ndarray) -> None:
    """Write reference positions of both faces with displacement, contact pressure and resultants.

    Points: the N nodes of the inner face, then the N of the outer one ("face" tells 0 or 1). "displacement" [mm] in
    Cartesian components, "pressure" [MPa] on the outer face. Cells: one hexahedron an element with the mean resultants
    H_11-, ..., H_33 [N/mm] in the order of the strains.
    """
    discretisation = shell.discretisation
    inner, outer = discretisation.positions()
    n = len(inner)
    corners = discretisation.grid.elements
    a1, a2 = discretisation.grid.centre.T
    frame = discretisation.surface.frame(a1, a2)
    left_handed = np.linalg.det(frame) < 0
    corners = np.where(left_handed[:, None], corners[:, ::-1], corners)  # a hexahedron of positive volume
    resultants = shell.resultants(u)[:, : len(STRAINS)]
    names = ["H_" + strain.lstrip("2").replace("E", "") for strain in STRAINS]
    mesh = meshio.Mesh(
        points=np.concatenate([inner, outer]),
        cells=[("hexahedron", np.hstack([corners, corners + n]))],
        point_data={
            "displacement": np.concatenate(discretisation.cartesian(u)),
            "pressure": np.concatenate([np.zeros(n), pressure]),
            "face": np.repeat([0.0, 1.0], n),
        },
        cell_data={name: [resultants[:, i].copy()] for i, name in enumerate(names)},
    )
    meshio.write(path, mesh, file_format="vtu")
