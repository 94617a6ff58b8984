"""Cantilever rolled up by an end couple that follows its section: Sze, Liu, Lo (2004), section 3.2."""

from __future__ import annotations

import numpy as np

from formulations.geometry.surfaces import Plate
from formulations.loads.pressure import Couples
from formulations.section.laminate import Laminate, Ply
from formulations.shell import ShellModel
from studies.request import Request
from studies.scene import SOLVER, Reference, SceneModel, Setting
from studies.scenes.data import read_reference
from studies.scenes.element import ELEMENT, discretise, even_grid
from studies.scenes.statics import LOAD_FRACTIONS, StaticModel, edge_shares, loaded_shell

E, L, B, H = 1.2e6, 12.0, 1.0, 0.1  # MPa, mm; nu = 0
EI = E * B * H**3 / 12
M_MAX = 2 * np.pi * EI / L  # N mm over the edge: a full circle


def circular_arc(fraction: float) -> tuple[float, float]:
    """Shortening and deflection of the tip of an inextensible strip: it bends into an arc of curvature M/EI.

    -u = L - (EI/M) sin(M L/EI), w = (EI/M) (1 - cos(M L/EI)).
    """
    curvature = fraction * M_MAX / EI
    return float(L - np.sin(curvature * L) / curvature), float((1 - np.cos(curvature * L)) / curvature)


def _references() -> tuple[Reference, ...]:
    table = read_reference("sze2004_3.2_cantilever_end_moment.csv").to_numpy()[1:]
    sze = "Sze, Liu, Lo, Finite Elem. Anal. Des. 40 (2004) 1551, sect. 3.2 (S4R, 16x1)"
    # a strip of Green-Lagrange strain and finite thickness shortens by the order of (h kappa)^2
    sources = (
        ("exact", "inextensible circular arc", 1e-3, [(row[0], *circular_arc(row[0])) for row in table]),
        ("read", sze, 2e-3, [(row[0], row[1], row[3]) for row in table]),
    )
    return tuple(
        Reference(quantity, float(value), {"load_fraction": float(fraction)}, kind, source, uncertainty)
        for kind, source, uncertainty, rows in sources
        for fraction, shortening, deflection in rows
        for quantity, value in (("tip_shortening_mm", shortening), ("tip_deflection_mm", deflection))
    )


class RolledCantilever:
    """A strip clamped at a1 = 0; the couple at a1 = L keeps its moment and turns with the director."""

    name: str = "sze-moment"
    title: str = "Cantilever rolled into a circle by an end couple (Sze 3.2)"
    default_mesh: tuple[int, int] = (64, 1)
    settings: tuple[Setting, ...] = (LOAD_FRACTIONS, *ELEMENT, SOLVER)
    references: tuple[Reference, ...] = _references()

    def build(self, request: Request) -> SceneModel:
        """The couple about -e2 lifts the tip."""
        grid = even_grid(request, (0, L), (0, B))
        fixed = np.zeros((grid.n_nodes, 6), bool)
        fixed[grid.on_line(0, 0.0)] = True
        discretisation = discretise(request, Plate(), grid, Laminate.single(Ply.isotropic(E, 0.0, H)), fixed)
        tip = grid.on_line(0, L)
        axes = np.tile([0.0, -1.0, 0.0], (len(tip), 1))
        couples = Couples(tip, M_MAX * edge_shares(len(tip)), axes, H)

        def at_tip(shell: ShellModel, u: np.ndarray) -> dict[str, float]:
            v = discretisation.expand(u)[tip].mean(axis=0)
            return {"tip_shortening_mm": float(-v[:2].mean()), "tip_deflection_mm": float(v[4:].mean())}

        return StaticModel(
            loaded_shell(discretisation, request, couples=couples), request.numbers("load_fraction"), at_tip
        )
