"""What has been chosen: verdicts on all variants, trials of algorithms, what may be recommended, and what is uncertain.

Offers are made in :mod:`studies.solving.offers`.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from studies.ask.request import Request
from studies.ask.settings import rubbing
from studies.output.atomic import Table, forget, write_json
from studies.output.provenance import provenance
from studies.scenes.element import surfaces_of
from studies.solving.offers import Offer
from studies.solving.refinement.limits import Estimate
from studies.solving.refinement.nested import touches
from studies.solving.result import UNSTABLE
from studies.solving.trials import NOT_TRIED, Question, Trial, beside
from studies.solving.variants import REFERENCE
from studies.solving.verdict import NO_MESH, NOT_SETTLED, Verdict, Wall

CHOICE = "choice.json"
ANSWERED, NOT_ANSWERED = "answered", "not-converged"


@dataclass(eq=False)
class Choice:
    """The answer.

    stopped: why the reference has no more grids.  limit: of the reference, the exact measure; wall: with more surfaces,
    whose limit is the ``truth``; beyond: one that is not known well enough to be that.  verdicts: walls, measures,
    options of the element, models, the reference first.
    algorithms: from rest, on a coarse mesh and on one that is enough.  offers: what is recommended, the runner-up,
    further ones.  refused: offers that failed from rest.  reason: why nothing is recommended.  seconds: of wall
    time.
    """

    question: Question
    request: Request
    budget: float
    quantity: str
    stopped: str = ""
    limit: Estimate | None = None
    wall: Wall = field(default_factory=Wall)
    beyond: Wall | None = None
    verdicts: list[Verdict] = field(default_factory=list)
    algorithms: list[Trial] = field(default_factory=list)
    offers: list[Offer] = field(default_factory=list)
    refused: list[Offer] = field(default_factory=list)
    reason: str = ""
    seconds: float = 0.0

    @property
    def truth(self) -> Estimate | None:
        """What all errors count from."""
        return None if self.limit is None else self.wall.truth(self.limit)

    @property
    def recommended(self) -> Offer | None:
        """The cheapest that is enough, if anything is."""
        return self.offers[0] if self.offers else None

    @property
    def runner_up(self) -> Offer | None:
        """The next one."""
        return self.offers[1] if len(self.offers) > 1 else None

    @property
    def variants(self) -> list[dict[str, Any]]:
        """A row a measure, a wall, an option of the element, a model."""
        return [verdict.row for verdict in self.verdicts]

    @property
    def grids(self) -> list[dict[str, Any]]:
        """A row each of their grids."""
        return [row for verdict in self.verdicts for row in verdict.grids]

    @property
    def trials(self) -> list[dict[str, Any]]:
        """A row an algorithm and mesh; agrees: its value with that of the one asked for, to the judge."""
        asked = [beside(each, self.algorithms, self.question.contact) for each in self.algorithms]
        return [
            {
                "name": each.contact,
                "mesh": each.mesh,
                "ended": each.ended,
                "agrees": each.agrees(own),
                "value": each.value,
                "seconds": each.seconds,
                "newton_iterations": each.iterations,
                "said": each.against(own),
            }
            for each, own in zip(self.algorithms, asked, strict=True)
        ]

    @property
    def dropped(self) -> list[str]:
        """What there was no time for."""
        ladders = [verdict.ladder for verdict in self.verdicts]
        waiting = [f"{each.variant.axis} {each.variant.name} {each.waits}" for each in ladders if each.waits]
        algorithms = [f"algorithm {each.contact} {each.mesh}" for each in self.algorithms if each.ended == NOT_TRIED]
        return [*waiting, *algorithms]

    @property
    def uncertain(self) -> list[str]:
        """What this answer does not know, a sentence each."""
        return list(self._uncertain())

    def _uncertain(self) -> Iterator[str]:
        percent = f"{100 * self.question.error:g} %"
        for verdict in self.verdicts:
            ladder, word = verdict.ladder, verdict.word
            name, count = f"{ladder.variant.axis} {ladder.variant.name}", len(ladder.paths)
            if word == NOT_SETTLED:
                yield f"{name}: {count} grids do not settle whether its limit is within {percent}"
            elif word == NO_MESH:
                yield f"{name}: its limit is within {percent}, but none of its {count} grids surely is"
            elif verdict.first == count - 1:
                yield f"{name}: no grid finer than {ladder.paths[-1].mesh} was solved, the limit is an estimate"
        if self.verdicts and touches(self.verdicts[0].ladder.paths[-1].end):
            values = self.verdicts[0].values
            steps = 100 * np.abs(np.diff(values[-3:])) / (abs(values[-1]) or 1.0)
            if len(steps):
                yield f"the rim of contact jumps from node to node: the last grids differ by {steps.max():.2g} %"
        if self.verdicts and "interpolation" in self.request.settings and not self.wall.name:
            here, far = surfaces_of(self.request), self.beyond
            if far is not None and far.name:
                width = 100 * (far.beyond.within + far.left)
                by = f"surfaces={far.name} {100 * far.beyond.value:+.2g} +- {width:.2g} %"
                yield f"it is not settled whether more surfaces through the wall matter: {by}; errors count from {here}"
            else:
                yield f"the effect of more surfaces through the wall is not known: errors count from surfaces={here}"
        if self.stopped:
            yield f"measure {REFERENCE}: {self.stopped}"
        if rubbing(self.request.settings):
            yield "the error of the load steps of friction is not included in these errors"
        if self.recommended is not None and not self.recommended.holds:
            yield "there was no time to solve the recommended configuration from rest"
        if self.recommended is not None and self.recommended.trial is not None:
            if self.recommended.trial.ended == UNSTABLE:
                yield f"the recommended configuration is not a stable equilibrium: {self.recommended.trial.said}"
            yield from self.recommended.trial.notes
            faster = [offer for offer in self.offers if offer.untried and offer.price < self.recommended.price]
            yield from (
                f"{offer.words}: forecast at {offer.seconds:.2g} s, but not solved from rest" for offer in faster
            )
        yield from (offer.refusal for offer in self.refused)
        if self.dropped:
            yield f"no time within {self.budget:g} s for {len(self.dropped)} finer grids or trials"

    def as_json(self) -> dict[str, Any]:
        """The content of choice.json."""
        limit = self.truth
        return {
            "scene": self.question.name,
            "quantity": self.quantity,
            "error_asked": self.question.error,
            "budget_s": self.budget,
            "settings": {**self.request.settings, "steps": self.request.steps},
            "contact": self.request.contact,
            "newton": self.request.newton,
            "model": self.request.model,
            "outcome": NOT_ANSWERED if self.recommended is None else ANSWERED,
            "reason": self.reason,
            "reference": {
                "measure": self.request.measure,
                "surfaces": self.wall.name or surfaces_of(self.request),
                "limit": None if limit is None else limit.limit,
                "uncertainty": None if limit is None else limit.uncertainty,
            },
            "recommended": None if self.recommended is None else self.recommended.data,
            "runner_up": None if self.runner_up is None else self.runner_up.data,
            "variants": self.variants,
            "grids": self.grids,
            "algorithms": self.trials,
            "uncertain": self.uncertain,
            "dropped": self.dropped,
            "timing_s": {"total": self.seconds},
            "provenance": provenance(),
        }

    def write(self, directory: Path, beside: Sequence[str] = ()) -> None:
        """The tables, and choice.json, which names them and what is ``beside``; each whole, choice.json last."""
        tables = {name: getattr(self, name) for name in ("variants", "grids")} | {"algorithms": self.trials}
        kept = {f"{name}.csv": rows for name, rows in tables.items() if rows}
        for name, rows in kept.items():
            Table.of_rows(rows).write(directory / name)
        forget(directory, CHOICE, [*kept, *beside])
        write_json(directory / CHOICE, self.as_json() | {"files": [*kept, *beside]})
