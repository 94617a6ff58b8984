"""Hemisphere with an 18 degree hole under four radial point loads: Sze, Liu, Lo (2004), section 3.4."""

from dataclasses import replace

import numpy as np

from formulations.conditions.boundary import Supports
from formulations.geometry.surfaces import sphere
from formulations.section.laminate import Laminate, Ply
from studies.ask.declarations import (
    BENCHMARKS,
    BENT,
    EDGES,
    ROTATIONS,
    Ladder,
    Sheet,
    ShellLimit,
    meshes,
    thickness_over,
)
from studies.ask.scene import SOLVER, Declared, Request, SceneModel
from studies.scenes.data import tabulated
from studies.scenes.element import ELEMENT, LINES, discretise, even_grid
from studies.scenes.statics import LOAD_FRACTIONS, StaticModel, normal_at, normal_forces

E, NU, RADIUS, H = 6.825e7, 0.3, 10.0, 0.04  # MPa, -, mm, mm
HOLE = np.deg2rad(18.0)
P_MAX = 400.0  # N per point of the whole hemisphere; two quarters share each point


LADDER = Ladder(ROTATIONS, meshes(32, 32, 3), ("inward_mm", "outward_mm"), settings=EDGES, coarser=("16x16",))
FILE = "sze2004_3.4_hemisphere_18deg_hole.csv"
SOURCE = "Sze, Liu, Lo, Finite Elem. Anal. Des. 40 (2004) 1551, sect. 3.4 (S4R)"


class Hemisphere(Declared):
    """A quarter with two symmetry planes; the hole and the equator are free."""

    name = "hemisphere"
    title = "Hemisphere with an 18 degree hole (Sze 3.4)"
    default_mesh = (16, 16)
    settings = (LOAD_FRACTIONS, LINES, *ELEMENT, SOLVER)
    references = tabulated(FILE, SOURCE, 2e-3, {"outward_mm": (1, 1), "inward_mm": (2, 1)})
    quantities = {
        "outward_mm": "outwards under the force that pulls, at a1 = a2 = 0, mean of both faces",
        "inward_mm": "inwards under the force that pushes, at a1 = 0, a2 = 90 degrees, mean of both faces",
    }
    ladders = (  # two families with one limit: components or positions interpolated
        LADDER,
        replace(
            LADDER, name="hemisphere-isoparametric", settings={**LADDER.settings, "interpolation": "isoparametric"}
        ),
        Ladder(BENCHMARKS, meshes(16, 16, 3), ("outward_mm", "inward_mm")),
    )
    sheet = Sheet(azimuth=28.0, elevation=24.0)
    shell_limit = ShellLimit(BENT, thickness_over(RADIUS, H), same=False)

    def build(self, request: Request) -> SceneModel:
        """Outward force at a2 = 0, inward force at a2 = 90 degrees, half on each face."""
        right = np.pi / 2
        closer = (True,) * 4  # towards the free edges, and the loads on the planes of symmetry
        grid = even_grid(request, (0, right - HOLE), (0, right), closer)
        pulled, pushed = grid.node_at(0.0, 0.0), grid.node_at(0.0, right)
        supports = Supports.of_edges(grid, "free", "free", "symmetric", "symmetric")
        supports = supports.hold(pulled, (0,), ("inner",))  # the rigid motion along the axis, and nothing else
        laminate = Laminate.single(Ply.isotropic(E, NU, H))
        quarter = discretise(request, sphere(RADIUS), grid, laminate, *supports.masks)
        under_loads = normal_at(quarter, {"outward_mm": (pulled, 1), "inward_mm": (pushed, -1)})
        forces = normal_forces(grid, {pulled: P_MAX / 2, pushed: -P_MAX / 2})
        return StaticModel.of(request, quarter, under_loads, forces=forces)


SCENES = (Hemisphere(),)
