"""The linearised step of a frictional problem on springs: gaps and slips give way under their forces.

With k = w epsilon [N/mm] the laws hold for g + f/k and s + t/k instead of g and s. Under given states, with e across
the direction d of a slip, forces are F = -C (v + J du), v = (g, s)::

    stick   C = k
    slip    C_n = k,    C_tn = -mu k d,    C_tt = kappa/(1 + kappa/k) e e^T

which is not symmetric. Only the displacements are unknowns, K + J^T C J is what is factorised, and no candidate needs
unknowns of its own. Where a spring is stiffer than they are, its force is not k times a rounded way: it is what is left
of the forces on them.
Source: Simo, Laursen, Comput. Struct. 42 (1992) 97-116.
"""

from __future__ import annotations

import numpy as np
from scipy import sparse

from contact.coulomb import State
from contact.friction.held import DEPENDENT
from contact.friction.laws import Laws
from contact.friction.step import Linear, Stepped
from contact.newton.step import NewtonRun
from contact.solvers.sparse import added


class SprungStep:
    """The linearisation on springs of k (m,) [N/mm], factorised for every choice of states."""

    def __init__(self, run: NewtonRun, linear: Linear, k: np.ndarray) -> None:
        self._run, self._linear, self._k = run, linear, k
        self._last: tuple[Laws, Stepped] | None = None

    def near(self, laws: Laws) -> SprungStep:
        """The same for all."""
        return self

    def step(self, laws: Laws) -> Stepped:
        """The step under the laws, gaps and slips without what springs give way; raises SingularMatrixError."""
        if self._last is None or self._last[0] is not laws:
            self._last = laws, self._solved(laws)
        return self._last[1]

    def foreseen(self, laws: Laws) -> Stepped:
        """The same: every choice of states is a factorisation."""
        return self.step(laws)

    def _solved(self, laws: Laws) -> Stepped:
        run, linear, J, m = self._run, self._linear, self._linear.ways.rows, len(self._k)
        with run.tally.timed("contact_s"):
            C = _stiffness(laws, linear.mu, self._k)
            blocks = sparse.csr_matrix(sparse.bsr_matrix((C, np.arange(m), np.arange(m + 1)), shape=(3 * m, 3 * m)))
            matrix = added(linear.tangent, sparse.csc_matrix(J.T @ blocks @ J))
            left = -linear.residual - J.T @ (blocks @ linear.now)
        du = run.solution(run.factorise(matrix), matrix, left)
        with run.tally.timed("contact_s"):
            way = (linear.now + J @ du).reshape(m, 3)
            F = -np.einsum("mij,mj->mi", C, way)
            self._react(F, du, laws.closed)
        normal, friction = np.where(laws.closed, F[:, 0], 0.0), np.where(laws.closed[:, None], F[:, 1:], 0.0)
        give = np.divide(1.0, self._k, out=np.zeros(m), where=self._k > 0)
        gap, slip = way[:, 0] + give * normal, way[:, 1:] + give[:, None] * friction
        return Stepped(du, gap, slip, normal, friction)

    def _react(self, F: np.ndarray, du: np.ndarray, closed: np.ndarray) -> None:
        """Put the forces on unknowns of a candidate's own in place of those of stiff springs."""
        K, ways = self._linear.tangent, self._linear.ways
        used = np.bincount(ways.rows.indices, minlength=K.shape[0])
        left, own = K @ du + self._linear.residual, np.abs(K.diagonal())
        for i in np.flatnonzero(closed).tolist():
            unknowns, J = ways.block(i)
            acts = J.any(axis=1)
            alone = np.array_equal(used[unknowns], np.sum(J != 0, axis=0))
            if not alone or self._k[i] * np.sum(J * J) <= np.max(own[unknowns], initial=0.0):
                continue
            size = np.linalg.svd(J[acts], compute_uv=False)
            if len(size) == np.sum(acts) and size[-1] > DEPENDENT * size[0]:
                F[i, acts] = np.linalg.lstsq(J[acts].T, left[unknowns], rcond=None)[0]


def _stiffness(laws: Laws, mu: np.ndarray, k: np.ndarray) -> np.ndarray:
    """C (m, 3, 3)."""
    C = np.where(laws.closed, k, 0.0)[:, None, None] * np.eye(3)
    slips = laws.state == State.SLIP
    kappa, stiff = laws.across, k > 0
    soft = np.divide(
        kappa, 1 + np.divide(kappa, k, out=np.zeros_like(k), where=stiff), out=np.zeros_like(k), where=stiff
    )
    e = np.stack([-laws.direction[:, 1], laws.direction[:, 0]], axis=1)
    C[slips, 1:, 0] = -(np.where(slips, mu, 0.0) * k)[slips, None] * laws.direction[slips]
    C[slips, 1:, 1:] = (soft[:, None, None] * e[:, :, None] * e[:, None, :])[slips]
    return C
