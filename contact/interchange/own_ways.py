"""A frictional problem of rigid bodies as a step whose contacts have unknowns of their own: their relative ways.

Contacts of one body share its unknowns, and active sets need candidates that share none. With the ways u (3m,) of the
contacts among the unknowns, and y = l/c beside them, c [N/mm] a stiffness that puts both in one unit, the local problem
u = W l + q is, whatever W::

    c y = l,    c u - c^2 W y = c q

and the global one M v = H l + q, u = H^T v + b::

    M v - c H y = q,    c y = l,    c u - c H^T v = c b

Both are K x + r = (0, l, 0), and e^2/2c of the last equation e is added to what they are the stationary point of: K is
symmetric where W or M is, regular where M is, never definite, and a contact that is let go feels the stiffness c. Gaps
and slips are the u themselves. A state that holds redundant contacts is singular in it: their forces are several.
"""

import numpy as np
from scipy import sparse

from contact.interchange.linearised_step import FrozenFrictionalStep
from contact.interchange.siconos import SiconosProblem


def with_own_ways(problem: SiconosProblem) -> FrozenFrictionalStep:
    """The step in x = (u, y), or x = (v, u, y); in a plane the second slip is none."""
    d, m = problem.d, len(problem.mu)
    c = 1 / _softness(problem)
    one, no = c * sparse.eye_array(d * m), sparse.csr_matrix((d * m, d * m))
    if problem.W is not None:
        first, W = 0, c * problem.W
        e = sparse.hstack([one, -c * W], format="csr")
        upper, r = sparse.hstack([no, one]), np.zeros(d * m)
    else:
        assert problem.M is not None
        assert problem.H is not None
        assert problem.q is not None
        first, H = problem.M.shape[0], c * problem.H
        e = sparse.hstack([-H.T, one, no], format="csr")
        moved = sparse.hstack([problem.M, sparse.csr_matrix(H.shape), -H])
        upper = sparse.vstack([moved, sparse.hstack([sparse.csr_matrix(H.T.shape), no, one])])
        r = np.concatenate([-problem.q, np.zeros(d * m)])
    K = sparse.csc_matrix(sparse.vstack([upper, e])) + sparse.csc_matrix(e.T @ e) / c
    r = np.concatenate([r, -c * problem.offset]) - e.T @ problem.offset
    normal = first + d * np.arange(m)
    G, shape = _picked(normal, K.shape[0]), (2 * m, K.shape[0])
    rows = (2 * np.arange(m)[:, None] + np.arange(d - 1)).ravel()
    columns = (normal[:, None] + np.arange(1, d)).ravel()
    S = sparse.csr_matrix((np.ones(len(rows)), (rows, columns)), shape=shape)
    size, slip = float(np.linalg.norm(r)), np.zeros((m, 2))
    return FrozenFrictionalStep(K, r, G, np.zeros(m), np.ones(m), size, S=S, slip=slip, mu=problem.mu)


def _picked(columns: np.ndarray, n: int) -> sparse.csr_matrix:
    """Rows of unity (m, n)."""
    return sparse.csr_matrix((np.ones(len(columns)), columns, np.arange(len(columns) + 1)), shape=(len(columns), n))


def _softness(problem: SiconosProblem) -> float:
    """The way [mm] that a force of 1 N makes, about; beyond every eigenvalue of W, as K is singular where c W has 1."""
    if problem.W is not None:
        return 2 * float(np.max(np.asarray(abs(problem.W).sum(axis=1)))) or 1.0
    assert problem.M is not None
    assert problem.H is not None
    return float(np.max(np.asarray(abs(problem.H).sum(axis=0)))) ** 2 / float(np.max(np.abs(problem.M.diagonal())))
