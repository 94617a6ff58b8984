"""Strips clamped at one end and loaded at the other: a twisted beam, a hook, a slender beam on distorted elements."""

from collections.abc import Mapping

import numpy as np

from formulations.section.laminate import Ply
from studies.ask.scene import Reference, Request, SceneModel, Setting, Sheet
from studies.scenes.benchmarks.quads import SETTINGS, Map, OnQuads, pulled_strip
from studies.scenes.element import LINES, centred_laminate

THICK, THIN = 0.32, 0.0032  # mm
LOADS = {"in-plane": 2, "out-of-plane": 1}  # which of x, y, z it is along: the width of the loaded end is along z
BEAM, LIMIT = "Zupan, Saje (2004), in FinEtoolsFlexStructures", "S4, extrapolated, in FinEtoolsFlexStructures"
USUAL = "in FinEtoolsFlexStructures, origin not given there"
SOLID = "quadratic hexahedra of scikit-fem, 96x8x2, thickness along the normals"
KNOWN = (  # h, kind, source, uncertainty, in plane, out of plane
    (THICK, "read", BEAM, 0.005, 0.005424534868469, 0.001753248285256),
    (THICK, "computed", SOLID, 0.0003, 0.0054123, 0.0017500),
    (THIN, "read", LIMIT, 0.001, 0.005249866, 0.0012951361),
    (THIN, "read", USUAL, 0.0013, 0.005256, 0.001294),
)


def twisted(s: np.ndarray, t: np.ndarray) -> np.ndarray:
    """x = L s; the width lies along (cos a, sin a) in y and z, a = s pi/2."""
    y, angle = TwistedBeam.WIDTH * (t - 0.5), TwistedBeam.TWIST * s
    return np.stack([TwistedBeam.LENGTH * s, y * np.cos(angle), y * np.sin(angle)], axis=-1)


class TwistedBeam(OnQuads):
    """Twisted beam of MacNeal and Harder: a strip clamped at one end, twisted by 90 degrees, with a force at the other.

    The targets 0.005424 and 0.001754 are those of beams with rectangular sections; solids give 0.99990 and 1.0001 of
    them. A shell has its thickness along its normals, which lean by 4 degrees at the edges, so its sections are thicker
    there: solids of this shape give 0.9977 in plane and 0.9982 out of it. The limits here are 0.9975 and 0.9964. A
    shear correction of 5/6 adds 0.0003; straight fibres cost 0.0017 of the bending across the width, as in the slender
    beam. Shells of h = 0.32 mm differ by 0.5 % among themselves. The limits of the thin strip here are 0.0052499 and
    0.0012926; the usual targets, 0.005256 and 0.001294, differ by 0.12 and 0.11 %. Out of plane the limit of S4 is 0.2
    % above this one; a force on the middle node alone explains 0.04 % of that. The shells of another program (Kratos'
    thick quadrilaterals) under the forces of this scene agree to 0.03 % on 96x16. Source: MacNeal, Harder, Finite Elem.
    Anal. Des. 1 (1985) 3-20.

    s along x from the clamp to the loaded end, t across. The force is (h/0.32 mm)^3 N, so the deflection is about the
    same for all thicknesses.

    At h = 0.0032 mm the rounding of the forces, E A u eps/h, is 0.006 of that load: a single linear solve has three
    digits, the iterations of a solve have nine.
    """

    E, NU, LENGTH, WIDTH, TWIST = 29e6, 0.22, 12.0, 1.1, np.pi / 2  # MPa, -, mm, mm, rad

    name = "twisted-beam"
    title = "Twisted beam under a force at its end (MacNeal, Harder)"
    default_mesh = (48, 8)
    settings = (
        Setting("h_mm", THICK, "thickness", low=1e-3, high=1.0),
        Setting.one_of("load", LOADS, "in-plane", "force at the end, in its plane (z) or out of it (y)"),
        *SETTINGS,
    )
    references = tuple(
        Reference("tip_deflection_mm", value, {"h_mm": h, "load": load, "measure": "linear"}, kind, source, within)
        for h, kind, source, within, *values in KNOWN
        for load, value in zip(LOADS, values, strict=True)
    )
    quantities = {"tip_deflection_mm": "along the force, mean over the loaded end and both faces"}
    sheet = Sheet(azimuth=-60.0, elevation=30.0, listed=False)

    def build(self, request: Request) -> SceneModel:
        """The force is distributed over the end, half on each face."""
        h, axis = request.number("h_mm"), LOADS[request.choice("load")]
        wall = centred_laminate(request, Ply.isotropic(self.E, self.NU, h))
        return pulled_strip(request, twisted, wall, axis, (h / THICK) ** 3)


RADII, ANGLES = (14.0, 46.0), np.deg2rad([60.0, 150.0])
FORCE = 1.0  # N, along the width
AT: Mapping[str, float | str] = {"load_fraction": 1.0, "measure": "linear"}


def hook(s: np.ndarray, t: np.ndarray) -> np.ndarray:
    """s: of the whole angle, 210 degrees, of which the small arc has 60; z = 20 mm t."""
    angle = ANGLES.sum() * s
    (r, R), first = RADII, ANGLES[0]
    small = np.stack([r * np.sin(angle), r * (1 - np.cos(angle))], axis=-1)
    back = 2 * first - angle  # heading on the large arc, which turns the other way
    middle = (r + R) * np.array([np.sin(first), -np.cos(first)]) + [0.0, r]
    large = middle + R * np.stack([-np.sin(back), np.cos(back)], axis=-1)
    return np.concatenate(
        [np.where((angle < first)[..., None], small, large), RaaschHook.WIDTH * t[..., None]], axis=-1
    )


