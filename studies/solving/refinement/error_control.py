"""A quantity to an error: grids refined where it is decided, until its limit is known well enough.

Each round solves on a grid and on the one with all its elements cut, T and T'. Bilinear elements converge with the
square of their size, so that a round says of the limit::

    L = J' + (J' - J)/3

and two rounds with different grids say how well: L is within ::

    u = max(SAFETY |L - L_before|, |J' - J|/3, rim/2)

of the limit. The second term is all that Richardson's law adds: with nodes that hang on coarse elements the error on T
may be more than four times that on T'. The third is half of what the rim of a patch of contact, which jumps from node
to node, has done from T to T'. A first round alone knows |J' - J|. Where that is not enough, the difference between the
two shows which elements to cut (:mod:`studies.solving.refinement.goal`), and the next round begins. A grid whose
elements have modes by themselves is not used: its mesh is made finer across them, and the round begins again.
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from contact.problem import Outcome
from studies.ask.request import Request
from studies.ask.scene import Scene, UsageError
from studies.solving.refinement.adaptive_grids import GROWTH, Family
from studies.solving.refinement.goal import indicators, on_grid
from studies.solving.refinement.limits import SAFETY, Estimate
from studies.solving.refinement.mesh_error import headed
from studies.solving.refinement.records import (
    default_quantity,
    no_limit,
    record_estimate,
    record_grids,
    record_loads,
)
from studies.solving.refinement.richardson import correction
from studies.solving.result import Result
from studies.solving.solve import solve

MOST = 60_000  # unknowns of the next finer grid, at which a round is not begun
FEWEST, MOST_ROUNDS = 2, 8
TOO_LONG = "elements are too long and have unstable modes, and the budget leaves no time for shorter ones"
TOO_COARSE = 2  # times that a coarsest grid which cannot carry the load, or lacks the quantity, is cut everywhere


@dataclass(frozen=True)
class Round:
    """A quantity on a grid and on the one with all elements cut, and their unknowns.

    seconds: CPU time of the round; finer_seconds, own_seconds: of the finer grid and of the other alone, which may be
    that of the round before.  rim: what the rim of a patch of contact adds to the indicators.
    """

    value: float
    finer: float
    unknowns: int
    finer_unknowns: int
    seconds: float
    finer_seconds: float
    rim: float = 0.0
    own_seconds: float = 0.0

    @property
    def limit(self) -> float:
        """Richardson's for the order 2."""
        return self.finer + correction((2.0, 1.0), (self.value, self.finer))


def estimate(rounds: Sequence[Round]) -> Estimate:
    """What all rounds so far say of the limit."""
    last = rounds[-1]
    step = abs(last.finer - last.value)
    within = step if len(rounds) == 1 else max(SAFETY * abs(last.limit - rounds[-2].limit), step / 3, last.rim / 2)
    scale = abs(last.limit) or np.finfo(float).tiny
    return Estimate(last.limit, within / scale, abs(last.finer - last.limit) / scale)


def parse_error(text: str) -> float:
    """The relative error of "1%" or "0.01"; raises UsageError unless it is in [0.01%, 50%]."""
    try:
        value = float(text.removesuffix("%")) / (100 if text.endswith("%") else 1)
    except ValueError:
        value = float("nan")
    if not 1e-4 <= value <= 0.5:
        raise UsageError(f"error {text!r} must be a relative error in [0.01%, 50%], e.g. 1% or 0.01")
    return value


