"""Open cylinder pulled apart by two radial point forces: Sze, Liu, Lo (2004), section 3.5.

At half of the load the sides snap inwards, through a maximum and a minimum of the load about one per cent apart: the
curve is traced by arc length.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from formulations.geometry.grid import Grid
from formulations.geometry.surfaces import cylinder
from formulations.section.laminate import Laminate, Ply
from formulations.shell import ShellModel
from studies.request import Request
from studies.scene import SOLVER, Reference, SceneModel, Setting
from studies.scenes.data import read_reference
from studies.scenes.element import ELEMENT, discretise
from studies.scenes.statics import ARC_STEP, LOAD_FRACTIONS, CurveModel, loaded_shell

E, NU, RADIUS, LENGTH, H = 10.5e6, 0.3125, 4.953, 10.35, 0.094  # MPa, -, mm, mm, mm
P_MAX = 40_000.0  # N per force on the whole cylinder; four octants share each


def _references() -> tuple[Reference, ...]:
    table = read_reference("sze2004_3.5_pullout_open_cylinder.csv").to_numpy()[1:]
    source = "Sze, Liu, Lo, Finite Elem. Anal. Des. 40 (2004) 1551, sect. 3.5 (S4R, 24x36)"
    return tuple(
        Reference(quantity, float(value), {"load_fraction": float(row[0])}, "read", source, 5e-3)
        for row in table
        for quantity, value in (("w_A_mm", row[1]), ("u_B_mm", -row[2]), ("u_C_mm", -row[3]))
    )


@dataclass(frozen=True)
class PullOut:
    """An octant: a1 from mid-length to the free end, a2 from the load to the side.

    Radial displacements, outwards: w_A under the load, u_B at mid-length on the side, u_C at the end on the side.
    """

    name: str = "sze-pullout"
    title: str = "Open cylinder pulled out (Sze 3.5)"
    default_mesh: tuple[int, int] = (16, 24)
    settings: tuple[Setting, ...] = (LOAD_FRACTIONS, ARC_STEP, *ELEMENT, SOLVER)
    references: tuple[Reference, ...] = _references()

    def build(self, request: Request) -> SceneModel:
        """A quarter of the force in the octant's corner, half of it on each face."""
        n1, n2 = request.mesh
        end, side = LENGTH / 2, np.pi / 2
        grid = Grid.tensor(np.linspace(0, end, n1 + 1), np.linspace(0, side, n2 + 1))
        fixed = np.zeros((grid.n_nodes, 6), bool)
        fixed[grid.on_line(0, 0.0), 0:2] = True
        for plane in (0.0, side):
            fixed[grid.on_line(1, plane), 2:4] = True
        laminate = Laminate.single(Ply.isotropic(E, NU, H))
        discretisation = discretise(request, cylinder(RADIUS), grid, laminate, fixed)
        points = {"w_A_mm": grid.node_at(0, 0), "u_B_mm": grid.node_at(0, side), "u_C_mm": grid.node_at(end, side)}
        forces = np.zeros((grid.n_nodes, 6))
        forces[points["w_A_mm"], 4:] = 0.5 * P_MAX / 4

        def radial(shell: ShellModel, u: np.ndarray) -> dict[str, float]:
            v = discretisation.expand(u)
            return {name: float(v[node, 4:].mean()) for name, node in points.items()}

        return CurveModel.build(loaded_shell(discretisation, request, forces=forces), request, radial)
