"""Cantilever under end shear: Sze, Liu, Lo (2004), section 3.1; the exact solution is the inextensible elastica."""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from formulations.discretisation import Discretisation
from formulations.geometry.surfaces import Plate
from formulations.section.laminate import Laminate, Ply
from formulations.shell import ShellModel
from studies.ask.declarations import BEAM, BENCHMARKS, FULL, LONG, ROTATIONS, Ladder, ShellLimit, thickness_over
from studies.ask.scene import SOLVER, Declared, Reference, Request, SceneModel
from studies.scenes.data import Row, references
from studies.scenes.element import ELEMENT, patch
from studies.scenes.statics import LOAD_FRACTIONS, Reading, StaticModel, edge_forces

E, L, B, H = 1.2e6, 10.0, 1.0, 0.1  # MPa, mm; nu = 0
P_MAX = 4.0  # N, 4 E I / L^2 in all, spread over the edge, dead

# (load fraction, -u_tip, w_tip) of the exact inextensible elastica (elliptic integrals) and of the published table
ELASTICA = ((0.25, 0.56433, 3.01721), (0.5, 1.60642, 4.93457), (0.75, 2.54420, 6.03253), (1.0, 3.28941, 6.69964))
SZE = ((0.25, 0.563, 3.015), (0.5, 1.604, 4.933), (0.75, 2.541, 6.031), (1.0, 3.286, 6.698))
SOURCE = "Sze, Liu, Lo, Finite Elem. Anal. Des. 40 (2004) 1551, sect. 3.1 (S4R, 16x1)"
TIP: Mapping[str, str] = {
    "tip_deflection_mm": "motion of the tip along the normal, mean over both faces of the loaded edge",
    "tip_shortening_mm": "motion of the tip against a1, mean over both faces of the loaded edge",
}
SZE_ERROR = 4e-3  # mm, largest deviation of the S4R table from the elastica


def tip_row(fraction: float, shortening: float, deflection: float) -> Row:
    """What a table says of the tip of a strip at a load fraction."""
    return {"load_fraction": float(fraction)}, {"tip_shortening_mm": shortening, "tip_deflection_mm": deflection}


def clamped_strip(request: Request, length: float, width: float, ply: Ply) -> Discretisation:
    """A strip clamped at a1 = 0."""
    return patch(request, Plate(), (0, length), (0, width), Laminate.single(ply), ("clamped", "free", "free", "free"))


def tip_motion(strip: Discretisation, tip: np.ndarray) -> Reading:
    """Shortening and deflection of the nodes at the tip, the mean of both faces."""

    def at_tip(shell: ShellModel, u: np.ndarray) -> dict[str, float]:
        v = strip.expand(u)[tip].mean(axis=0)
        return {"tip_shortening_mm": float(-v[:2].mean()), "tip_deflection_mm": float(v[4:].mean())}

    return at_tip


def _references() -> tuple[Reference, ...]:
    exact = references("exact", "inextensible elastica, elliptic integrals", 1e-5, [tip_row(*row) for row in ELASTICA])
    read = references("read", SOURCE, 0.0, [tip_row(*row) for row in SZE])
    return exact + tuple(replace(reference, uncertainty=SZE_ERROR / reference.value) for reference in read)


class Cantilever(Declared):
    """A strip clamped at a1 = 0 and sheared at a1 = L."""

    name = "cantilever"
    title = "Cantilever under end shear (Sze 3.1)"
    default_mesh = (16, 1)
    settings = (LOAD_FRACTIONS, *ELEMENT, SOLVER)
    references = _references()
    quantities = TIP
    ladders = (
        # nothing varies across, nu = 0; coarser, two errors of different order take turns
        Ladder(ROTATIONS, LONG, tuple(TIP), settings=FULL),
        Ladder(BENCHMARKS, ("16x1", "32x2", "64x4"), ("tip_shortening_mm", "tip_deflection_mm")),
    )
    shell_limit = ShellLimit(BEAM, thickness_over(L, H))

    def build(self, request: Request) -> SceneModel:
        """Half of the shear acts on each face, distributed to the nodes as a uniform edge load."""
        strip = clamped_strip(request, L, B, Ply.isotropic(E, 0.0, H))
        tip = strip.grid.on_line(0, L)
        return StaticModel.of(request, strip, tip_motion(strip, tip), forces=edge_forces(strip, 0, L, P_MAX))


SCENES = (Cantilever(),)
