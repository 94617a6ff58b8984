"""Two answers to one problem: the same, or why not, by what can be computed of each alone.

Explanations are checked, not guessed, and begin with a class of :mod:`studies.analysis.agreement`: the
error of a state is that of one more Newton step in dense algebra, stability is counted by the eigenvalues of the dense
tangent on what the set leaves free, and of two different stable equilibria each must be confirmed by the way of solving
that has found the other; so must two states with friction whose paths were cut alike.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.linalg import null_space

from contact.problem import ContactAlgorithm, ContactProblem, ContactSolution
from contact.slip import slip_of
from studies.solving.disagreement import BRANCHES, LOAD_STEPS, UNSTABLE, Facts, why

ALIKE = 1e-6  # of displacements over the largest, of contact forces over the forces in balance
MARGIN = 30.0  # times the error of one more Newton step: its estimate is of first order
ZERO = 1e-9  # of the largest eigenvalue: less is neither positive nor negative
AGREES = "agrees"
TOLERANCE = "within what the tolerance leaves"


@dataclass(frozen=True, eq=False)
class Answer:
    """A converged state of a problem, and the algorithm that has found it.

    ways: the stages of its path and the parameters that were accepted on them.  steady: whether no state was unstable
    that its path has led through.  tight: the algorithm to a tight tolerance, where its own is loose.
    """

    problem: ContactProblem
    state: ContactSolution
    algorithm: ContactAlgorithm
    ways: Sequence[tuple[str, tuple[float, ...]]] = ()
    steady: bool = True
    tight: ContactAlgorithm | None = None


def compared(one: Answer, other: Answer) -> str:
    """AGREES, or what explains the difference, or nothing."""
    apart = difference(one, other)
    if apart <= ALIKE:
        return AGREES
    if one.problem.coulomb is not None:
        return _with_friction(one, other, apart)
    errors = [error_of(each) for each in (one, other)]
    if apart <= MARGIN * max(errors):
        return f"{TOLERANCE}: apart by {apart:.1e}, one more step moves them by {max(errors):.1e}"
    counts = [unstable(each) for each in (one, other)]
    if any(counts):
        return f"{UNSTABLE}: {counts[0]} and {counts[1]} eigenvalues are negative, apart by {apart:.1e}"
    if _parted(one, other):
        return f"{UNSTABLE}: on the way to them, apart by {apart:.1e}"
    if confirms(one, other.state) and confirms(other, one.state):
        return f"{BRANCHES}, each confirmed by the other way of solving: apart by {apart:.1e}"
    return ""


def _with_friction(one: Answer, other: Answer, apart: float) -> str:
    """What explains a difference with friction, or nothing: other steps, or a state that both ways of solving keep."""
    cause = why(*(Facts(friction=True, steps=list(each.ways), stable=not _parted(one, other)) for each in (one, other)))
    if cause == LOAD_STEPS:
        steps = [sum(len(way) for _, way in each.ways) for each in (one, other)]
        return f"{cause}: {steps[0]} and {steps[1]} on the path, apart by {apart:.1e}"
    if cause == UNSTABLE:
        return f"{cause}: on the way to them, apart by {apart:.1e}"
    errors = [_left(each) for each in (one, other)]
    if apart <= MARGIN * max(errors):
        return f"{TOLERANCE}: apart by {apart:.1e}, solved on they move by {max(errors):.1e}"
    if confirms(one, other.state) and confirms(other, one.state):
        return f"{cause}, each confirmed by the other way of solving: apart by {apart:.1e}"
    return ""


def _parted(one: Answer, other: Answer) -> bool:
    """Whether the paths led through unstable states, and to problems whose foundations stand in different places."""
    if one.steady and other.steady:
        return False
    u = one.state.u
    apart = np.max(np.abs(one.problem.gap(u) - other.problem.gap(u)), initial=0.0)
    return bool(apart > ALIKE * float(np.max(np.abs(u), initial=0.0)))


def _left(answer: Answer) -> float:
    """How far its own algorithm moves a state with friction to a tight tolerance; 0 where its own is as tight."""
    if answer.tight is None:
        return 0.0
    solution = answer.tight.solve(answer.problem, _again(answer.state))
    return difference(answer, replace(answer, state=solution)) if solution.outcome.converged else 0.0


def _again(state: ContactSolution) -> ContactSolution:
    """The state as a start from which slip is counted as it has been."""
    if state.friction is None:
        return state
    return replace(state, friction=replace(state.friction, anchors=state.friction.since))


def difference(one: Answer, other: Answer) -> float:
    """The larger of the relative differences of displacements and of contact forces; sets do not count by themselves.

    A candidate that touches without pressure may be in the set or not.
    """
    u, v = one.state.u, other.state.u
    f, g = (_force(each) for each in (one, other))
    scale = max(one.problem.linearise(u, None).scale, float(np.linalg.norm(f))) or 1.0
    size = max(float(np.max(np.abs(u), initial=0.0)), float(np.max(np.abs(v), initial=0.0))) or 1.0
    return max(float(np.max(np.abs(u - v), initial=0.0)) / size, float(np.linalg.norm(f - g)) / scale)


def _force(answer: Answer) -> np.ndarray:
    """That of the foundation on the unknowns (n,), friction included."""
    problem, state = answer.problem, answer.state
    if problem.coulomb is None or state.friction is None:
        return problem.contact_force(state.u, state.pressure)
    return problem.since(state.friction.since).contact_force(state.u, state.pressure, state.friction.force)


def tangent(answer: Answer, held: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Dense: K (n, n) with the springs of a finite epsilon, rows (a, n) of G that an exact set holds, residual (n,).

    held (m,) bool: the candidates that are held at their gaps.
    """
    problem, state = answer.problem, answer.state
    u, p, epsilon = state.u, state.pressure, answer.algorithm.epsilon
    lin = problem.linearise(u, None)
    K = problem.stiffness(lin, u, p).toarray()
    G = problem.gap_jacobian(u).toarray()
    residual = lin.residual - problem.contact_force(u, p) - _pull(answer)
    if np.isfinite(epsilon):
        W = problem.weight_matrix.toarray()[:, held]
        return K + epsilon * G.T @ W @ G[held], np.zeros((0, len(u))), residual
    return K, G[held], residual


