"""Open cylinder pulled apart by two radial point forces: Sze, Liu, Lo (2004), section 3.5.

At half of the load the sides snap inwards, through a maximum and a minimum of the load about one per cent apart: the
curve is traced by arc length.
"""

from dataclasses import replace

import numpy as np

from formulations.geometry.surfaces import cylinder
from formulations.section.laminate import Laminate, Ply
from studies.ask.declarations import BENT, CANCEL, FULL, ROTATIONS, Ladder, Sheet, ShellLimit, meshes, thickness_over
from studies.ask.scene import SOLVER, Declared, Reference, Request, SceneModel
from studies.scenes.curves import ARC_STEP, PATH, CurveModel, element_size, point_rise
from studies.scenes.data import tabulated
from studies.scenes.element import ELEMENT, patch
from studies.scenes.statics import LOAD_FRACTIONS, normal_at, normal_forces

E, NU, RADIUS, LENGTH, H = 10.5e6, 0.3125, 4.953, 10.35, 0.094  # MPa, -, mm, mm, mm
SHEAR = H * E / (2 * (1 + NU))  # N/mm
P_MAX = 40_000.0  # N per force on the whole cylinder; four octants share each


FILE = "sze2004_3.5_pullout_open_cylinder.csv"
SOURCE = "Sze, Liu, Lo, Finite Elem. Anal. Des. 40 (2004) 1551, sect. 3.5 (S4R, 24x36)"
READ = {"w_A_mm": (1, 1), "u_B_mm": (2, -1), "u_C_mm": (3, -1)}  # the table has the inward motions of B and C
PUBLISHED_SIZE = float(np.sqrt(LENGTH / 2 / 24 * RADIUS * np.pi / 2 / 36))  # mm, of the elements


def _references() -> tuple[Reference, ...]:
    """The table, and w_A as its elements would give it if they were as large as the wall is thick."""
    published, rise = tabulated(FILE, SOURCE, 5e-3, READ), point_rise(P_MAX, SHEAR, H, PUBLISHED_SIZE)
    even = (
        replace(each, quantity="w_A_even_mm", value=each.value - float(each.at["load_fraction"]) * rise)
        for each in published
        if each.quantity == "w_A_mm"
    )
    return (*published, *even)


class PullOut(Declared):
    """An octant: a1 from mid-length to the free end, a2 from the load to the side.

    Radial displacements, outwards: w_A under the load, u_B at mid-length on the side, u_C at the end on the side.
    """

    name = "sze-pullout"
    title = "Open cylinder pulled out (Sze 3.5)"
    default_mesh = (16, 24)
    settings = (LOAD_FRACTIONS, PATH, ARC_STEP, *ELEMENT, SOLVER)
    references = _references()
    quantities = {
        "w_A_mm": "outwards under the force, a1 = a2 = 0; grows by the logarithm of the size of the elements",
        "w_A_even_mm": "w_A without what elements of another size than the thickness add to it",
        "u_B_mm": "outwards at mid-length on the side, a1 = 0, a2 = 90 degrees",
        "u_C_mm": "outwards at the free end on the side, a1 = 5.175 mm, a2 = 90 degrees",
    }
    ladders = (
        Ladder(  # even lines: with closer ones at the load the path is lost at its snap
            ROTATIONS,
            meshes(12, 18, 3),
            ("w_A_even_mm", "u_B_mm", "u_C_mm"),
            settings=FULL,
            coarser=("6x9",),
            causes={"u_C_mm": CANCEL},
        ),
    )
    sheet = Sheet("x", 35.0, 24.0)
    shell_limit = ShellLimit(BENT, thickness_over(RADIUS, H), same=False)

    def build(self, request: Request) -> SceneModel:
        """A quarter of the force in the octant's corner, half of it on each face."""
        end, side = LENGTH / 2, np.pi / 2
        laminate, edges = Laminate.single(Ply.isotropic(E, NU, H)), ("symmetric", "free", "symmetric", "symmetric")
        octant = patch(request, cylinder(RADIUS), (0, end), (0, side), laminate, edges)
        A, B, C = (octant.grid.node_at(*at) for at in ((0, 0), (0, side), (end, side)))
        radial = normal_at(octant, {"w_A_mm": (A, 1), "u_B_mm": (B, 1), "u_C_mm": (C, 1)})
        rise = {"w_A_mm": point_rise(P_MAX, SHEAR, H, element_size(octant, A))}
        return CurveModel.of(request, octant, radial, rise, forces=normal_forces(octant.grid, {A: P_MAX / 4}))


SCENES = (PullOut(),)
