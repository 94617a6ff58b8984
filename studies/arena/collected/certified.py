"""The answer to a frozen step, computed by one method and confirmed by others that are none of our algorithms.

The first is one of our algorithms whose answer passes the judge. The second solves the equations on its set, by SciPy
alone with residuals in extended precision, and checks every sign; where the step is a convex programme, an
interior-point solver must arrive at a set with the same displacements and forces, without an initial set. Elsewhere the
answer need not be unique.

With friction the second solves the equations on the states of the answer; signs and cones are checked by the judge.
Where the step is a sequence of convex programmes, the oracle must arrive at the same answer without initial states. A
different answer that passes the judge is not a contradiction: the solution is not unique then.
This module must not depend on the collection or on a file format.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import product

import numpy as np
from scipy import sparse
from scipy.sparse.linalg import splu

from contact.catalogue import ALGORITHMS
from contact.interchange import friction_oracle
from contact.interchange.friction_states import Known
from contact.interchange.linearised_step import FrozenFrictionalStep, FrozenStep
from contact.interchange.oracle import AGREEMENT, OracleError, minimise, refusal
from contact.problem import ContactSolution
from contact.verify import judge
from studies.experiments.friction.public_problems import algorithms

TRIED = ("semismooth", "lcp", "trial-and-error")  # the first whose answer passes the judge is used
REFINEMENTS = 5
SIGN = 1e-9  # of the largest force or gap: smaller values count as zero, touching without pressure
SAME = 1e-8  # of the largest force and displacement: two answers within it are the same
ROUNDED = 10.0  # times eps and the condition: deviation of two answers that rounding explains


class NotCertifiedError(ArithmeticError):
    """The methods agree on no answer to the step; the message has the reason."""


@dataclass(frozen=True, eq=False)
class Certified:
    """du (n,) and pressure (m,) of an algorithm, accepted by the judge, on a confirmed set.

    confirmed_by: the methods.  pressed, touching: candidates that carry force; that are closed without, to SIGN.
    """

    du: np.ndarray
    pressure: np.ndarray
    found_by: str
    pressed: np.ndarray
    touching: np.ndarray
    confirmed_by: tuple[str, ...] = ()


def find(step: FrozenStep) -> Certified:
    """The answer of the first algorithm that passes the judge; raises NotCertifiedError where none does."""
    reasons = []
    for name in TRIED:
        try:
            return _found_by(name, step)
        except NotCertifiedError as error:
            reasons.append(f"{name}: {error}")
    raise NotCertifiedError("; ".join(reasons))


def _found_by(name: str, step: FrozenStep) -> Certified:
    problem, algorithm = step.problem(), ALGORITHMS[name]()
    refused = algorithm.supports(problem)
    if refused is not None:
        raise NotCertifiedError(f"does not apply: {refused}")
    try:
        solution = algorithm.solve(problem, ContactSolution.at_rest(len(step.r), len(step.gap)))
    except ValueError as error:  # two candidates may share an unknown, which some algorithms do not take
        raise NotCertifiedError(str(error)) from None
    wrong = judge(problem, solution.u, solution.pressure).failures()
    if not solution.outcome.converged or wrong:
        raise NotCertifiedError(", ".join(wrong) if solution.outcome.converged else solution.outcome.value)
    gap = step.gap + step.G @ solution.u
    return Certified(solution.u, solution.pressure, name, *_states(step, _nodal(step, solution.pressure), gap))


def confirm(step: FrozenStep, answer: Certified, condition: float = 1.0) -> Certified:
    """The answer with the methods that confirm it; raises NotCertifiedError where one contradicts.

    condition: of K, where it is known; differences within its rounding error are no contradiction.
    """
    same = rounding(condition)
    du, forces = exact_on(step, answer.pressure > 0)
    _compare(step, answer, du, forces, same, "the equations")
    gap = step.gap + step.G @ du
    least = max(same * _large(step, gap), _digit(step, du))
    if np.any(forces < -same * np.max(forces, initial=0.0)) or np.any(gap < -least):
        raise NotCertifiedError(f"a force or a gap on the set of {answer.found_by} has the wrong sign")
    ways = ["equations on the set in extended precision"]
    if refusal(step) is None:
        ways += _by_interior_point(step, answer, same)
    return replace(answer, confirmed_by=tuple(ways))


def rounding(condition: float) -> float:
    """Relative difference within which two answers are the same, where K has this condition."""
    return max(SAME, ROUNDED * float(np.finfo(float).eps) * condition) if np.isfinite(condition) else SAME


def _compare(step: FrozenStep, answer: Certified, du: np.ndarray, forces: np.ndarray, same: float, whose: str) -> None:
    """Raises NotCertifiedError where displacements (n,) or nodal forces (m,) differ by more than rounding, ``same``.

    Displacements also agree where their difference changes forces only in the last digit: they may be zero.
    """
    moved = float(np.max(np.abs(step.K @ (answer.du - du)), initial=0.0))
    du = answer.du if moved <= ROUNDED * float(np.finfo(float).eps) * step.scale else du
    for what, one, other in (("displacements", answer.du, du), ("forces", _nodal(step, answer.pressure), forces)):
        apart, size = float(np.max(np.abs(one - other), initial=0.0)), float(np.max(np.abs(other), initial=0.0))
        if not apart <= same * size:
            raise NotCertifiedError(f"{what} of {answer.found_by} are {apart:.1e} off {whose}, of {size:.1e}")


def _by_interior_point(step: FrozenStep, answer: Certified, same: float) -> list[str]:
    """Raises NotCertifiedError where the answer on its set differs; empty where it does not converge.

    Sets are not compared: rounding decides which candidates that touch without force are in one. Nor are its forces.
    """
    try:
        pressure = minimise(step)[1]
    except OracleError:
        return []  # its forces of thin shells are accurate to 1e-6 only, and a set by them may have no answer
    _compare(step, answer, *exact_on(step, pressure > 0), same, "the interior point")
    return ["convex programme by an interior point"]


def _states(step: FrozenStep, forces: np.ndarray, gap: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Candidates (m,) that carry force, and that touch without."""
    pressed = forces > SIGN * np.max(np.abs(forces), initial=0.0)
    return pressed, ~pressed & (np.abs(gap) <= SIGN * _large(step, gap))


