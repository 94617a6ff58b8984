"""Two hollow half-spheres, one in the other, pressed down by a rigid plane: a wedge of both about the axis.

A benchmark of mortar methods (Puso, Laursen, CMAME 193 (2004) 601-629), with the data of a public version that has the
curves of four codes (solids4foam/solid-benchmarks, hyperElasticity/compressedSpheres): radii of 10, 12 and 14 mm, E = 1
MPa, nu = 0.3, a compressible neo-Hookean material, rims on a plane without friction, and the force on a quarter of the
whole. Both walls are solids, or shells with h/R = 0.18 and 0.15. The wedge is narrow enough for one element around to
represent an arc: with 10 degrees forces are 0.7 % too low. A hole about the axis, 0.1 degrees from the pole to its rim,
keeps elements from meeting in a point; the rims of solids there move only along the axis. A hole of one degree is worth
1 % of the force at 1 mm, and 0.3 % at 5 mm.
The codes agree up to about 5 mm, where without friction the inner one snaps through.

With friction the forces are within the band of three codes up to 5 mm, on all meshes, with both pairings and either
slave: 3 to 9 % above one code, and 4 to 10 % below two that agree, as without friction. The curve of the benchmark's
own code (about 4000 cells) is 1 to 4 % above.
Faces are curved. With facets, the inner one folds along their edges as the pole is pressed in. A point at rest in a
fold is pushed by either facet in turn, until the step is cut (80x1 in steps of 0.125 mm, at 3.25 mm). With
pairing=nodes, which does not average, the path stops there (80x1 in steps of 0.25 mm, before 2 mm).
Shells are unstable from 0.5 mm on: in a short wave at the pole the pressed face of either moves along the meridian, in
alternate directions from grid line to grid line. Solids are stable.
"""

import math
from dataclasses import replace

import numpy as np

from formulations.geometry.surfaces import sphere
from formulations.section.laminate import LAWS, LINEAR, Laminate, Ply
from formulations.solid_mesh import SolidMesh
from studies.ask.scene import EPSILON, SOLVER, Reference, Request, SceneModel, Setting, Sheet, UsageError
from studies.scenes.data import Row, reference_rows, references
from studies.scenes.element import grid_over, of_wall, on_grid, spaced_lines
from studies.scenes.faces.bodies import Bodies, Body, Placed, Side
from studies.scenes.faces.model import FacesModel, Facing, Meeting, of_second, paired, uncut
from studies.scenes.faces.rigid import Floor
from studies.scenes.faces.solids import tied
from studies.scenes.solids import OfSolids
from studies.scenes.statics import loaded_shell

E, NU = 1.0, 0.3  # MPa, -
RADII = (10.0, 12.0, 14.0)  # mm: inside, between both, outside
WEDGE, HOLE = math.radians(2.5), math.radians(0.1)
QUARTER = math.pi / 2 / WEDGE
UNDER = RADII[2] / 2  # least height of what may meet the plane [mm]

TRAVELS = Setting.positive("delta_mm", (1.0, 2.0, 3.0, 4.0), "travel of the plane", 5.0, kind="floats")
BODIES = Setting.one_of("bodies", ("solids", "shells"), "solids", "elements of both half-spheres")
THROUGH = Setting("through", 2, "elements through the wall of a solid", "int", 1, 16)
COARSER = paired(slave="second", faces="curved")  # facets of both do not fit each other, and the finer one has more
FILE = "half_spheres_nested.csv"
SOURCE = "middle and half width of the band of three or four codes: Abaqus, FEBio, Areias et al., Puso and Laursen"


def band() -> tuple[Reference, ...]:
    """What the digitised curves of the codes leave open."""
    bands: tuple[Reference, ...] = ()
    for row in reference_rows(FILE):
        forces = [force for name, force in row.items() if name.endswith("_N") and not math.isnan(force)]
        middle, half = (max(forces) + min(forces)) / 2, (max(forces) - min(forces)) / 2
        at: Row = ({"delta_mm": row["delta_mm"], "mu": row["mu"], "law": "neo-hooke"}, {"quarter_N": middle})
        bands += references("read", SOURCE, half / middle, [at])
    return bands


