"""Hemisphere with an 18 degree hole under four radial point loads: Sze, Liu, Lo (2004), section 3.4."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from formulations.geometry.grid import Grid
from formulations.geometry.surfaces import sphere
from formulations.section.laminate import Laminate, Ply
from formulations.shell import ShellModel
from studies.request import Request
from studies.scene import SOLVER, Reference, SceneModel, Setting
from studies.scenes.data import read_reference
from studies.scenes.element import ELEMENT, discretise
from studies.scenes.statics import LOAD_FRACTIONS, StaticModel, loaded_shell

E, NU, RADIUS, H = 6.825e7, 0.3, 10.0, 0.04  # MPa, -, mm, mm
HOLE = np.deg2rad(18.0)
P_MAX = 400.0  # N per point of the whole hemisphere; two quarters share each point


def _references() -> tuple[Reference, ...]:
    table = read_reference("sze2004_3.4_hemisphere_18deg_hole.csv").to_numpy()[1:]
    source = "Sze, Liu, Lo, Finite Elem. Anal. Des. 40 (2004) 1551, sect. 3.4 (S4R)"
    return tuple(
        Reference(quantity, float(value), {"load_fraction": float(row[0])}, "read", source, 2e-3)
        for row in table
        for quantity, value in (("outward_mm", row[1]), ("inward_mm", row[2]))
    )


@dataclass(frozen=True)
class Hemisphere:
    """A quarter with two symmetry planes; the hole and the equator are free."""

    name: str = "hemisphere"
    title: str = "Hemisphere with an 18 degree hole (Sze 3.4)"
    default_mesh: tuple[int, int] = (16, 16)
    settings: tuple[Setting, ...] = (LOAD_FRACTIONS, *ELEMENT, SOLVER)
    references: tuple[Reference, ...] = _references()

    def build(self, request: Request) -> SceneModel:
        """Outward pull at a2 = 0, inward push at a2 = 90 degrees, half on each face."""
        n1, n2 = request.mesh
        right = np.pi / 2
        grid = Grid.tensor(np.linspace(0, right - HOLE, n1 + 1), np.linspace(0, right, n2 + 1))
        fixed = np.zeros((grid.n_nodes, 6), bool)
        for plane in (0.0, right):
            fixed[grid.on_line(1, plane), 2:4] = True
        pulled, pushed = grid.node_at(0.0, 0.0), grid.node_at(0.0, right)
        fixed[pulled, 0] = True  # the rigid motion along the axis, and nothing else
        laminate = Laminate.single(Ply.isotropic(E, NU, H))
        discretisation = discretise(request, sphere(RADIUS), grid, laminate, fixed)
        forces = np.zeros((grid.n_nodes, 6))
        forces[pulled, 4:] = 0.5 * P_MAX / 2
        forces[pushed, 4:] = -0.5 * P_MAX / 2
        shell = loaded_shell(discretisation, request, forces=forces)

        def under_loads(shell: ShellModel, u: np.ndarray) -> dict[str, float]:
            v = discretisation.expand(u)
            return {"outward_mm": float(v[pulled, 4:].mean()), "inward_mm": float(-v[pushed, 4:].mean())}

        return StaticModel(shell, request.numbers("load_fraction"), under_loads)
