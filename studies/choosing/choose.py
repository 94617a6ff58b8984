"""Which measure, algorithm, element and mesh is enough on a scene, and what it costs, within a budget of wall time.

The exact measure comes first, on grids that grow until one of them is enough: its limit is the reference. Then measures
on the same grids, algorithms on a grid that is enough, options of the element, models, each with a share of what is
left; last the cheapest of all that is enough, as its command line asks for it.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from typing import Any

from studies.choosing.choice import Choice
from studies.choosing.clock import Clock
from studies.choosing.ladder import Ladder, climb_all, mesh_of
from studies.choosing.offers import Offer, offers_of, recommended
from studies.choosing.question import Question
from studies.choosing.reference import follow, limit_stated
from studies.choosing.trials import FROM_REST, race
from studies.choosing.variants import ELEMENT, MEASURE, MODEL, REFERENCE, Variant, variants
from studies.choosing.verdict import Verdict, judged
from studies.refinement.cascade import Cascade, first_grid
from studies.refinement.limits import Estimate
from studies.scene import has_contact

ALGORITHM = "algorithm"
SHARES = {MEASURE: 0.6, ALGORITHM: 0.5, ELEMENT: 0.6, MODEL: 1.0}  # of what is left, in this order
OF_REFERENCE = 0.7  # without a mesh of the exact measure that is enough nothing is
BUDGET = 60.0
ERROR = "1%"
CHOOSING = 0.92  # of the budget; the rest is for loading, drawing and writing
ASIDE = 1.5  # of the seconds foreseen for a solve from rest, kept for it


def choose(
    name: str,
    given: Mapping[str, object],
    error: float,
    budget: float = BUDGET,
    quantity: str | None = None,
    progress: Callable[[str], None] = lambda text: None,
    mesh: str | Sequence[int] | None = None,
    **options: Any,
) -> Choice:
    """What is enough for a relative ``error`` of a quantity; without a recommendation where nothing is.

    given, mesh: settings, and the coarsest grid.  budget: seconds of wall time.  quantity: by default the force, or the
    first that the scene has references for.  options: contact, newton, model, steps.
    Raises UsageError as :func:`studies.complete.complete` does, and for a quantity that the scene does not have.
    """
    clock = Clock(CHOOSING * budget)
    scene, request = first_grid(name, given, mesh, measure=REFERENCE, **options)
    lines = {key: value for key, value in request.settings.items() if key == "grading"}
    question = Question(name, scene, {**lines, **given}, options, error)
    cascade = Cascade(scene, error, quantity)
    with clock.share(OF_REFERENCE):
        stopped = follow(cascade, request, clock, progress)
    found = Choice(question, request, budget, quantity or "", stopped)
    limit = limit_stated(cascade)
    if isinstance(limit, str):
        found.reason = limit
    else:
        found.quantity, found.limit = cascade.name, limit
        _compare(found, cascade, limit, clock, progress)
        if not found.offers:
            found.reason = f"nothing is surely within {100 * error:g} % on grids up to {mesh_of(cascade.last)}"
    found.seconds = clock.spent
    return found


def loosened(found: Choice, error: float, progress: Callable[[str], None] = lambda text: None) -> Choice:
    """What the same grids say of a larger error; its own recommendation is solved from rest, within the same budget.

    Algorithms are not tried again. Raises ValueError where no limit is known, or the error is smaller.
    """
    if found.limit is None or error < found.question.error:
        least = min(error, found.question.error)
        raise ValueError(f"of {found.question.name} nothing is known to {100 * least:g} %")
    question, reference = replace(found.question, error=error), found.verdicts[0].ladder
    verdicts = [judged(each.ladder, reference, found.limit, found.quantity, error) for each in found.verdicts]
    clock, offers = Clock(CHOOSING * found.budget), offers_of(question, verdicts, found.algorithms)
    held = recommended(offers, found.quantity, found.limit, clock, progress)
    refused = [offer for offer in offers if not offer.holds and not offer.untried]
    reason = "" if held else f"nothing is surely within {100 * error:g} % on grids up to {mesh_of(reference.paths[-1])}"
    answer = replace(found, question=question, verdicts=verdicts, algorithms=[], reason=reason)
    answer.offers, answer.refused, answer.seconds = held, refused, clock.spent
    return answer


def _compare(found: Choice, cascade: Cascade, limit: Estimate, clock: Clock, progress: Callable[[str], None]) -> None:
    """Measures, algorithms, options of the element and models, what is recommended, and what there is time for then."""
    question, quantity = found.question, cascade.name
    reference = Ladder(Variant(MEASURE, REFERENCE, cascade.grids[0].request), cascade.grids)
    others = [Ladder(each) for each in variants(question.scene, reference.variant.request)]

    def verdict(ladder: Ladder) -> Verdict:
        return judged(ladder, reference, limit, quantity, question.error)

    def climb(own: Sequence[Ladder]) -> None:
        limits = lambda ladder: verdict(ladder).limit  # noqa: E731
        for text in climb_all(own, reference, quantity, limits, question.scene, question.error, clock):
            progress(text)

    def offers() -> list[Offer]:
        found.verdicts = [verdict(each) for each in (reference, *others)]
        return offers_of(question, found.verdicts, found.algorithms)

    path = verdict(reference).enough or cascade.last
    foreseen = FROM_REST * path.seconds
    for axis, part in SHARES.items():
        with clock.share(part, ASIDE * foreseen * clock.wait):
            if axis != ALGORITHM:
                climb([each for each in others if each.variant.axis == axis])
            elif has_contact(question.scene):
                meshes = mesh_of(reference.paths[0]), mesh_of(path)
                found.algorithms = race(question, quantity, meshes, foreseen, clock, progress)
    first = offers()
    found.offers = recommended(first, quantity, limit, clock, progress)
    found.refused = [offer for offer in first if not offer.holds and not offer.untried]
    climb(others)
    known = {offer.words for offer in first}
    found.offers += [offer for offer in offers() if offer.words not in known]
