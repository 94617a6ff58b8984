"""Two thin tubes that cross at right angles, pressed on each other: the contact begins as a point.

The axis of the first tube is along y, that of the second, above, along x. The model has half of the length and half of
the circumference of each, between two planes of symmetry; the diaphragms at the ends of both approach by delta. Of
tubes in many layers that cross in turn it has a quarter of the circumference, and the planes of the axes approach by
delta.

Under small forces each wall deflects as under a point force; for thin shells that is the classic pinched cylinder. In a
shell with shear the deflection under a point grows without limit, by the logarithm of the element size. So does the
approach of the faces, until the contact is as wide as the wall is thick. With ``shear_correction`` 1000 the middle of
the wall has a limit. From a delta of about the wall thickness on, the contact opens at the crossing and becomes a ring.
Equal tubes of the default sizes share delta equally up to 5 mm. Beyond, one dents more than the other; differences of
mesh and slave decide which.

Grid lines get closer towards the crossing like a sine. Where a node touches, the gap averaged around it is still open
by the square of the element size: with mortar there is no contact before delta reaches that.
"""

import numpy as np

from formulations.geometry.surfaces import cylinder
from formulations.section.laminate import Ply
from formulations.shell import ShellModel
from studies.ask.declarations import CONTACT, Ladder, Sheet, meshes
from studies.ask.scene import EPSILON, Declared, Reference, Request, SceneModel, Setting, UsageError
from studies.scenes.closed_forms.pinched_tube import pinched_tube
from studies.scenes.data import Row, references
from studies.scenes.element import centred_laminate, grid_over, on_grid, spaced_lines
from studies.scenes.faces.bodies import Bodies, Placed, Side
from studies.scenes.faces.model import PAIRED, FacesModel, Facing, Meeting, of_second, uncut
from studies.scenes.statics import SHELL_SETTINGS, loaded_shell

RADIUS, LENGTH, H, E, NU = 100.0, 100.0, 1.0, 2e5, 0.3  # mm, mm (half of it), mm, MPa, -
NEAR = 0.7  # of a radius or half a length, beyond which the other wall is not met
UPRIGHT = np.array([[0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]])  # a1 along y, a2 = 0 on top, from there to x
ACROSS = np.array([[0.0, 1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, -1.0]])  # half a turn about x = y, z = 0
POINT = 0.1  # mm: a travel at which one node touches, or a few beside each other
QUARTERS = 4

TRAVELS = Setting.positive("delta_mm", (0.25, 0.5, 1.0), "approach of the tubes", 50.0, kind="floats")
LAYERS = Setting.one_of("layers", ("two", "many"), "two", "two tubes, or many that cross in turn, above each other")
ENDS = Setting.one_of("ends", ("diaphragm", "free"), "diaphragm", "ends of the tubes; free needs layers=many")
LINES = Setting.one_of("lines", ("even", "crossing"), "crossing", "grid lines: even, or closer towards the crossing")


def _size(key: str, default: float, meaning: str, low: float, high: float) -> tuple[Setting, Setting]:
    return (
        Setting(key, default, f"{meaning} of the first tube", low=low, high=high),
        Setting(f"other_{key}", default, f"{meaning} of the second tube", low=low, high=high),
    )


RADII = _size("radius_mm", RADIUS, "radius of the middle surface", 1.0, 1e4)
LENGTHS = _size("half_length_mm", LENGTH, "half of the length", 1.0, 1e5)
WALLS = _size("h_mm", H, "thickness", 1e-3, 1e3)
MODULI = _size("E_MPa", E, "Young's modulus", 1e-3, 1e12)
POISSON = Setting("nu", NU, "Poisson's ratio of both", low=0.0, high=0.499)
SIZES, DEFAULTS = (RADII, LENGTHS, WALLS, MODULI), (RADIUS, LENGTH, H, E)
SOURCE = "thin tube between diaphragms under a force at a point, by a double Fourier series"


def of_a_point(layers: str) -> float:
    """E h w/F of a wall of the default sizes, thin and without shear, of which F pushes a point in by w."""
    return pinched_tube(RADIUS, H, 2 * LENGTH, NU, 1 + (layers == "many"))


def _references() -> tuple[Reference, ...]:
    held: dict[str, float | str] = {
        each.key: value for both, value in zip(SIZES, DEFAULTS, strict=True) for each in both
    }
    at = {**held, "ends": "diaphragm", "nu": NU, "measure": "linear", "shear_correction": 1000.0, "delta_mm": POINT}
    rows: list[Row] = [({**at, "layers": layers}, {"dent_Eh_over_F": of_a_point(layers)}) for layers in LAYERS.choices]
    return references("exact", SOURCE, 1e-3, rows)


