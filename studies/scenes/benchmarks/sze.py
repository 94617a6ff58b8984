"""Thin shells of Sze, Liu, Lo, Finite Elem. Anal. Des. 40 (2004) 1551, whose loads increase monotonically."""

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from formulations.geometry.surfaces import annulus, cylinder
from formulations.loads import Couples
from formulations.section.laminate import Laminate, Ply
from studies.ask.declarations import BEAM, BENT, EDGES, ROTATIONS, Ladder, Sheet, ShellLimit, meshes, thickness_over
from studies.ask.scene import SOLVER, Declared, Reference, Request, SceneModel, Setting
from studies.scenes.benchmarks.cantilever import TIP, B, E, H, clamped_strip, tip_motion, tip_row
from studies.scenes.data import reference_rows, references, tabulated
from studies.scenes.element import ELEMENT, LINES, patch
from studies.scenes.statics import LOAD_FRACTIONS, StaticModel, edge_forces, edge_shares, normal_at, normal_forces

L = 12.0  # mm, of the strip that is rolled up
EI = E * B * H**3 / 12
M_MAX = 2 * np.pi * EI / L  # N mm over the edge: a full circle


def circular_arc(fraction: float) -> tuple[float, float]:
    """Shortening and deflection of the tip of an inextensible strip: it bends into an arc of curvature M/EI.

    -u = L - (EI/M) sin(M L/EI), w = (EI/M) (1 - cos(M L/EI)).
    """
    curvature = fraction * M_MAX / EI
    return float(L - np.sin(curvature * L) / curvature), float((1 - np.cos(curvature * L)) / curvature)


def _references() -> tuple[Reference, ...]:
    table = [tuple(row.values()) for row in reference_rows("sze2004_3.2_cantilever_end_moment.csv")[1:]]
    sze = "Sze, Liu, Lo, Finite Elem. Anal. Des. 40 (2004) 1551, sect. 3.2 (S4R, 16x1)"
    # a strip of Green-Lagrange strain and finite thickness shortens by the order of (h kappa)^2
    arcs = [tip_row(row[0], *circular_arc(row[0])) for row in table]
    return references("exact", "inextensible circular arc", 1e-3, arcs) + references(
        "read", sze, 2e-3, [tip_row(row[0], row[1], row[3]) for row in table]
    )


class SlitAnnulus(Declared):
    """Slit annular plate lifted along one side of the slit, section 3.3.

    The whole annulus: a2 = 0 is loaded, a2 = 360 degrees clamped; A is the inner and B the outer corner of the load.
    """

    E, INNER, OUTER, H = 21e6, 6.0, 10.0, 0.03  # MPa, mm, mm, mm; nu = 0
    P_MAX = 0.8  # N/mm along the free side of the slit, across the plate, dead
    SOURCE = "Sze, Liu, Lo, Finite Elem. Anal. Des. 40 (2004) 1551, sect. 3.3 (S4R, 10x80)"

    name = "sze-annulus"
    title = "Slit annular plate lifted at the slit (Sze 3.3)"
    default_mesh = (10, 80)
    settings = (LOAD_FRACTIONS, LINES, *ELEMENT, SOLVER)
    references = tabulated("sze2004_3.3_slit_annular_plate.csv", SOURCE, 5e-3, {"w_A_mm": (1, 1), "w_B_mm": (2, 1)})
    quantities = {
        "w_A_mm": "across the plate at the inner corner of the loaded side, a1 = 6 mm, a2 = 0",
        "w_B_mm": "across the plate at the outer corner of the loaded side, a1 = 10 mm, a2 = 0",
    }
    ladders = (Ladder(ROTATIONS, meshes(10, 80, 3), ("w_B_mm", "w_A_mm"), settings=EDGES, coarser=("5x40",)),)
    shell_limit = ShellLimit(BEAM, thickness_over(OUTER - INNER, H), same=False)

    def build(self, request: Request) -> SceneModel:
        """Half of the line force acts on each face, along e3."""
        laminate, edges = Laminate.single(Ply.isotropic(self.E, 0.0, self.H)), ("free", "free", "free", "clamped")
        plate = patch(request, annulus(), (self.INNER, self.OUTER), (0, 2 * np.pi), laminate, edges)
        corners = {
            "w_A_mm": (plate.grid.node_at(self.INNER, 0.0), 1),
            "w_B_mm": (plate.grid.node_at(self.OUTER, 0.0), 1),
        }
        forces = edge_forces(plate, 1, 0.0, self.P_MAX * (self.OUTER - self.INNER))
        return StaticModel.of(request, plate, normal_at(plate, corners), forces=forces)


class RolledCantilever(Declared):
    """Cantilever rolled up by an end couple that follows its section, section 3.2.

    A strip clamped at a1 = 0; the couple at a1 = L keeps its moment and turns with the director.
    """

    name = "sze-moment"
    title = "Cantilever rolled into a circle by an end couple (Sze 3.2)"
    default_mesh = (64, 1)
    settings = (LOAD_FRACTIONS, *ELEMENT, SOLVER)
    references = _references()
    quantities = TIP
    ladders = (
        Ladder(
            ROTATIONS, meshes(32, 1), tuple(TIP), settings={"load_fraction": "0.5"}, whole={"load_fraction": "0.5,1"}
        ),
    )
    shell_limit = ShellLimit(BEAM, thickness_over(L, H), same=False)

    def build(self, request: Request) -> SceneModel:
        """The couple about -e2 lifts the tip."""
        strip = clamped_strip(request, L, B, Ply.isotropic(E, 0.0, H))
        tip = strip.grid.on_line(0, L)
        loaded, shares = edge_shares(strip, 0, L)
        couples = Couples(loaded, M_MAX * shares, np.tile([0.0, -1.0, 0.0], (len(loaded), 1)), H)
        return StaticModel.of(request, strip, tip_motion(strip, tip), couples=couples)


