"""What scenes of solids share, and their models. No shell, no law and no contact enters here."""

from dataclasses import replace
from pathlib import Path

import numpy as np

from contact.problem import ContactSolution
from formulations.solid import SolidModel
from studies.ask.layers import write_solid_fields
from studies.ask.scene import Declared, Request, UsageError, candidates_at, nodal_pressure


class OfSolids(Declared):
    """A scene of solids alone."""

    models: tuple[str, ...] = ("auto",)

    def settle(self, request: Request) -> Request:
        """Plain Newton, for there are no resultants to predict; raises UsageError for a strain measure: it has none."""
        if request.measure != "exact":
            raise UsageError(
                f"measure {request.measure!r} does not apply to {self.name}: a solid has none, leave it out"
            )
        return replace(request, model="full", newton="plain", leaves=())


class SolidSceneModel:
    """The model of one solid; nodes (m,): of its mesh, those of the candidates."""

    body: SolidModel
    nodes: np.ndarray

    @property
    def n_unknowns(self) -> int:
        """Number of unknowns."""
        return self.body.discretisation.n_free

    def write_fields(self, path: Path, state: ContactSolution) -> None:
        """The hexahedra of the part that is solved."""
        solid = self.body.discretisation
        write_solid_fields(path, solid, state.u, nodal_pressure(state, candidates_at(self.nodes, len(solid.mesh.x))))
