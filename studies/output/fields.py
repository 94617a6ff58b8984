"""fields.vtu: shells as one layer of hexahedra between their faces, solids as they are, for ParaView and its like."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from formulations.shell import ShellModel
from formulations.solid import SolidDiscretisation
from formulations.strains.quantities import STRAINS
from studies.output.vtu import PLACES_27, write_vtu


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
    write_vtu(
        path,
        np.concatenate([inner, outer]),
        np.hstack([corners, corners + n]),
        point_data={
            "displacement": np.concatenate(discretisation.cartesian(u, shell.prescribed)),
            "pressure": np.concatenate([np.zeros(n), pressure]),
            "face": np.repeat([0.0, 1.0], n),
        },
        cell_data=dict(zip(names, resultants.T, strict=True)),
    )


def write_solid_fields(path: Path, solid: SolidDiscretisation, u: np.ndarray, pressure: np.ndarray) -> None:
    """Write the reference nodes of a solid with displacement [mm] and the pressure (N,) [MPa] on its outer face.

    Cells: triquadratic hexahedra with the number of their ply, from inside to outside.
    """
    mesh = solid.mesh
    places = np.array(PLACES_27)
    order = places if mesh.orientation > 0 else places[:, [1, 0, 2]]  # a hexahedron of positive volume
    data = {"displacement": solid.expand(u), "pressure": pressure}
    write_vtu(path, mesh.x, mesh.elements[:, order @ (9, 3, 1)], data, {"ply": mesh.ply.astype(float)})
