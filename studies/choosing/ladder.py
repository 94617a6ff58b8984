"""A variant on the grids of the reference, coarse to fine, each path started from the one on the grid before.

What is enough is not decided here (:mod:`studies.choosing.verdict`).
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field, replace

from studies.choosing.clock import Clock
from studies.choosing.rule import NONE, Difference
from studies.choosing.variants import Variant
from studies.refinement.nested import LOOSE, Sketch, sketch
from studies.request import PartError, UsageError
from studies.scene import Scene

GROWTH = 1.25  # power of the unknowns that seconds grow with
FAILURES = 2  # grids in a row on which a path is not followed, after which no other is tried


@dataclass(eq=False)
class Ladder:
    """The reference, or a variant, on grids; ``paths`` are those that were followed to their end.

    lost: grids in a row on which it was not.  said: why there are no more of them.
    """

    variant: Variant
    paths: list[Sketch] = field(default_factory=list)
    lost: int = 0
    said: str = ""

    def climb(self, scene: Scene, beside: Sketch) -> None:
        """Follow the path on one grid more: that of the reference's path ``beside`` it, which is its first start."""
        request = replace(self.variant.request, mesh=beside.request.mesh)
        try:
            found = sketch(scene, request, self.paths[-1] if self.paths else beside, LOOSE)
        except (UsageError, PartError) as error:
            found, self.said = None, str(error)
        if found is not None:
            self.paths.append(found)
            self.lost = 0
            return
        self.lost += 1
        if self.lost >= FAILURES and not self.said:
            self.said = f"its path is not followed to its end on {mesh_of(beside)}"

    def foreseen(self, beside: Sketch) -> float:
        """CPU seconds on the grid of the reference's path beside it."""
        if not self.paths:
            return beside.seconds
        last = self.paths[-1]
        return last.seconds * max(1.0, beside.model.n_unknowns / last.model.n_unknowns) ** GROWTH

    def values(self, quantity: str) -> list[float]:
        """What was read off, by grid."""
        return [float(each.quantities.get(quantity, math.nan)) for each in self.paths]


def climb_all(
    ladders: Sequence[Ladder],
    along: Sequence[Sketch],
    limit: Callable[[Ladder], Difference | str],
    scene: Scene,
    error: float,
    clock: Clock,
) -> Iterator[str]:
    """Climb grid by grid, all ladders beside one another, as far as time and sense go; yields what is done next.

    along: the paths of the reference.  limit: f of a ladder so far; a variant whose limit is surely off by more than
    the error goes no further.
    """
    for path in along:
        for ladder in ladders:
            name = f"{ladder.variant.axis} {ladder.variant.name} {mesh_of(path)}"
            if ladder.said or ladder.variant.refused:
                continue
            apart = limit(ladder) if ladder.paths else NONE
            if isinstance(apart, Difference) and apart.least > error:
                ladder.said = f"not followed beyond {mesh_of(ladder.paths[-1])}: surely off"
            elif not clock.fits(name, ladder.foreseen(path)):
                ladder.said = f"no time for {mesh_of(path)}"
            else:
                yield name
                ladder.climb(scene, path)


def mesh_of(path: Sketch) -> str:
    """N1xN2."""
    return "{}x{}".format(*path.request.mesh)
