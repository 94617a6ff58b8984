"""The crushed ring of :mod:`studies.scenes.contact.crushed_ring` as a solid, with a choice of laws.

Ring, plates and readings are the same; there is no strain measure, section or middle surface. Plane strain fixes the
displacement along the axis. Plane stress is a slice, free on one side, so thin that it contracts freely. 3D is half of
the width with a free side.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from contact.obstacles.foundation import Candidates, against
from contact.problem import ContactProblem, ContactSolution
from formulations.section.laminate import LAWS
from formulations.solid import SolidDiscretisation, SolidModel
from formulations.solid_mesh import SolidMesh
from studies.ask.request import Request
from studies.ask.scene import (
    EPSILON,
    SOLVER,
    Begun,
    Observation,
    Reference,
    Setting,
    Stage,
)
from studies.scenes.contact.crushed_ring import DATA, FILE, QUANTITIES, RING, SHEET, TOP, WIDTH, experiment, plate, ring
from studies.scenes.data import At, reference_rows, references
from studies.scenes.element import spaced_lines
from studies.scenes.solids import OfSolids, SolidSceneModel

SLICE = 0.2  # mm, a hundredth of the wall; half of it changes the force by 2e-5
HALVES = {"plane-strain": WIDTH, "plane-stress": SLICE, "3d": WIDTH / 2}  # what is solved of the width
LAW = Setting.one_of("law", LAWS.keys(), "svk", "material law")
STATE = Setting.one_of("state", HALVES, "plane-strain", "what the ring does along its axis")
THROUGH = Setting("per_ply", 4, "elements through the thickness", "int", 1, 16)
SOURCE = "plane solid of 9-node quadrilaterals, 24x4, another program"
COLUMNS = {
    "hencky_N": ("hencky", "plane-strain"),
    "svk_N": ("svk", "plane-strain"),
    "hencky_plane_stress_N": ("hencky", "plane-stress"),
}


def _computed() -> tuple[Reference, ...]:
    forces: tuple[Reference, ...] = ()
    for row in reference_rows(FILE):
        for column, (law, state) in COLUMNS.items():
            at: At = {"delta_mm": row["delta_mm"], **DATA, "law": law, "state": state}
            forces += references("computed", SOURCE, 2e-3, [(at, {"force_N": row[column]})])
    return forces


class SolidRing(OfSolids):
    """a1 along the axis, a2 from the plate over a quarter of the ring; the force is that on half a plate."""

    name = "crushed-ring-solid"
    title = "The crushed polyurethane ring as a solid, with its law and its state along the axis"
    default_mesh = (1, 24)
    settings = (*RING, LAW, STATE, THROUGH, EPSILON, SOLVER)
    references = (*experiment(), *_computed())
    quantities = QUANTITIES
    sheet = SHEET

    def build(self, request: Request) -> SolidRingModel:
        """A quarter of the ring."""
        (surface, laminate), state = ring(request), request.choice("state")
        lines = spaced_lines(0, HALVES[state], request.mesh[0]), spaced_lines(0, TOP, request.mesh[1])
        mesh = SolidMesh.build(surface, *lines, laminate, per_ply=int(request.number("per_ply")))
        axial = slice(None) if state == "plane-strain" else mesh.on(0, 0.0)
        fixed = mesh.supports((mesh.on(1, 0.0), 1), (mesh.on(1, TOP), 0), (axial, 2))
        solid = SolidDiscretisation.build(mesh, laminate, fixed, LAWS[request.choice("law")])
        nodes = np.setdiff1d(np.unique(mesh.outer), mesh.on(1, TOP))
        areas = mesh.face_areas(mesh.outer)[nodes]
        candidates = Candidates(mesh.x[nodes], solid.displacement_operator(nodes), areas)
        return SolidRingModel(SolidModel(solid), candidates, nodes, request, WIDTH / HALVES[state])


@dataclass(frozen=True, eq=False)
class SolidRingModel(SolidSceneModel):
    """One path of the travel, from rest.

    nodes (m,): of the mesh, those of the candidates.  copies: how often the part that is solved lies in the width.
    """

    body: SolidModel
    candidates: Candidates
    nodes: np.ndarray
    request: Request
    copies: float

    def stages(self) -> Iterator[Stage]:
        """The path from rest."""
        yield Stage("load", self._begin, self.request.numbers("delta_mm"), self._observe)

    def _begin(self, previous: ContactSolution | None) -> Begun:
        return self.problem_at, ContactSolution.at_rest(self.n_unknowns, len(self.nodes))

    def problem_at(self, delta: float) -> ContactProblem:
        """The ring and the plate at a travel."""
        problem = against(self.body.linearise, self.candidates, plate(self.request, delta))
        return replace(problem, ordered=self.body.ordered)

    def _observe(self, problem: ContactProblem, state: ContactSolution, delta: float) -> Observation:
        body = self.body.discretisation
        stretches = body.stretches(body.expand(state.u))
        quantities = {
            "force_N": self.copies * float(problem.nodal_forces(state.pressure).sum()),
            "least_stretch": float(stretches.min()),
            "largest_stretch": float(stretches.max()),
        }
        return Observation({"delta_mm": delta, **quantities, "contact_nodes": int(state.active.sum())}, quantities)


SCENES = (SolidRing(),)