def solve_to_error(
    scene: Scene,
    request: Request,
    error: float,
    quantity: str | None = None,
    progress: Callable[[str], None] = lambda text: None,
    most: int = MOST,
    budget: float = math.inf,
) -> tuple[Result, bool]:
    """The result on the finest grid, and whether its quantity is surely known to a relative ``error``.

    budget: CPU seconds, beyond which no round is begun; the best answer in that time is one.

    request: on the coarsest mesh.  quantity: by default the force, or the first that the scene has references for. The
    quantities hold the estimate, the table ``refinement`` the rounds. A path that ends before its last load ends the
    refinement: its result is returned. Raises UsageError for a quantity that the scene does not have.
    The table ``loads`` states every load. No limit is stated for what has none under a point load.
    """
    family, rounds, seen_at = Family.of(scene, request), list[Round](), list[list[Round]]()
    known, too_coarse, begun = None, 0, time.process_time()
    for _ in range(MOST_ROUNDS):
        start, head = time.process_time(), f"round {len(rounds) + 1}"
        if rounds:
            head += f", about {GROWTH * rounds[-1].seconds:.2g} CPU s"
        tell = headed(progress, head)
        coarse = known or solve(scene, family.asked, tell)
        if coarse.unsupported:
            return coarse, False
        late = time.process_time() - begun > budget
        if not coarse.outcome.converged:
            if rounds or late or too_coarse == TOO_COARSE or coarse.outcome is Outcome.WRONG:
                return coarse, False
            family, too_coarse = family.everywhere(), too_coarse + 1
            continue
        quantity = quantity or default_quantity(scene, coarse.quantities)
        finer = family.everywhere()
        if quantity not in coarse.quantities:
            if too_coarse == TOO_COARSE or not _may_come(scene, quantity):
                raise UsageError(f"{scene.name} has no quantity {quantity!r}; it has {', '.join(coarse.quantities)}")
            if late:
                coarse.reason = f"the grid of {coarse.counters['dofs']} unknowns has no {quantity}"
                return coarse, False
            family, too_coarse = finer, too_coarse + 1
            continue
        fine = solve(scene, finer.asked, tell)
        if not fine.outcome.converged:
            return fine, False
        if quantity not in fine.quantities:
            fine.reason = f"the grid of {fine.counters['dofs']} unknowns has no {quantity}, though a coarser one has it"
            return fine, False
        shorter = family.shortened(scene, fine)
        if shorter is not family:
            if time.process_time() - begun > budget:
                fine.reason = TOO_LONG
                return fine, False
            family, known = shorter, None
            continue
        unknowns, most_unknowns = (int(each.counters["dofs"]) for each in (coarse, fine))
        value, finer_value = coarse.quantities[quantity], fine.quantities[quantity]
        following, rim = _next(family, finer, coarse, fine, quantity)
        seconds = time.process_time() - start, fine.timing["cpu"]
        rounds.append(Round(value, finer_value, unknowns, most_unknowns, *seconds, rim, coarse.timing["cpu"]))
        seen_at.append(at_loads(coarse, fine, quantity, rounds[-1]))
        record_rounds(fine, quantity, rounds)
        reason = no_limit(fine, quantity, error)
        if reason:
            fine.reason = reason
            return fine, False
        limit = estimate(rounds)
        progress(f"{quantity} {limit}")
        record_estimate(fine, quantity, limit, error)
        record_loads(fine, quantity, of_rounds(seen_at))
        if len(rounds) >= FEWEST and limit.uncertainty <= error:
            return fine, True
        how_well = _known(quantity, limit, error)
        if time.process_time() - begun + GROWTH * rounds[-1].seconds > budget:
            fine.reason = how_well
            return fine, True
        if most_unknowns > most / 2 or following.asked == family.asked:  # too many, or all that is marked is deepest
            break
        family = following
        known = fine if family.asked == finer.asked else None
    fine.reason = f"no grid of up to {most} unknowns gives {quantity} surely within {100 * error:g} %"
    if len(rounds) < FEWEST and limit.uncertainty <= error:
        fine.reason += f": {how_well}"
    return fine, False


def _known(quantity: str, limit: Estimate, error: float) -> str:
    """How well, where that is not enough."""
    sure = f"not to {100 * error:g} %" if limit.uncertainty > error else "by two grids alone"
    return f"{quantity} is known to {100 * limit.uncertainty:.2g} %, {sure}"


def _next(family: Family, finer: Family, coarse: Result, fine: Result, quantity: str) -> tuple[Family, float]:
    """The grid of the next round, refined where the quantity needs it, and what the rim has of the indicators.

    Where there is no dual problem, it is refined everywhere.
    """
    if family.tree is None or finer.tree is None:
        return finer, 0.0
    try:
        on_both = on_grid(coarse, quantity), on_grid(fine, quantity)
    except (KeyError, ArithmeticError):
        return finer, 0.0
    eta, rim = indicators(*on_both, family.tree.parents(finer.tree))
    return family.refined(eta), rim


def _may_come(scene: Scene, quantity: str) -> bool:
    """Whether a quantity that a grid lacks may come with finer ones: of a limit point, or with a reference."""
    return "limit_" in quantity or quantity in {reference.quantity for reference in scene.references}


def record_rounds(result: Result, quantity: str, rounds: Sequence[Round]) -> None:
    """The rounds as a table."""
    record_grids(result, [{"quantity": quantity, **vars(each), "limit": each.limit} for each in rounds])


def at_loads(coarse: Result, fine: Result, quantity: str, last: Round) -> list[Round]:
    """The round at every requested load; the rim of the last is taken to have the same part in all."""
    values = [[step.seen.get(quantity) for step in result.loads] for result in (coarse, fine)]
    if fine.end is None or fine.end.trace is not None or None in values[0] + values[1]:
        return []
    pairs = zip(*values, strict=True)
    return [replace(last, value=a, finer=b, rim=last.rim * abs(b / (last.finer or 1.0))) for a, b in pairs]


def of_rounds(rounds: Sequence[Sequence[Round]]) -> list[Estimate | str]:
    """The estimates of every load from the rounds of all loads; none where a round does not have them."""
    return [estimate(each) for each in zip(*rounds, strict=True)] if all(rounds) else []
