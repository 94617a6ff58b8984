"""Scordelis-Lo roof: a cylindrical roof on two diaphragms under its weight.

References are as transcribed in public codes: none of the printed pages was seen. 0.3024 is the value that MacNeal and
Harder proposed for normalising; 0.30202 is Krysl and Chen's for flat facets; 0.3006 is that of a Kirchhoff-Love
isogeometric code, in which the whole equations are solved to convergence.
"""

from collections.abc import Mapping

import numpy as np

from formulations.geometry.surfaces import cylinder
from formulations.section.laminate import Ply
from formulations.shell import ShellModel
from studies.ask.declarations import LINEAR, ROOF, Ladder, Sheet, ShellLimit, meshes, thickness_over
from studies.ask.scene import Declared, Reference, Request, SceneModel
from studies.scenes.element import centred_laminate, patch
from studies.scenes.statics import LOAD_FRACTION, SHELL_SETTINGS, StaticModel, area_load

E, RADIUS, LENGTH, H = 4.32e8, 25.0, 50.0, 0.25  # MPa, mm, mm, mm; nu = 0
HALF_ANGLE = np.deg2rad(40.0)
WEIGHT = 90.0  # MPa, force per area of the middle surface, straight down, dead

AT: Mapping[str, float | str] = {"load_fraction": 1.0, "measure": "linear"}
REFERENCES = (
    Reference("edge_deflection_mm", 0.3024, AT, "read", "MacNeal, Harder (1985), in FinEtoolsFlexStructures", 0.01),
    Reference("edge_deflection_mm", 0.30202, AT, "read", "Krysl, Chen, in FinEtoolsFlexStructures", 0.005),
    Reference("edge_deflection_mm", 0.3006, AT, "read", "PENGoLINS, isogeometric Kirchhoff-Love", 0.002),
)


class ScordelisLo(Declared):
    """A quarter: a1 from a diaphragm to the middle, a2 from the crown (the Cartesian x axis points up) to the edge."""

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
        """The diaphragm holds the motion in its plane, half of the weight is on each face."""
        laminate = centred_laminate(request, Ply.isotropic(E, 0.0, H))
        edges = ("hard-diaphragm", "symmetric", "symmetric", "free")
        quarter = patch(request, cylinder(RADIUS), (0, LENGTH / 2), (0, HALF_ANGLE), laminate, edges)
        down, edge = np.array([-1.0, 0.0, 0.0]), quarter.grid.node_at(LENGTH / 2, HALF_ANGLE)

        def at_edge(shell: ShellModel, u: np.ndarray) -> dict[str, float]:
            both_faces = np.mean([face[edge] for face in quarter.cartesian(u)], axis=0)
            return {"edge_deflection_mm": float(down @ both_faces)}

        return StaticModel.of(request, quarter, at_edge, forces=area_load(quarter, lambda a1, a2: WEIGHT * down))


SCENES = (ScordelisLo(),)