def pressed(answer: Answer) -> np.ndarray:
    """Candidates (m,) bool that are in the set and carry pressure."""
    return np.asarray(answer.state.active & (answer.state.pressure > 0))


def error_of(answer: Answer) -> float:
    """What one more Newton step on its set would move a state by, displacements and forces as in :func:`difference`."""
    K, G, residual = tangent(answer, pressed(answer))
    u = answer.state.u
    gap = answer.problem.gap(u)[pressed(answer)][: len(G)]
    n, a = len(u), len(G)
    whole = np.block([[K, -G.T], [G, np.zeros((a, a))]])
    try:
        step = np.linalg.lstsq(whole, np.append(-residual, -gap), rcond=1e-15)[0]
    except np.linalg.LinAlgError:
        return float("inf")
    scale = max(answer.problem.linearise(u, None).scale, 1e-300)
    size = float(np.max(np.abs(u), initial=0.0)) or 1.0
    return max(float(np.max(np.abs(step[:n]), initial=0.0)) / size, float(np.linalg.norm(G.T @ step[n:])) / scale)


def unstable(answer: Answer) -> int:
    """Negative eigenvalues of the symmetric part of the tangent, on the motions that pressed candidates leave free."""
    return signs(answer, pressed(answer))[0]


def signs(answer: Answer, held: np.ndarray) -> tuple[int, int]:
    """Eigenvalues of the symmetric part of the tangent on the motions that leave the held gaps: below zero, and none.

    By dense algebra on a basis of these motions, of the tangent with unit diagonal: no factorisation of a solve.
    """
    K, G, _ = tangent(answer, held)
    stretch = 1 / np.sqrt(np.maximum(np.abs(np.diag(K)), np.finfo(float).tiny))
    K, G = stretch[:, None] * (K + K.T) / 2 * stretch, G * stretch
    free = null_space(G) if len(G) else np.eye(len(K))
    if not free.shape[1]:
        return 0, 0
    values = np.linalg.eigvalsh(free.T @ K @ free)
    zero = ZERO * float(np.max(np.abs(values)))
    return int(np.sum(values < -zero)), int(np.sum(np.abs(values) <= zero))


def confirms(answer: Answer, state: ContactSolution) -> bool:
    """Whether the algorithm of an answer, on its problem, stays at another state when it sets out from there.

    With friction it counts the slip from where the other state has.
    """
    solution = answer.algorithm.solve(answer.problem, _again(state))
    if not solution.outcome.converged:
        return False
    return difference(replace(answer, state=solution), replace(answer, state=state)) <= ALIKE


def _pull(answer: Answer) -> np.ndarray:
    """Force of friction on the unknowns (n,), none without it."""
    problem, state = answer.problem, answer.state
    if problem.coulomb is None or state.friction is None:
        return np.zeros_like(state.u)
    slips = slip_of(problem, state.friction.since).jacobian(state.u)
    return np.asarray(slips.T @ state.friction.force.ravel())
