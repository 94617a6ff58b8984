"""Whether an equilibrium is stable: eigenvalues of the tangent on the motions that its contact set leaves free.

A state at fixed loads is a minimum of the potential, and stable, when the second variation is positive on all motions
with G_A du = 0 (with the springs of a finite epsilon: on all motions). The number of negative eigenvalues is
that of the negative pivots of one factorisation (Sylvester), and no factorisation of an algorithm is trusted for it.

A tangent that is not symmetric has no potential. Where the symmetric part is positive definite every motion takes work
(Hill) and the state is stable; where it is not, only an eigenvalue of the tangent itself with a negative real part
says that the state is unstable. Eigenvalues inside rounding have no sign: they are counted by themselves, and a body
that only a foundation holds has such.

Elements may have motions of their own that they do not resist, though the body would. Where eigenvalues are negative,
they are counted again with what the elements leave out: those that are negative only without it are modes of elements,
counted by themselves, and say nothing of the body.
Sources: Hill, J. Mech. Phys. Solids 6 (1958) 236-249; Bazant, Cedolin, Stability of Structures (2010), chapters 4, 10.

No algorithm, no path and no sentence of a scene may enter here.
"""

from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Any

import numpy as np
from scipy import sparse

from contact.newton.solves import holdable, released
from contact.problem import ContactProblem, ContactSolution, Linearisation, Linearised, Overlooked
from contact.solvers.sparse import SingularMatrixError, added, negative_pivots, symmetric

ROUNDING = 1e-13  # of the diagonal: eigenvalues of the matrix with unit diagonal below this have no sign
CRITICAL = 1e-3  # of the least positive eigenvalue: a negative one below this is that of the critical point of a body
STABLE, UNSTABLE, NOT_COUNTED = "stable", "unstable", "not counted"
CONSISTENT = "the pressures of a consistent coupling act on candidates outside the set: there is no potential"
WORK = "second-order work is negative on some motions, but none of the softest eigenvalues is"


@dataclass(frozen=True)
class Stability:
    """The verdict on one state.

    negative: eigenvalues of the tangent below zero by more than rounding, None where they were not counted, and at
    least so many where the tangent is not ``symmetric``, without those of elements alone.  rounding: those that
    rounding leaves without a sign.  why: they were not counted.  factorisations: that the count has taken.
    element_modes: those of elements alone.  cuts: in how many parts along both coordinates elements have none.
    aspect: of those that stress alone drives, see :class:`contact.problem.Overlooked`.
    """

    negative: int | None
    rounding: int = 0
    symmetric: bool = True
    why: str = ""
    factorisations: int = 0
    element_modes: int = 0
    cuts: tuple[int, int] = (1, 1)
    aspect: float = 0.0

    @property
    def record(self) -> dict[str, Any]:
        """Word, sentence and counts, as they stand in a certificate; cuts: of elements, where these have modes."""
        counts = {"negative": self.negative, "rounding": self.rounding, "factorisations": self.factorisations}
        alone = {"element_modes": self.element_modes} | ({"cuts": list(self.cuts)} if self.element_modes else {})
        return {"word": self.word, "sentence": self.sentence, **counts, **alone}

    @property
    def word(self) -> str:
        """STABLE, UNSTABLE or NOT_COUNTED."""
        return NOT_COUNTED if self.negative is None else UNSTABLE if self.negative else STABLE

    @property
    def sentence(self) -> str:
        """The word with what it rests on."""
        if self.negative is None:
            return f"{self.word}: {self.why}{self._of_elements}"
        least = "" if self.symmetric or not self.negative else "at least "
        counted = f"{least}{self.negative} negative eigenvalue{'' if self.negative == 1 else 's'} of the tangent"
        unsigned = f", {self.rounding} within rounding" if self.rounding else ""
        return f"{self.word}: {counted} on the motions that contact leaves free{unsigned}{self._of_elements}"

    @property
    def _of_elements(self) -> str:
        """What is counted apart, and how it is avoided."""
        if not self.element_modes:
            return ""
        modes = f"{self.element_modes} mode{'' if self.element_modes == 1 else 's'} of elements alone"
        long = f" up to {self.aspect:.2g} times wider than long" if self.aspect > 1 else ""
        cut = " and ".join(f"in {n} along a{axis}" for axis, n in enumerate(self.cuts, 1) if n > 1)
        return f", apart from {modes}{long}, not of the body, which alternate: elements cut {cut} have none"


def stability(problem: ContactProblem, state: ContactSolution, epsilon: float = np.inf) -> Stability:
    """The verdict on a converged state under the law of an epsilon [MPa/mm], infinite for the exact condition."""
    if not holdable(problem):
        return Stability(None, why=CONSISTENT)
    K = problem.stiffness(problem.linearise(state.u, None), state.u, state.pressure)
    try:
        inertia, overlooked = _counted(problem, state, K, epsilon), None
        if inertia.negative and problem.element_modes is not None:
            overlooked = problem.element_modes(state.u)
            inertia = _apart(problem, state, K, epsilon, inertia, overlooked)
    except ValueError as error:  # a candidate without an unknown, or two that share one
        return Stability(None, why=str(error))
    return (
        inertia
        if inertia.symmetric or not inertia.negative
        else _divergent(problem, state, epsilon, inertia, overlooked)
    )


