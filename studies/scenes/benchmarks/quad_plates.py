"""A rhombus and a hyperbolic paraboloid on quadrilaterals."""

import numpy as np

from formulations.conditions.boundary import Supports
from formulations.geometry.grid import Grid
from formulations.section.laminate import Ply
from formulations.shell import ShellModel
from studies.ask.scene import Reference, Request, SceneModel, Setting, Sheet, UsageError
from studies.scenes.benchmarks.quads import SETTINGS, MappedShell, OnQuads
from studies.scenes.data import reference_rows
from studies.scenes.element import centred_laminate
from studies.scenes.statics import StaticModel, area_load

E, NU, SIDE, ANGLE, PRESSURE = 1e7, 0.3, 100.0, np.pi / 6, 1.0  # MPa, -, mm, rad, MPa
SOURCE = "plate with shear, quadrilaterals of order 6 and 7 of scikit-fem, graded towards the edges"
KNOWN = {100.0: 0.42413, 1000.0: 0.41409}  # by a/h


def rhombus(s: np.ndarray, t: np.ndarray) -> np.ndarray:
    """Both sides are 100 mm long, with 30 degrees between them."""
    x = SIDE * (s + t * np.cos(ANGLE))
    return np.stack([x, SIDE * t * np.sin(ANGLE), np.zeros_like(x)], axis=-1)


def _supports(free: Supports, square: Grid) -> Supports:
    """No deflection of the middle on any edge; three more motions are held, in the plane, at two corners."""
    edges = np.unique(np.concatenate([square.on_line(axis, end) for axis in (0, 1) for end in (0.0, 1.0)]))
    held = free.hinged(edges, (2,))
    return held.hinged(np.array([square.node_at(0.0, 0.0)]), (0, 1)).hinged(np.array([square.node_at(1.0, 0.0)]), (1,))


