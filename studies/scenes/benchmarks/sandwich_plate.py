"""NAFEMS R0031/3: a simply supported sandwich plate under uniform pressure; lengths in inches and stresses in psi.

They are read as mm and MPa. The printed values are those of the theory of sandwiches, whose faces are membranes: they
belong into the middle of the lower face, its shear to the middle of the quarter, as a vendor says; at its outer side
elasticity has 5 % more. The core has no stiffness in its plane but for 1e-6 of that of the faces, without which it is
no material, and along the normal that of the faces, ten times of which changes the deflection by 2e-6 and stresses by
less: the printed values neglect how much it gets thinner. Two faces have one shear strain for the soft core and the
stiff faces: they are too stiff by far.
"""

import numpy as np

from formulations.geometry.surfaces import Plate
from formulations.section.laminate import Laminate, Ply
from formulations.section.sampling import SURFACES
from formulations.shell import ShellModel
from studies.ask.scene import SOLVER, Declared, Reference, Request, SceneModel
from studies.scenes.data import references
from studies.scenes.element import of_wall, patch
from studies.scenes.statics import LOAD_FRACTION, StaticModel, area_load, elements_at

SIDE, PRESSURE = 10.0, 100.0  # mm, MPa
FACE = Ply(1e7, 4e6, 1.875e6, 1.875e6, 0.3, 0.3, 0.0, 0.028)  # across the wall as along y, which is not printed
CORE = Ply(10.0, 10.0, 10.0, 1.2e4, 0.0, 0.0, 0.0, 0.75, E_N=1e7, G_LN=3e4)
PRINTED = {"w_mm": -0.123, "sigma_x_MPa": 34449.0, "sigma_y_MPa": 13390.0, "tau_xy_MPa": -5067.5}
EXACT = {"w_mm": -0.122108, "sigma_x_MPa": 34332.5, "sigma_y_MPa": 13414.1, "tau_xy_MPa": -5078.38}


def _references() -> tuple[Reference, ...]:
    nafems = "NAFEMS R0031 (1995), test 3, in vendors' verification manuals"
    series = "elasticity of the layers, a double Fourier series"
    at = {"measure": "linear"}
    return references("read", nafems, 1e-2, [(at, PRINTED)]) + references("computed", series, 1e-4, [(at, EXACT)])


class SandwichPlate(Declared):
    """A quarter: a1 = x and a2 = y from the supports to the middle; the pressure pushes on the outer face along -z."""

    name = "sandwich-plate"
    title = "Simply supported sandwich plate under pressure (NAFEMS R0031/3)"
    default_mesh = (16, 16)
    settings = (LOAD_FRACTION, *of_wall("2/ply", "svk", SURFACES), SOLVER)
    references = _references()
    quantities = {
        "w_mm": "deflection of the middle surface in the middle of the plate",
        "sigma_x_MPa": "stress along x in the middle of the lower face, in the middle of the plate",
        "sigma_y_MPa": "stress along y there",
        "tau_xy_MPa": "shear stress in the middle of the lower face, at a quarter of the plate from both supports",
    }

    def build(self, request: Request) -> SceneModel:
        """The supports hold the edge's own plane."""
        laminate = Laminate((FACE, CORE, FACE), -FACE.thickness - CORE.thickness / 2)
        edges = ("hard-diaphragm", "symmetric", "hard-diaphragm", "symmetric")
        quarter = patch(request, Plate(), (0.0, SIDE / 2), (0.0, SIDE / 2), laminate, edges)
        down = np.array([0.0, 0.0, -PRESSURE])
        return StaticModel.of(request, quarter, _read, forces=area_load(quarter, lambda x, y: down, shares=(0.0, 1.0)))


def _read(shell: ShellModel, u: np.ndarray) -> dict[str, float]:
    """Means over the elements that hold the place."""
    grid, lower_face = shell.discretisation.grid, shell.ply_stresses(u)[:, 0].mean(axis=1)
    at_middle, at_quarter = (lower_face[elements_at(grid, x, x)].mean(axis=0) for x in (SIDE / 2, SIDE / 4))
    w = shell.discretisation.at_distance(u, 0.0)[grid.node_at(SIDE / 2, SIDE / 2), 2]
    values = (w, at_middle[0], at_middle[1], at_quarter[2])
    return dict(zip(PRINTED, map(float, values), strict=True))


SCENES = (SandwichPlate(),)
