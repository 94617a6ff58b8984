"""Clamped semi-cylinder pinched at its free end, isotropic and of two cross-plies: Sze, Liu, Lo (2004), section 3.7."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from formulations.geometry.surfaces import cylinder
from formulations.section.laminate import Laminate, Ply
from studies.ask.declarations import BENT, ROTATIONS, Ladder, Sheet, ShellLimit, meshes, thickness_over
from studies.ask.scene import SOLVER, Reference, Request, SceneModel, Setting
from studies.scenes.data import tabulated
from studies.scenes.element import ELEMENT, patch
from studies.scenes.statics import LOAD_FRACTIONS, StaticModel, normal_at, normal_forces

RADIUS, LENGTH, H = 101.6, 304.8, 3.0  # mm
P_MAX = 2000.0  # N on the whole semi-cylinder; a half carries a half
E, NU = 2068.5, 0.3  # MPa
E_L, E_T, G = 2068.5, 517.125, 795.6  # MPa; G_TT is not in the paper: G_LT; nu_LT = nu_TT = NU


FILE = "sze2004_3.7_pinched_semicylinder.csv"
COARSE = "coarse elements lock in the folds, and that error falls faster than the second order that is left in the end"
SOURCE = "Sze, Liu, Lo, Finite Elem. Anal. Des. 40 (2004) 1551, sect. 3.7 (S4R, 40x40)"


@dataclass(frozen=True)
class SemiCylinder:
    """Half of it: a1 from the clamped end to the free one, a2 from the crown to the straight edge.

    The straight edge rests on a plane: it slides along it, and its director stays in it. w_A is the deflection under
    the force, inwards.  layers: "isotropic", or the fibre directions of three equal plies, degrees from the generator.
    column: of the published table.
    """

    name: str
    layers: str
    column: int
    default_mesh: tuple[int, int] = (32, 32)
    settings: tuple[Setting, ...] = (LOAD_FRACTIONS, *ELEMENT, SOLVER)
    quantities = {"w_A_mm": "inwards under the force, on the crown at the free end, a1 = 304.8 mm, a2 = 0"}
    ladders = (Ladder(ROTATIONS, meshes(12, 12, 3), ("w_A_mm",), coarser=("6x6",), causes={"w_A_mm": COARSE}),)

    shell_limit = ShellLimit(BENT, thickness_over(RADIUS, H), same=False)

    @property
    def sheet(self) -> Sheet:
        """The path of 90/0/90 ends on a mesh coarser than its own."""
        return Sheet("x", 40.0, 24.0, mesh="" if self.layers == "90/0/90" else "16x16")

    @property
    def title(self) -> str:
        """One line for people."""
        return f"Pinched semi-cylinder, {self.layers} (Sze 3.7)"

    @cached_property
    def references(self) -> tuple[Reference, ...]:
        """The published curve."""
        return tabulated(FILE, SOURCE, 5e-3, {"w_A_mm": (self.column, 1)})

    def laminate(self) -> Laminate:
        """One isotropic layer or the three plies, about the middle surface."""
        if self.layers == "isotropic":
            return Laminate.single(Ply.isotropic(E, NU, H))
        angles = (np.deg2rad(float(angle)) for angle in self.layers.split("/"))
        return Laminate(tuple(Ply(E_L, E_T, G, G, NU, NU, angle, H / 3) for angle in angles), -0.5 * H)

    def build(self, request: Request) -> SceneModel:
        """Half of the force in the corner of crown and free end, half of it on each face."""
        edges = ("clamped", "free", "symmetric", "symmetric")
        half = patch(request, cylinder(RADIUS), (0, LENGTH), (0, np.pi / 2), self.laminate(), edges)
        A = half.grid.node_at(LENGTH, 0.0)
        forces = normal_forces(half.grid, {A: -P_MAX / 2})
        return StaticModel.of(request, half, normal_at(half, {"w_A_mm": (A, -1)}), forces=forces)


SCENES = (
    SemiCylinder("semicylinder", "isotropic", 1),
    SemiCylinder("semicylinder-0-90-0", "0/90/0", 2),
    SemiCylinder("semicylinder-90-0-90", "90/0/90", 3),
)