def _large(step: FrozenStep, gap: np.ndarray) -> float:
    """The largest gap, before or after the step."""
    return float(max(np.max(np.abs(step.gap), initial=0.0), np.max(np.abs(gap), initial=0.0)))


def _digit(step: FrozenStep, du: np.ndarray) -> float:
    """Rounding error of a gap under displacements (n,), also where it is zero before and after the step."""
    reach = float(np.max(np.abs(step.G.data), initial=0.0) * np.max(np.abs(du), initial=0.0))
    return ROUNDED * float(np.finfo(float).eps) * reach


def exact_on(step: FrozenStep, pressed: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """du (n,) and nodal forces (m,) with K du + r = G^T f and closed gaps on the set (m,) bool, none elsewhere.

    The saddle-point system by SuperLU, refined by residuals in extended precision. With consistent coupling, W p, the
    forces of all candidates come from the pressures of the set. Raises NotCertifiedError where it is singular.
    """
    n, nodes = len(step.r), np.flatnonzero(pressed)
    W = sparse.diags_array(step.weights, format="csc") if step.coupling is None else sparse.csc_matrix(step.coupling)
    push = sparse.csc_matrix(step.G.T @ W)[:, nodes]
    unit = float(np.max(np.abs(step.K.diagonal()), initial=0.0) / max(np.max(np.abs(push.data), initial=0.0), 1e-300))
    upper = sparse.hstack([step.K, -unit * push])
    lower = sparse.hstack([step.G[nodes], sparse.csr_matrix((len(nodes), len(nodes)))])
    A = sparse.csc_matrix(sparse.vstack([upper, lower]))
    b = np.concatenate([-step.r, -step.gap[nodes]])
    long = sparse.csr_matrix((A.data, A.indices, A.indptr), shape=A.shape[::-1]).T.astype(np.longdouble)
    try:
        factor = splu(A)
    except RuntimeError as error:
        raise NotCertifiedError(f"the equations on the set are singular: {error}") from None
    x = np.zeros(len(b), dtype=np.longdouble)
    for _ in range(REFINEMENTS):
        x = x + factor.solve((b - long @ x).astype(float))
    pressure = np.zeros(len(pressed))
    pressure[nodes] = unit * x[n:].astype(float)
    return x[:n].astype(float), np.asarray(W @ pressure)


def _nodal(step: FrozenStep, pressure: np.ndarray) -> np.ndarray:
    return np.asarray(step.weights * pressure if step.coupling is None else step.coupling @ pressure)


# --- with friction ----------------------------------------------------------------------------------------------------

EQUATIONS, PROGRAMMES = "equations on the states", "Tresca programmes by an interior point"


@dataclass(frozen=True, eq=False)
class FrictionCertified:
    """The answer, its algorithm, and the methods of confirmation.  several: whether the oracle has another."""

    known: Known
    found_by: str
    confirmed_by: tuple[str, ...] = ()
    several: bool = False


def find_with_friction(step: FrozenFrictionalStep) -> FrictionCertified:
    """By the first exact algorithm whose answer passes the judge; raises NotCertifiedError where none does.

    From rest, and then with all candidates sticking, as K alone may be singular.
    """
    problem, reasons = step.problem(), []
    rest = ContactSolution.at_rest(len(step.r), len(step.mu))
    starts = rest, replace(rest, active=np.ones(len(step.mu), bool))
    for (name, algorithm), start in product(algorithms().items(), starts):
        if np.isfinite(algorithm.epsilon):
            continue
        try:
            solution = algorithm.solve(problem, start)
        except (ValueError, ArithmeticError) as error:
            reasons.append(f"{name}: {error}")
            continue
        friction = solution.rubbed
        converged = solution.outcome.converged
        wrong = judge(problem, solution.u, solution.pressure, friction.force).failures() if converged else []
        if converged and not wrong:
            normal = problem.nodal_forces(solution.pressure)
            return FrictionCertified(Known(solution.u, normal, friction.force, friction.state), name)
        reasons.append(f"{name}: {', '.join(wrong) or solution.outcome.word}")
    raise NotCertifiedError("; ".join(dict.fromkeys(reasons)))


def confirm_with_friction(
    step: FrozenFrictionalStep, answer: FrictionCertified, condition: float = 1.0
) -> FrictionCertified:
    """The answer with the methods that confirm it; raises NotCertifiedError where the equations contradict.

    condition: of K, where it is known; its rounding error is not a contradiction, up to the tolerance of the oracle.
    """
    same = min(max(SAME, ROUNDED * float(np.finfo(float).eps) * condition), AGREEMENT)
    try:
        apart = _apart(step, friction_oracle.on_its_states(step, answer.known), answer.known)
    except OracleError as error:
        raise NotCertifiedError(str(error)) from None
    if not apart <= same:
        raise NotCertifiedError(f"the answer of {answer.found_by} is {apart:.1e} off the equations on its states")
    try:
        own = friction_oracle.minimise(step)
    except OracleError:
        return replace(answer, confirmed_by=(EQUATIONS,))
    if _apart(step, own, answer.known) <= same:
        return replace(answer, confirmed_by=(EQUATIONS, PROGRAMMES))
    pressure = np.divide(own.normal, step.weights, out=np.zeros_like(own.normal), where=step.weights > 0)
    wrong = judge(step.problem(), own.du, pressure, own.friction).failures()
    return replace(answer, confirmed_by=(EQUATIONS,), several=not wrong)


def _apart(step: FrozenFrictionalStep, own: Known, known: Known) -> float:
    comparison = friction_oracle.compared(step, own, known.du, known.normal, known.friction)
    return max(comparison.displacement_error, comparison.force_error)
