"""What may be recommended: configurations that are enough, their command lines, and whether solves from rest agree.

What is enough is decided before (:mod:`studies.solving.verdict`); the whole answer is :mod:`studies.solving.choice`.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from typing import Any

from studies.solving.refinement.limits import Estimate
from studies.solving.trials import FROM_REST, SLOWER, Clock, Question, Trial, tried
from studies.solving.variants import Variant
from studies.solving.verdict import Verdict, errors

FASTER = 0.8  # of the seconds, what a change of what is asked for may take at the most
LOADING = 1.0  # s that every solve takes before it begins: beside it small differences do not count
TRIALS, ENOUGH = 4, 2  # offers that are tried at most, and that have to be confirmed


@dataclass(eq=False)
class Offer:
    """A configuration that is enough: what is changed of the question, and the seconds that it is foreseen to take.

    variant: its axis, name and wall.  error_at_most: of its value on its grid.  changes: how many there are.  trial:
    from rest, where there was time.
    """

    question: Question
    variant: Variant
    contact: str
    mesh: str
    options: dict[str, str]
    settings: dict[str, str]
    foreseen: float
    error_at_most: float
    changes: int
    trial: Trial | None = None
    holds: bool = field(default=False, init=False)

    @property
    def words(self) -> str:
        """What it is, for people."""
        variant, wall = self.variant, f" surfaces={self.variant.wall}" if self.variant.wall else ""
        return f"{variant.axis} {variant.name} {self.contact} {self.mesh}{wall}"

    @property
    def untried(self) -> bool:
        """Whether nothing is known of it from rest."""
        return self.trial is None or self.trial.ended == SLOWER

    @property
    def seconds(self) -> float:
        """CPU seconds from rest, judged; those that are foreseen where it was not tried to the end."""
        return self.trial.seconds if self.trial is not None and self.holds else self.foreseen

    @property
    def price(self) -> float:
        """Seconds with those of loading, dearer by what every change has to save: a tie is for what is asked for."""
        return (LOADING + self.seconds) / FASTER**self.changes

    @property
    def command(self) -> str:
        """The line that solves it."""
        return self.question.command(self.mesh, self.options, self.settings)

    @property
    def data(self) -> dict[str, Any]:
        """As plain data."""
        fields = {name: getattr(self, name) for name in ("command", "words", "mesh", "error_at_most", "seconds")}
        return {**fields, "tried": self.holds}

    def attempt(self, quantity: str, limit: Estimate, seconds: float, progress: Callable[[str], None]) -> None:
        """Solve it from rest; confirmed where the judge certifies it and its value is within the error, too."""
        ask = lambda: self.question.asked(self.mesh, self.options, self.settings)  # noqa: E731
        self.trial = tried(ask, quantity, seconds, progress)
        if self.trial.solved and self.trial.value is not None:
            (most,) = errors([self.trial.value], limit)
            self.holds, self.error_at_most = most <= self.question.error, most

    @property
    def refusal(self) -> str:
        """Why it is not recommended, though its path from a coarser grid is enough."""
        assert self.trial is not None
        why = self.trial.said or f"its error is up to {100 * self.error_at_most:.2g} %"
        return f"{self.words}: {self.trial.ended} from rest: {why}"


def offers_of(question: Question, verdicts: Sequence[Verdict], algorithms: Sequence[Trial]) -> list[Offer]:
    """All that is enough, by the algorithm asked for and by the fastest one that agrees with it, cheapest first.

    verdicts: that on the reference first.
    """
    return sorted(_offers(question, verdicts, algorithms), key=lambda offer: offer.price)


def recommended(
    offers: Sequence[Offer], quantity: str, limit: Estimate, clock: Clock, progress: Callable[[str], None]
) -> list[Offer]:
    """The offers confirmed from rest, cheapest first, and after them those that there was no time to try."""
    for offer in offers[:TRIALS]:
        if sum(each.holds for each in offers) >= ENOUGH or not clock.fits(offer.foreseen):
            break
        progress(f"{offer.words} from rest")
        offer.attempt(quantity, limit, max(clock.left, 0.0), progress)
    held = sorted((offer for offer in offers if offer.holds), key=lambda offer: offer.price)
    return held + [offer for offer in offers if offer.untried]


def _offers(question: Question, verdicts: Sequence[Verdict], algorithms: Sequence[Trial]) -> Iterator[Offer]:
    ratios = {question.contact: 1.0}
    base = next((each for each in reversed(algorithms) if each.contact == question.contact and each.solved), None)
    if base is not None:
        agree = [each for each in algorithms if each.mesh == base.mesh and each.solved and each.agrees(base)]
        fastest = min(agree, key=lambda each: each.seconds)
        ratios |= {fastest.contact: fastest.seconds / base.seconds}
    for verdict in verdicts:
        path, variant = verdict.enough, verdict.ladder.variant
        if path is None or verdict.first is None:
            continue
        for contact, ratio in ratios.items():
            yield Offer(
                question,
                variant,
                contact,
                path.mesh,
                {**variant.options, "contact": contact},
                dict(variant.settings),
                FROM_REST * ratio * path.seconds,
                verdict.most[verdict.first],
                (verdict is not verdicts[0]) + (variant.wall != "") + (contact != question.contact),
            )