class MorleySkewPlate(OnQuads):
    """Morley's skew plate: a rhombus with angles of 30 and 150 degrees, simply supported, under a uniform pressure.

    The moments are singular at the obtuse corners, so all elements converge slowly. Morley's series for the thin plate
    is quoted with 0.408 for 1000 D w/(p a^4). The edges here hold only the deflection, and a plate with shear then
    deflects more, by about (h/a)^0.42: 4.0 % at a/h = 100, 1.5 % at 1000. No shell with this support can reach 0.408
    there. Source: Morley, Skew plates and structures (1963), whose pages were not seen.

    The whole rhombus: s along x, t at 30 degrees to it.
    """

    name = "morley-skew-plate"
    title = "Morley's skew plate under pressure, simply supported"
    default_mesh = (32, 32)
    settings = (
        Setting("a_over_h", 1000.0, "side over thickness", low=10.0, high=1e4),
        *SETTINGS,
    )
    references = tuple(
        Reference("w_bar", value, {"a_over_h": ratio, "measure": "linear"}, "computed", SOURCE, 0.001)
        for ratio, value in KNOWN.items()
    )
    quantities = {"w_bar": "1000 D w/(p a^4) in the middle, D = E h^3/(12 (1 - nu^2))"}
    sheet = Sheet(azimuth=-60.0, elevation=30.0, listed=False)

    def build(self, request: Request) -> SceneModel:
        """Half of the pressure acts on each face; it is so small that the deflection is 1/1000 of the thickness.

        Raises UsageError for odd numbers of elements, which have no node in the middle.
        """
        if any(n % 2 for n in request.mesh):
            raise UsageError(f"mesh {request.mesh[0]}x{request.mesh[1]} must have even numbers: a node in the middle")
        h = SIDE / request.number("a_over_h")
        plate = MappedShell.of(
            request, rhombus, centred_laminate(request, Ply.isotropic(E, NU, h)), _supports, (True,) * 4
        )
        flexural = E * h**3 / (12 * (1 - NU**2))
        pressure = PRESSURE * h**4 * E / SIDE**4
        n1, n2 = request.mesh
        middle = (n1 // 2) * (n2 + 1) + n2 // 2
        w_one = pressure * SIDE**4 / (1000 * flexural)

        def read(model: ShellModel, u: np.ndarray) -> dict[str, float]:
            return {"w_bar": float(plate.mean_motion(u, middle)[2] / w_one)}

        load = area_load(plate.body, lambda a1, a2: np.array([0.0, 0.0, pressure]))
        return StaticModel.of(request, plate.body, read, forces=load)


DOWN = np.array([0.0, 0.0, -1.0])
BATHE = "Bathe, Iosilevich, Chapelle (2000), table 2, in FinEtoolsFlexStructures"
COLUMNS = {"tip_deflection_mm": "displacement[m]", "strain_energy": "strain_energy[N m]"}


def paraboloid(s: np.ndarray, t: np.ndarray) -> np.ndarray:
    """x = s - 1/2, y = t/2: the half y >= 0."""
    x, y = Hypar.SIDE * (s - 0.5), 0.5 * Hypar.SIDE * t
    return np.stack([x, y, (x**2 - y**2) / Hypar.SIDE], axis=-1)


def _references() -> tuple[Reference, ...]:
    rows = reference_rows("hypar_partly_clamped_bathe2000.csv")
    return tuple(
        Reference(name, row[column], {"t_over_L": row["t_over_L[-]"], "measure": "linear"}, "read", BATHE, 0.01)
        for row in rows
        for name, column in COLUMNS.items()
    )


def _clamped(free: Supports, square: Grid) -> Supports:
    """Clamped at x = -1/2, symmetric about y = 0."""
    return free.clamped(square.on_line(0, 0.0)).symmetric(square.on_line(1, 0.0), 1)


class Hypar(OnQuads):
    """Hyperbolic paraboloid z = x^2 - y^2 over a square, clamped along one edge, under its weight: it bends and locks.

    The thinner the shell, the larger the share of bending in its energy; the limit is purely inextensional bending. The
    values are those of elements of order four, as read in FinEtoolsFlexStructures, given there in m and Pa; any
    consistent units are equivalent. Source: Bathe, Iosilevich, Chapelle, Comput. Struct. 75 (2000) 1-30, table 2.

    The half y >= 0 with a plane of symmetry at y = 0: s along x from the clamp, t along y.
    """

    E, NU, SIDE, WEIGHT = 2e11, 0.3, 1.0, 8000.0  # MPa, -, mm, N/mm^3: per volume, so that p = WEIGHT h

    name = "hypar"
    title = "Hyperbolic paraboloid clamped along one edge, under its weight (Bathe, Iosilevich, Chapelle)"
    default_mesh = (48, 24)
    settings = (
        Setting("t_over_L", 0.01, "thickness over the side of the square", low=1e-5, high=0.1),
        *SETTINGS,
    )
    references = _references()
    quantities = {
        "tip_deflection_mm": "downwards in the middle of the free edge x = 1/2",
        "strain_energy": "half of the work of the weight on the whole shell [N mm], the strain energy if it is linear",
    }
    sheet = Sheet(azimuth=-60.0, elevation=30.0, listed=False)

    def build(self, request: Request) -> SceneModel:
        """The weight acts on the area of the middle surface, half on each face."""
        h = request.number("t_over_L") * self.SIDE
        shell = MappedShell.of(
            request,
            paraboloid,
            centred_laminate(request, Ply.isotropic(self.E, self.NU, h)),
            _clamped,
            (True, True, False, True),
        )
        weight = area_load(shell.body, lambda a1, a2: self.WEIGHT * h * DOWN)
        tip = shell.square.node_at(1.0, 0.0)

        def read(model: ShellModel, u: np.ndarray) -> dict[str, float]:
            work = float(np.sum(weight * shell.body.expand(u)))  # of a half: half of the work on the whole
            return {"tip_deflection_mm": float(DOWN @ shell.mean_motion(u, tip)), "strain_energy": work}

        return StaticModel.of(request, shell.body, read, forces=weight)


SCENES = (
    Hypar(),
    MorleySkewPlate(),
)
