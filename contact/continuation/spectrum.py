"""The softest motions that the contact set of a state leaves free: eigenvalues of the tangent there, and their modes.

C is the compliance of the tangent K (curvature of the gap included), that is the map of forces b to the motions du that
they cause while the set A of nodes in contact stays::

    K du - G^T W p = b,    G_A du + p_A/epsilon = 0,    p = 0 outside A

The largest eigenvalues of C are one over the eigenvalues mu of least size of the tangent on G_A du = 0 (for a finite
epsilon of K + epsilon G^T W_A G_A), with the same modes. No path and no algorithm may enter here.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy import sparse
from scipy.sparse.linalg import ArpackNoConvergence, LinearOperator, eigs, eigsh

from contact.newton.solves import released
from contact.problem import ContactProblem, ContactSolution
from contact.solvers.sparse import (
    SingularMatrixError,
    added,
    factorise,
    negative_pivots,
    row_norm,
    solution,
    symmetric,
)

MODES = 8
PRECISE = 1e-9  # of an eigenvalue
FURTHER = 10.0  # from shift to shift, until one is beyond the lowest eigenvalue
ROUNDING = 1e-12  # of the largest compliance: less is that of a motion which the foundation holds
DENSE = 20  # unknowns up to which all eigenvalues are cheap


@dataclass(frozen=True, eq=False)
class Spectrum:
    """Eigenvalues mu (k,) [N/mm] by size, the least first, unit modes (n, k), and how many of ALL are negative.

    negative: None for an unsymmetric tangent. k = 0 where nothing is free to move.
    """

    eigenvalues: np.ndarray
    modes: np.ndarray
    negative: int | None

    def like(self, mode: np.ndarray) -> tuple[float, float]:
        """The eigenvalue of the mode most like ``mode`` (n,), and the cosine between them."""
        likeness = cosines(mode, self.modes)
        best = int(np.argmax(likeness))
        return float(self.eigenvalues[best]), float(likeness[best])


def spectrum(problem: ContactProblem, state: ContactSolution, epsilon: float = np.inf) -> Spectrum:
    """The softest motions that the contact set of a converged state leaves free.

    Raises SingularMatrixError, and ValueError when two candidates share an unknown.
    """
    K = problem.stiffness(problem.linearise(state.u, None), state.u, state.pressure)
    nodes, energetic = np.flatnonzero(state.active), problem.coupling is None and symmetric(K)
    compliances, modes = _largest(_compliance(problem, state, K, epsilon), K.shape[0], symmetric=energetic)
    return Spectrum(1.0 / compliances, modes, _negative(problem, state.u, K, nodes, epsilon) if energetic else None)


def lowest(
    problem: ContactProblem, state: ContactSolution, epsilon: float, negative: int, softest: Spectrum
) -> Spectrum:
    """So many of the negative eigenvalues that a symmetric tangent has, MODES at the most, and their unit modes.

    softest: its spectrum, which may not show them all; of an unsymmetric tangent there is no other. A shift by more
    than the lowest eigenvalue leaves a definite tangent, of which they are the softest: the compliance itself has them
    behind all soft motions, and on 96x96 elements of the hemisphere it took 575 to 1727 products to see one, for 31
    after a shift.  Raises as :func:`spectrum`.
    """
    if softest.negative is None:
        return softest
    below = softest.eigenvalues < 0
    near, modes = softest.eigenvalues[below], softest.modes[:, below]
    missing = min(negative, MODES) - len(near)
    if missing <= 0 or len(state.u) <= DENSE:
        wanted = slice(0, negative)
        return Spectrum(near[wanted], modes[:, wanted], softest.negative)
    K = problem.stiffness(problem.linearise(state.u, None), state.u, state.pressure)
    nodes, most = np.flatnonzero(state.active), row_norm(K)
    shift, moves = float(np.max(np.abs(softest.eigenvalues))), _moves(problem, K)
    while True:
        shifted = added(K, sparse.csc_matrix(sparse.diags_array(shift * moves)))
        if shift > most or not _negative(problem, state.u, shifted, nodes, epsilon):
            break
        shift *= FURTHER
    comply = _compliance(problem, state, shifted, epsilon)
    compliances, others = _largest(comply, K.shape[0], symmetric=True, count=missing)
    return Spectrum(np.append(near, 1.0 / compliances - shift), np.hstack([modes, others]), softest.negative)


def negative_eigenvalues(problem: ContactProblem, state: ContactSolution, epsilon: float) -> int | None:
    """Negative eigenvalues of the tangent on what the set leaves free; None where they cannot be counted."""
    K = problem.stiffness(problem.linearise(state.u, None), state.u, state.pressure)
    if problem.coupling is not None or not symmetric(K):
        return None
    try:
        return _negative(problem, state.u, K, np.flatnonzero(state.active), epsilon)
    except ValueError:  # two candidates share an unknown
        return None


def _compliance(
    problem: ContactProblem, state: ContactSolution, K: sparse.csc_matrix, epsilon: float
) -> Callable[[np.ndarray], np.ndarray]:
    """What forces (n,) move on the motions that the set leaves free; raises as :func:`spectrum` does."""
    nodes, pivots, A = np.flatnonzero(state.active), None, K
    if len(nodes):
        from contact.newton.pivots import Pivots  # loaded with a contact set alone

        pivots = Pivots.choose(problem, state.u, nodes, K, epsilon).opened(np.zeros(len(nodes)))
        A, _ = pivots.substitute(K, np.zeros(K.shape[0]))
    factor = factorise(A, ordered=problem.ordered)
    moves = _moves(problem, K)

    def comply(b: np.ndarray) -> np.ndarray:
        x = solution(factor, b * moves)
        return (x if pivots is None else pivots.resolve(x)[0]) * moves

    return comply


def _moves(problem: ContactProblem, K: sparse.csc_matrix) -> np.ndarray:
    """Which unknowns (n,) bool of a tangent are motions; the others are multipliers."""
    return np.arange(K.shape[0]) < K.shape[0] - problem.multipliers


def _largest(
    comply: Callable[[np.ndarray], np.ndarray], n: int, *, symmetric: bool, count: int = MODES
) -> tuple[np.ndarray, np.ndarray]:
    """Eigenvalues (count,) of largest size of a compliance (n, n), given by its products, and unit vectors (n, k).

    Of a complex pair of an unsymmetric one: the size with the sign of the real part, and the real part of its vector.
    """
    if n <= DENSE:
        values, vectors = np.linalg.eig(np.column_stack([comply(e) for e in np.eye(n)]))
    else:
        C, start = LinearOperator((n, n), matvec=comply, dtype=float), np.random.default_rng(0).normal(size=n)
        try:
            values, vectors = (eigsh if symmetric else eigs)(C, k=count, which="LM", v0=start, tol=PRECISE)
        except ArpackNoConvergence as error:
            raise SingularMatrixError(f"its lowest eigenvalues were not found: {error}") from error
    size = np.abs(values)
    order = np.argsort(-size)
    order = order[size[order] > ROUNDING * np.max(size)]  # the others are held
    modes = np.real(vectors[:, order])
    return np.copysign(size, np.real(values))[order], modes / np.linalg.norm(modes, axis=0)


def _negative(problem: ContactProblem, u: np.ndarray, K: sparse.csc_matrix, nodes: np.ndarray, epsilon: float) -> int:
    """Negative eigenvalues of the symmetric tangent on what the set leaves free."""
    free, forces = released(problem, u, nodes, K, epsilon)
    return negative_pivots(free, ordered=problem.ordered or forces > 0, multipliers=problem.multipliers + forces)


def cosines(v: np.ndarray, modes: np.ndarray) -> np.ndarray:
    """Of v (n,) with each of the unit modes (n, k), without sign."""
    return np.abs(v @ modes) / (float(np.linalg.norm(v)) or 1.0)
