"""Cantilever under end shear: Sze, Liu, Lo (2004), section 3.1; the exact answer is the inextensible elastica."""

from __future__ import annotations

import numpy as np

from formulations.geometry.surfaces import Plate
from formulations.section.laminate import Laminate, Ply
from formulations.shell import ShellModel
from studies.request import Request
from studies.scene import SOLVER, Reference, SceneModel, Setting
from studies.scenes.element import ELEMENT, discretise, even_grid
from studies.scenes.statics import LOAD_FRACTIONS, StaticModel, edge_shares, loaded_shell

E, L, B, H = 1.2e6, 10.0, 1.0, 0.1  # MPa, mm; nu = 0
P_MAX = 4.0  # N, 4 E I / L^2 in all, spread over the edge, dead

# (load fraction, -u_tip, w_tip) of the exact inextensible elastica (elliptic integrals) and of the published table
ELASTICA = ((0.25, 0.56433, 3.01721), (0.5, 1.60642, 4.93457), (0.75, 2.54420, 6.03253), (1.0, 3.28941, 6.69964))
SZE = ((0.25, 0.563, 3.015), (0.5, 1.604, 4.933), (0.75, 2.541, 6.031), (1.0, 3.286, 6.698))

SZE_ERROR = 4e-3  # mm, the S4R table is off the elastica by up to this


def _references() -> tuple[Reference, ...]:
    sources = (
        (ELASTICA, "exact", "inextensible elastica, elliptic integrals", 1e-5),
        (SZE, "read", "Sze, Liu, Lo, Finite Elem. Anal. Des. 40 (2004) 1551, sect. 3.1 (S4R, 16x1)", None),
    )
    return tuple(
        Reference(quantity, value, {"load_fraction": fraction}, kind, source, uncertainty or SZE_ERROR / value)
        for table, kind, source, uncertainty in sources
        for fraction, shortening, deflection in table
        for quantity, value in (("tip_shortening_mm", shortening), ("tip_deflection_mm", deflection))
    )


class Cantilever:
    """A strip clamped at a1 = 0, sheared at a1 = L."""

    name: str = "cantilever"
    title: str = "Cantilever under end shear (Sze 3.1)"
    default_mesh: tuple[int, int] = (16, 1)
    settings: tuple[Setting, ...] = (LOAD_FRACTIONS, *ELEMENT, SOLVER)
    references: tuple[Reference, ...] = _references()

    def build(self, request: Request) -> SceneModel:
        """Half of the shear on each face, shared by the nodes as a uniform edge load."""
        grid = even_grid(request, (0, L), (0, B))
        fixed = np.zeros((grid.n_nodes, 6), bool)
        fixed[grid.on_line(0, 0.0)] = True
        laminate = Laminate.single(Ply.isotropic(E, 0.0, H))
        discretisation = discretise(request, Plate(), grid, laminate, fixed)
        tip = grid.on_line(0, L)
        forces = np.zeros((grid.n_nodes, 6))
        forces[tip, 4:] = 0.5 * P_MAX * edge_shares(len(tip))[:, None]
        shell = loaded_shell(discretisation, request, forces=forces)

        def at_tip(shell: ShellModel, u: np.ndarray) -> dict[str, float]:
            v = discretisation.expand(u)[tip].mean(axis=0)
            return {"tip_shortening_mm": float(-v[:2].mean()), "tip_deflection_mm": float(v[4:].mean())}

        return StaticModel(shell, request.numbers("load_fraction"), at_tip)
