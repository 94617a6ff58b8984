"""Which measure, algorithm, element and mesh is enough on a scene, and what it costs, within a budget of wall time.

The exact measure comes first, on grids that grow until one of them is enough: its limit is the reference. Then walls
with more surfaces on the same grids, until more would change nothing: what those have is the truth, and the fewest that
are enough are the wall of all that follows; where their grids do not decide within the error, errors count from the
wall that was asked for, as the answer states. Then measures, how two faces meet, algorithms on a grid that is enough,
options of the element, models, each with a share of what is left; last the cheapest of all that is enough, as its
command line asks for it.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from typing import Any

from studies.ask.request import Request, UsageError
from studies.ask.scene import CutScene, Scene, has_contact
from studies.solving.choice import Choice
from studies.solving.offers import Offer, offers_of, recommended
from studies.solving.refinement.cascade import FINER, TOO_FINE, Cascade
from studies.solving.refinement.grids import element_size, first_grid, near, on_one_grid
from studies.solving.refinement.limits import Estimate
from studies.solving.refinement.records import no_limit
from studies.solving.trials import FROM_REST, Clock, Question, race
from studies.solving.variants import (
    ELEMENT,
    FACES,
    FAILURES,
    MEASURE,
    MODEL,
    REFERENCE,
    Ladder,
    Variant,
    beside_wall,
    richer_walls,
    variants,
)
from studies.solving.verdict import (
    ENOUGH,
    NO_MESH,
    NONE,
    SETTLED,
    Difference,
    Verdict,
    Wall,
    errors,
    first_enough,
    judged,
)

ALGORITHM = "algorithm"
SHARES = {MEASURE: 0.6, FACES: 0.5, ALGORITHM: 0.5, ELEMENT: 0.6, MODEL: 1.0}  # of what is left, in this order
OF_REFERENCE = 0.7  # without a mesh of the exact measure that is enough nothing is
OF_WALLS = 0.3  # what two faces miss, where a few grids show it
BUDGET = 60.0
ERROR = "1%"
CHOOSING = 0.92  # of the budget; the rest is for loading, drawing and writing
ASIDE = 1.5  # of the seconds foreseen for a solve from rest, kept for it
DEARER = 2.8  # seconds of the next grid over those of the last, which has half the unknowns


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
    Raises UsageError as :func:`studies.scenes.complete.complete` does, for a mesh that cannot be refined, and for a
    quantity that the scene does not have.
    """
    clock = Clock(CHOOSING * budget)
    scene, request = first_grid(name, given, mesh, measure=REFERENCE, **options)
    if request.mesh == (1, 1) and not isinstance(scene, CutScene):
        raise UsageError("mesh 1x1 must have 2 or more elements along one coordinate: a single one is not refined")
    scene = on_one_grid(scene, request)  # of all variants
    lines = {key: value for key, value in request.settings.items() if key == "grading"}
    question = Question(name, scene, {**lines, **given}, options, error)
    cascade = Cascade(scene, error, quantity)
    with clock.share(OF_REFERENCE):
        stopped = follow(cascade, request, clock, progress)
    cascade.check_quantity(0)  # however few grids there was time for
    choice = Choice(question, request, budget, quantity or "", stopped)
    limit = limit_stated(cascade)
    if isinstance(limit, str):
        choice.reason = limit
    else:
        choice.quantity, choice.limit = cascade.name, limit
        _compare(choice, cascade, limit, clock, progress)
        if not choice.offers:
            choice.reason = f"nothing is surely within {100 * error:g} % on grids up to {cascade.last.mesh}"
    choice.seconds = clock.spent
    return choice


def loosened(choice: Choice, error: float) -> Choice:
    """What the same grids say of a larger error; its own recommendation is solved from rest, within the same budget.

    Algorithms are not tried again. Raises ValueError where no limit is known, or the error is smaller.
    """
    if choice.limit is None or error < choice.question.error:
        least = min(error, choice.question.error)
        raise ValueError(f"no quantity of {choice.question.name} is known to {100 * least:g} %")
    question, reference = replace(choice.question, error=error), choice.verdicts[0].ladder
    wall = choice.beyond if choice.beyond is not None and choice.beyond.tells(error) else choice.wall
    known = reference, choice.limit, choice.quantity, error, wall
    verdicts = [judged(each.ladder, *known) for each in choice.verdicts]
    clock, offers = Clock(CHOOSING * choice.budget), offers_of(question, verdicts, choice.algorithms)
    held = recommended(offers, choice.quantity, wall.truth(choice.limit), clock, lambda text: None)
    refused = [offer for offer in offers if not offer.holds and not offer.untried]
    reason = "" if held else f"nothing is surely within {100 * error:g} % on grids up to {reference.paths[-1].mesh}"
    answer = replace(choice, question=question, wall=wall, verdicts=verdicts, algorithms=[], reason=reason)
    answer.offers, answer.refused, answer.seconds = held, refused, clock.spent
    return answer


