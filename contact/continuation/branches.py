"""From an unstable equilibrium to the stable ones beside it, at the same load.

The state is pushed a little along a motion on which its tangent is negative, both ways, and descends::

    u_k+1 = the equilibrium of r(u) + mu D (u - u_k) = G^T W p,    g >= 0, p >= 0, p g = 0

D is the size of the diagonal of K. Such a step is the minimum of the potential with springs mu D that hold the body
where it is, so that the potential falls from step to step (implicit Euler of the gradient flow, proximal point). With
mu above |lambda|, lambda the eigenvalue of K in the measure of D, each step has one solution, and the distance from the
unstable state grows by about the factor mu/(mu - |lambda|) a step; where steps shrink, the springs soften. What
descends to an equilibrium ends there without springs, by the algorithm's own Newton.
Sources: Rockafellar, SIAM J. Control Optim. 14 (1976) 877-898; Coffey, Kelley, Keyes, SIAM J. Sci. Comput. 25 (2003)
553-569.

Where there is no potential the same steps are taken and the end is judged all the same. No scene may enter here.
"""

from dataclasses import dataclass, replace

import numpy as np
from scipy import sparse

from contact.algorithms.base import answered
from contact.continuation.spectrum import lowest, spectrum
from contact.continuation.stability import STABLE, UNSTABLE, Stability, stability
from contact.newton.solves import Tally
from contact.problem import ContactAlgorithm, ContactProblem, ContactSolution, Linearisation

PUSH = 1e-3  # of all displacement, along the mode
STEPS = 80  # of a descent
SADDLES = 4  # descents: one may end at another unstable state
SOFTER, STIFFER = 0.5, 4.0
LEAP = 4.0  # times the last step: one that is longer has not descended, but found something else
ARRIVED = 1e-6  # change of a step over all displacement, with springs no stiffer than at the start
SAME = 1e-4  # distance over all displacement below which two states are one


@dataclass(frozen=True, eq=False)
class Branch:
    """Where one push has led.

    mode (n,): the unit motion; sign: of the push.  solution: the state that the descent has ended at, converged or not.
    stability: of it.  away: its distance from the unstable state, over all displacement.  reason: why it is none.
    """

    mode: np.ndarray
    sign: int
    solution: ContactSolution
    stability: Stability
    away: float
    reason: str = ""

    @property
    def found(self) -> bool:
        """Whether a stable equilibrium was found."""
        return not self.reason


def stable_branches(
    problem: ContactProblem, state: ContactSolution, algorithm: ContactAlgorithm
) -> tuple[Branch, Branch] | None:
    """Both branches off an unstable ``state`` along its most negative mode; None where it has no negative mode.

    Raises SingularMatrixError, ValueError where the tangent does not tell.
    """
    judged = stability(problem, state, algorithm.epsilon)
    if judged.word != UNSTABLE:
        return None
    mode = _most_negative(problem, state, algorithm.epsilon, judged)
    return _descended(problem, state, algorithm, mode, 1), _descended(problem, state, algorithm, mode, -1)


def _descended(
    problem: ContactProblem, state: ContactSolution, algorithm: ContactAlgorithm, mode: np.ndarray, sign: int
) -> Branch:
    """The state at the end of the descent from a push; where that is unstable, too, it is left by its own mode."""
    size, tally, at, along = float(np.linalg.norm(state.u)) or 1.0, Tally(), state, mode
    for _ in range(SADDLES):
        end = _down(problem, at, algorithm, sign * along, size, tally)
        away = float(np.linalg.norm(end.u - state.u)) / size
        if not end.outcome.converged:
            why = end.outcome.value
            return Branch(mode, sign, end, Stability(None, why=why), away, f"the descent does not converge: {why}")
        judged = stability(problem, end, algorithm.epsilon)
        if judged.word != UNSTABLE:
            break
        at, along = end, _most_negative(problem, end, algorithm.epsilon, judged)
        along = -along if along @ mode < 0 else along
    reason = "" if judged.word == STABLE else f"the descent ends at a state that is {judged.sentence}"
    if away <= SAME:
        reason = "the descent goes back to the same state"
    return Branch(mode, sign, end, judged, away, reason)


def _most_negative(problem: ContactProblem, state: ContactSolution, epsilon: float, judged: Stability) -> np.ndarray:
    """The mode (n,) of the most negative eigenvalue among the softest of those that the verdict has counted."""
    below = lowest(problem, state, epsilon, judged.negative or 0, spectrum(problem, state, epsilon))
    return np.asarray(below.modes[:, int(np.argmin(below.eigenvalues))])


def _down(
    problem: ContactProblem,
    state: ContactSolution,
    algorithm: ContactAlgorithm,
    push: np.ndarray,
    size: float,
    tally: Tally,
) -> ContactSolution:
    """The end of one descent from a state and a unit push, with the counters of all so far."""
    K = problem.stiffness(problem.linearise(state.u, None), state.u, state.pressure)
    D = np.abs(K.diagonal())
    D[D == 0] = np.max(D, initial=0.0) or 1.0
    D[len(D) - problem.multipliers :] = 0.0
    mu = first = 2 * abs(float(push @ (K @ push))) / float(push @ (D * push))
    at, last = replace(state, u=state.u + PUSH * size * push), PUSH * size
    for _ in range(STEPS):
        lower = answered(algorithm, held_at(problem, at.u, mu * D), at)
        tally.add(replace(lower, history=()))
        moved = float(np.linalg.norm(lower.u - at.u))
        if not lower.outcome.converged or moved > LEAP * last:
            mu *= STIFFER
            continue
        if moved <= ARRIVED * size and mu <= first:
            break
        # softer springs while steps grow would leave the tangent negative; where they shrink it no longer is
        mu *= SOFTER if moved < last else 1.0
        at, last = lower, moved
    end = answered(algorithm, problem, at)
    tally.add(replace(end, history=()))
    return replace(end, counters=dict(tally.counters))


def held_at(problem: ContactProblem, u: np.ndarray, springs: np.ndarray) -> ContactProblem:
    """The problem with springs (n,) [N/mm] from every unknown to its value in u (n,)."""
    diagonal = sparse.csc_matrix(sparse.diags_array(springs))

    def linearise(v: np.ndarray, memory: object) -> Linearisation:
        lin = problem.linearise(v, memory)
        tangent = sparse.csc_matrix(lin.tangent + diagonal)
        return Linearisation(lin.residual + springs * (v - u), tangent, lin.scale, lin.remember)

    return replace(problem, linearise=linearise, energy=None, residual=None, travel=None, only=None)
