"""Hyperboloid of one sheet with free ends under p cos 2 phi: it bends without stretching, the hardest test of locking.

The printed reference is a Reissner-Mindlin shell. It differs from a shell of two faces by O(t/R): negligible in thin
shells, 0.4 % at t/R = 0.1, and 30 % at t/R = 1, where the waists of the two faces have 1/2 and 3/2 of the radius of the
middle surface. Both shells have one-dimensional solutions (:mod:`studies.scenes.closed_forms`), which separate the
error of the formulation from that of the mesh. At t/R = 1 the solid is solved, too: two faces differ from it by 3 %,
Mindlin's shell by 46 %.
"""

from dataclasses import replace

import numpy as np

from formulations.geometry.surfaces import hyperboloid
from formulations.section.laminate import Ply
from studies.ask.declarations import LINEAR, Ladder, Sheet, meshes
from studies.ask.scene import Declared, Reference, Request, SceneModel, Setting, UsageError
from studies.scenes.closed_forms.harmonic import HarmonicShell, HarmonicSolid
from studies.scenes.element import LINES, ShearCorrected, patch
from studies.scenes.statics import LOAD_FRACTION, SHELL_SETTINGS, StaticModel, area_load, normal_at

E, NU, RADIUS, LOAD = 2.85e4, 0.3, 1.0, 1e4  # MPa, -, mm; p = LOAD (t/R)^3 cos 2 phi MPa
HARMONIC, REISSNER = 2, 5 / 6
SURFACE = hyperboloid(RADIUS, RADIUS)
THICKNESS = Setting("t_over_R", 0.01, "thickness over the radius of the waist", low=1e-4, high=1.0)
SHEAR, *OTHERS = SHELL_SETTINGS
PRECISE = 1e13  # shear_correction/t_over_R^4: all grids solved up to here, none of 24 x 24 at ten times that

# Digits of a one-dimensional reduction; Lee, Bathe, Comput. Struct. 82 (2004) 945, computed to the digits of Neunteufel
MINDLIN = {1.0: 1.3577317, 0.1: 0.18954566, 0.01: 0.15046617, 0.001: 0.1498902}
TWO_FACES = {1.0: 0.951994037, 0.1: 0.188873629, 0.01: 0.150468689, 0.001: 0.149890247}
SOLID = {1.0: 0.92698, 0.1: 0.188029}
DEGREE = 140  # of the polynomials
DIGITS = 7e-7  # a unit of the last digit printed: the first two are cut off, not rounded
OF_SOLID = 1e-5
FORMULATION = "this shell in one dimension, studies/scenes/closed_forms/harmonic.py"
ELASTICITY = "linear elasticity in two dimensions, studies/scenes/closed_forms/harmonic.py"
PRINTED = "Reissner-Mindlin shell in one dimension, M. Neunteufel"


def two_faces(t: float) -> HarmonicShell:
    """The shell of the suite of the thickness t [mm]."""
    return HarmonicShell(SURFACE, _wall(t, REISSNER), HARMONIC, LOAD * t**3, RADIUS, False, DEGREE)


def _wall(t: float, shear_correction: float) -> ShearCorrected:
    return ShearCorrected((Ply.isotropic(E, NU, t),), -0.5 * t, shear_correction)


def solid(t: float) -> HarmonicSolid:
    """The body of the thickness t [mm] without the assumptions of a shell."""
    return HarmonicSolid(SURFACE, E, NU, t, HARMONIC, LOAD * t**3, RADIUS, degree=30, through=8)


def _references() -> tuple[Reference, ...]:
    known = (
        ("read", PRINTED, DIGITS, MINDLIN),
        ("computed", FORMULATION, DIGITS, TWO_FACES),
        ("computed", ELASTICITY, OF_SOLID, SOLID),
    )
    return tuple(
        Reference("w_waist_mm", value, {"t_over_R": t, "measure": "linear"}, kind, source, within)
        for kind, source, within, values in known
        for t, value in values.items()
    )


LADDERS = tuple(
    Ladder(
        LINEAR,
        meshes(16, 16, 3),
        ("w_waist_mm",),
        "linear",
        {"t_over_R": ratio},
        coarser=("8x8",),  # locks in the thin one
        name=f"free-hyperboloid-{ratio}",
    )
    for ratio in ("0.1", "0.001")
)


class FreeHyperboloid(Declared):
    """An eighth: a1 = z from the waist to the free end, a2 a quarter of the circle; lines are closer at the end."""

    name = "free-hyperboloid"
    title = "Hyperboloid with free ends under p cos 2 phi (Lee, Bathe)"
    default_mesh = (32, 32)
    settings = (
        THICKNESS,
        LOAD_FRACTION,
        replace(LINES, default="edges"),  # a free end has a layer of the width sqrt(R t), and one of the width t in it
        replace(SHEAR, default=REISSNER),
        *OTHERS,
    )
    references = _references()
    quantities = {"w_waist_mm": "outwards at the waist, a1 = a2 = 0"}
    ladders = LADDERS
    sheet = Sheet(azimuth=25.0, elevation=22.0)

    def build(self, request: Request) -> SceneModel:
        """p acts on the area of the middle surface, half on each face, outwards at a2 = 0.

        Raises UsageError for a wall too thin for its shear stiffness.
        """
        ratio, correction = request.number("t_over_R"), request.number("shear_correction")
        if correction > PRECISE * ratio**4:
            most = f"at most {PRECISE:.0e} t_over_R^4 = {PRECISE * ratio**4:.3g}"
            why = "the rounding of what resists shear and squeeze exceeds what resists bending"
            raise UsageError(f"shear_correction = {correction:g} at t_over_R = {ratio:g} must be {most}: {why} beyond")
        t = ratio * RADIUS
        wall = _wall(t, correction)
        edges = ("symmetric", "free", "symmetric", "symmetric")
        eighth = patch(request, SURFACE, (0, RADIUS), (0, np.pi / 2), wall, edges)

        def pressure(a1: np.ndarray, a2: np.ndarray) -> np.ndarray:
            normal = SURFACE.frame(a1, a2)[..., 2, :]
            return LOAD * t**3 * np.cos(HARMONIC * a2)[..., None] * normal

        at_waist = normal_at(eighth, {"w_waist_mm": (eighth.grid.node_at(0.0, 0.0), 1)})
        return StaticModel.of(request, eighth, at_waist, forces=area_load(eighth, pressure))


SCENES = (FreeHyperboloid(),)