LIMITS: dict[float, tuple[str, float, tuple[float, ...]]] = {
    0.0: (
        "solids on 20x1, 40x1 and 80x1, with what four through the wall change on 40x1; either slave; shells on 40x1",
        5e-3,
        (0.323, 0.7225, 1.196, 1.736),
    ),
    0.5: (
        "solids on 20x1, 40x1, 80x1 and 160x1 in steps of 0.25 mm, with what half of them changes on 80x1 and four "
        "through the wall on 40x1; either slave, both pairings",
        5e-3,
        (0.3385, 0.7535, 1.2455, 1.811, 2.418),
    ),
}


def limits() -> tuple[Reference, ...]:
    """What the finer meshes and steps of solids leave open, and without friction shells."""
    bounds: tuple[Reference, ...] = ()
    for mu, (source, uncertainty, forces) in LIMITS.items():
        rows: list[Row] = [
            ({"delta_mm": float(i + 1), "mu": mu, "law": "neo-hooke"}, {"quarter_N": force})
            for i, force in enumerate(forces)
        ]
        bounds += references("refined", source, uncertainty, rows)
    return bounds


class HalfSpheres(OfSolids):
    """a1 is the latitude from the rim, a2 the angle around the axis; the inner half-sphere is the first body."""

    name = "half-spheres"
    title = "Two hollow half-spheres, one in the other, under a rigid plane"
    default_mesh = (30, 1)
    settings = (
        *(TRAVELS, BODIES, THROUGH, *COARSER),
        *(EPSILON, *of_wall("3", "neo-hooke", ("3", "5", "7")), SOLVER),
    )
    references = (*band(), *limits())
    quantities = {
        "quarter_N": "force of the plane on a quarter of the circle",
        "between_N": "resultant of the pressures between the half-spheres on a quarter, added up without direction",
    }
    sheet = Sheet("z", -62.0, 14.0)

    def settle(self, request: Request) -> Request:
        """Solids as all of them; shells are whole."""
        return super().settle(request) if request.choice("bodies") == "solids" else replace(request, model="full")

    def build(self, request: Request) -> SceneModel:
        """Both sides of the wedge and the rims are symmetric."""
        request = uncut(request)
        count = request.mesh[0]
        inner, outer = _half(request, 0, count), _half(request, 1, of_second(count, request))

        def bodies(delta: float) -> Bodies:
            above = Floor.square(2 * RADII[2], RADII[2] - delta, facing=-1)
            return Bodies((inner, outer, above))

        high = np.flatnonzero(outer.face(1)[0][:, 2] >= UNDER)
        sides = [(Side(0, 1), np.arange(len(inner.face(1)[0]))), (Side(1, 0), np.arange(len(outer.face(0)[0])))]
        pressed = Facing(Side(1, 1), Side(2, 1), high, smooth=True)

        def measured(delta: float, meeting: Meeting) -> dict[str, float]:
            of_pair = np.bincount(meeting.pair, meeting.force, minlength=2) * QUARTER
            return {"quarter_N": float(of_pair[1]), "between_N": float(of_pair[0])}

        return FacesModel.of(request, bodies, [Facing.between(request, *sides), pressed], measured, lying=True)


def _half(request: Request, number: int, count: int) -> Body:
    if request.mesh[1] > 4:
        raise UsageError(f"mesh {request.mesh_text}: the second number is of a wedge of 2.5 degrees, at most 4")
    inside, outside = RADII[number : number + 2]
    laminate = Laminate.single(Ply.isotropic(E, NU, outside - inside))
    middle = sphere((inside + outside) / 2)
    up, around = spaced_lines(0.0, math.pi / 2 - HOLE, count), spaced_lines(0.0, WEDGE, request.mesh[1])
    if request.choice("bodies") == "shells":
        edges = ("symmetric", "free", "symmetric", "symmetric")
        return Placed(loaded_shell(on_grid(request, middle, grid_over(request, up, around), laminate, edges), request))
    mesh = SolidMesh.build(middle, up, around, laminate, per_ply=int(request.number("through")))
    fixed = mesh.supports(
        *((mesh.on(0, 0.0), 2), (mesh.on(0, up[-1]), 0)),
        *((mesh.on(1, side), 1) for side in (0.0, WEDGE)),
    )
    back, law = mesh.inner if number == 1 else None, LAWS[str(request.settings.get("law", LINEAR))]
    return tied(request, mesh, laminate, fixed, mesh.outer, back=back, turned=mesh.parameter[:, 1], law=law)


SCENES = (HalfSpheres(),)
