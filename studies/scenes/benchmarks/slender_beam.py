"""Slender cantilever of MacNeal and Harder on six rectangles, trapezoids or parallelograms, with angles of 45 degrees.

No four-noded element can pass the patch test and bend in its plane without locking once it is a trapezoid (MacNeal,
IJNME 24 (1987) 1793-1799): on six of them it takes a part of the load in plane only. Values are Timoshenko's beam.
In plane the limit is 0.9909 of it. Poisson's ratio makes the wall thinner where it is stretched, so that its faces lean
across the beam. In a solid fibres across the wall bend with them; straight ones leave shears of nu M h/(2 E I) at the
faces, and nu^2 G (h/b)^2/(E + (1 - nu^2) G (h/b)^2) = 0.0080 of the flexibility goes. A solid has 0.9984: the clamp.
Source: MacNeal, Harder, Finite Elem. Anal. Des. 1 (1985) 3-20.
"""

import numpy as np

from formulations.section.laminate import Ply
from studies.ask.scene import Reference, Request, SceneModel, Setting, Sheet
from studies.scenes.benchmarks.quads import SETTINGS, Map, OnQuads, pulled_strip
from studies.scenes.element import LINES, centred_laminate

E, NU, LENGTH, WIDTH, H = 1e7, 0.3, 6.0, 0.2, 0.1  # MPa, -, mm, mm, mm
G, SIX = E / (2 * (1 + NU)), 6
LOADS = {"extension": 0, "in-plane": 1, "out-of-plane": 2}  # a force of 1 N at the end along x, y or z
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
    """s from the clamp along x, t along y; finer meshes of 6 k elements cut the six into parts."""

    name = "slender-beam"
    title = "Slender cantilever on rectangles, trapezoids and parallelograms (MacNeal, Harder)"
    default_mesh = (SIX, 1)
    coarsest_mesh = (SIX, 1)
    settings = (
        Setting.one_of("shape", SHAPES, "rectangle", "the shape of its elements"),
        Setting.one_of("load", LOADS, "in-plane", "force of 1 N at the end: along it (x), across (y), or normal (z)"),
        *(setting for setting in SETTINGS if setting is not LINES),
    )
    references = tuple(
        Reference("tip_deflection_mm", value, {"load": load, "measure": "linear"}, "exact", "Timoshenko's beam", 0.01)
        for load, value in VALUES.items()
    )
    quantities = {"tip_deflection_mm": "along the force, mean over the loaded end and both faces"}
    sheet = Sheet(azimuth=-60.0, elevation=30.0, listed=False)

    def build(self, request: Request) -> SceneModel:
        """The force is spread over the end, half on each face."""
        axis = LOADS[request.choice("load")]
        wall = centred_laminate(request, Ply.isotropic(E, NU, H))
        return pulled_strip(request, strip(request.choice("shape")), wall, axis, 1.0)


SCENES = (SlenderBeam(),)
