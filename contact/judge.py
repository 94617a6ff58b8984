"""The judge: recomputes what an answer is worth from (problem, u, pressure) alone and trusts no algorithm."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy import sparse

from contact.linear import SingularMatrixError, checked_solve, factorise
from contact.problem import ROUNDING_ALONE, WORST_ROUNDING, ContactProblem, excused, rounding_floor


@dataclass(frozen=True)
class Verdict:
    """Residuals of the contact conditions.

    equilibrium: |r - G^T W p| over the largest force in balance [-].  penetration: largest -g [mm].
    tension: largest -p [MPa].  complementarity: largest |p g| [MPa mm].  All are >= 0, best 0.
    rounding: the equilibrium that rounding alone would explain [-]; it excuses nothing above itself.
    correction: the displacement that the imbalance still asks for over all displacement [-], on the pressed nodes held
    at their gaps; infinite unless it decides, see :func:`contact.problem.excused`.
    """

    equilibrium: float
    penetration: float
    tension: float
    complementarity: float
    rounding: float
    correction: float = np.inf

    @property
    def kkt(self) -> dict[str, float]:
        """The four residuals by name."""
        names = ("equilibrium", "penetration", "tension", "complementarity")
        return {name: getattr(self, name) for name in names}

    def failures(
        self,
        *,
        equilibrium: float = 1e-8,
        penetration: float = 1e-9,
        tension: float = 0.0,
        complementarity: float = 1e-9,
    ) -> list[str]:
        """The names of the residuals above their bounds (NaN counts as above).

        The defaults are those of an exact multiplier; a finite epsilon needs wider bounds for penetration, p/epsilon,
        and complementarity, p^2/epsilon.
        """
        bounds = {
            "equilibrium": np.inf if excused(self.equilibrium, self.rounding, self.correction) else equilibrium,
            "penetration": penetration,
            "tension": tension,
            "complementarity": complementarity,
        }
        return [name for name, bound in bounds.items() if not self.kkt[name] <= bound]


def judge(problem: ContactProblem, u: np.ndarray, pressure: np.ndarray) -> Verdict:
    """Recompute all residuals; raises ValueError when the pressures do not fit the candidates."""
    if pressure.shape != problem.weights.shape:
        raise ValueError(f"{pressure.shape} pressures for {problem.weights.shape} contact candidates")
    lin = problem.linearise(u, None)
    gap = problem.gap(u)
    contact = problem.contact_force(u, pressure)
    scale = max(lin.scale, float(np.linalg.norm(contact))) or 1.0
    imbalance, rounding = lin.residual - contact, rounding_floor(lin, u) / scale
    equilibrium = float(np.linalg.norm(imbalance)) / scale
    decides = ROUNDING_ALONE < equilibrium <= min(rounding, WORST_ROUNDING)
    return Verdict(
        equilibrium=equilibrium,
        penetration=float(np.max(-gap, initial=0.0)),
        tension=float(np.max(-pressure, initial=0.0)),
        complementarity=float(np.max(np.abs(pressure * gap), initial=0.0)),
        rounding=rounding,
        correction=_correction(problem, lin.tangent, imbalance, u, pressure) if decides else np.inf,
    )


def _correction(
    problem: ContactProblem, K: sparse.csc_matrix, imbalance: np.ndarray, u: np.ndarray, pressure: np.ndarray
) -> float:
    """|du|/|u| with K du - G^T W dp = -imbalance and G du = 0 on the pressed nodes; infinite when that is singular."""
    nodes, G = np.flatnonzero(pressure > 0), problem.gap_jacobian(u)
    W = sparse.diags_array(problem.weights, format="csc") if problem.coupling is None else problem.coupling
    if problem.gap_curvature is not None:
        K = K - problem.gap_curvature(u, problem.nodal_forces(pressure))
    above = sparse.hstack([K, -sparse.csc_matrix(G.T @ W)[:, nodes]])
    below = sparse.hstack([G[nodes], sparse.csr_matrix((len(nodes), len(nodes)))])
    A = sparse.csc_matrix(sparse.vstack([above, below]))
    b = np.append(-imbalance, np.zeros(len(nodes)))
    try:
        du = checked_solve(factorise(A), A, b)[: len(u)]
    except SingularMatrixError:
        return float("inf")
    return float(np.linalg.norm(du) / np.linalg.norm(u))
