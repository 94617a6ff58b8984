"""NAFEMS R0031/1: a strip of seven cross-plies [0/90/0/90/0/90/0] in three-point bending.

The printed values are those of a beam of layers: M E h/(2 D), T S/D and P L^3/(48 D) with the shear's part, of the
moduli along the strip alone. They are met to their last digit with a span of 30 mm, plies of 0.1 mm and one of 0.4 mm
in the middle, and 10 N/mm across the strip. In elasticity the line load on the upper face is felt below, too: there the
stress is 2.4 % larger, in a wall of two faces 1 %. Between sides that do not move across the strip it is in plane
strain, and a series gives all. The ends that hang over the supports carry nothing and are left out.
"""

import numpy as np

from formulations.conditions.boundary import Supports
from formulations.geometry.surfaces import Plate
from formulations.section.laminate import Laminate, Ply
from formulations.section.sampling import SURFACES
from formulations.shell import ShellModel
from formulations.wall_stresses import S13, WallStresses
from studies.ask.scene import SOLVER, Declared, Reference, Request, SceneModel, Setting, UsageError
from studies.scenes.data import references
from studies.scenes.element import discretise, even_grid, of_wall
from studies.scenes.statics import LOAD_FRACTION, StaticModel, edge_shares

SPAN, WIDTH, LINE_LOAD = 30.0, 10.0, 10.0  # mm, mm, N/mm
ANGLES = (0, 90, 0, 90, 0, 90, 0)
THICKNESSES = (0.1, 0.1, 0.1, 0.4, 0.1, 0.1, 0.1)  # mm
PLIES = tuple(
    Ply(1e5, 5e3, 3e3, 2e3, 0.4, 0.4, np.radians(angle), h)  # nu_TT is not printed: nu_LT
    for angle, h in zip(ANGLES, THICKNESSES, strict=True)
)
SIDES = {"free": "free", "held": "symmetric"}
PRINTED = {"sigma_MPa": 683.9, "tau_MPa": -4.1, "tau_equilibrium_MPa": -4.1, "w_mm": -1.06}
# of a beam, and of two digits
KNOWN_TO = {"sigma_MPa": 0.025, "tau_MPa": 0.012, "tau_equilibrium_MPa": 0.012, "w_mm": 0.006}
IN_PLANE_STRAIN = {"sigma_MPa": 700.117, "tau_MPa": -4.10335, "tau_equilibrium_MPa": -4.10335, "w_mm": -1.054242}


def _references() -> tuple[Reference, ...]:
    nafems = "NAFEMS R0031 (1995), test 1, in a vendor's verification manual; its dimensions are recalled"
    series = "Pagano's elasticity in plane strain, a Fourier series of the line load"
    return references("read", nafems, KNOWN_TO, [({"sides": "free", "measure": "linear"}, PRINTED)]) + references(
        "computed", series, 1e-4, [({"sides": "held", "measure": "linear"}, IN_PLANE_STRAIN)]
    )


class LaminatedStrip(Declared):
    """A quarter: a1 from a support to the load, a2 from the middle of the strip to a side; the load pushes along -z."""

    name = "laminated-strip"
    title = "Laminated strip in three-point bending (NAFEMS R0031/1)"
    default_mesh = (40, 2)
    settings = (
        LOAD_FRACTION,
        Setting.one_of("sides", SIDES, "free", "of the strip: free, or without motion across it"),
        *of_wall("3/ply", "svk", SURFACES),
        SOLVER,
    )
    references = _references()
    quantities = {
        "sigma_MPa": "stress along the strip under the load on the lower face, from the two elements before it",
        "tau_MPa": "shear stress between the lowest two plies, midway from the support to the load",
        "tau_equilibrium_MPa": "the same by equilibrium",
        "w_mm": "deflection of the lower face under the load",
    }

    def build(self, request: Request) -> SceneModel:
        """The support holds the whole wall, the load is on the upper face."""
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
        return StaticModel.of(request, quarter, _read, forces=forces)


def _read(shell: ShellModel, u: np.ndarray) -> dict[str, float]:
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


SCENES = (LaminatedStrip(),)