class CrossedTubes(Declared):
    """a1 from the crossing along the axis of each tube, a2 from the crossing around it."""

    name = "crossed-tubes"
    title = "Two crossing tubes pressed on each other"
    default_mesh = (16, 24)
    settings = (
        *(TRAVELS, LAYERS, ENDS, *RADII, *LENGTHS, *WALLS, *MODULI, POISSON),
        *(*PAIRED, LINES, EPSILON),
        *SHELL_SETTINGS,
    )
    references = _references()
    quantities = {
        "force_N": "force between the tubes, along the normal of both axes",
        "dent_mm": "of the first tube at the crossing, in the middle of its wall",
        "other_dent_mm": "of the second tube",
        "dent_Eh_over_F": "that of the first tube times its E h over the force; 0 without one",
        "spread_along_mm": "mean distance of the nodal forces from the crossing along the axis of the first tube",
        "spread_across_mm": "the same along the axis of the second tube",
    }
    ladders = (Ladder(CONTACT, meshes(8, 12, 3), ("force_N", "dent_mm"), settings={"delta_mm": "1"}, coarser=("4x6",)),)
    sheet = Sheet("z", 35.0, 30.0, settings={"delta_mm": "4"})

    def build(self, request: Request) -> SceneModel:
        """Each tube has two planes of symmetry, and a third with many layers."""
        request = uncut(request)
        _check(request)
        radii, lengths, walls = ([request.number(each.key) for each in of_both] for of_both in SIZES[:3])
        counts = request.mesh, tuple(of_second(n, request) for n in request.mesh)
        tubes = [_tube(request, number, mesh) for number, mesh in enumerate(counts)]
        grids = [tube.discretisation.grid for tube in tubes]

        def bodies(delta: float) -> Bodies:
            apart = np.array([0.0, 0.0, sum(radii) + sum(walls) / 2 - delta])
            return Bodies((Placed(tubes[0], UPRIGHT), Placed(tubes[1], ACROSS @ UPRIGHT, apart)))

        def before(number: int) -> np.ndarray:
            """The nodes of a tube which the other one is before."""
            along, around = grids[number].nodes.T
            aside = radii[number] * np.sin(np.minimum(around, np.pi / 2))
            far = min(radii[1 - number], lengths[number]), min(radii[number], lengths[1 - number])
            return np.flatnonzero((along <= NEAR * far[0]) & (aside <= NEAR * far[1]))

        def measured(delta: float, meeting: Meeting) -> dict[str, float]:
            each = zip(tubes, grids, np.split(meeting.u, [tubes[0].discretisation.n_free]), strict=True)
            tops = [tube.discretisation.at_distance(u, 0.0)[grid.node_at(0, 0), 2] for tube, grid, u in each]
            dents = [0.0 - float(top) for top in tops]
            force, total = QUARTERS * abs(float(meeting.resultant[0, 2])), float(meeting.force.sum())
            soft = dents[0] * request.number("E_MPa") * walls[0] / force if force else 0.0
            x, y = meeting.force @ np.abs(meeting.position[:, :2]) / total if total else (0.0, 0.0)
            read = force, *dents, soft, float(y), float(x)
            return dict(zip(self.quantities, read, strict=True))

        patches = [np.flatnonzero(np.isin(grid.elements, before(k)).any(axis=1)) for k, grid in enumerate(grids)]
        sides = [(Side(k, 1, patch), before(k)) for k, patch in enumerate(patches)]
        return FacesModel.of(request, bodies, [Facing.between(request, *sides)], measured)


def _check(request: Request) -> None:
    if (request.choice("layers"), request.choice("ends")) == ("two", "free"):
        raise UsageError("ends = free: two tubes would not be held; it needs layers=many")
    for radius, h in zip(RADII, WALLS, strict=True):
        if request.number(h.key) >= request.number(radius.key):
            most = f"below {radius.key} = {request.number(radius.key):g}"
            raise UsageError(f"{h.key} = {request.number(h.key):g} must be {most}")


def _tube(request: Request, number: int, mesh: tuple[int, ...]) -> ShellModel:
    radius, length, h, young = (request.number(of_both[number].key) for of_both in SIZES)
    laminate = centred_laminate(request, Ply.isotropic(young, request.number("nu"), h))
    closer, turn = request.choice("lines") == "crossing", np.pi / (1 + (request.choice("layers") == "many"))
    along, around = (spaced_lines(0.0, end, n, closer) for end, n in zip((length, turn), mesh, strict=True))
    edges = ("symmetric", request.choice("ends"), "symmetric", "symmetric")
    return loaded_shell(on_grid(request, cylinder(radius), grid_over(request, along, around), laminate, edges), request)


SCENES = (CrossedTubes(),)