class PinchedBetweenDiaphragms(Declared):
    """Cylinder between diaphragms pinched by two radial point forces, section 3.6.

    Between an eighth and a fifth of the load the wall snaps: u_B turns from inwards to outwards on a nearly level part
    of the curve. On 48x48 the load increases monotonically. Coarser meshes have additional limit points, where the wall
    folds over single elements, and need close load steps to follow the path.

    An octant: a1 from mid-length to the diaphragm, a2 from the load to the side.

    Radial displacements at mid-length: w_A inwards under the load, u_B outwards on the side.
    """

    E, NU, RADIUS, LENGTH, H = 30e3, 0.3, 100.0, 200.0, 1.0  # MPa, -, mm, mm, mm
    P_MAX = 12_000.0  # N per force on the whole cylinder; four octants share each
    LOADS = replace(LOAD_FRACTIONS, default=(0.05, 0.1, 0.15, 0.2, 0.25, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 1.0))
    SOURCE = "Sze, Liu, Lo, Finite Elem. Anal. Des. 40 (2004) 1551, sect. 3.6 (S4R, 48x48)"

    name = "sze-pinched"
    title = "Pinched cylinder between diaphragms (Sze 3.6)"
    default_mesh = (48, 48)
    settings = (LOADS, *ELEMENT, SOLVER)
    references = tabulated(
        "sze2004_3.6_pinched_cylinder_diaphragms.csv", SOURCE, 5e-3, {"w_A_mm": (1, 1), "u_B_mm": (2, 1)}
    )
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
        """A quarter of the force acts in the corner of the octant, half of it on each face."""
        end, side = self.LENGTH / 2, np.pi / 2
        laminate, edges = (
            Laminate.single(Ply.isotropic(self.E, self.NU, self.H)),
            ("symmetric", "diaphragm", "symmetric", "symmetric"),
        )
        octant = patch(request, cylinder(self.RADIUS), (0, end), (0, side), laminate, edges)
        A, B = octant.grid.node_at(0.0, 0.0), octant.grid.node_at(0.0, side)
        radial = normal_at(octant, {"w_A_mm": (A, -1), "u_B_mm": (B, 1)})
        return StaticModel.of(request, octant, radial, forces=normal_forces(octant.grid, {A: -self.P_MAX / 4}))


@dataclass(frozen=True)
class SemiCylinder:
    """Clamped semi-cylinder pinched at its free end, isotropic and of two cross-plies, section 3.7.

    Half of it: a1 from the clamped end to the free one, a2 from the crown to the straight edge.

    The straight edge slides on a plane, and its director stays in this plane. w_A is the inward deflection under the
    force.

    layers: "isotropic", or the fibre directions of three equal plies, degrees from the generator.
    column: of the published table.
    """

    RADIUS, LENGTH, H = 101.6, 304.8, 3.0  # mm
    P_MAX = 2000.0  # N on the whole semi-cylinder; a half carries a half
    E, NU = 2068.5, 0.3  # MPa
    E_L, E_T, G = 2068.5, 517.125, 795.6  # MPa; G_TT is not in the paper: G_LT; nu_LT = nu_TT = NU
    COARSE = "coarse elements lock in the folds; that error falls faster than the second order that is left in the end"
    SOURCE = "Sze, Liu, Lo, Finite Elem. Anal. Des. 40 (2004) 1551, sect. 3.7 (S4R, 40x40)"

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
        return tabulated("sze2004_3.7_pinched_semicylinder.csv", self.SOURCE, 5e-3, {"w_A_mm": (self.column, 1)})

    def laminate(self) -> Laminate:
        """One isotropic layer or the three plies, about the middle surface."""
        if self.layers == "isotropic":
            return Laminate.single(Ply.isotropic(self.E, self.NU, self.H))
        angles = (np.deg2rad(float(angle)) for angle in self.layers.split("/"))
        return Laminate(
            tuple(Ply(self.E_L, self.E_T, self.G, self.G, self.NU, self.NU, angle, self.H / 3) for angle in angles),
            -0.5 * self.H,
        )

    def build(self, request: Request) -> SceneModel:
        """Half of the force acts in the corner of the crown and the free end, half of it on each face."""
        edges = ("clamped", "free", "symmetric", "symmetric")
        half = patch(request, cylinder(self.RADIUS), (0, self.LENGTH), (0, np.pi / 2), self.laminate(), edges)
        A = half.grid.node_at(self.LENGTH, 0.0)
        forces = normal_forces(half.grid, {A: -self.P_MAX / 2})
        return StaticModel.of(request, half, normal_at(half, {"w_A_mm": (A, -1)}), forces=forces)


SCENES = (
    SlitAnnulus(),
    RolledCantilever(),
    PinchedBetweenDiaphragms(),
    SemiCylinder("semicylinder", "isotropic", 1),
    SemiCylinder("semicylinder-0-90-0", "0/90/0", 2),
    SemiCylinder("semicylinder-90-0-90", "90/0/90", 3),
)
