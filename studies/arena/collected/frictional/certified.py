"""The answer to a frozen step with friction, found by one way and confirmed by others that are no algorithm of ours.

The first is an algorithm of ours before the judge of friction. The second solves the equations on its states anew;
signs and cones are the judge's. Where the step is a sequence of convex programmes, the oracle has to come to the same
answer from no states at all. An answer of its own that the judge takes is no contradiction: answers are several then.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import product

import numpy as np

from contact.interchange.friction_oracle import compared, minimise, on_its_states
from contact.interchange.friction_states import Known
from contact.interchange.linearised_step import FrozenFrictionalStep
from contact.interchange.oracle import AGREEMENT, OracleError
from contact.problem import ContactSolution
from contact.verify import judge
from studies.arena.collected.certified import ROUNDED, SAME, NotCertifiedError
from studies.experiments.friction.public.public_problems import algorithms

EQUATIONS, PROGRAMMES = "equations on the states", "Tresca programmes by an interior point"


@dataclass(frozen=True, eq=False)
class FrictionCertified:
    """The answer, who found it, and the ways that confirm it.  several: whether the oracle has another sound one."""

    known: Known
    found_by: str
    confirmed_by: tuple[str, ...] = ()
    several: bool = False


def find(step: FrozenFrictionalStep) -> FrictionCertified:
    """By the first exact algorithm whose answer the judge takes; raises NotCertifiedError where none has one.

    From rest, and where K leaves free what contacts hold, from all of them sticking.
    """
    problem, reasons = step.problem(), []
    rest = ContactSolution.at_rest(len(step.r), len(step.mu))
    starts = rest, replace(rest, active=np.ones(len(step.mu), bool))
    for (name, algorithm), start in product(algorithms().items(), starts):
        if np.isfinite(algorithm.epsilon):
            continue
        try:
            found = algorithm.solve(problem, start)
        except (ValueError, ArithmeticError) as error:
            reasons.append(f"{name}: {error}")
            continue
        friction = found.rubbed
        wrong = judge(problem, found.u, found.pressure, friction.force).failures() if found.outcome.converged else []
        if found.outcome.converged and not wrong:
            normal = problem.nodal_forces(found.pressure)
            return FrictionCertified(Known(found.u, normal, friction.force, friction.state), name)
        reasons.append(f"{name}: {', '.join(wrong) or found.outcome.word}")
    raise NotCertifiedError("; ".join(dict.fromkeys(reasons)))


def confirm(step: FrozenFrictionalStep, answer: FrictionCertified, condition: float = 1.0) -> FrictionCertified:
    """The answer with the ways that confirm it; raises NotCertifiedError where the equations contradict.

    condition: of K, where it is known; what rounding makes of it is no contradiction, up to the oracle's agreement.
    """
    same = min(max(SAME, ROUNDED * float(np.finfo(float).eps) * condition), AGREEMENT)
    try:
        apart = _apart(step, on_its_states(step, answer.known), answer.known)
    except OracleError as error:
        raise NotCertifiedError(str(error)) from None
    if not apart <= same:
        raise NotCertifiedError(f"the answer of {answer.found_by} is {apart:.1e} off the equations on its states")
    try:
        own = minimise(step)
    except OracleError:
        return replace(answer, confirmed_by=(EQUATIONS,))
    if _apart(step, own, answer.known) <= same:
        return replace(answer, confirmed_by=(EQUATIONS, PROGRAMMES))
    pressure = np.divide(own.normal, step.weights, out=np.zeros_like(own.normal), where=step.weights > 0)
    wrong = judge(step.problem(), own.du, pressure, own.friction).failures()
    return replace(answer, confirmed_by=(EQUATIONS,), several=not wrong)


def _apart(step: FrozenFrictionalStep, own: Known, known: Known) -> float:
    found = compared(step, own, known.du, known.normal, known.friction)
    return max(found.displacement_error, found.force_error)
