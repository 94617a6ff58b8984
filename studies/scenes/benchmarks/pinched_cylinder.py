"""Pinched cylinder with end diaphragms: the classic linear test of bending without extension under point loads.

The reference is a thin-shell (Kirchhoff) value, 164.24 P/(E t). A shell with transverse shear has no limit to compare
with it: a point load sinks in by P/(2 pi G t) for every e-fold of mesh refinement (the shear force around it is
P/(2 pi r)), which is 0.25 % of the reference. With ``shear_correction`` 1000 the shell is one of Kirchhoff and has one.
"""

from collections.abc import Mapping

import numpy as np

from formulations.geometry.surfaces import cylinder
from formulations.section.laminate import Ply
from studies.ask.declarations import BENT, LINEAR, Ladder, Sheet, ShellLimit, meshes, thickness_over
from studies.ask.scene import Declared, Reference, Request, SceneModel
from studies.scenes.element import centred_laminate, patch
from studies.scenes.statics import LOAD_FRACTION, SHELL_SETTINGS, StaticModel, normal_at, normal_forces

E, NU, RADIUS, LENGTH, H = 3e6, 0.3, 300.0, 600.0, 3.0  # MPa, -, mm, mm, mm
P = 1.0  # N, each of the two opposite forces; an eighth of the cylinder carries a quarter of one

AT: Mapping[str, float | str] = {"load_fraction": 1.0, "measure": "linear"}
SOURCE = "Lindberg, Olson, Cowper (1969), in FinEtoolsFlexStructures; 164.24 P/(E t) in opensees-gallery"


class PinchedCylinder(Declared):
    """An eighth: a1 from the loaded section to the diaphragm, a2 from the force over 90 degrees."""

    name = "pinched-cylinder"
    title = "Pinched cylinder with end diaphragms"
    default_mesh = (32, 32)
    settings = (LOAD_FRACTION, *SHELL_SETTINGS)
    references = (Reference("deflection_mm", 1.82488e-5, AT, "read", SOURCE, 0.005),)
    quantities = {"deflection_mm": "inwards under the force, a1 = a2 = 0"}
    ladders = (Ladder(LINEAR, meshes(8, 8), ("deflection_mm",), "linear", {"shear_correction": "1000"}),)
    sheet = Sheet("x", 35.0, 24.0)
    shell_limit = ShellLimit(BENT, thickness_over(RADIUS, H), same=False)

    def build(self, request: Request) -> SceneModel:
        """Three symmetry planes and a diaphragm; half of the force on each face."""
        laminate = centred_laminate(request, Ply.isotropic(E, NU, H))
        edges = ("symmetric", "hard-diaphragm", "symmetric", "symmetric")
        eighth = patch(request, cylinder(RADIUS), (0, LENGTH / 2), (0, np.pi / 2), laminate, edges)
        loaded = eighth.grid.node_at(0.0, 0.0)
        under_load = normal_at(eighth, {"deflection_mm": (loaded, -1)})
        return StaticModel.of(request, eighth, under_load, forces=normal_forces(eighth.grid, {loaded: -P / 4}))


SCENES = (PinchedCylinder(),)
