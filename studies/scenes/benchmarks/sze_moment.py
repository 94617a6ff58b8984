"""Cantilever rolled up by an end couple that follows its section: Sze, Liu, Lo (2004), section 3.2."""

import numpy as np

from formulations.loads.pressure import Couples
from formulations.section.laminate import Ply
from studies.ask.declarations import BEAM, ROTATIONS, Ladder, ShellLimit, meshes, thickness_over
from studies.ask.scene import SOLVER, Declared, Reference, Request, SceneModel
from studies.scenes.benchmarks.cantilever import TIP, clamped_strip, tip_motion, tip_row
from studies.scenes.data import reference_rows, references
from studies.scenes.element import ELEMENT
from studies.scenes.statics import LOAD_FRACTIONS, StaticModel, edge_shares

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
    table = [tuple(row.values()) for row in reference_rows("sze2004_3.2_cantilever_end_moment.csv")[1:]]
    sze = "Sze, Liu, Lo, Finite Elem. Anal. Des. 40 (2004) 1551, sect. 3.2 (S4R, 16x1)"
    # a strip of Green-Lagrange strain and finite thickness shortens by the order of (h kappa)^2
    arcs = [tip_row(row[0], *circular_arc(row[0])) for row in table]
    return references("exact", "inextensible circular arc", 1e-3, arcs) + references(
        "read", sze, 2e-3, [tip_row(row[0], row[1], row[3]) for row in table]
    )


class RolledCantilever(Declared):
    """A strip clamped at a1 = 0; the couple at a1 = L keeps its moment and turns with the director."""

    name = "sze-moment"
    title = "Cantilever rolled into a circle by an end couple (Sze 3.2)"
    default_mesh = (64, 1)
    settings = (LOAD_FRACTIONS, *ELEMENT, SOLVER)
    references = _references()
    quantities = TIP
    ladders = (
        Ladder(
            ROTATIONS, meshes(32, 1), tuple(TIP), settings={"load_fraction": "0.5"}, whole={"load_fraction": "0.5,1"}
        ),
    )
    shell_limit = ShellLimit(BEAM, thickness_over(L, H), same=False)

    def build(self, request: Request) -> SceneModel:
        """The couple about -e2 lifts the tip."""
        strip = clamped_strip(request, L, B, Ply.isotropic(E, 0.0, H))
        tip = strip.grid.on_line(0, L)
        loaded, shares = edge_shares(strip, 0, L)
        couples = Couples(loaded, M_MAX * shares, np.tile([0.0, -1.0, 0.0], (len(loaded), 1)), H)
        return StaticModel.of(request, strip, tip_motion(strip, tip), couples=couples)


SCENES = (RolledCantilever(),)