class RaaschHook(OnQuads):
    """Raasch's hook: a thick curved strip of two arcs of opposite curvature, clamped at one end, sheared at the other.

    It bends, twists and shears across the wall at once; shells whose drilling rotation is coupled to the twist do not
    converge. nu = 0.35 here; values for 0.3 are also in use. The limit here is 0.992 of that of solids, with a shear
    correction of 5/6 it is 0.998. A strip in torsion shears across its wall in layers along its edges, h/sqrt(12 kappa)
    wide. They reduce its stiffness by the fraction 2 h/(b sqrt(12 kappa)), with 5/6 as much as in a solid. Elements
    wider than these layers are too stiff, to first order in their width: 0.970 on 56x8, and 0.987 there with
    lines=edges. Source: Knight, AIAA J. 35 (1997) 1281-1285; 5.022 by solids of 20 nodes and 5.02 by another program
    are as read in FinEtoolsFlexStructures.

    s from the clamp along both arcs by their angle, t along z; with 7 elements, or a multiple, a grid line lies where
    the arcs meet.
    """

    E, NU, H, WIDTH = 3300.0, 0.35, 2.0, 20.0  # MPa, -, mm, mm
    SOLID = "solids of 20 nodes, in FinEtoolsFlexStructures"

    name = "raasch-hook"
    title = "Raasch's hook under a shear force at its end"
    default_mesh = (56, 8)
    settings = SETTINGS
    references = (Reference("tip_deflection_mm", 5.02201, AT, "read", SOLID, 0.01),)
    quantities = {"tip_deflection_mm": "along the width (z), mean over the loaded end and both faces"}
    sheet = Sheet(azimuth=-60.0, elevation=35.0, listed=False)

    def build(self, request: Request) -> SceneModel:
        """The force is distributed over the end, half on each face."""
        wall = centred_laminate(request, Ply.isotropic(self.E, self.NU, self.H))
        return pulled_strip(request, hook, wall, 2, FORCE)


E, NU, LENGTH, WIDTH, H = 1e7, 0.3, 6.0, 0.2, 0.1  # MPa, -, mm, mm, mm
G, SIX = E / (2 * (1 + NU)), 6
ALONG = {"extension": 0, "in-plane": 1, "out-of-plane": 2}  # a force of 1 N at the end along x, y or z
SHAPES = {  # how the five lines between the six elements lean: to either side by the width over their length
    "rectangle": np.zeros(SIX + 1),
    "trapezoid": np.array([0, 1, -1, 1, -1, 1, 0.0]),
    "parallelogram": np.array([0, 1, 1, 1, 1, 1, 0.0]),
}


def _bending(inertia: float) -> float:
    return LENGTH**3 / (3 * E * inertia) + 1.2 * LENGTH / (G * WIDTH * H)


VALUES = {
    "extension": LENGTH / (E * WIDTH * H),
    "in-plane": _bending(H * WIDTH**3 / 12),
    "out-of-plane": _bending(WIDTH * H**3 / 12),
}


def strip(shape: str) -> Map:
    """x = L s + b (t - 1/2) lean(s), y = b (t - 1/2), with a lean that is linear over each of the six elements."""

    def mapped(s: np.ndarray, t: np.ndarray) -> np.ndarray:
        lean = np.interp(s, np.linspace(0.0, 1.0, SIX + 1), SHAPES[shape])
        y = WIDTH * (t - 0.5)
        return np.stack([LENGTH * s + y * lean, y, np.zeros_like(y)], axis=-1)

    return mapped


class SlenderBeam(OnQuads):
    """Slender cantilever of MacNeal and Harder on six rectangles, or trapezoids or parallelograms with 45 degree
    angles.

    No trapezoidal element of four nodes can both pass the patch test and bend in its plane without locking (MacNeal,
    IJNME 24 (1987) 1793-1799): six of them give only a part of the in-plane deflection. Values are those of
    Timoshenko's beam. In plane the limit is 0.9909 of it. By Poisson's ratio the wall is thinner where it is stretched,
    so its faces lean across the beam. In a solid, fibres across the wall bend with them; straight fibres leave shear
    strains of nu M h/(2 E I) at the faces, which remove nu^2 G (h/b)^2/(E + (1 - nu^2) G (h/b)^2) = 0.0080 of the
    flexibility. A solid has 0.9984, because of the clamp. Source: MacNeal, Harder, Finite Elem. Anal. Des. 1 (1985)
    3-20.

    s from the clamp along x, t along y; finer meshes of 6 k elements divide the six.
    """

    name = "slender-beam"
    title = "Slender cantilever on rectangles, trapezoids and parallelograms (MacNeal, Harder)"
    default_mesh = (SIX, 1)
    coarsest_mesh = (SIX, 2)  # in its plane it bends, across which one element is too stiff, whatever its length
    settings = (
        Setting.one_of("shape", SHAPES, "rectangle", "shape of the elements"),
        Setting.one_of("load", ALONG, "in-plane", "force of 1 N at the end: along it (x), across (y), or normal (z)"),
        *(setting for setting in SETTINGS if setting is not LINES),
    )
    references = tuple(
        Reference("tip_deflection_mm", value, {"load": load, "measure": "linear"}, "exact", "Timoshenko's beam", 0.01)
        for load, value in VALUES.items()
    )
    quantities = {"tip_deflection_mm": "along the force, mean over the loaded end and both faces"}
    sheet = Sheet(azimuth=-60.0, elevation=30.0, listed=False)

    def build(self, request: Request) -> SceneModel:
        """The force is distributed over the end, half on each face."""
        axis = ALONG[request.choice("load")]
        wall = centred_laminate(request, Ply.isotropic(E, NU, H))
        return pulled_strip(request, strip(request.choice("shape")), wall, axis, 1.0)


SCENES = (
    TwistedBeam(),
    RaaschHook(),
    SlenderBeam(),
)
