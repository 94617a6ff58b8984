"""Slit annular plate lifted along one side of the slit: Sze, Liu, Lo (2004), section 3.3."""

import numpy as np

from formulations.geometry.surfaces import annulus
from formulations.section.laminate import Laminate, Ply
from studies.ask.declarations import BEAM, EDGES, ROTATIONS, Ladder, ShellLimit, meshes, thickness_over
from studies.ask.scene import SOLVER, Declared, Request, SceneModel
from studies.scenes.data import tabulated
from studies.scenes.element import ELEMENT, LINES, patch
from studies.scenes.statics import LOAD_FRACTIONS, StaticModel, edge_forces, normal_at

E, INNER, OUTER, H = 21e6, 6.0, 10.0, 0.03  # MPa, mm, mm, mm; nu = 0
P_MAX = 0.8  # N/mm along the free side of the slit, across the plate, dead


FILE = "sze2004_3.3_slit_annular_plate.csv"
SOURCE = "Sze, Liu, Lo, Finite Elem. Anal. Des. 40 (2004) 1551, sect. 3.3 (S4R, 10x80)"


class SlitAnnulus(Declared):
    """The whole turn: a2 = 0 is loaded, a2 = 360 degrees clamped; A is the inner, B the outer corner of the load."""

    name = "sze-annulus"
    title = "Slit annular plate lifted at the slit (Sze 3.3)"
    default_mesh = (10, 80)
    settings = (LOAD_FRACTIONS, LINES, *ELEMENT, SOLVER)
    references = tabulated(FILE, SOURCE, 5e-3, {"w_A_mm": (1, 1), "w_B_mm": (2, 1)})
    quantities = {
        "w_A_mm": "across the plate at the inner corner of the loaded side, a1 = 6 mm, a2 = 0",
        "w_B_mm": "across the plate at the outer corner of the loaded side, a1 = 10 mm, a2 = 0",
    }
    ladders = (Ladder(ROTATIONS, meshes(10, 80, 3), ("w_B_mm", "w_A_mm"), settings=EDGES, coarser=("5x40",)),)
    shell_limit = ShellLimit(BEAM, thickness_over(OUTER - INNER, H), same=False)

    def build(self, request: Request) -> SceneModel:
        """Half of the line force on each face, along e3."""
        laminate, edges = Laminate.single(Ply.isotropic(E, 0.0, H)), ("free", "free", "free", "clamped")
        plate = patch(request, annulus(), (INNER, OUTER), (0, 2 * np.pi), laminate, edges)
        corners = {"w_A_mm": (plate.grid.node_at(INNER, 0.0), 1), "w_B_mm": (plate.grid.node_at(OUTER, 0.0), 1)}
        forces = edge_forces(plate, 1, 0.0, P_MAX * (OUTER - INNER))
        return StaticModel.of(request, plate, normal_at(plate, corners), forces=forces)


SCENES = (SlitAnnulus(),)
