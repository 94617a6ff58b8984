"""Hyperbolic paraboloid z = x^2 - y^2 over a square, clamped along one edge, under its weight: it bends and locks.

The thinner, the more of the energy is bending; nothing but inextensional bending is left in the end. Values are those
of elements of order four, as read in FinEtoolsFlexStructures, in m and Pa there: all consistent units are alike.
Source: Bathe, Iosilevich, Chapelle, Comput. Struct. 75 (2000) 1-30, table 2.
"""

import numpy as np

from formulations.conditions.boundary import Supports
from formulations.geometry.grid import Grid
from formulations.section.laminate import Ply
from formulations.shell import ShellModel
from studies.ask.scene import Reference, Request, SceneModel, Setting, Sheet
from studies.scenes.benchmarks.quads import SETTINGS, MappedShell, OnQuads
from studies.scenes.data import reference_rows
from studies.scenes.element import centred_laminate
from studies.scenes.statics import StaticModel, area_load

E, NU, SIDE, WEIGHT = 2e11, 0.3, 1.0, 8000.0  # MPa, -, mm, N/mm^3: per volume, so that p = WEIGHT h
DOWN = np.array([0.0, 0.0, -1.0])
SOURCE = "Bathe, Iosilevich, Chapelle (2000), table 2, in FinEtoolsFlexStructures"
COLUMNS = {"tip_deflection_mm": "displacement[m]", "strain_energy": "strain_energy[N m]"}


def paraboloid(s: np.ndarray, t: np.ndarray) -> np.ndarray:
    """x = s - 1/2, y = t/2: the half y >= 0."""
    x, y = SIDE * (s - 0.5), 0.5 * SIDE * t
    return np.stack([x, y, (x**2 - y**2) / SIDE], axis=-1)


def _references() -> tuple[Reference, ...]:
    rows = reference_rows("hypar_partly_clamped_bathe2000.csv")
    return tuple(
        Reference(name, row[column], {"t_over_L": row["t_over_L[-]"], "measure": "linear"}, "read", SOURCE, 0.01)
        for row in rows
        for name, column in COLUMNS.items()
    )


def _supports(free: Supports, square: Grid) -> Supports:
    """Clamped at x = -1/2, symmetric about y = 0."""
    return free.clamped(square.on_line(0, 0.0)).symmetric(square.on_line(1, 0.0), 1)


class Hypar(OnQuads):
    """The half y >= 0 with a plane of symmetry at y = 0: s along x from the clamp, t along y."""

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
        """The weight on the area of the middle surface, half on each face."""
        h = request.number("t_over_L") * SIDE
        shell = MappedShell.of(
            request,
            paraboloid,
            centred_laminate(request, Ply.isotropic(E, NU, h)),
            _supports,
            (True, True, False, True),
        )
        weight = area_load(shell.body, lambda a1, a2: WEIGHT * h * DOWN)
        tip = shell.square.node_at(1.0, 0.0)

        def read(model: ShellModel, u: np.ndarray) -> dict[str, float]:
            work = float(np.sum(weight * shell.body.expand(u)))  # of a half: half of the work on the whole
            return {"tip_deflection_mm": float(DOWN @ shell.mean_motion(u, tip)), "strain_energy": work}

        return StaticModel.of(request, shell.body, read, forces=weight)


SCENES = (Hypar(),)
