"""Laminated plates of NAFEMS R0031: a strip of cross-plies and a sandwich."""

import numpy as np

from formulations.conditions.boundary import Supports
from formulations.geometry.surfaces import Plate
from formulations.section.laminate import SURFACES, Laminate, Ply
from formulations.shell import ShellModel
from formulations.wall_stresses import S13, WallStresses
from studies.ask.scene import SOLVER, Declared, Reference, Request, SceneModel, Setting, UsageError
from studies.scenes.data import references
from studies.scenes.element import discretise, even_grid, of_wall, patch
from studies.scenes.statics import LOAD_FRACTION, StaticModel, area_load, edge_shares, elements_at

SPAN, WIDTH, LINE_LOAD = 30.0, 10.0, 10.0  # mm, mm, N/mm
ANGLES = (0, 90, 0, 90, 0, 90, 0)
THICKNESSES = (0.1, 0.1, 0.1, 0.4, 0.1, 0.1, 0.1)  # mm
PLIES = tuple(
    Ply(1e5, 5e3, 3e3, 2e3, 0.4, 0.4, np.radians(angle), h)  # nu_TT is not printed: nu_LT
    for angle, h in zip(ANGLES, THICKNESSES, strict=True)
)
SIDES = {"free": "free", "held": "symmetric"}
OF_BEAM = {"sigma_MPa": 683.9, "tau_MPa": -4.1, "tau_equilibrium_MPa": -4.1, "w_mm": -1.06}
# of a beam, and of two digits
KNOWN_TO = {"sigma_MPa": 0.025, "tau_MPa": 0.012, "tau_equilibrium_MPa": 0.012, "w_mm": 0.006}
IN_PLANE_STRAIN = {"sigma_MPa": 700.117, "tau_MPa": -4.10335, "tau_equilibrium_MPa": -4.10335, "w_mm": -1.054242}


def _of_strip() -> tuple[Reference, ...]:
    nafems = "NAFEMS R0031 (1995), test 1, in a vendor's verification manual; its dimensions are recalled"
    series = "Pagano's elasticity in plane strain, a Fourier series of the line load"
    return references("read", nafems, KNOWN_TO, [({"sides": "free", "measure": "linear"}, OF_BEAM)]) + references(
        "computed", series, 1e-4, [({"sides": "held", "measure": "linear"}, IN_PLANE_STRAIN)]
    )


class LaminatedStrip(Declared):
    """NAFEMS R0031/1: a strip of seven cross-plies [0/90/0/90/0/90/0] in three-point bending.

    The printed values are those of a layered beam, M E h/(2 D), T S/D and P L^3/(48 D) plus the part of shear, with the
    moduli along the strip alone. They are reproduced to the last digit with a span of 30 mm, plies of 0.1 mm with one
    of 0.4 mm in the middle, and 10 N/mm across the strip. In elasticity the line load on the upper face raises the
    stress below it on the lower face by 2.4 %, in a wall of two faces by 1 %. Between sides fixed across the strip,
    plane strain holds, and a series gives all quantities. The ends beyond the supports carry nothing and are left out.

    A quarter: a1 from a support to the load, a2 from the middle of the strip to a side; the load acts along -z.
    """

    name = "laminated-strip"
    title = "Laminated strip in three-point bending (NAFEMS R0031/1)"
    default_mesh = (40, 2)
    settings = (
        LOAD_FRACTION,
        Setting.one_of("sides", SIDES, "free", "edges of the strip: free, or held across it"),
        *of_wall("3/ply", "svk", SURFACES),
        SOLVER,
    )
    references = _of_strip()
    quantities = {
        "sigma_MPa": "stress along the strip under the load on the lower face, from the two elements before it",
        "tau_MPa": "shear stress between the lowest two plies, midway from the support to the load",
        "tau_equilibrium_MPa": "the same by equilibrium",
        "w_mm": "deflection of the lower face under the load",
    }

    def build(self, request: Request) -> SceneModel:
        """The support holds the whole wall; the load is on the upper face."""
        if request.mesh[0] < 2:
            raise UsageError(f"mesh {request.mesh_text} must have at least 2 elements along the strip")
        laminate = Laminate(PLIES, -0.5 * sum(THICKNESSES))
        grid = even_grid(request, (0.0, SPAN / 2), (0.0, WIDTH / 2))
        supports = Supports.of_edges(grid, "free", "symmetric", "symmetric", SIDES[request.choice("sides")])
        supports = supports.hold(grid.on_line(0, 0.0), (2,))
        quarter = discretise(request, Plate(), grid, laminate, *supports.masks)
        nodes, shares = edge_shares(quarter, 0, SPAN / 2)
        forces = np.zeros((grid.n_nodes, 6))
        forces[nodes, 5] = -LINE_LOAD / 2 * WIDTH / 2 * shares
        return StaticModel.of(request, quarter, _read_strip, forces=forces)


