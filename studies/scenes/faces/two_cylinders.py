"""Two solid cylinders pressed on each other: Hertz's line contact between two deformable bodies.

The model is a quarter of each cylinder in plane strain, cut at its middle plane and at the plane of symmetry through
the contact: an infinite column of cylinders of two alternating materials, whose middle planes approach by 2 delta. The
contact is so small that it is that of two half spaces; the approach of halves of discs has a closed form, too. Both are
valid up to the order of a/R, by which the solids, which allow large strains, differ from them.

Grid lines get closer towards the contact like sinh, so that a quarter of them is in the contact and one lies on its rim
by the closed form. The middle of each cylinder, up to 0.005 of the radius, is left out, because its rays meet there.
"""

import math
from dataclasses import replace

import numpy as np

from formulations.geometry.surfaces import cylinder
from formulations.section.laminate import Laminate, Ply
from formulations.solid_mesh import SolidMesh
from studies.ask.scene import EPSILON, SOLVER, Reference, Request, SceneModel, Setting, Sheet, UsageError
from studies.scenes.closed_forms.contact import hertz_pressure, pressed_cylinders
from studies.scenes.data import Row, references
from studies.scenes.faces.bodies import Bodies, Side
from studies.scenes.faces.model import PAIRED, FacesModel, Facing, Meeting, of_second
from studies.scenes.faces.solids import PlacedSolid, tied, towards_start
from studies.scenes.solids import OfSolids

RADIUS, WIDTH, E, NU = 100.0, 1.0, 1000.0, 0.3  # mm, mm, MPa
BORE = 0.005  # of the radius; one of 0.02 takes 5e-4 off the force
DELTAS = (0.01, 0.025)  # a/R = 0.0057 and 0.0095
IN_CONTACT, BELOW = 0.25, 0.2  # share of the elements along the face in the contact, and down to its half width
FACE = 0.5  # share of the elements along the face that may meet others
FEWEST = 4  # elements along the face: one in the contact
FACING = np.diag([-1.0, 1.0, -1.0])  # half a turn about the second axis
TRAVELS = Setting.positive("delta_mm", DELTAS, "half of the approach of the middle planes", 1.0, kind="floats")
STIFFER = Setting("E_ratio", 1.0, "Young's modulus of the second cylinder over that of the first", low=1e-3, high=1e3)
SOURCE = "Hertz, line contact of half spaces, and the approach of halves of discs (Johnson)"


def _moduli(ratio: float) -> tuple[float, float]:
    return E / (1 - NU**2), ratio * E / (1 - NU**2)


def _references() -> tuple[Reference, ...]:
    rows: list[Row] = []
    for delta in DELTAS:
        for ratio in (1.0, 10.0):
            force = pressed_cylinders(2 * delta, RADIUS, _moduli(ratio))[0]
            values = {"P_over_ER": force / E / RADIUS, "peak_over_hertz": 1.0, "half_width_over_hertz": 1.0}
            rows.append(({"delta_mm": delta, "E_ratio": ratio}, values))
    return references("exact", SOURCE, 1e-2, rows)


class TwoCylinders(OfSolids):
    """a1 along the axis, a2 from the contact over a quarter of each cylinder."""

    name = "two-cylinders"
    title = "Two solid cylinders pressed on each other"
    default_mesh = (1, 32)
    settings = (TRAVELS, STIFFER, *PAIRED, EPSILON, SOLVER)
    references = _references()
    quantities = {
        "P_over_ER": "force between the cylinders per length, over E R of the first",
        "peak_over_hertz": "largest pressure over Hertz's under the same force",
        "half_width_over_hertz": "half width of the contact by the second moment of its pressure, over Hertz's",
    }
    sheet = Sheet("x", -62.0, 14.0)

    def build(self, request: Request) -> SceneModel:
        """The cuts of the quarters are symmetric."""
        deltas, moduli = request.numbers("delta_mm"), _moduli(request.number("E_ratio"))
        half_width = pressed_cylinders(2 * deltas[-1], RADIUS, moduli)[1]
        counts = request.mesh[1], of_second(request.mesh[1], request)
        if min(counts) < FEWEST:
            along = " and ".join(map(str, counts))
            raise UsageError(f"mesh {request.mesh_text}: {along} elements along the faces, each must have {FEWEST}")
        first, second = (
            _quarter(request, n, modulus * (1 - NU**2), half_width) for n, modulus in zip(counts, moduli, strict=True)
        )
        modulus = 1 / sum(1 / each for each in moduli)

        def placed(delta: float) -> Bodies:
            shift = np.array([2 * (RADIUS - delta), 0.0, WIDTH])
            return Bodies((first, replace(second, turn=FACING, shift=shift)))

        def measured(delta: float, meeting: Meeting) -> dict[str, float]:
            force = 2 * float(meeting.force.sum()) / WIDTH
            if force <= 0:
                return {"P_over_ER": force / E / RADIUS, "peak_over_hertz": 0.0, "half_width_over_hertz": 0.0}
            a, peak = hertz_pressure(force, RADIUS / 2, modulus)
            squared = float(meeting.force @ meeting.position[:, 1] ** 2 / meeting.force.sum())
            return {
                "P_over_ER": force / E / RADIUS,
                "peak_over_hertz": float(meeting.pressure.max()) / peak,
                "half_width_over_hertz": 2 * math.sqrt(squared) / a,  # of a semi-ellipse that mean square is a^2/4
            }

        sides = [(Side(k, 1), np.arange(len(each.points_of(1)))) for k, each in enumerate((first, second))]
        return FacesModel.of(request, placed, [Facing.between(request, *sides)], measured)


def _quarter(request: Request, n: int, young: float, half_width: float) -> PlacedSolid:
    side = np.pi / 2
    around = towards_start(n, side, half_width / RADIUS, IN_CONTACT)
    depths = towards_start(max(1, 3 * n // 4), RADIUS * (1 - BORE), half_width, BELOW)
    layers = np.diff(depths)[::-1]
    laminate = Laminate(tuple(Ply.isotropic(young, NU, h) for h in layers), -float(depths[-1]))
    mesh = SolidMesh.build(cylinder(RADIUS), np.linspace(0.0, WIDTH, request.mesh[0] + 1), around, laminate)
    fixed = mesh.supports((mesh.on(1, 0.0), 1), (mesh.on(1, side), 0), (slice(None), 2))
    ends = mesh.parameter[mesh.outer, 1].max(axis=1)
    face = mesh.outer[ends <= around[max(1, round(FACE * n))] + 1e-9]
    return tied(request, mesh, laminate, fixed, face, uniform=True)


SCENES = (TwoCylinders(),)
