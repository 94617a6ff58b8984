"""Slit annular plate lifted along one side of the slit: Sze, Liu, Lo (2004), section 3.3."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from formulations.geometry.grid import Grid
from formulations.geometry.surfaces import annulus
from formulations.section.laminate import Laminate, Ply
from formulations.shell import ShellModel
from studies.request import Request
from studies.scene import SOLVER, Reference, SceneModel, Setting
from studies.scenes.data import read_reference
from studies.scenes.element import ELEMENT, discretise
from studies.scenes.statics import LOAD_FRACTIONS, StaticModel, edge_shares, loaded_shell

E, INNER, OUTER, H = 21e6, 6.0, 10.0, 0.03  # MPa, mm, mm, mm; nu = 0
P_MAX = 0.8  # N/mm along the free side of the slit, across the plate, dead


def _references() -> tuple[Reference, ...]:
    table = read_reference("sze2004_3.3_slit_annular_plate.csv").to_numpy()[1:]
    source = "Sze, Liu, Lo, Finite Elem. Anal. Des. 40 (2004) 1551, sect. 3.3 (S4R, 10x80)"
    return tuple(
        Reference(quantity, float(value), {"load_fraction": float(row[0])}, "read", source, 5e-3)
        for row in table
        for quantity, value in (("w_A_mm", row[1]), ("w_B_mm", row[2]))
    )


@dataclass(frozen=True)
class SlitAnnulus:
    """The whole turn: a2 = 0 is loaded, a2 = 360 degrees clamped; A is the inner, B the outer corner of the load."""

    name: str = "sze-annulus"
    title: str = "Slit annular plate lifted at the slit (Sze 3.3)"
    default_mesh: tuple[int, int] = (10, 80)
    settings: tuple[Setting, ...] = (LOAD_FRACTIONS, *ELEMENT, SOLVER)
    references: tuple[Reference, ...] = _references()

    def build(self, request: Request) -> SceneModel:
        """Half of the line force on each face, along e3."""
        n1, n2 = request.mesh
        turn = 2 * np.pi
        grid = Grid.tensor(np.linspace(INNER, OUTER, n1 + 1), np.linspace(0, turn, n2 + 1))
        fixed = np.zeros((grid.n_nodes, 6), bool)
        fixed[grid.on_line(1, turn)] = True
        discretisation = discretise(request, annulus(), grid, Laminate.single(Ply.isotropic(E, 0.0, H)), fixed)
        slit = grid.on_line(1, 0.0)
        forces = np.zeros((grid.n_nodes, 6))
        forces[slit, 4:] = 0.5 * P_MAX * (OUTER - INNER) * edge_shares(len(slit))[:, None]
        corners = {"w_A_mm": grid.node_at(INNER, 0.0), "w_B_mm": grid.node_at(OUTER, 0.0)}

        def at_corners(shell: ShellModel, u: np.ndarray) -> dict[str, float]:
            v = discretisation.expand(u)
            return {name: float(v[node, 4:].mean()) for name, node in corners.items()}

        return StaticModel(
            loaded_shell(discretisation, request, forces=forces), request.numbers("load_fraction"), at_corners
        )
