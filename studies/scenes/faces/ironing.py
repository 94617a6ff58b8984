"""Shallow ironing: a die whose lower face is an arc is pressed into a slab and drawn along it, with friction.

Plane strain. The slab is held at its bottom; the top of the die is moved down by ``depth_mm`` and then along the slab.
Both have the law of :class:`formulations.section.laws.NeoHooke`. V and H are what it takes to move the die, downwards
and along, by the forces on the bottom of the slab.

In a steady slide nothing more is stored, and all work of H is friction's, whatever the law of the solids::

    H = mu sum f ds/dX,    H/V = mu (sum f/V) mean(ds/dX)

with the normal forces f and the way ds of the surface of the slab past the die while this moves by dX, about as far.
Normal forces lean to both sides on the arc: their sum is more than V, and H/V more than mu. No slide by Coulomb's law
with H/V far above that is steady.
Sources: Fischer, Wriggers, CMAME 195 (2006) 5020-5036; dimensions after Yastrebov, Numerical Methods in Contact
Mechanics (2013), as in the tutorial ``shallowIroning`` of solids4foam, whose README has the digitised curves of others.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from itertools import pairwise

import numpy as np

from formulations.geometry.surfaces import Plate
from formulations.section.laminate import Laminate, Ply
from formulations.section.laws import LAWS
from formulations.solid.ties import TiedSolid
from formulations.solid_mesh import SolidMesh
from studies.ask.scene import EPSILON, SOLVER, Reference, Request, SceneModel, Setting, Sheet
from studies.scenes.data import Row, references
from studies.scenes.faces.bodies import Bodies, Side
from studies.scenes.faces.model import OTHER, PAIRED, FacesModel, Facing, Meeting
from studies.scenes.faces.solids import PlacedSolid, towards_start
from studies.scenes.solids import OfSolids

WIDTH, E, NU = 1.0, 689.6, 0.32  # mm, MPa, -
LONG, THICK = 12.0, 4.0  # of the slab [mm]
HALF, RADIUS, HIGH = 0.6, 0.75, 0.9  # half of the chord of the die, its arc, its sides [mm]
SAG = RADIUS - math.sqrt(RADIUS**2 - HALF**2)
START = np.array([0.0, 0.2 + HALF, 0.2])  # of the lowest point of the die, from the corner of the slab
NEAR, IN_NEAR = 1.0, 0.5  # depth [mm] in which that share of the layers of the slab lies
LAYERS = 6  # elements along the slab for one through it
LOW = [9 * i + k for k in range(3) for i in range(3)]  # nodes of an element at its low a2, turned inwards as its inner
HIGH_SIDE = [9 * i + 6 + k for i in range(3) for k in range(3)]
DEPTH = Setting.positive("depth_mm", 1.0, "way of the top of the die down, 0.2 of it before it touches", 1.2)
SLIDE = Setting(
    "slide_mm", (1.0, 2.0, 3.0, 4.0, 5.0), "stops of the top of the die along the slab, in turn", "path", 0.0, 10.4
)
STIFFER = Setting("E_ratio", 10.0, "Young's modulus of the die over that of the slab", low=1e-2, high=1e4)
DIE = replace(OTHER, default=100, help="elements along the die, per cent of those of the slab over the same length")


BENCHMARK: Mapping[str, float | str] = {"depth_mm": 1.0, "E_ratio": 10.0, "mu": 0.3}
# V and H per width [N/mm] at the end of the press, and half way through a slide of 10 mm
PUBLISHED = {
    "solids4foam, tutorial shallowIroning": (316.4, 55.0, 395.1, 122.7),
    "Code_Aster SSNP153": (332.0, 71.0, 421.0, 143.3),
    "Hartmann, Oliver, Weyler, Cante, Hernandez, CMAME 198 (2009)": (319.5, 67.2, 408.4, 160.2),
    "Fischer, Wriggers, CMAME 195 (2006)": (297.9, 62.1, 365.1, 188.8),
    "Yastrebov, thesis (2011)": (289.7, 58.5, 359.5, 170.8),
    "Poulios, Renard, Comput. Struct. 153 (2015)": (267.9, 55.3, 337.4, 102.1),
}
OURS = (314.0, 64.7, 403.0, 141.0)  # from 1x60 and 1x120 with order 1 or 2, means over 1 mm
WITHIN = {"V_N_mm": 0.01, "H_N_mm": 0.02, "H_over_V": 0.02}
SPREAD = {"V_N_mm": 0.15, "H_N_mm": 0.35, "H_over_V": 0.35}  # of these values: they disagree far beyond their reading


def _references() -> tuple[Reference, ...]:
    def rows(V1: float, H1: float, V2: float, H2: float) -> list[Row]:
        return [
            ({**BENCHMARK, "way_mm": at}, {"V_N_mm": V, "H_N_mm": H, "H_over_V": H / V})
            for at, V, H in ((1.0, V1, H1), (6.0, V2, H2))
        ]

    found = references("refined", "limit of meshes of this scene", WITHIN, rows(*OURS))
    for source, values in PUBLISHED.items():
        found += references("read", f"{source}, curves digitised by solids4foam", SPREAD, rows(*values))
    return found


class Ironing(OfSolids):
    """a1 across, a2 along the slab."""

    name = "ironing"
    title = "Shallow ironing: a die pressed into a slab and drawn along it"
    default_mesh = (1, 60)
    settings = (DEPTH, SLIDE, STIFFER, DIE, *PAIRED[1:], EPSILON, SOLVER)
    references = _references()
    quantities = {
        "V_N_mm": "force on the die downwards, per width",
        "H_N_mm": "force on the die along the slab, per width",
        "H_over_V": "their ratio, the friction of the whole",
    }
    sheet = Sheet("z", -62.0, 14.0)

    def build(self, request: Request) -> SceneModel:
        """The slab is the first body."""
        slab, die = _slab(request, E), _die(request, E * request.number("E_ratio"))
        way = _Way(request.number("depth_mm"), request.numbers("slide_mm"))

        def placed(at: float) -> Bodies:
            return Bodies((PlacedSolid(slab), PlacedSolid(die, shift=START + way.shift(at))))

        held = slab.solid.discretisation.mesh.on(2, -THICK)

        def measured(at: float, meeting: Meeting) -> dict[str, float]:
            H, V = -reaction(slab, meeting.u[: slab.n_free], held)[1:] / WIDTH
            return {"V_N_mm": -V, "H_N_mm": H, "H_over_V": -H / V if V else 0.0}

        sides = [(Side(k, 1), columns(PlacedSolid(each))) for k, each in enumerate((slab, die))]
        return FacesModel.of(request, placed, [Facing.between(request, *sides)], measured, "way_mm", targets=way.stops)


def reaction(body: TiedSolid, u: np.ndarray, held: np.ndarray) -> np.ndarray:
    """Force (3,) [N] of the supports of nodes (k,) on a body at u (n,)."""
    solid = body.solid.discretisation
    forces = solid.nodal(solid.dofs, solid.internal_force(body.expand(u))).reshape(-1, 3)
    return np.asarray(forces[held].sum(axis=0))


def columns(body: PlacedSolid) -> np.ndarray:
    """Points (m, j) of its face that move alike: those of a line along a1, the lowest first."""
    at = np.round(body.solid.solid.discretisation.mesh.parameter[body.points_of(1)], 9)
    return np.lexsort(at.T).reshape(-1, len(np.unique(at[:, 0])))


class _Way:
    """Way of the top of the die: down, then from stop to stop along the slab; all lengths add up."""

    def __init__(self, depth: float, slides: Sequence[float]) -> None:
        self._depth, self._places = depth, (0.0, *slides)
        legs = [abs(b - a) for a, b in pairwise(self._places)]
        self._ends = depth + np.append(0.0, np.cumsum(legs))

    @property
    def stops(self) -> tuple[float, ...]:
        """The end of the press, and of each leg of the slide [mm]."""
        return tuple(map(float, self._ends))

    def shift(self, at: float) -> np.ndarray:
        """(3,) [mm]."""
        return np.array([0.0, np.interp(at, self._ends, self._places), -min(at, self._depth)])


def _slab(request: Request, young: float) -> TiedSolid:
    n = request.mesh[1]
    depths = towards_start(max(2, n // LAYERS), THICK, NEAR, IN_NEAR)
    laminate = Laminate(tuple(Ply.isotropic(young, NU, h) for h in np.diff(depths)[::-1]), -THICK)
    across = np.linspace(0.0, WIDTH, request.mesh[0] + 1)
    mesh = SolidMesh.build(Plate(), across, np.linspace(0.0, LONG, n + 1), laminate)
    return _in_plane_strain(mesh, laminate, mesh.on(2, -THICK), mesh.outer)


def _die(request: Request, young: float) -> TiedSolid:
    share = request.number("other_elements") / 100 * request.mesh[1] / LONG
    along, up = (max(2, round(share * length)) for length in (2 * HALF, HIGH))
    laminate = Laminate((Ply.isotropic(young, NU, HIGH),), 0.0)
    across = np.linspace(0.0, WIDTH, request.mesh[0] + 1)
    mesh = SolidMesh.build(Plate(), across, np.linspace(-1.0, 1.0, along + 1), laminate, per_ply=up)
    a1, s, t = mesh.parameter[:, 0], mesh.parameter[:, 1], mesh.parameter[:, 2] / HIGH
    angle = s * math.asin(HALF / RADIUS)
    y = (1 - t) * RADIUS * np.sin(angle) + t * HALF * s
    z = (1 - t) * RADIUS * (1 - np.cos(angle)) + t * (SAG + HIGH)
    face = np.concatenate([mesh.inner, *_sides(mesh)])
    mesh = replace(mesh, x=np.stack([a1, y, z], axis=1))
    return _in_plane_strain(mesh, laminate, mesh.on(2, HIGH), face)


def _sides(mesh: SolidMesh) -> list[np.ndarray]:
    """The quadrilaterals (F, 9) of both sides but for the highest, turned as those of the inner face are."""
    found = [mesh.elements[:, nodes] for nodes in (LOW, HIGH_SIDE)]
    a, high = mesh.parameter, mesh.parameter[:, 2].max()
    return [
        quads[np.all(a[quads, 1] == end, axis=1) & (a[quads, 2].max(axis=1) < high)]
        for quads, end in zip(found, (-1.0, 1.0), strict=True)
    ]


def _in_plane_strain(mesh: SolidMesh, laminate: Laminate, held: np.ndarray, face: np.ndarray) -> TiedSolid:
    fixed = mesh.supports((slice(None), 0), (held, slice(None)))
    return TiedSolid.build(mesh, laminate, fixed, face, plane=True, law=LAWS["neo-hooke"])


SCENES = (Ironing(),)