def _compare(choice: Choice, cascade: Cascade, limit: Estimate, clock: Clock, progress: Callable[[str], None]) -> None:
    """Walls, measures, algorithms, elements and models, what is recommended, and what there is time for then."""
    question, quantity = choice.question, cascade.name
    reference = Ladder(Variant(MEASURE, REFERENCE, cascade.grids[0].request), cascade.grids)
    walls, others = list[Ladder](), list[Ladder]()

    def verdict(ladder: Ladder) -> Verdict:
        return judged(ladder, reference, limit, quantity, question.error, choice.wall)

    def climb(ladders: Sequence[Ladder]) -> None:
        limits = lambda ladder: verdict(ladder).limit  # noqa: E731
        for text in climb_all(ladders, reference, quantity, limits, question.scene, question.error, clock):
            progress(text)
        if choice.beyond is None:
            choice.wall = Wall.of([judged(each, reference, limit, quantity, question.error) for each in walls])

    def offers() -> list[Offer]:
        choice.verdicts = [verdict(each) for each in (reference, *walls, *others)]
        return offers_of(question, choice.verdicts, choice.algorithms)

    with clock.share(OF_WALLS):
        for wall in richer_walls(question.scene, reference.variant.request):
            walls.append(Ladder(wall))
            climb(walls[-1:])
            if choice.wall.name != wall.name or choice.wall.left <= SETTLED * question.error:
                break
    if not choice.wall.tells(question.error):  # what is not known of a wall must not hide what is known on this one
        choice.beyond, choice.wall = choice.wall, Wall()
    on = next((each for each in (reference, *walls) if verdict(each).word in (ENOUGH, NO_MESH)), reference)
    beyond = verdict(on).limit
    if isinstance(beyond, Difference) and verdict(on).word == NO_MESH:
        with clock.share(OF_WALLS):
            limit = choice.limit = _finer(choice, cascade, limit, beyond.most, clock, progress)
            climb([each for each in walls if each is on])
    every = variants(question.scene, on.variant.request, question.given)
    others += (Ladder(beside_wall(each, on.variant)) for each in every)
    path = verdict(reference).enough or cascade.last
    foreseen = FROM_REST * path.seconds
    for axis, part in SHARES.items():
        with clock.share(part, ASIDE * foreseen * clock.wait):
            if axis != ALGORITHM:
                climb([each for each in others if each.variant.axis == axis])
            elif has_contact(question.scene):
                meshes = reference.paths[0].mesh, path.mesh
                choice.algorithms = race(question, quantity, meshes, foreseen, clock, progress)
    first = offers()
    choice.offers = recommended(first, quantity, choice.wall.truth(limit), clock, progress)
    choice.refused = [offer for offer in first if not offer.holds and not offer.untried]
    climb([*walls, *others] if choice.beyond is None else others)
    known = {offer.words for offer in first}
    choice.offers += [offer for offer in offers() if offer.words not in known]


def _finer(
    choice: Choice, cascade: Cascade, limit: Estimate, beyond: float, clock: Clock, progress: Callable[[str], None]
) -> Estimate:
    """The limit of the reference on finer grids, as the uncertainty ``beyond`` of the wall leaves less for grids."""
    grid = near(cascade.scene, cascade.last.request, FINER)
    if grid is not None:
        choice.stopped = follow(cascade, grid, clock, progress, beyond)
    stated = limit_stated(cascade)
    return stated if isinstance(stated, Estimate) else limit


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
            ladder.climb(scene, path, clock.left / clock.wait)


def follow(
    cascade: Cascade, request: Request, clock: Clock, progress: Callable[[str], None], beyond: float = 0.0
) -> str:
    """Follow the path on finer and finer grids until one of them is enough; returns why there are no more of them.

    request: on the next grid.  beyond: the part of the error that no grid reduces.  Raises UsageError for a quantity
    that the scene does not have.
    """
    grid: Request | None = request
    lost, reason = 0, ""
    while grid is not None and lost < FAILURES:
        text = grid.mesh_text
        if cascade.grids and not clock.fits(DEARER * cascade.last.seconds):
            return f"no time for {text}"
        progress(f"{REFERENCE} {text}")
        reason = f"the path does not reach its last load on {text}"
        followed = cascade.grow(grid, seconds=clock.left / clock.wait)
        if not followed and not cascade.grids and element_size(grid) < TOO_FINE * element_size(request):
            break
        lost = lost + 1 if cascade.grids and not followed else 0
        if followed:
            reason = ""
            cascade.check_quantity()
            limit = cascade.stated()
            if isinstance(limit, Estimate):
                progress(f"{cascade.name} {limit}")
                if first_enough(errors(cascade.values, limit), NONE, cascade.error - beyond) is not None:
                    return ""
        grid = near(cascade.scene, grid, FINER)
    return reason or f"no grid is finer than {text}"


def limit_stated(cascade: Cascade) -> Estimate | str:
    """The limit of the exact measure, or why it is not known."""
    if not cascade.grids:
        return f"the path of the measure {REFERENCE} does not reach its last load on any grid"
    limit = cascade.stated()
    reason = no_limit(cascade.last, cascade.name, cascade.error)
    if reason or isinstance(limit, Estimate):
        return reason or limit
    return f"the limit of {cascade.name} is not known: {limit}"
