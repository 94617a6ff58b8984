"""The models of the sheets' cells, built and not solved, and what they are made of."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from contact.obstacles.foundation import RigidPlane
from formulations.section.laminate import Laminate
from formulations.shell import ShellModel
from formulations.solid import SolidDiscretisation
from studies.ask.request import Request
from studies.ask.scene import Scene, SceneModel
from studies.run.campaigns.cell import Cell
from studies.run.campaigns.sheet_cells import sheet_cell
from studies.scenes import SCENES
from studies.scenes.contact import crushed_ring
from studies.scenes.contact.base import ContactModel
from studies.scenes.contact.crushed_ring_solid import SolidRingModel
from studies.scenes.manufactured.scene import ManufacturedModel, carrying
from studies.scenes.tyre.model import checked_wall
from studies.scenes.tyre.press import PressedTyre


@dataclass(frozen=True, eq=False)
class Built:
    """The model of a cell.

    body: the shell under load fraction 1, or its last load, or the solid; None for another kind of model.
    foundation: what it is pressed on.  normal: of a rigid plane, from the body to it.
    """

    cell: Cell
    scene: Scene
    request: Request
    model: SceneModel
    body: ShellModel | SolidDiscretisation | None
    foundation: object | None

    @property
    def normal(self) -> np.ndarray | None:
        """Of a plane."""
        return self.foundation.normal if isinstance(self.foundation, RigidPlane) else None

    @property
    def laminate(self) -> Laminate | None:
        """Of its wall."""
        if isinstance(self.body, ShellModel):
            return self.body.discretisation.laminate
        if isinstance(self.model, SolidRingModel):
            return crushed_ring.ring(self.request)[1]
        return checked_wall(self.request.settings)[0] if isinstance(self.model, PressedTyre) else None


def built_models() -> Iterator[Built]:
    """Of every scene of the catalogue."""
    yield from map(built, SCENES)


def built(name: str) -> Built:
    """Of one scene."""
    cell = sheet_cell(name)
    scene, request = cell.resolved()
    model = scene.build(request)
    return Built(cell, scene, request, model, _body(model), _foundation(model, request))


def _body(model: SceneModel) -> ShellModel | SolidDiscretisation | None:
    if isinstance(model, ContactModel):
        return (model.body_at or model.shell.scaled)(1.0 if model.key == "load_fraction" else model.targets[-1])
    if isinstance(model, ManufacturedModel):
        return carrying(model.shell, model.exact_at(1.0), model.loaded)
    body = getattr(model, "shell", None) or getattr(model, "body", None)
    if isinstance(body, ShellModel):
        return body
    solid = getattr(body, "discretisation", None)
    return solid if isinstance(solid, SolidDiscretisation) else None


def _foundation(model: SceneModel, request: Request) -> object | None:
    if isinstance(model, ContactModel):
        return model.plane_at(model.targets[-1])
    if isinstance(model, SolidRingModel):
        return crushed_ring.plate(request, request.numbers("delta_mm")[-1])
    return model.foundation if isinstance(model, PressedTyre) else None