def _read_strip(shell: ShellModel, u: np.ndarray) -> dict[str, float]:
    """Along the middle of the strip."""
    grid, laminate = shell.discretisation.grid, shell.discretisation.laminate
    row = np.flatnonzero(grid.centre[:, 1] - grid.half[:, 1] == 0.0)
    row = row[np.argsort(grid.centre[row, 0])]
    x, sides = grid.centre[row, 0], shell.ply_stresses(u)[row, 0, :, 0]
    (before, last), (far, near) = sides[-2:, 0], (SPAN / 2 - x[-2:]) ** 2
    node = grid.node_at(SPAN / 2, 0.0)
    readings = {
        "sigma_MPa": float(last + (last - before) * near / (far - near)),  # of a parabola even about the load
        "w_mm": float(shell.discretisation.at_distance(u, laminate.d_minus)[node, 2]),
    }
    if shell.discretisation.wall is None:
        tau = -THICKNESSES[0] * np.gradient(sides.mean(axis=1), x)
        return readings | {"tau_equilibrium_MPa": float(np.interp(SPAN / 4, x, tau))}
    stresses = WallStresses.of(shell, u)
    between = np.isclose(stresses.d, laminate.d_minus + THICKNESSES[0])
    both = stresses.law[row][:, between, S13].mean(axis=1), stresses.equilibrium[row][:, between, 0].mean(axis=1)
    by_law, by_equilibrium = (float(np.interp(SPAN / 4, x, tau)) for tau in both)
    return readings | {"tau_MPa": by_law, "tau_equilibrium_MPa": by_equilibrium}


SIDE, PRESSURE = 10.0, 100.0  # mm, MPa
FACE = Ply(1e7, 4e6, 1.875e6, 1.875e6, 0.3, 0.3, 0.0, 0.028)  # across the wall as along y, which is not printed
CORE = Ply(10.0, 10.0, 10.0, 1.2e4, 0.0, 0.0, 0.0, 0.75, E_N=1e7, G_LN=3e4)
PRINTED = {"w_mm": -0.123, "sigma_x_MPa": 34449.0, "sigma_y_MPa": 13390.0, "tau_xy_MPa": -5067.5}
EXACT = {"w_mm": -0.122108, "sigma_x_MPa": 34332.5, "sigma_y_MPa": 13414.1, "tau_xy_MPa": -5078.38}


def _of_sandwich() -> tuple[Reference, ...]:
    nafems = "NAFEMS R0031 (1995), test 3, in vendors' verification manuals"
    series = "elasticity of the layers, a double Fourier series"
    at = {"measure": "linear"}
    return references("read", nafems, 1e-2, [(at, PRINTED)]) + references("computed", series, 1e-4, [(at, EXACT)])


class SandwichPlate(Declared):
    """NAFEMS R0031/3: a simply supported sandwich plate under uniform pressure; lengths in inches and stresses in psi.

    They are read as mm and MPa. The printed values are those of sandwich theory, whose faces are membranes. They apply
    in the middle of the lower face, the shear stress at the middle of the quarter, according to a vendor; at the outer
    side of the face elasticity gives 5 % more. In its plane the core has only 1e-6 of the stiffness of the faces,
    because a material needs some. Along the normal it has that of the faces, since the printed values neglect its
    change of thickness; ten times as much changes the deflection by 2e-6 and the stresses by less. Two faces have one
    shear strain for the soft core and the stiff faces, and are far too stiff.

    A quarter: a1 = x and a2 = y from the supports to the middle; the pressure acts on the outer face along -z.
    """

    name = "sandwich-plate"
    title = "Simply supported sandwich plate under pressure (NAFEMS R0031/3)"
    default_mesh = (16, 16)
    settings = (LOAD_FRACTION, *of_wall("2/ply", "svk", SURFACES), SOLVER)
    references = _of_sandwich()
    quantities = {
        "w_mm": "deflection of the middle surface in the middle of the plate",
        "sigma_x_MPa": "stress along x in the middle of the lower face, in the middle of the plate",
        "sigma_y_MPa": "stress along y there",
        "tau_xy_MPa": "shear stress in the middle of the lower face, at a quarter of the plate from both supports",
    }

    def build(self, request: Request) -> SceneModel:
        """The supports hold the displacements in the plane of the edge."""
        laminate = Laminate((FACE, CORE, FACE), -FACE.thickness - CORE.thickness / 2)
        edges = ("hard-diaphragm", "symmetric", "hard-diaphragm", "symmetric")
        quarter = patch(request, Plate(), (0.0, SIDE / 2), (0.0, SIDE / 2), laminate, edges)
        down = np.array([0.0, 0.0, -PRESSURE])
        return StaticModel.of(
            request, quarter, _read_sandwich, forces=area_load(quarter, lambda x, y: down, shares=(0.0, 1.0))
        )


def _read_sandwich(shell: ShellModel, u: np.ndarray) -> dict[str, float]:
    """Means over the elements that hold the place."""
    grid, lower_face = shell.discretisation.grid, shell.ply_stresses(u)[:, 0].mean(axis=1)
    at_middle, at_quarter = (lower_face[elements_at(grid, x, x)].mean(axis=0) for x in (SIDE / 2, SIDE / 4))
    w = shell.discretisation.at_distance(u, 0.0)[grid.node_at(SIDE / 2, SIDE / 2), 2]
    values = (w, at_middle[0], at_middle[1], at_quarter[2])
    return dict(zip(PRINTED, map(float, values), strict=True))


SCENES = (
    LaminatedStrip(),
    SandwichPlate(),
)
