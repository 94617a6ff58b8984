"""Bodies as layers of hexahedra with what a state says of them, for files of VTK.

Shells are one layer between their faces, solids are as they are. The format is :mod:`studies.output.vtu`.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from formulations.shell import ShellModel
from formulations.strains.quantities import STRAINS
from studies.output.vtu import CORNERS_8, PLACES_27, Data, write_vtu

if TYPE_CHECKING:  # loaded with a solid
    from formulations.solid import SolidDiscretisation
    from formulations.solid_mesh import SolidMesh


def write_fields(path: Path, shell: ShellModel, u: np.ndarray, pressure: np.ndarray, face: int = 1) -> None:
    """Write reference positions of both faces with displacement, contact pressure and resultants.

    Points: the N nodes of the inner face, then the N of the outer one ("face" tells 0 or 1). "displacement" [mm] in
    Cartesian components, "pressure" [MPa] on the ``face`` that touches. Cells: one hexahedron an element with the mean
    resultants H_11-, ..., H_33 [N/mm] in the order of the strains, and stresses S_LL1-, S_TT1-, S_LT1-, S_LL1+, ...
    [MPa] along and across the fibres of ply 1, 2, ... from inside, on its inner (-) and outer (+) side.
    """
    write_layers(path, [shell_layer(shell, u, np.concatenate([pressure * (face == 0), pressure * (face == 1)]))])


@dataclass(frozen=True, eq=False)
class Layer:
    """One body of a file: points (N, 3), cells (e, 8 or 27) of their nodes, what points and what cells carry."""

    points: np.ndarray
    cells: np.ndarray
    of_points: Mapping[str, np.ndarray]
    of_cells: Mapping[str, np.ndarray]

    def placed(self, turn: np.ndarray, shift: np.ndarray) -> Layer:
        """At x = turn X + shift; turn (3, 3), shift (3,)."""
        moved = self.of_points["displacement"] @ turn.T
        return replace(self, points=self.points @ turn.T + shift, of_points={**self.of_points, "displacement": moved})


def write_layers(path: Path, layers: Sequence[Layer]) -> None:
    """Bodies in one file, one after the other, with what all of them have; "body" is the number of one of several."""
    starts = np.cumsum([0, *(len(each.points) for each in layers)])
    cells = [each.cells + start for each, start in zip(layers, starts, strict=False)]
    of_points, of_cells = (_of_all([each.of_points for each in layers]), _of_all([each.of_cells for each in layers]))
    if len(layers) > 1:
        of_cells["body"] = np.repeat(np.arange(float(len(cells))), [len(each) for each in cells])
    write_vtu(path, np.concatenate([each.points for each in layers]), np.concatenate(cells), of_points, of_cells)


def _of_all(data: Sequence[Data]) -> dict[str, np.ndarray]:
    return {name: np.concatenate([own[name] for own in data]) for name in data[0] if all(name in own for own in data)}


def shell_layer(shell: ShellModel, u: np.ndarray, pressure: np.ndarray) -> Layer:
    """What :func:`write_fields` writes; pressure (2N,): of both faces."""
    discretisation = shell.discretisation
    inner, outer = discretisation.positions()
    n = len(inner)
    corners = discretisation.grid.elements
    turned = discretisation.left_handed()[:, None]
    corners = np.where(turned, corners[:, ::-1], corners)  # a hexahedron of positive volume
    resultants, stresses = shell.mean_resultants(u), shell.ply_stresses(u)
    names = ["H_" + strain.lstrip("2").replace("E", "") for strain in STRAINS]
    plies = range(1, stresses.shape[1] + 1)
    names += [f"S_{part}{ply}{side}" for ply in plies for side in "-+" for part in ("LL", "TT", "LT")]
    points = {
        "displacement": np.concatenate(discretisation.cartesian(u, shell.prescribed)),
        "pressure": pressure,
        "face": np.repeat([0.0, 1.0], n),
    }
    cells = dict(zip(names, np.hstack([resultants, stresses.reshape(len(corners), -1)]).T, strict=True))
    return Layer(np.concatenate([inner, outer]), np.hstack([corners, corners + n]), points, cells)


def write_solid_fields(path: Path, solid: SolidDiscretisation, u: np.ndarray, pressure: np.ndarray) -> None:
    """Write the reference nodes of a solid with displacement [mm] and the pressure (N,) [MPa] on its outer face.

    Cells: triquadratic hexahedra with the number of their ply, from inside to outside.
    """
    mesh = solid.mesh
    places = np.array(PLACES_27)
    order = places if mesh.orientation > 0 else places[:, [1, 0, 2]]  # a hexahedron of positive volume
    data = {"displacement": solid.expand(u), "pressure": pressure}
    write_vtu(path, mesh.x, mesh.elements[:, order @ (9, 3, 1)], data, {"ply": mesh.ply.astype(float)})


def solid_layer(mesh: SolidMesh, displacement: np.ndarray, pressure: np.ndarray) -> Layer:
    """A solid beside other bodies: an element as eight hexahedra between its 27 nodes; data (N, 3), (N,)."""
    places = np.array(CORNERS_8)
    order = places if mesh.orientation > 0 else places[:, [1, 0, 2]]
    eighths = [(order + corner) @ (9, 3, 1) for corner in CORNERS_8]
    cells = np.concatenate([mesh.elements[:, each] for each in eighths])
    return Layer(mesh.x, cells, {"displacement": displacement, "pressure": pressure}, {})
