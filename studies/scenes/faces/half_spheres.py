"""Two hollow half-spheres, one in the other, pressed down by a rigid plane: a wedge of both about the axis.

A benchmark of mortar methods (Puso, Laursen, CMAME 193 (2004) 601-629), with the data of a public one that has the
curves of four codes (solids4foam/solid-benchmarks, hyperElasticity/compressedSpheres): radii of 10, 12 and 14 mm,
E = 1 MPa, nu = 0.3, a compressible neo-Hookean material, rims on a plane without friction, and the force on a quarter
of the whole. Both walls are solids, or shells of 0.18 and 0.15 of their radii. A hole about the axis, HOLE from the
pole to its rim, keeps elements from meeting in a point. Rims of solids there move along the axis alone, as the axis
does: free ones slide over each other, where gaps jump. It is worth 1 % of the force at 1 mm, and 0.2 % from 2 mm on.
What the codes agree on ends near 5 mm, where without friction the inner one snaps through.

With friction forces are inside the band of three codes up to 5 mm, on all meshes, with both pairings and either slave:
4 to 10 % above one, and as much below two that agree, as they are without friction. On curved faces they are the same.
Shells are unstable from 0.5 mm on: in a short wave at the pole the pressed face of either moves along the meridian,
one way and the other from line to line of the mesh. Solids are stable.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from formulations.geometry.surfaces import sphere
from formulations.section.laminate import Laminate, Ply
from formulations.section.laws import LAWS, LINEAR
from formulations.solid.ties import TiedSolid
from formulations.solid_mesh import SolidMesh
from studies.ask.declarations import Sheet
from studies.ask.request import Request
from studies.ask.scene import EPSILON, SOLVER, Reference, Scene, SceneModel, Setting, UsageError
from studies.scenes.data import Row, reference_rows, references
from studies.scenes.element import grid_over, of_wall, on_grid, spaced_lines
from studies.scenes.faces.bodies import Bodies, Body, Placed, Side
from studies.scenes.faces.model import (
    OTHER,
    PAIRING,
    SHAPE_OF_FACES,
    SLAVE,
    SLAVES,
    FacesModel,
    Facing,
    Meeting,
    of_second,
    pairing_of,
)
from studies.scenes.faces.rigid import Floor
from studies.scenes.faces.solids import PlacedSolid, settled_for_solids
from studies.scenes.statics import loaded_shell

E, NU = 1.0, 0.3  # MPa, -
RADII = (10.0, 12.0, 14.0)  # mm: inside, between both, outside
WEDGE, HOLE = math.radians(10.0), math.radians(1.0)
QUARTER = math.pi / 2 / WEDGE
UNDER = RADII[2] / 2  # least height of what may meet the plane [mm]

TRAVELS = Setting.positive("delta_mm", (1.0, 2.0, 3.0, 4.0), "travel of the plane", 5.0, kind="floats")
BODIES = Setting.one_of("bodies", ("solids", "shells"), "solids", "what both are made of")
THROUGH = Setting("through", 2, "elements through the wall of a solid", "int", 1, 16)
COARSER = replace(SLAVE, default=SLAVES[1])  # facets of both do not fit each other, and the finer one has more of them
FILE = "half_spheres_nested.csv"
SOURCE = "middle and half width of the band of three or four codes: Abaqus, FEBio, Areias et al., Puso and Laursen"


def band() -> tuple[Reference, ...]:
    """What the digitised curves of the codes leave open."""
    found: tuple[Reference, ...] = ()
    for row in reference_rows(FILE):
        forces = [force for name, force in row.items() if name.endswith("_N") and not math.isnan(force)]
        middle, half = (max(forces) + min(forces)) / 2, (max(forces) - min(forces)) / 2
        at: Row = ({"delta_mm": row["delta_mm"], "mu": row["mu"], "law": "neo-hooke"}, {"quarter_N": middle})
        found += references("read", SOURCE, half / middle, [at])
    return found


LIMITS: dict[float, tuple[str, float, tuple[float, ...]]] = {
    0.0: (
        "solids on 80x1, with four through the wall and a quarter of the hole as well; shells on 80x1",
        5e-3,
        (0.3225, 0.7222, 1.1935, 1.7315),
    ),
    0.5: (
        "solids on 80x1 in steps of 0.25 mm, with what half of them, two elements around, four through the wall and a "
        "quarter of the hole change on 40x1; either slave, both pairings",
        1.5e-2,
        (0.336, 0.753, 1.243, 1.816, 2.425),
    ),
}


def limits() -> tuple[Reference, ...]:
    """What the finer meshes, steps and holes of solids leave open, and without friction shells."""
    found: tuple[Reference, ...] = ()
    for mu, (source, uncertainty, forces) in LIMITS.items():
        rows: list[Row] = [
            ({"delta_mm": float(i + 1), "mu": mu, "law": "neo-hooke"}, {"quarter_N": force})
            for i, force in enumerate(forces)
        ]
        found += references("refined", source, uncertainty, rows)
    return found


class HalfSpheres:
    """a1 the latitude from the rim, a2 around the axis; the inner one is the first."""

    name: str = "half-spheres"
    title: str = "Two hollow half-spheres, one in the other, under a rigid plane"
    default_mesh: tuple[int, int] = (30, 1)
    settings: tuple[Setting, ...] = (
        *(TRAVELS, BODIES, THROUGH, OTHER, PAIRING, SHAPE_OF_FACES, COARSER),
        *(EPSILON, *of_wall("3", "neo-hooke", ("3", "5", "7")), SOLVER),
    )
    references: tuple[Reference, ...] = (*band(), *limits())
    quantities: Mapping[str, str] = {
        "quarter_N": "force of the plane on a quarter of the circle",
        "between_N": "resultant of the pressures between the half-spheres on a quarter, added up without direction",
    }
    sheet: Sheet = Sheet("z", -62.0, 14.0)

    def settle(self, request: Request) -> Request:
        """Solids as for all of them."""
        return settled_for_solids(request, self.name) if request.choice("bodies") == "solids" else request

    def build(self, request: Request) -> SceneModel:
        """Symmetry on both sides of the wedge and at the rims."""
        request = replace(request, leaves=())  # cuts of one body are none of the other's: both follow the mesh
        count = request.mesh[0]
        inner, outer = _half(request, 0, count), _half(request, 1, of_second(count, request))
        own = SLAVES.index(request.choice("slave"))

        def bodies(delta: float) -> Bodies:
            above = Floor.square(2 * RADII[2], RADII[2] - delta, facing=-1)
            return Bodies((inner, outer, above))

        faces = (1, 0)
        every = np.arange(len((inner, outer)[own].face(faces[own])[0]))
        high = np.flatnonzero(outer.face(1)[0][:, 2] >= UNDER)
        between = Facing(Side(own, faces[own]), Side(1 - own, faces[1 - own]), every)
        pressed = Facing(Side(1, 1), Side(2, 1), high, smooth=True)

        def measured(delta: float, meeting: Meeting) -> dict[str, float]:
            of_pair = np.bincount(meeting.pair, meeting.force, minlength=2) * QUARTER
            return {"quarter_N": float(of_pair[1]), "between_N": float(of_pair[0])}

        pairing, deltas = pairing_of(request), request.numbers("delta_mm")
        return FacesModel(bodies, (between, pressed), pairing, deltas, measured, "delta_mm", lying=True)


def _half(request: Request, number: int, count: int) -> Body:
    if request.mesh[1] > 4:
        raise UsageError(f"mesh {request.mesh_text}: the second number is of a wedge of 10 degrees, at most 4")
    inside, outside = RADII[number : number + 2]
    laminate = Laminate.single(Ply.isotropic(E, NU, outside - inside))
    middle = sphere((inside + outside) / 2)
    up, around = spaced_lines(0.0, math.pi / 2 - HOLE, count), spaced_lines(0.0, WEDGE, request.mesh[1])
    if request.choice("bodies") == "shells":
        edges = ("symmetric", "free", "symmetric", "symmetric")
        return Placed(loaded_shell(on_grid(request, middle, grid_over(request, up, around), laminate, edges), request))
    mesh = SolidMesh.build(middle, up, around, laminate, per_ply=int(request.number("through")))
    fixed = np.zeros((len(mesh.x), 3), bool)
    fixed[mesh.on(0, 0.0), 2] = True
    fixed[mesh.on(0, up[-1]), 0] = True
    fixed[np.concatenate([mesh.on(1, 0.0), mesh.on(1, WEDGE)]), 1] = True
    back = mesh.inner if number == 1 else None
    law = LAWS[str(request.settings.get("law", LINEAR))]
    turned = mesh.parameter[:, 1]
    try:
        return PlacedSolid(TiedSolid.build(mesh, laminate, fixed, mesh.outer, back=back, turned=turned, law=law))
    except ValueError as error:
        raise UsageError(f"mesh {request.mesh_text}: {error}") from None


SCENES: tuple[Scene, ...] = (HalfSpheres(),)
