"""Shallow ironing: a die whose lower face is an arc is pressed into a slab and drawn along it, with friction.

Plane strain. The slab is held at its bottom; the top of the die moves down by ``depth_mm`` and then along the slab.
Both have the law of :class:`formulations.section.laws.NeoHooke`. The slab is a solid of quadratic elements, or a shell:
bilinear along the slab, cubic displacements through each of its layers, assumed strains as in all shells here. V and H
are the downward and the longitudinal force on the top of the die.

In a steady slide no more energy is stored, and friction takes all work of H, whatever the law of the solids::

    H = mu sum f ds/dX,    H/V = mu (sum f/V) mean(ds/dX)

with the normal forces f and the path ds of the surface of the slab past the die while the die moves by dX; ds is about
dX. The normal forces on the arc lean to both sides: their sum exceeds V, and H/V exceeds mu. A slide with H/V far above
that is not steady under Coulomb's law.
Sources: Fischer, Wriggers, CMAME 195 (2006) 5020-5036; dimensions after Yastrebov, Numerical Methods in Contact
Mechanics (2013), as in the tutorial ``shallowIroning`` of solids4foam, whose README has the digitised curves of others.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from itertools import pairwise

import numpy as np

from formulations.conditions.boundary import Supports
from formulations.conditions.dof_map import Images
from formulations.discretisation import Discretisation
from formulations.geometry.grid import Grid
from formulations.geometry.surfaces import Plate
from formulations.section.laminate import LAWS, Laminate, Ply
from formulations.shell import ShellModel
from formulations.solid.ties import TiedSolid
from formulations.solid_mesh import SolidMesh
from formulations.strains.catalogue import MEASURES
from studies.ask.scene import EPSILON, SOLVER, Reference, Request, SceneModel, Setting, Sheet, UsageError
from studies.scenes.data import Row, references
from studies.scenes.element import PRESETS
from studies.scenes.faces.bodies import Bodies, Body, Placed, Side
from studies.scenes.faces.model import OTHER, PAIRED, FacesModel, Facing, Meeting
from studies.scenes.faces.solids import PlacedSolid, growing, towards_start
from studies.scenes.solids import OfSolids

WIDTH, E, NU = 1.0, 689.6, 0.32  # mm, MPa, -
LONG, THICK = 12.0, 4.0  # of the slab [mm]
HALF, RADIUS, HIGH = 0.6, 0.75, 0.9  # half of the chord of the die, its arc, its sides [mm]
SAG = RADIUS - math.sqrt(RADIUS**2 - HALF**2)
ABOVE = 0.2  # height of the lowest point of the die before it is pressed down
NEAR, IN_NEAR = 1.0, 0.5  # depth [mm] in which that share of the layers of the slab lies
LAYERS = 6  # elements along the slab for one through it
BESIDE = 0.2  # on both sides of the way of the die where elements are closer there
LOW = [9 * i + k for k in range(3) for i in range(3)]  # nodes of an element at its low a2, turned inwards as its inner
HIGH_SIDE = [9 * i + 6 + k for i in range(3) for k in range(3)]
DEPTH = Setting.positive("depth_mm", 1.0, "downward travel of the top of the die, 0.2 of it before contact", 1.2)
SLIDE = Setting(
    "slide_mm", (1.0, 2.0, 3.0, 4.0, 5.0), "positions of the top of the die along the slab, in turn", "path", 0.0, 10.4
)
BEGIN = Setting(
    "start_mm", 0.2, "position of the rear side of the die along the slab when it is pressed in", low=0, high=10.8
)
LINES = Setting.one_of(
    "lines", ("even", "way"), "even", "grid lines: even along the slab, or coarser away from the path of the die"
)
SLAB = Setting.one_of("slab", ("solid", "shell"), "solid", "elements of the slab")
STIFFER = Setting("E_ratio", 10.0, "Young's modulus of the die over that of the slab", low=1e-2, high=1e4)
DIE = replace(OTHER, default=100, help="elements along the die, per cent of those of the slab over the same length")


BENCHMARK: Mapping[str, float | str] = {"depth_mm": 1.0, "start_mm": 0.2, "E_ratio": 10.0, "mu": 0.3}
# V and H per width [N/mm] at the end of the press, and half way through a slide of 10 mm
PUBLISHED = {
    "solids4foam, tutorial shallowIroning": (316.4, 55.0, 395.1, 122.7),
    "Code_Aster SSNP153": (332.0, 71.0, 421.0, 143.3),
    "Hartmann, Oliver, Weyler, Cante, Hernandez, CMAME 198 (2009)": (319.5, 67.2, 408.4, 160.2),
    "Fischer, Wriggers, CMAME 195 (2006)": (297.9, 62.1, 365.1, 188.8),
    "Yastrebov, thesis (2011)": (289.7, 58.5, 359.5, 170.8),
    "Poulios, Renard, Comput. Struct. 153 (2015)": (267.9, 55.3, 337.4, 102.1),
}
# With lines=way on 1x240 slabs of solids and as shells have V and H of the press within 0.2 % of each other, and H/V of
# the slide of 0.341 and 0.339. Solids have 0.349, 0.341, 0.335, 0.334 on 1x120, 1x240, 1x480, 1x960.
OURS = (315.5, 65.8, 401.0, 133.5)
WITHIN = {"V_N_mm": 0.005, "H_N_mm": 0.02, "H_over_V": 0.02}
SPREAD = {"V_N_mm": 0.15, "H_N_mm": 0.35, "H_over_V": 0.35}  # of these values: they disagree far beyond their reading


def _references() -> tuple[Reference, ...]:
    def rows(V1: float, H1: float, V2: float, H2: float) -> list[Row]:
        return [
            ({**BENCHMARK, "way_mm": at}, {"V_N_mm": V, "H_N_mm": H, "H_over_V": H / V})
            for at, V, H in ((1.0, V1, H1), (6.0, V2, H2))
        ]

    press, slide = rows(*OURS)
    ours = "limit of meshes, slabs of solids and as a shell"
    collected = references("refined", ours, WITHIN, [press, slide])
    for source, values in PUBLISHED.items():
        collected += references("read", f"{source}, curves digitised by solids4foam", SPREAD, rows(*values))
    return collected


class Ironing(OfSolids):
    """a1 across the slab, a2 along it."""

    name = "ironing"
    title = "Shallow ironing: a die pressed into a slab and drawn along it"
    default_mesh = (1, 60)
    settings = (DEPTH, BEGIN, SLIDE, STIFFER, SLAB, LINES, DIE, *PAIRED[1:], EPSILON, SOLVER)
    references = _references()
    quantities = {
        "V_N_mm": "force on the die downwards, per width",
        "H_N_mm": "force on the die along the slab, per width",
        "H_over_V": "their ratio, the friction of the whole",
    }
    sheet = Sheet("z", -62.0, 14.0)

    def build(self, request: Request) -> SceneModel:
        """The slab is the first body; raises UsageError where the die would slide beyond the end of the slab."""
        far = request.number("start_mm") + max(request.numbers("slide_mm")) + 2 * HALF
        if far > LONG:
            raise UsageError(f"start_mm and slide_mm take the die to {far:g} mm: the slab ends at {LONG:g} mm")
        slab, die = _slab(request), _die(request)
        travel = _Way(request.number("depth_mm"), request.numbers("slide_mm"))
        start = np.array([0.0, request.number("start_mm") + HALF, ABOVE])

        def placed(at: float) -> Bodies:
            return Bodies((slab, PlacedSolid(die, shift=start + travel.shift(at))))

        held = die.solid.discretisation.mesh.on(2, HIGH)

        def measured(at: float, meeting: Meeting) -> dict[str, float]:
            H, V = reaction(die, meeting.u[slab.n_free :], held)[1:] / WIDTH
            return {"V_N_mm": -V, "H_N_mm": H, "H_over_V": -H / V if V else 0.0}

        sides = [(Side(k, 1), columns(each)) for k, each in enumerate((slab, PlacedSolid(die)))]
        return FacesModel.of(
            request, placed, [Facing.between(request, *sides)], measured, "way_mm", targets=travel.stops
        )


def reaction(body: TiedSolid, u: np.ndarray, held: np.ndarray) -> np.ndarray:
    """Force (3,) [N] of the supports of nodes (k,) on a body at u (n,)."""
    solid = body.solid.discretisation
    forces = solid.nodal(solid.dofs, solid.internal_force(body.expand(u))).reshape(-1, 3)
    return np.asarray(forces[held].sum(axis=0))


def columns(body: Body) -> np.ndarray:
    """Points (m, j) of its face that move alike: those of a line along a1, the lowest first."""
    at = np.round(body.face(1)[0], 9)
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


def _slab(request: Request) -> Body:
    depths, along = _depths(request), _along(request)
    across = np.linspace(0.0, WIDTH, request.mesh[0] + 1)
    if request.choice("slab") == "shell":
        return Placed(_shell(np.append(depths[:-1:2], depths[-1]), across, along))
    laminate = _layers(depths)
    mesh = SolidMesh.build(Plate(), across, along, laminate)
    return PlacedSolid(_in_plane_strain(mesh, laminate, mesh.on(2, -THICK), mesh.outer))


def _along(request: Request) -> np.ndarray:
    """Lines along the slab."""
    n = request.mesh[1]
    if request.choice("lines") == "even":
        return np.linspace(0.0, LONG, n + 1)
    start = request.number("start_mm")
    low = max(start - BESIDE, 0.0)
    high = min(start + max(request.numbers("slide_mm")) + 2 * HALF + BESIDE, LONG)
    middle = np.linspace(low, high, math.ceil((high - low) * n / LONG) + 1)
    before, beyond = (growing(LONG / n, length) for length in (low, LONG - high))
    return np.concatenate([low - before[:0:-1], middle, high + beyond[1:]])


def _depths(request: Request) -> np.ndarray:
    """Lines through the slab, from its face."""
    n = request.mesh[1]
    if request.choice("lines") == "even":
        return towards_start(max(2, n // LAYERS), THICK, NEAR, IN_NEAR)
    return growing(LONG / n, THICK)


def _layers(depths: np.ndarray) -> Laminate:
    return Laminate(tuple(Ply.isotropic(E, NU, h) for h in np.diff(depths)[::-1]), -THICK)


def _shell(depths: np.ndarray, across: np.ndarray, along: np.ndarray) -> ShellModel:
    """In plane strain: nodes of other a1 move as those of the first one do."""
    grid = Grid.tensor(across, along)
    every, line = np.arange(grid.n_nodes), np.round(grid.nodes[:, 1], 9)
    supports = Supports.none(grid).hold(every, (0,)).hold(every, (1, 2), ("inner",))
    first = grid.on_line(0, across[0])
    leads = first[np.searchsorted(line[first], line)]
    others = every[leads != every]
    images = Images(others, leads[others], np.ones((len(others), 3)))
    body = Discretisation.build(Plate(), grid, _layers(depths), *supports.masks, images=images, surfaces="4/ply")
    element = PRESETS["refined"]
    return ShellModel(
        body,
        MEASURES["exact"],
        law="neo-hooke",
        newton="plain",
        thickness_strain=element["thickness_strain"],
        membrane=element["membrane"],
    )


def _die(request: Request) -> TiedSolid:
    share = request.number("other_elements") / 100 * request.mesh[1] / LONG
    along, up = (max(2, round(share * length)) for length in (2 * HALF, HIGH))
    heights = np.linspace(0.0, HIGH, up + 1) if request.choice("lines") == "even" else growing(1 / share, HIGH)
    young = E * request.number("E_ratio")
    laminate = Laminate((Ply.isotropic(young, NU, HIGH),), 0.0)
    across = np.linspace(0.0, WIDTH, request.mesh[0] + 1)
    mesh = SolidMesh.build(Plate(), across, np.linspace(-1.0, 1.0, along + 1), laminate, per_ply=len(heights) - 1)
    a1, s, row = mesh.parameter[:, 0], mesh.parameter[:, 1], mesh.parameter[:, 2] / HIGH * (len(heights) - 1)
    t = np.interp(row, np.arange(len(heights)), heights) / HIGH
    angle = s * math.asin(HALF / RADIUS)
    y = (1 - t) * RADIUS * np.sin(angle) + t * HALF * s
    z = (1 - t) * RADIUS * (1 - np.cos(angle)) + t * (SAG + HIGH)
    face = np.concatenate([mesh.inner, *_sides(mesh)])
    mesh = replace(mesh, x=np.stack([a1, y, z], axis=1))
    return _in_plane_strain(mesh, laminate, mesh.on(2, HIGH), face)


def _sides(mesh: SolidMesh) -> list[np.ndarray]:
    """The quadrilaterals (F, 9) of both sides but for the highest, turned as those of the inner face are."""
    both_sides = [mesh.elements[:, nodes] for nodes in (LOW, HIGH_SIDE)]
    a, high = mesh.parameter, mesh.parameter[:, 2].max()
    return [
        quads[np.all(a[quads, 1] == end, axis=1) & (a[quads, 2].max(axis=1) < high)]
        for quads, end in zip(both_sides, (-1.0, 1.0), strict=True)
    ]


def _in_plane_strain(mesh: SolidMesh, laminate: Laminate, held: np.ndarray, face: np.ndarray) -> TiedSolid:
    fixed = mesh.supports((slice(None), 0), (held, slice(None)))
    return TiedSolid.build(mesh, laminate, fixed, face, plane=True, law=LAWS["neo-hooke"])


SCENES = (Ironing(),)
