"""From the cells of a campaign to rows of its index: who is solved, under which identity, and who is not and why."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

from contact.algorithms.base import ContractError, unsupported
from contact.catalogue import ALGORITHMS
from contact.problem import Linearised, without_contact
from formulations.element.strain_operator import ON_LINES
from formulations.section.laminate import BETWEEN_FACES
from studies.ask.request import Request
from studies.ask.scene import UsageError, has_contact
from studies.ask.settings import configured, rubbing
from studies.output.atomic import SCHEMA, plain
from studies.run.campaign import Campaign
from studies.run.source_hash import BESIDE_A_CELL, ONLY_WITH, sources_hash
from studies.run.task import Task
from studies.scenes import SCENES
from studies.scenes.complete import Cell
from studies.scenes.element import surfaces_of
from studies.scenes.plugins import modules_of

SOLVERS = ("studies.solving.solve",)  # what solves a cell, besides its own scene


@dataclass(frozen=True)
class Row:
    """A planned cell: ``request`` is the resolved one; without an id it is not solved, and ``reason`` says why."""

    cell: Cell
    id: str | None
    request: Request | None
    reason: str = ""

    def as_json(self) -> dict[str, Any]:
        """The row of the index."""
        cell = self.cell
        identity = {"label": cell.label, "id": self.id, "scene": cell.scene, "command": cell.command}
        asked = {"options": cell.options, "settings": cell.settings, "files": cell.artefacts}
        known = {name: value for name in ("expected", "group") if (value := getattr(cell, name))}
        request = None if self.request is None else plain(self.request.data)
        return {**identity, **asked, **known, "request": request, "reason": self.reason}

    def task(self, use: tuple[str, ...] = (), *, artefacts: bool = False) -> Task:
        """What a process is asked that solves it; its files are kept where ``artefacts`` says so."""
        assert self.id is not None
        return Task("cell", self.id, self.cell.label, self.request, artefacts=artefacts, use=use)


def plan(campaign: Campaign) -> list[Row]:
    """A row for each cell, in order."""
    return [planned(cell) for cell in campaign.cells]


def identity(request: Request, *beside: str) -> str:
    """Hash of all that decides the result: request, schema, sources of what solves it; neither date nor machine.

    beside: other modules that decide it.
    """
    parts = type(SCENES[request.scene]).__module__, ALGORITHMS[request.contact].__module__
    outside = modules_of(request.measure, request.contact, request.scene, str(request.settings.get("law", "")))
    # a part from outside may execute whatever it likes
    unused = () if outside else (name for what, has in _having(request).items() if not has for name in ONLY_WITH[what])
    without = (*BESIDE_A_CELL, *unused)
    sources = sources_hash((*SOLVERS, *beside, *parts, *outside), without=without)
    content = json.dumps(plain([SCHEMA, sources, request.data]), sort_keys=True)
    return hashlib.sha256(content.encode()).hexdigest()[:16]


def _having(request: Request) -> dict[str, bool]:
    """Whether a request of parts of ours has what some modules are executed with alone, see ONLY_WITH."""
    interpolation = request.settings.get("interpolation")  # of shells alone
    return {
        "friction": rubbing(request.settings),
        "candidates": has_contact(SCENES[request.scene]),
        "surfaces between the faces": interpolation is None or surfaces_of(request) != BETWEEN_FACES,
        "quadrilaterals": interpolation not in ON_LINES,
        "bending along arcs": "bending" in request.settings,
        "hanging nodes": bool(request.leaves),
    }


def planned(cell: Cell) -> Row:
    """The only place where the request of a cell is resolved; raises UsageError for a scene that is not here."""
    try:
        _, request = cell.resolved()
    except UsageError as error:
        if cell.scene not in SCENES:
            raise
        return Row(cell, None, None, str(error))
    reason = _refusal(request)
    return Row(cell, None if reason else identity(request), request, reason)


def _refusal(request: Request) -> str:
    """Why a resolved request makes no sense, as far as that shows without building it."""
    if not has_contact(SCENES[request.scene]) and request.contact != Request.contact:
        return f"{request.scene} has no contact: {Request.contact} stands for every algorithm"
    try:
        refused = unsupported(configured(request.contact, request.settings), _NO_MECHANICS)
    except (ValueError, ContractError) as error:
        refused = str(error)
    return f"{request.contact} does not apply: {refused}" if refused else ""


def _no_mechanics(u: np.ndarray, memory: object) -> Linearised:
    raise TypeError("a plan asks an algorithm what it can do, and solves nothing")


_NO_MECHANICS = without_contact(_no_mechanics, 0)


def solved_rows(rows: list[Row]) -> Iterator[tuple[str, Row]]:
    """Rows that are solved, by id: one where several ask for the same, with its files if any of them wants them."""
    by_id: dict[str, Row] = {}
    for row in rows:
        if row.id is not None and (row.id not in by_id or row.cell.artefacts):
            by_id[row.id] = row
    yield from by_id.items()
