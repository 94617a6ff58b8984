"""A variant on the grids of the reference, coarse to fine, each path started from the one on the grid before.

What is enough is not decided here (:mod:`studies.solving.choosing.verdict`).
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field, replace

from studies.ask.request import PartError, UsageError
from studies.ask.scene import Scene
from studies.solving.choosing.clock import Clock
from studies.solving.choosing.rule import NONE, Difference
from studies.solving.choosing.variants import Variant
from studies.solving.refinement.nested import LOOSE, Sketch, sketch

FEWEST = 4  # grids, each with twice the unknowns of the last, that say anything of a limit
FAILURES = 2  # grids in a row on which a path is not followed, after which no other is tried


@dataclass(eq=False)
class Ladder:
    """The reference, or a variant, on grids; ``paths`` are those that were followed to their end.

    seen: grids that were tried.  lost: those in a row on which the path was not followed.  said: why no more are tried.
    waits: the mesh that there was no time for.
    """

    variant: Variant
    paths: list[Sketch] = field(default_factory=list)
    seen: int = 0
    lost: int = 0
    said: str = ""
    waits: str = ""

    def climb(self, scene: Scene, beside: Sketch) -> None:
        """Follow the path on one grid more: that of the reference's path ``beside`` it, which is its first start."""
        request = replace(self.variant.request, mesh=beside.request.mesh)
        self.seen, self.waits = self.seen + 1, ""
        try:
            found = sketch(scene, request, self.paths[-1] if self.paths else beside, LOOSE)
        except (UsageError, PartError) as error:
            found, self.said = None, str(error)
        if found is not None:
            self.rest()
            self.paths.append(found)
            self.lost = 0
            return
        self.lost += 1
        if self.lost >= FAILURES and not self.said:
            self.said = f"its path is not followed to its end on {beside.mesh}"

    def rest(self) -> None:
        """Keep of the last path its values alone: nothing is started from it any more."""
        self.paths[-1:] = [path.values_only for path in self.paths[-1:]]

    @property
    def turn(self) -> int:
        """Who comes first: those without a grid, those that have begun, those with one grid, those with enough."""
        return 0 if self.seen == 0 else 3 if self.seen >= FEWEST else 1 if self.seen > 1 else 2

    def next_of(self, along: Ladder) -> Sketch | None:
        """The reference's path on the grid that is tried next, if there is one."""
        return along.paths[self.seen] if self.seen < len(along.paths) else None

    def begun(self, along: Ladder) -> Sequence[Sketch]:
        """The reference's paths on the grids that come next at one go."""
        return along.paths[self.seen : FEWEST if self.turn == 2 else self.seen + 1]

    def price(self, along: Ladder, quantity: str, error: float) -> float:
        """The seconds of the next grid, times 1 and the distance from the reference over ``error`` on the last one."""
        path = self.next_of(along)
        seconds = 0.0 if path is None else self.foreseen(along, [path])
        if not self.paths:
            return seconds
        own, other = (each.quantities.get(quantity, math.nan) for each in (self.paths[-1], self._beside(along)))
        apart = abs(own - other) / (abs(other) or math.ulp(0.0))
        return seconds * (1 + (apart / error if math.isfinite(apart) else 0.0))

    def foreseen(self, along: Ladder, beside: Sequence[Sketch]) -> float:
        """CPU seconds on the grids of these paths of the reference, which takes so much more there than on the last."""
        seconds = sum(each.seconds for each in beside)
        return seconds * self.paths[-1].seconds / self._beside(along).seconds if self.paths else seconds

    def _beside(self, along: Ladder) -> Sketch:
        """The reference's path on the last grid."""
        return next(each for each in along.paths if each.request.mesh == self.paths[-1].request.mesh)

    def values(self, quantity: str) -> list[float]:
        """What was read off, by grid."""
        return [float(each.quantities.get(quantity, math.nan)) for each in self.paths]


def climb_all(
    ladders: Sequence[Ladder],
    along: Ladder,
    quantity: str,
    limit: Callable[[Ladder], Difference | str],
    scene: Scene,
    error: float,
    clock: Clock,
) -> Iterator[str]:
    """Climb grid by grid as far as time and sense go; yields what is done next.

    All of them on the coarsest grid; then each on as many as a limit takes, if there is time for those; then the rest.
    The next is the cheapest, those that are far from the reference on their last grid counted dearer: they come later,
    and are not judged by that.  along: the reference.  limit: f of a ladder so far; a variant whose limit is surely off
    by more than the error comes last: finer grids only say by how much.
    """

    def turn(ladder: Ladder) -> tuple[bool, int, float]:
        apart = limit(ladder) if ladder.paths else NONE
        sure = isinstance(apart, Difference) and apart.least > error
        return sure, ladder.turn, ladder.price(along, quantity, error)

    open_ = [ladder for ladder in ladders if not ladder.variant.refused]
    while open_:
        ladder = min(open_, key=turn)
        path = ladder.next_of(along)
        if path is None or ladder.said:
            ladder.rest()
            open_.remove(ladder)
        elif not clock.fits(ladder.foreseen(along, ladder.begun(along))):
            ladder.waits = path.mesh
            open_.remove(ladder)
        else:
            yield f"{ladder.variant.axis} {ladder.variant.name} {path.mesh}"
            ladder.climb(scene, path)
