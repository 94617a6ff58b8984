"""Whether an equilibrium is stable: eigenvalues of the tangent on the motions that its contact set leaves free.

A state at fixed loads is a minimum of the potential, and stable, when the second variation is positive on all motions
with G_A du = 0 (with the springs of a finite epsilon: on all motions). The number of negative eigenvalues is
that of the negative pivots of one factorisation (Sylvester), and no factorisation of an algorithm is trusted for it.

A tangent that is not symmetric has no potential. Where the symmetric part is positive definite every motion takes work
(Hill) and the state is stable; where it is not, only an eigenvalue of the tangent itself with a negative real part
says that the state is unstable. Eigenvalues inside rounding have no sign: they are counted by themselves, and a body
that only a foundation holds has such.
Sources: Hill, J. Mech. Phys. Solids 6 (1958) 236-249; Bazant, Cedolin, Stability of Structures (2010), chapters 4, 10.

No algorithm, no path and no sentence of a scene may enter here.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy import sparse

from contact.continuation.critical_points import spectrum
from contact.newton.held import Held, holdable
from contact.problem import ContactProblem, ContactSolution
from contact.solvers.sparse import SingularMatrixError, added, negative_pivots, symmetric

ROUNDING = 1e-13  # of the diagonal: eigenvalues of the matrix with unit diagonal below this have no sign
STABLE, UNSTABLE, NOT_COUNTED = "stable", "unstable", "not counted"
CONSISTENT = "the pressures of a consistent coupling act on candidates outside the set: there is no potential"
WORK = "second-order work is negative on some motions, but none of the softest eigenvalues is"


@dataclass(frozen=True)
class Stability:
    """The verdict on one state.

    negative: eigenvalues of the tangent below zero by more than rounding, None where they were not counted, and at
    least so many where the tangent is not ``symmetric``.  rounding: those that rounding leaves without a sign.
    why: they were not counted.  factorisations: that the count has taken.
    """

    negative: int | None
    rounding: int = 0
    symmetric: bool = True
    why: str = ""
    factorisations: int = 0

    @property
    def record(self) -> dict[str, Any]:
        """Word, sentence and counts, as they stand in a certificate."""
        counts = {"negative": self.negative, "rounding": self.rounding, "factorisations": self.factorisations}
        return {"word": self.word, "sentence": self.sentence, **counts}

    @property
    def word(self) -> str:
        """STABLE, UNSTABLE or NOT_COUNTED."""
        return NOT_COUNTED if self.negative is None else UNSTABLE if self.negative else STABLE

    @property
    def sentence(self) -> str:
        """The word with what it rests on."""
        if self.negative is None:
            return f"{self.word}: {self.why}"
        least = "" if self.symmetric or not self.negative else "at least "
        counted = f"{least}{self.negative} negative eigenvalue{'' if self.negative == 1 else 's'} of the tangent"
        unsigned = f", {self.rounding} within rounding" if self.rounding else ""
        return f"{self.word}: {counted} on the motions that contact leaves free{unsigned}"


def stability(problem: ContactProblem, state: ContactSolution, epsilon: float = np.inf) -> Stability:
    """The verdict on a converged state under the law of an epsilon [MPa/mm], infinite for the exact condition."""
    if not holdable(problem):
        return Stability(None, why=CONSISTENT)
    K = problem.stiffness(problem.linearise(state.u, None), state.u, state.pressure)
    try:
        M = Held.on(problem, state.u, np.flatnonzero(state.active), K, epsilon).matrix
    except ValueError as error:  # a candidate without an unknown, or two that share one
        return Stability(None, why=str(error))
    conservative = symmetric(K)
    whole = M if conservative else sparse.csc_matrix((M + M.T) / 2)
    negative, unsigned, spent = _signs(whole, ordered=problem.ordered)
    if conservative or negative == 0:
        return Stability(negative, unsigned, conservative, factorisations=spent)
    try:
        softest = spectrum(problem, state, epsilon).eigenvalues
    except SingularMatrixError as error:
        return Stability(None, symmetric=False, why=f"the tangent is not symmetric: {error}", factorisations=spent + 1)
    divergent = int(np.sum(softest < 0))
    return Stability(divergent or None, unsigned, False, "" if divergent else WORK, spent + 1)


def _signs(M: sparse.csc_matrix, *, ordered: bool) -> tuple[int, int, int]:
    """Eigenvalues of a symmetric matrix below zero, those that rounding leaves without a sign, and factorisations.

    A shift of the diagonal by ROUNDING takes the latter from the former; nothing is shifted where all are positive.
    """
    found = negative_pivots(M, ordered=ordered)
    if found == 0:
        return 0, 0, 1
    diagonal = np.abs(M.diagonal())
    diagonal[diagonal == 0] = np.max(diagonal, initial=0.0) or 1.0
    shift = sparse.csc_matrix(sparse.diags_array(ROUNDING * diagonal))
    sure = negative_pivots(added(M, shift), ordered=ordered)
    return min(sure, found), max(found - sure, 0), 2