def _counted(
    problem: ContactProblem,
    state: ContactSolution,
    K: sparse.csc_matrix,
    epsilon: float,
    order: np.ndarray | None = None,
) -> Stability:
    """By the symmetric part of a tangent K (n, n); order (n,): of its elimination, where the unknowns have another."""
    M, forces = released(problem, state.u, np.flatnonzero(state.active), K, epsilon)
    multipliers = problem.multipliers + forces
    conservative = symmetric(K)
    part = M if conservative else sparse.csc_matrix((M + M.T) / 2)
    if order is not None and not multipliers:
        part = sparse.csc_matrix(part[order][:, order])
    negative, unsigned, spent = _signs(part, multipliers, ordered=problem.ordered or forces > 0)
    return Stability(negative, unsigned, conservative, factorisations=spent)


def _apart(
    problem: ContactProblem,
    state: ContactSolution,
    K: sparse.csc_matrix,
    epsilon: float,
    whole: Stability,
    overlooked: Overlooked,
) -> Stability:
    """What is ``found``, the modes of elements apart, by the coordinate along which they move."""
    from contact.continuation.spectrum import MODES  # loaded where something is unstable alone

    first, second = overlooked.stiffness
    stiffened = added(K, first)
    one = _counted(problem, state, stiffened, epsilon, overlooked.order)
    both = _counted(problem, state, added(stiffened, second), epsilon, overlooked.order)
    spent = whole.factorisations + one.factorisations + both.factorisations
    counts = [count.negative or 0 for count in (whole, one, both)]
    alone = [max(before - after, 0) for before, after in pairwise(counts)]
    if any(alone) and whole.symmetric and counts[0] <= MODES:  # near its critical points a body is as soft
        spent += 2
        excess = sum(alone) - _alternating(problem, state, epsilon, counts[0], overlooked)
        for axis in np.argsort(alone):
            alone[axis], excess = max(alone[axis] - max(excess, 0), 0), excess - alone[axis]
    if not any(alone):
        return replace(whole, factorisations=spent)
    cuts = [max(n, 2) if count else 1 for n, count in zip(overlooked.cuts, alone, strict=True)]
    return replace(
        both,
        negative=counts[0] - sum(alone),
        factorisations=spent,
        element_modes=sum(alone),
        cuts=(cuts[0], cuts[1]),
        aspect=overlooked.aspect,
    )


def _alternating(
    problem: ContactProblem, state: ContactSolution, epsilon: float, negative: int, overlooked: Overlooked
) -> int:
    """How many of the negative eigenvalues have modes that alternate; at a critical point the body's has no size."""
    from contact.continuation.spectrum import lowest, spectrum

    try:
        soft = spectrum(problem, state, epsilon)
        below = lowest(problem, state, epsilon, negative, soft)
    except SingularMatrixError:
        return 0
    positive = soft.eigenvalues[soft.eigenvalues > 0]
    critical = CRITICAL * float(np.min(positive)) if len(positive) else 0.0
    return overlooked.alternating(below.modes[:, below.eigenvalues < -critical])


def _divergent(
    problem: ContactProblem, state: ContactSolution, epsilon: float, inertia: Stability, overlooked: Overlooked | None
) -> Stability:
    """By the softest eigenvalues of an unsymmetric tangent whose symmetric part has the signs ``found``."""
    from contact.continuation.spectrum import spectrum  # loaded where the signs alone do not decide

    spent = inertia.factorisations + 1
    try:
        softest = spectrum(
            _stiffened(problem, overlooked if inertia.element_modes else None), state, epsilon
        ).eigenvalues
    except SingularMatrixError as error:
        return replace(inertia, negative=None, why=f"the tangent is not symmetric: {error}", factorisations=spent)
    divergent = int(np.sum(softest < 0))
    return replace(inertia, negative=divergent or None, why="" if divergent else WORK, factorisations=spent)


def _stiffened(problem: ContactProblem, overlooked: Overlooked | None) -> ContactProblem:
    """The problem with what its elements leave out of the tangent."""
    if overlooked is None:
        return problem
    first, second = overlooked.stiffness

    def linearise(u: np.ndarray, memory: object) -> Linearised:
        lin = problem.linearise(u, memory)
        return Linearisation(lin.residual, sparse.csc_matrix(lin.tangent + first + second), lin.scale, lin.remember)

    return replace(problem, linearise=linearise)


def _signs(M: sparse.csc_matrix, multipliers: int, *, ordered: bool) -> tuple[int, int, int]:
    """Eigenvalues of a symmetric matrix below zero, those that rounding leaves without a sign, and factorisations.

    A shift of the diagonal by ROUNDING takes the latter from the former; nothing is shifted where all are positive.
    Those of multipliers do not count.
    """
    counted = negative_pivots(M, ordered=ordered, multipliers=multipliers)
    if counted == 0:
        return 0, 0, 1
    diagonal = np.abs(M.diagonal())
    diagonal[diagonal == 0] = np.max(diagonal, initial=0.0) or 1.0
    shift = sparse.csc_matrix(sparse.diags_array(ROUNDING * diagonal))
    sure = negative_pivots(added(M, shift), ordered=ordered, multipliers=multipliers)
    return min(sure, counted), max(counted - sure, 0), 2
