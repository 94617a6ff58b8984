"""Control by work: the factor of a load is unknown, and the work that the load has done is given.

r(u) = s(u) - t f(u) is linear in the factor t of a load that may follow, and W(u) is the work of f on the way from
rest, W' its gradient, f itself where the load has a potential. Of a pressure W is that pressure times the volume that
its face has swept: a body is filled. Beyond a limit point of t, where no step of it has a next state, W goes on. With
t = c y and y one more unknown, the last one, whose equation counts as a force::

    s(u) - c y f(u) = 0,    c (W* - W(u)) = 0,    tangent [[K, -c f], [-c W', 0]]

y is the multiplier of a condition on u: on all x = (u, y) the tangent has one negative eigenvalue more than K has on
the motions with W' du = 0, and a state with no other is stable while W is given. Contact adds to r as it does anywhere.
Source: Nocedal, Wright, Numerical Optimization (2006), theorem 16.3, of the eigenvalues (recalled). No load and no
contact set enter here.
"""

from collections.abc import Callable

import numpy as np
from scipy import sparse

from contact.problem import Linearisation, Linearise

Work = Callable[[np.ndarray], tuple[float, np.ndarray, np.ndarray]]  # u -> W [N mm], f (n,) [N], W' (n,) [N]


def by_work(linearise_at: Callable[[float], Linearise], work: Work, given: float, per_mm: float) -> Linearise:
    """The model in x = (u, y) under a given work W* [N mm], of a problem with one of its ``multipliers``.

    linearise_at(t): the model at the factor t of the load.  per_mm: c, with which y is of the size of displacements.
    """

    def linearise(x: np.ndarray, memory: object) -> Linearisation:
        u, y = x[:-1], float(x[-1])
        lin, (done, force, gradient) = linearise_at(per_mm * y)(u, memory), work(u)
        missing = per_mm * (given - done)
        tangent = _bordered(lin.tangent, -per_mm * force, -per_mm * gradient)
        scale = max(lin.scale, abs(missing))  # at rest nothing else is in balance
        return Linearisation(np.append(lin.residual, missing), tangent, scale, lambda dx: lin.remember(dx[:-1]))

    return linearise


def _bordered(K: sparse.csc_matrix, column: np.ndarray, row: np.ndarray) -> sparse.csc_matrix:
    """[[K, column], [row, 0]], every entry of the border in its place, zeros and all: one pattern for all states."""
    n, ends = len(row), K.indptr[1:]
    indices = np.concatenate([np.insert(K.indices, ends, n), np.arange(n + 1)])
    data = np.concatenate([np.insert(K.data, ends, row), column, [0.0]])
    indptr = np.append(K.indptr + np.arange(n + 1), len(data))
    return sparse.csc_matrix((data, indices, indptr), shape=(n + 1, n + 1))
