"""Hyperelastic cylinder pinched by two opposite line loads: large strains, bent until its inner faces nearly meet.

Radius 90, length 300, thickness 20 or 2 mm, mu = 6e4 and lam = 2.4e5 MPa, both ends free: the problem of Büchter, Ramm
and Roehl (1994) and of Reese, Wriggers and Reddy (2000), who hold the line opposite to the load (recalled; the data are
those of public programs). Here both lines carry the same load, half of it on each face, and planes of symmetry keep the
cylinder. At the unit of the load the thick one is 146 mm lower; it goes with the cube of the thickness, as bending
does. At 160 mm the inner faces of the thick one meet; the thin one is that low at 35 kN, as in print (recalled).

Under a line load a solid has no limit: it sinks in by the logarithm of the size of its elements. The middle of the wall
does not, and is what is read. In the limit of the meshes three surfaces leave the thick wall within 3 % of the solid,
five within 0.3 %. Elements much longer than wide have modes of their own on the face that is compressed: the default
mesh is of squares.
"""

import numpy as np

from formulations.geometry.surfaces import cylinder
from formulations.section.laminate import Laminate, Ply
from formulations.shell import ShellModel
from studies.ask.scene import SOLVER, Declared, Reference, Request, SceneModel, Setting
from studies.scenes.data import Row, references
from studies.scenes.element import of_wall, patch
from studies.scenes.statics import LOAD_FRACTIONS, StaticModel, edge_forces

MU, LAM, RADIUS, LENGTH, THICK = 6e4, 2.4e5, 90.0, 300.0, 20.0  # MPa, MPa, mm, mm, mm
E, NU = MU * (3 * LAM + 2 * MU) / (LAM + MU), LAM / (2 * (LAM + MU))
UNIT = 30e6  # N a line, on the thick cylinder
SOLID = {0.25: (26.322, 10.131), 0.5: (61.122, 20.111), 0.75: (101.76, 27.616), 1.0: (146.14, 31.478)}
OF_SOLID = "3D solid, 27-node hexahedra 8x16x4 with the same law; 6x18x3 is within 1e-3"


def _references() -> tuple[Reference, ...]:
    rows: list[Row] = [
        ({"h_mm": THICK, "law": "neo-hooke", "load_fraction": load}, {"approach_mm": approach, "bulge_mm": bulge})
        for load, (approach, bulge) in SOLID.items()
    ]
    return references("computed", OF_SOLID, 2e-3, rows)


class PinchedRubber(Declared):
    """An eighth: a1 from mid-length to the free end, a2 from the load to the side."""

    name = "pinched-rubber"
    title = "Rubber cylinder pinched by two line loads"
    default_mesh = (16, 16)
    settings = (
        LOAD_FRACTIONS,
        Setting("h_mm", THICK, "thickness; the load goes with its cube", low=0.5, high=60),
        *of_wall("5", "neo-hooke"),
        SOLVER,
    )
    references = _references()
    quantities = {
        "approach_mm": "of the loaded lines at mid-length, in the middle of the wall",
        "bulge_mm": "outwards at mid-length on the side, in the middle of the wall",
    }

    def build(self, request: Request) -> SceneModel:
        """A quarter of the force on the line in the plane of symmetry, half of it on each face."""
        h, side = request.number("h_mm"), np.pi / 2
        laminate = Laminate.single(Ply.isotropic(E, NU, h))
        edges = ("symmetric", "free", "symmetric", "symmetric")
        eighth = patch(request, cylinder(RADIUS), (0, LENGTH / 2), (0, side), laminate, edges)
        under, beside = (eighth.grid.node_at(0.0, at) for at in (0.0, side))

        def read(shell: ShellModel, u: np.ndarray) -> dict[str, float]:
            v = shell.discretisation.at_distance(u, 0.0)[:, 2]
            return {"approach_mm": float(-2 * v[under]), "bulge_mm": float(v[beside])}

        force = -UNIT * (h / THICK) ** 3 / 4
        return StaticModel.of(request, eighth, read, forces=edge_forces(eighth, 1, 0.0, force))


SCENES = (PinchedRubber(),)
