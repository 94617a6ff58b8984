"""Cylinder between diaphragms pinched by two radial point forces: Sze, Liu, Lo (2004), section 3.6.

Between an eighth and a fifth of the load the wall snaps: u_B turns from inwards to outwards on a nearly level piece of
the curve. The load grows all the way on 48x48; coarser meshes have limit points of their own, where the wall folds over
single elements, and loads must be close to one another for the path to be followed.
"""

from dataclasses import replace

import numpy as np

from formulations.geometry.surfaces import cylinder
from formulations.section.laminate import Laminate, Ply
from studies.ask.declarations import BENT, ROTATIONS, Ladder, Sheet, ShellLimit, meshes, thickness_over
from studies.ask.scene import SOLVER, Declared, Request, SceneModel
from studies.scenes.data import tabulated
from studies.scenes.element import ELEMENT, patch
from studies.scenes.statics import LOAD_FRACTIONS, StaticModel, normal_at, normal_forces

E, NU, RADIUS, LENGTH, H = 30e3, 0.3, 100.0, 200.0, 1.0  # MPa, -, mm, mm, mm
P_MAX = 12_000.0  # N per force on the whole cylinder; four octants share each


LOADS = replace(LOAD_FRACTIONS, default=(0.05, 0.1, 0.15, 0.2, 0.25, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 1.0))
FILE = "sze2004_3.6_pinched_cylinder_diaphragms.csv"
SOURCE = "Sze, Liu, Lo, Finite Elem. Anal. Des. 40 (2004) 1551, sect. 3.6 (S4R, 48x48)"


class PinchedBetweenDiaphragms(Declared):
    """An octant: a1 from mid-length to the diaphragm, a2 from the load to the side.

    Radial displacements at mid-length: w_A inwards under the load, u_B outwards on the side.
    """

    name = "sze-pinched"
    title = "Pinched cylinder between diaphragms (Sze 3.6)"
    default_mesh = (48, 48)
    settings = (LOADS, *ELEMENT, SOLVER)
    references = tabulated(FILE, SOURCE, 5e-3, {"w_A_mm": (1, 1), "u_B_mm": (2, 1)})
    quantities = {
        "w_A_mm": "inwards under the force, a1 = a2 = 0",
        "u_B_mm": "outwards at mid-length on the side, a1 = 0, a2 = 90 degrees",
    }
    ladders = (
        Ladder(  # before the snap
            ROTATIONS, meshes(16, 16, 3), ("w_A_mm", "u_B_mm"), settings={"load_fraction": "0.1"}, coarser=("8x8",)
        ),
    )
    sheet = Sheet("x", 35.0, 24.0, mesh="24x24")
    shell_limit = ShellLimit(BENT, thickness_over(RADIUS, H), same=False)

    def build(self, request: Request) -> SceneModel:
        """A quarter of the force in the octant's corner, half of it on each face."""
        end, side = LENGTH / 2, np.pi / 2
        laminate, edges = Laminate.single(Ply.isotropic(E, NU, H)), ("symmetric", "diaphragm", "symmetric", "symmetric")
        octant = patch(request, cylinder(RADIUS), (0, end), (0, side), laminate, edges)
        A, B = octant.grid.node_at(0.0, 0.0), octant.grid.node_at(0.0, side)
        radial = normal_at(octant, {"w_A_mm": (A, -1), "u_B_mm": (B, 1)})
        return StaticModel.of(request, octant, radial, forces=normal_forces(octant.grid, {A: -P_MAX / 4}))


SCENES = (PinchedBetweenDiaphragms(),)
