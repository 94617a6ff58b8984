"""Clamped shallow spherical cap under uniform pressure: snap-through at a published load.

The coordinates are singular at the apex, so a small hole is left there. Its edge is held as by a rigid plug, which also
carries the pressure on the hole: it cannot move along the meridian. The tests measure the effect of the hole: at lam =
4 a hole of 0.1 of the radius raises the snap pressure by 2.7 %, one of 0.05 by 0.8 %, and one of 0.01 by less than 0.1
%.

With a/R = 0.05 the cap is so shallow that the shallow-shell equations apply
(:mod:`studies.scenes.closed_forms.marguerre_cap`). They give 0.5637 of the classical pressure at lam = 4, Teng and
Rotter's finite rotations 0.563; Budiansky's 0.578 of 1959 is 2.5 % higher. Beyond lam = 5.5 a real cap buckles without
symmetry, which a quarter with few elements around cannot show.
"""

import numpy as np

from formulations.geometry.surfaces import sphere
from formulations.loads import edge_force
from formulations.section.laminate import Laminate, Ply
from studies.ask.declarations import SNAP, Ladder
from studies.ask.scene import SOLVER, Declared, Reference, Request, SceneModel, Setting
from studies.scenes.closed_forms.marguerre_cap import ShallowCap, classical_pressure, shallowness
from studies.scenes.curves import ARC_STEP, CURVE_FRACTIONS, PATH, CurveModel
from studies.scenes.element import ELEMENT, patch
from studies.scenes.statics import area_load, normal_at

E, NU, RADIUS, BASE = 1e4, 0.3, 2000.0, 100.0  # MPa, -, mm, mm
RISE = BASE**2 / (2 * RADIUS)  # mm, of the shallow cap
SHALLOWNESS = Setting(
    "shallowness", 4.0, "lam = 2 (3 (1 - nu^2))^(1/4) sqrt(rise/h); it sets the thickness", low=2.0, high=6.0
)
HOLE = Setting("hole", 0.01, "radius of the hole at the apex over that of the base", low=1e-3, high=0.5)

TENG = "Teng, Rotter, Comput. Struct. 31 (1989) 211, table 1, in AchilleasF/AQUINAS-FE, Example GNA05"
BUDIANSKY = "Budiansky (1959), in the same table"
COMPUTED = "shallow-shell equations by collocation, studies/scenes/closed_forms/marguerre_cap.py"
READ = {4.0: (0.563, 0.578), 5.0: (0.615, 0.629), 5.5: (0.746, 0.789)}  # p/p_classical of both
SHALLOW = {4.0: (0.563725, 1.062193), 5.0: (0.615989, 0.575940), 5.5: (0.744912, 0.426638)}  # p/p_classical, w [mm]


def thickness(lam: float) -> float:
    """The h [mm] of the given shallowness."""
    return RISE * (shallowness(1.0, 1.0, NU) / lam) ** 2


def shallow_cap(lam: float) -> ShallowCap:
    """The same cap by the shallow equations."""
    return ShallowCap(E, NU, RADIUS, BASE, thickness(lam))


def _references() -> tuple[Reference, ...]:
    references = []
    for lam, (teng, budiansky) in READ.items():
        at, (snap, deflection) = {"shallowness": lam}, SHALLOW[lam]
        references += [
            Reference("limit_load_fraction", teng, at, "read", TENG, 0.003),
            Reference("limit_load_fraction", budiansky, at, "read", BUDIANSKY, 0.06),
            Reference("limit_load_fraction", snap, at, "computed", COMPUTED, 0.003),
            Reference("limit_w_apex_mm", deflection, at, "computed", COMPUTED, 0.01),
        ]
    return tuple(references)


class ShallowSphericalCap(Declared):
    """A quarter with two symmetry planes; a1 is the latitude, from the clamped base to the hole."""

    name = "shallow-cap"
    title = "Clamped shallow spherical cap under pressure"
    default_mesh = (32, 4)
    settings = (SHALLOWNESS, HOLE, CURVE_FRACTIONS, PATH, ARC_STEP, *ELEMENT, SOLVER)
    references = _references()
    quantities = {"w_apex_mm": "downwards at the edge of the small hole at the apex"}
    ladders = (  # nothing varies around the axis
        Ladder(SNAP, ("8x2", "16x2", "32x2", "64x2"), ("limit_load_fraction", "limit_w_apex_mm")),
    )

    def build(self, request: Request) -> SceneModel:
        """Dead pressure acts along the normals, half on each face; load fraction 1 is the classical pressure."""
        h, hole = thickness(request.number("shallowness")), BASE * request.number("hole")
        base, rim = (float(np.arccos(r / RADIUS)) for r in (BASE, hole))
        surface, laminate = sphere(RADIUS), Laminate.single(Ply.isotropic(E, NU, h))
        edges = ("clamped", "symmetric", "symmetric", "symmetric")
        quarter = patch(request, surface, (base, rim), (0, np.pi / 2), laminate, edges)
        p = classical_pressure(E, NU, RADIUS, h)
        forces = area_load(quarter, lambda a1, a2: -p * surface.frame(a1, a2)[..., 2, :])
        plug = np.array([0.0, 0.0, -p * hole / 2])  # p pi c^2 over the circumference 2 pi c
        forces += edge_force(quarter, 0, rim, lambda a1, a2: plug)
        at_apex = normal_at(quarter, {"w_apex_mm": (quarter.grid.on_line(0, rim), -1)})
        return CurveModel.of(request, quarter, at_apex, forces=forces)


SCENES = (ShallowSphericalCap(),)
