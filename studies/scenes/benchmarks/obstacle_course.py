"""Two linear benchmarks of the shell obstacle course: the pinched cylinder and the Scordelis-Lo roof."""

from collections.abc import Mapping

import numpy as np

from formulations.geometry.surfaces import cylinder
from formulations.section.laminate import Ply
from formulations.shell import ShellModel
from studies.ask.declarations import BENT, LINEAR, ROOF, Ladder, Sheet, ShellLimit, meshes, thickness_over
from studies.ask.scene import Declared, Reference, Request, SceneModel
from studies.scenes.element import centred_laminate, patch
from studies.scenes.statics import LOAD_FRACTION, SHELL_SETTINGS, StaticModel, area_load, normal_at, normal_forces

AT: Mapping[str, float | str] = {"load_fraction": 1.0, "measure": "linear"}


class PinchedCylinder(Declared):
    """Pinched cylinder with end diaphragms: the classic linear test of inextensional bending under point loads.

    The reference is a thin-shell (Kirchhoff) value, 164.24 P/(E t). A shell with transverse shear has no limit: the
    deflection under a point load grows by P/(2 pi G t) for every e-fold of mesh refinement (the shear force around it
    is P/(2 pi r)), which is 0.25 % of the reference. With ``shear_correction`` 1000 the shell is a Kirchhoff shell and
    has a limit.

    An eighth: a1 from the loaded section to the diaphragm, a2 from the force over 90 degrees.
    """

    E, NU, RADIUS, LENGTH, H = 3e6, 0.3, 300.0, 600.0, 3.0  # MPa, -, mm, mm, mm
    P = 1.0  # N, each of the two opposite forces; an eighth of the cylinder carries a quarter of one
    SOURCE = "Lindberg, Olson, Cowper (1969), in FinEtoolsFlexStructures; 164.24 P/(E t) in opensees-gallery"

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
        """Three symmetry planes and a diaphragm; half of the force acts on each face."""
        laminate = centred_laminate(request, Ply.isotropic(self.E, self.NU, self.H))
        edges = ("symmetric", "hard-diaphragm", "symmetric", "symmetric")
        eighth = patch(request, cylinder(self.RADIUS), (0, self.LENGTH / 2), (0, np.pi / 2), laminate, edges)
        loaded = eighth.grid.node_at(0.0, 0.0)
        under_load = normal_at(eighth, {"deflection_mm": (loaded, -1)})
        return StaticModel.of(request, eighth, under_load, forces=normal_forces(eighth.grid, {loaded: -self.P / 4}))


REFERENCES = (
    Reference("edge_deflection_mm", 0.3024, AT, "read", "MacNeal, Harder (1985), in FinEtoolsFlexStructures", 0.01),
    Reference("edge_deflection_mm", 0.30202, AT, "read", "Krysl, Chen, in FinEtoolsFlexStructures", 0.005),
    Reference("edge_deflection_mm", 0.3006, AT, "read", "PENGoLINS, isogeometric Kirchhoff-Love", 0.002),
)


class ScordelisLo(Declared):
    """Scordelis-Lo roof: a cylindrical roof on two diaphragms under its weight.

    References are as transcribed in public codes; the printed pages were not seen. MacNeal and Harder proposed 0.3024
    for normalising; 0.30202 is Krysl and Chen's for flat facets; 0.3006 is that of a Kirchhoff-Love isogeometric code,
    which solves the complete equations to convergence.

    A quarter: a1 from a diaphragm to the middle, a2 from the crown (the Cartesian x axis points up) to the edge.
    """

    E, RADIUS, LENGTH, H = 4.32e8, 25.0, 50.0, 0.25  # MPa, mm, mm, mm; nu = 0
    HALF_ANGLE = np.deg2rad(40.0)
    WEIGHT = 90.0  # MPa, force per area of the middle surface, straight down, dead

    name = "scordelis-lo"
    title = "Scordelis-Lo roof under its weight"
    default_mesh = (16, 16)
    settings = (LOAD_FRACTION, *SHELL_SETTINGS)
    references = REFERENCES
    quantities = {"edge_deflection_mm": "downwards in the middle of the free edge, a1 = 25 mm, a2 = 40 degrees"}
    ladders = (Ladder(LINEAR, meshes(8, 8), ("edge_deflection_mm",), "linear"),)
    sheet = Sheet("x", 40.0, 28.0)
    shell_limit = ShellLimit(ROOF, thickness_over(RADIUS, H))

    def build(self, request: Request) -> SceneModel:
        """The diaphragm holds the displacements in its plane; half of the weight acts on each face."""
        laminate = centred_laminate(request, Ply.isotropic(self.E, 0.0, self.H))
        edges = ("hard-diaphragm", "symmetric", "symmetric", "free")
        quarter = patch(request, cylinder(self.RADIUS), (0, self.LENGTH / 2), (0, self.HALF_ANGLE), laminate, edges)
        down, edge = np.array([-1.0, 0.0, 0.0]), quarter.grid.node_at(self.LENGTH / 2, self.HALF_ANGLE)

        def at_edge(shell: ShellModel, u: np.ndarray) -> dict[str, float]:
            both_faces = np.mean([face[edge] for face in quarter.cartesian(u)], axis=0)
            return {"edge_deflection_mm": float(down @ both_faces)}

        return StaticModel.of(request, quarter, at_edge, forces=area_load(quarter, lambda a1, a2: self.WEIGHT * down))


SCENES = (
    ScordelisLo(),
    PinchedCylinder(),
)
