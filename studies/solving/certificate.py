"""What the judge says of a state, and of the way that led to it, by name and number.

Nothing here knows a scene, and nothing solves.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from contact.continuation.stability import Stability, stability
from contact.newton.solves import RESIDUAL_TOLERANCE
from contact.problem import ContactProblem, ContactSolution, Linearised
from contact.verify import claim, gap_residuals, judge

if TYPE_CHECKING:
    from contact.swept import Crossing

UNITS = {"penetration": "mm", "tension": "MPa", "complementarity": "MPa mm"}  # of the residuals that have one
NO_STATE = "what the judge refuses is not an equilibrium"
NO_POTENTIAL = "friction has no potential whose second variation would be looked at"
UNTOLD = "friction"  # of an answer without friction forces although candidates are pressed
SWEPT = "swept"  # the failure of a state that a candidate has reached through the foundation
UNSET = "set"  # the failure of a contact set that is not that of the nodes that press
CARRIES = 1e-8  # of the largest pressure, and of a large gap: less is neither pressed nor open
INVERTED = "inverted"  # the failure of a state in which an element has no volume left, or less than none


def certificate(
    problem: ContactProblem,
    state: ContactSolution,
    epsilon: float = math.inf,
    tolerance: float = RESIDUAL_TOLERANCE,
    passed: Sequence[Crossing] = (),
    before: tuple[ContactProblem, ContactSolution] | None = None,
) -> dict[str, Any]:
    """What the judge says of a state, by the law of its epsilon: failures by name, their diagnosis, kkt, balances,
    scales.

    exceeded: size and bound of the residuals that are above theirs, by name; only where some are.
    stability: word, sentence and counts of :class:`contact.continuation.stability.Stability`; it is not a failure.
    kkt has the true gaps, whatever epsilon.  tolerance: the equilibrium that was asked for. It is the claim that is
    judged: where it is wider than the judge's own bound, it is the bound, of equilibrium and of what follows from it.
    A set that leaves out nodes that press, or has open ones in it, is UNSET: readings of the patch are taken from it.
    Where an element has no volume left INVERTED is a failure: St. Venant-Kirchhoff material resists that with finite
    forces, and balances them inside out.
    passed: what went through the foundation on the way from the state before; a failure of its own, SWEPT.
    before: with friction, problem and state at the last accepted load, from which slip is counted.
    """
    if before is None:
        problem, friction, since, forces = _linearised_once(problem, state.u), None, None, state.pressure
    else:  # the anchors of the slip are recomputed, not taken from the answer
        from contact.slip import anchors_left  # no solve without friction loads it

        problem = problem.since(anchors_left(problem, *before, epsilon))
        friction = np.zeros((len(state.pressure), 2)) if state.friction is None else state.friction.force
        since, forces = before[1].u, problem.nodal_forces(state.pressure)
    verdict = judge(problem, state.u, state.pressure, friction, epsilon=epsilon, since=since)
    record = verdict.certificate
    record["kkt"] |= gap_residuals(problem, state.u, forces, math.inf)
    exceeded = verdict.exceeded(**claim(tolerance, len(state.u)))
    failures, inside_out = list(exceeded), _inside_out(problem, state.u)
    set_wrong = "" if failures else _set_wrong(problem, state, epsilon, verdict.length)
    if friction is not None:
        if state.friction is None and forces.any():
            failures.append(UNTOLD)
        sizes = {**verdict.kkt, **verdict.balances}
        diagnosis = [f"{name}: {sizes[name]:.2e}" for name in failures if name in sizes]
        standing = Stability(None, why=NO_POTENTIAL)
    elif failures:
        from contact.diagnosis import diagnose  # loaded with a failure alone

        diagnosis = diagnose(problem, state.u, state.pressure, epsilon=epsilon)
        standing = Stability(None, why=NO_STATE)
    else:
        diagnosis = []
        refused = bool(inside_out or set_wrong)
        standing = Stability(None, why=NO_STATE) if refused else stability(problem, state, epsilon)
    if set_wrong:
        failures.append(UNSET)
        diagnosis.append(set_wrong)
    if inside_out:
        failures.append(INVERTED)
        diagnosis.append(inside_out)
    if passed:
        failures.append(SWEPT)
        shares = f"{passed[0].enters:.3g} to {passed[0].leaves:.3g}"
        diagnosis.append(f"{SWEPT}: {passed[0]}, from {shares} of its way")
    record |= {"exceeded": exceeded} if exceeded else {}
    return {**record, "failures": failures, "diagnosis": diagnosis, "stability": standing.record}


def _set_wrong(problem: ContactProblem, state: ContactSolution, epsilon: float, length: float) -> str:
    """How many nodes that press are not in the contact set, and how many open ones are; empty where none."""
    pressed = state.pressure > CARRIES * float(np.max(state.pressure, initial=0.0))
    opened = problem.gap(state.u) + state.pressure / epsilon > CARRIES * length
    left_out, extra = int(np.sum(pressed & ~state.active)), int(np.sum(opened & ~pressed & state.active))
    if not left_out and not extra:
        return ""
    return f"{UNSET}: {left_out} nodes that press are left out of the contact set, {extra} open ones are in it"


def _inside_out(problem: ContactProblem, u: np.ndarray) -> str:
    """Which elements of a finite state have no volume left; empty where none, or where volumes are not known."""
    if problem.volume_ratios is None or not np.all(np.isfinite(u)):
        return ""
    ratios = problem.volume_ratios(u)
    count, least = int(np.sum(ratios <= 0)), float(np.nanmin(ratios, initial=np.inf))
    turned = f"{count} of {len(ratios)} elements {'is' if count == 1 else 'are'} inside out"
    return f"{INVERTED}: {turned}, the worst of {least:.3g} times its volume at rest" if count else ""


def refusal(certificate: Mapping[str, Any]) -> str:
    """Why the judge refuses a state: each failed condition with its size and its bound; empty where it does not."""
    reasons = {line.partition(":")[0]: line for line in certificate["diagnosis"]}
    for name, (size, bound) in certificate.get("exceeded", {}).items():
        unit = f" {UNITS[name]}" if name in UNITS else ""
        above = f"{name} {size:.3g}{unit} above {bound:.3g}{unit}"
        reasons[name] = f"{name} is not a number" if math.isnan(size) else above
    return ", ".join(reasons.get(name, name) for name in certificate["failures"])


def _linearised_once(problem: ContactProblem, u: np.ndarray) -> ContactProblem:
    """The problem, whose linearisation at ``u`` (n,) the judge and the count of eigenvalues share."""
    linearise, kept = problem.linearise, list[Linearised]()

    def once(at: np.ndarray, memory: object) -> Linearised:
        if at is not u or memory is not None:
            return linearise(at, memory)
        if not kept:
            kept.append(linearise(at, None))
        return kept[0]

    return replace(problem, linearise=once)
