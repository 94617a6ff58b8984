"""Shells of Sze, Liu, Lo, Finite Elem. Anal. Des. 40 (2004) 1551, that snap; arc length traces their curves."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, ClassVar

import numpy as np

from formulations.geometry.surfaces import cylinder
from formulations.section.laminate import Laminate, Ply
from studies.ask.declarations import (
    BENT,
    CANCEL,
    FULL,
    ROOF,
    ROTATIONS,
    SNAP,
    Ladder,
    Sheet,
    ShellLimit,
    meshes,
    thickness_over,
)
from studies.ask.scene import SOLVER, Declared, Reference, Request, Scene, SceneModel, Setting
from studies.scenes.curves import ARC_STEP, CURVE_FRACTIONS, PATH, UNTIL, CurveModel, element_size, point_rise
from studies.scenes.data import reference_rows, references, tabulated
from studies.scenes.element import ELEMENT, LINES, patch
from studies.scenes.statics import LOAD_FRACTIONS, normal_at, normal_forces

RADIUS, HALF_LENGTH, HALF_ANGLE = 2540.0, 254.0, 0.1  # mm, mm, rad
P_MAX = 3000.0  # N of the whole roof, down; a quarter carries a quarter
E, NU = 3102.75, 0.3  # MPa
E_L, E_T, G, NU_LT = 3300.0, 1100.0, 660.0, 0.25  # MPa; G_TT and nu_TT are not in the paper: G_LT and nu_LT

LIMIT = ("limit_load_fraction", "limit_w_C_even_mm")
SZE = "Sze, Liu, Lo, Finite Elem. Anal. Des. 40 (2004) 1551, sect. 3.8 (S4R), interpolated in its table"
SOLID = (
    "3D St. Venant-Kirchhoff solid, triquadratic hexahedra; limit load extrapolated from 6x6, 8x8 and 12x12 "
    "(isotropic) or 4x4x3, 6x6x3 and 8x8x3 (plies) by their own order, displacement of the finest; at the hinge the "
    "normals stay straight and turn about their middle"
)


def published_limit(table: np.ndarray) -> tuple[float, float]:
    """First limit point (load fraction, displacement) of a curve given by points (n, 2) of both.

    The vertex of the parabola through the first local maximum and the points beside it.
    """
    load, w = table.T
    top = int(np.flatnonzero(np.diff(load) < 0)[0])
    a, b, c = np.polyfit(w[top - 1 : top + 2], load[top - 1 : top + 2], 2)
    vertex = -b / (2 * a)
    return float(np.polyval((a, b, c), vertex)), float(vertex)


@dataclass(frozen=True)
class Roof:
    """Hinged cylindrical roof under a central point load, section 3.8.

    The load passes two or four limit points, and the displacement may turn back.

    A quarter with two symmetry planes; the straight edges are hinged at the middle surface, the curved ones free.

    layers: "isotropic", or the fibre directions of three equal plies from the inside out, degrees from the generator.
    data: the published curve.  solid: load fraction and displacement of the first limit point of a 3D solid.
    uncertainty: relative, of the published limit load (where the table is sparse, of that, too).
    """

    name: str
    title: str
    thickness: float
    layers: str
    data: str
    solid: tuple[float, float]
    uncertainty: float
    default_mesh: tuple[int, int] = (16, 16)
    coarsest: int = 8  # elements each way on its ladder
    cancelling: tuple[str, ...] = ()  # quantities in which errors cancel there
    settings: tuple[Setting, ...] = (CURVE_FRACTIONS, UNTIL, PATH, ARC_STEP, LINES, *ELEMENT, SOLVER)

    quantities: ClassVar[Mapping[str, str]] = {
        "w_C_mm": "downwards under the force, a1 = a2 = 0; grows by the logarithm of the size of the elements",
        "w_C_even_mm": "w_C without what elements of another size than the thickness add to it",
    }

    sheet: ClassVar[Sheet] = Sheet("x", 50.0, 24.0)

    @property
    def shell_limit(self) -> ShellLimit:
        """That of a roof of its thickness."""
        return ShellLimit(ROOF, thickness_over(RADIUS, self.thickness), same=False)

    @property
    def ladders(self) -> tuple[Ladder, ...]:
        """To the first limit point."""
        n = self.coarsest
        return (
            Ladder(
                SNAP,
                meshes(n, n, 3),
                LIMIT,
                settings={"lines": "edges", "until": "limit"},
                coarser=(f"{n // 2}x{n // 2}",),
                causes=dict.fromkeys(self.cancelling, CANCEL),
                whole={"until": "load"},
            ),
        )

    @cached_property
    def references(self) -> tuple[Reference, ...]:
        """The first limit point, of the published curve and of a solid."""
        published = published_limit(np.array([tuple(row.values()) for row in reference_rows(self.data)]))
        return _limit("read", SZE, self.uncertainty, published) + _limit("computed", SOLID, 3e-3, self.solid)

    def laminate(self) -> Laminate:
        """One isotropic layer or the three plies, about the middle surface."""
        if self.layers == "isotropic":
            return Laminate.single(Ply.isotropic(E, NU, self.thickness))
        angles = (np.deg2rad(float(angle)) for angle in self.layers.split("/"))
        plies = (Ply(E_L, E_T, G, G, NU_LT, NU_LT, angle, self.thickness / 3) for angle in angles)
        return Laminate(tuple(plies), -0.5 * self.thickness)

    def build(self, request: Request) -> SceneModel:
        """a1 along the generator from the middle, a2 from the crown to the hinge."""
        edges = ("symmetric", "free", "symmetric", "hinged")
        quarter = patch(request, cylinder(RADIUS), (0, HALF_LENGTH), (0, HALF_ANGLE), self.laminate(), edges)
        centre = quarter.grid.node_at(0.0, 0.0)
        forces = normal_forces(quarter.grid, {centre: -P_MAX / 4})
        under_load = normal_at(quarter, {"w_C_mm": (centre, -1)})
        shear = self.thickness * (E / (2 * (1 + NU)) if self.layers == "isotropic" else G)  # the same in every ply
        rise = {"w_C_mm": point_rise(P_MAX, shear, self.thickness, element_size(quarter, centre))}
        return CurveModel.of(request, quarter, under_load, rise, forces=forces)


def _limit(kind: str, source: str, uncertainty: float, values: tuple[float, float]) -> tuple[Reference, ...]:
    """Load fraction and displacement of a limit point, the second one twice as uncertain.

    That covers the deviation of the published elements, about as large as the wall is thick, from w_C_even_mm (0.1 %).
    """
    within = {"limit_load_fraction": uncertainty} | dict.fromkeys(
        ("limit_w_C_mm", "limit_w_C_even_mm"), 2 * uncertainty
    )
    return references(kind, source, within, [({}, dict(zip(within, (*values, values[1]), strict=True)))])


def _roof(letter: str, h: float, layers: str, solid: tuple[float, float], uncertainty: float, **more: Any) -> Roof:
    """A roof by the letter of its section in the paper."""
    title = f"Hinged roof, {h:g} mm, {layers} (Sze 3.8{letter})"
    data = f"sze2004_3.8{letter}_hinged_roof_h{h:g}_{layers.replace('/', '-')}.csv"
    return Roof(f"roof-{letter}", title, h, layers, data, solid, uncertainty, **more)


def _with_even(published: tuple[Reference, ...], rise: float) -> tuple[Reference, ...]:
    """A table, and w_A as its elements would give it if they were as large as the wall is thick."""
    even = (
        replace(each, quantity="w_A_even_mm", value=each.value - float(each.at["load_fraction"]) * rise)
        for each in published
        if each.quantity == "w_A_mm"
    )
    return (*published, *even)


class PullOut(Declared):
    """Open cylinder pulled apart by two radial point forces: Sze, Liu, Lo (2004), section 3.5.

    At half of the load the sides snap inwards. The load has a maximum and a minimum about one per cent apart, so arc
    length traces the curve.

    An octant: a1 from mid-length to the free end, a2 from the load to the side.

    Radial displacements, outwards: w_A under the load, u_B at mid-length on the side, u_C at the end on the side.
    """

    E, NU, RADIUS, LENGTH, H = 10.5e6, 0.3125, 4.953, 10.35, 0.094  # MPa, -, mm, mm, mm
    SHEAR = H * E / (2 * (1 + NU))  # N/mm
    P_MAX = 40_000.0  # N per force on the whole cylinder; four octants share each
    SOURCE = "Sze, Liu, Lo, Finite Elem. Anal. Des. 40 (2004) 1551, sect. 3.5 (S4R, 24x36)"
    READ = {"w_A_mm": (1, 1), "u_B_mm": (2, -1), "u_C_mm": (3, -1)}  # the table has the inward motions of B and C
    PUBLISHED_SIZE = float(np.sqrt(LENGTH / 2 / 24 * RADIUS * np.pi / 2 / 36))  # mm, of the elements

    name = "sze-pullout"
    title = "Open cylinder pulled out (Sze 3.5)"
    default_mesh = (16, 24)
    settings = (LOAD_FRACTIONS, PATH, ARC_STEP, *ELEMENT, SOLVER)
    references = _with_even(
        tabulated("sze2004_3.5_pullout_open_cylinder.csv", SOURCE, 5e-3, READ),
        point_rise(P_MAX, SHEAR, H, PUBLISHED_SIZE),
    )
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
        """A quarter of the force acts in the corner of the octant, half of it on each face."""
        end, side = self.LENGTH / 2, np.pi / 2
        laminate, edges = (
            Laminate.single(Ply.isotropic(self.E, self.NU, self.H)),
            ("symmetric", "free", "symmetric", "symmetric"),
        )
        octant = patch(request, cylinder(self.RADIUS), (0, end), (0, side), laminate, edges)
        A, B, C = (octant.grid.node_at(*at) for at in ((0, 0), (0, side), (end, side)))
        radial = normal_at(octant, {"w_A_mm": (A, 1), "u_B_mm": (B, 1), "u_C_mm": (C, 1)})
        rise = {"w_A_mm": point_rise(self.P_MAX, self.SHEAR, self.H, element_size(octant, A))}
        return CurveModel.of(request, octant, radial, rise, forces=normal_forces(octant.grid, {A: self.P_MAX / 4}))


SCENES: tuple[Scene, ...] = (
    PullOut(),
    _roof("a", 12.7, "isotropic", (0.7387, 10.85), 0.015, coarsest=16),
    _roof("b", 12.7, "0/90/0", (0.3592, 9.80), 0.015),
    _roof("c", 12.7, "90/0/90", (0.5919, 13.94), 0.015),
    _roof("d", 6.35, "isotropic", (0.1943, 13.21), 0.01),
    _roof("e", 6.35, "0/90/0", (0.0807, 10.88), 0.03),
    _roof("f", 6.35, "90/0/90", (0.1579, 15.82), 0.01, cancelling=("limit_load_fraction",)),
)
