"""What the grids of a variant say: its error in their limit, the mesh that is enough, and that in words and rows.

The rule is :mod:`studies.solving.choosing.rule`; nothing is solved here.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from studies.solving.choosing.ladder import Ladder
from studies.solving.choosing.rule import NONE, Difference, difference, errors, first_enough
from studies.solving.refinement.limits import FEW, Estimate, Seen
from studies.solving.refinement.nested import Sketch, touches

WORDS = ("enough", "no mesh yet", "not enough", "not settled", "not known", "failed", "does not apply", "not tried")
ENOUGH, NO_MESH, NOT_ENOUGH, NOT_SETTLED, NOT_KNOWN, FAILED, REFUSED, NOT_TRIED = WORDS


@dataclass(frozen=True, eq=False)
class Verdict:
    """On a ladder, for an error.

    limit: f, or why it is not known.  values, most: by grid, what was read off and the most that it is off.
    first: the grid from which on all are enough, if there is one.
    """

    ladder: Ladder
    error: float
    limit: Difference | str
    values: Sequence[float]
    most: Sequence[float]
    first: int | None

    @property
    def enough(self) -> Sketch | None:
        """The path on the cheapest mesh that is enough."""
        return None if self.first is None else self.ladder.paths[self.first]

    @property
    def word(self) -> str:
        """Of :data:`WORDS`: whether the limit is surely within the error, surely not, or neither, and why."""
        limit, ladder = self.limit, self.ladder
        if ladder.variant.refused:
            return REFUSED
        if not ladder.paths:
            return FAILED if ladder.lost else NOT_TRIED
        if isinstance(limit, str):
            return NOT_KNOWN
        if limit.least > self.error:
            return NOT_ENOUGH
        if limit.most > self.error:
            return NOT_SETTLED
        return NO_MESH if self.first is None else ENOUGH

    @property
    def said(self) -> str:
        """Why it does not apply, goes no further, or has no limit."""
        ladder = self.ladder
        unknown = self.limit if isinstance(self.limit, str) and ladder.paths else ""
        waits = f"no time for {ladder.waits}" if ladder.waits else ""
        return ladder.variant.refused or "; ".join(filter(None, (unknown, ladder.said, waits)))

    @property
    def row(self) -> dict[str, Any]:
        """As the row of a table; None where a thing is not known."""
        known = self.limit if isinstance(self.limit, Difference) and self.ladder.paths else None
        path = self.enough
        return {
            "axis": self.ladder.variant.axis,
            "name": self.ladder.variant.name,
            "formulation_error": None if known is None else known.value,
            "within": None if known is None else known.within,
            "settled": None if known is None else known.settled,
            "verdict": self.word,
            "mesh": None if path is None else path.mesh,
            "unknowns": None if path is None else path.unknowns,
            "error_at_most": None if self.first is None else self.most[self.first],
            "path_seconds": None if path is None else path.seconds,
            "grids": len(self.ladder.paths),
            "said": self.said,
        }

    @property
    def grids(self) -> list[dict[str, Any]]:
        """A row a grid: what was read off, the most that it is off, the CPU seconds of its path from the one before."""
        return [
            {
                "axis": self.ladder.variant.axis,
                "name": self.ladder.variant.name,
                "mesh": path.mesh,
                "unknowns": path.unknowns,
                "value": value,
                "error_at_most": most,
                "enough": self.first is not None and k >= self.first,
                "path_seconds": path.seconds,
            }
            for k, (path, value, most) in enumerate(zip(self.ladder.paths, self.values, self.most, strict=True))
        ]


def judged(ladder: Ladder, reference: Ladder, limit: Estimate, quantity: str, error: float) -> Verdict:
    """The verdict on a ladder; on that of the reference, too, which is off by its grids alone."""
    values, apart = ladder.values(quantity), NONE if ladder is reference else _apart(ladder, reference, limit, quantity)
    most = errors(values, limit)
    return Verdict(ladder, error, apart, values, most, first_enough(most, apart, error))


def _apart(ladder: Ladder, reference: Ladder, limit: Estimate, quantity: str) -> Difference | str:
    """f, from the grids that both have."""
    if not ladder.paths:
        return FEW
    known = {path.request.mesh: value for path, value in zip(reference.paths, reference.values(quantity), strict=True)}
    own = [Seen(path.size, value) for path, value in zip(ladder.paths, ladder.values(quantity), strict=True)]
    beside = [Seen(path.size, known[path.request.mesh]) for path in ladder.paths]
    return difference(own, beside, limit, touching=touches(reference.paths[-1].end))
