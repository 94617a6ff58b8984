"""The judge: recomputes what an answer is worth from (problem, u, pressure) alone and trusts no algorithm."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from contact.problem import WORST_ROUNDING, ContactProblem, rounding_floor


@dataclass(frozen=True)
class Verdict:
    """Residuals of the contact conditions.

    equilibrium: |r - G^T W p| over the largest force in balance [-].  penetration: largest -g [mm].
    tension: largest -p [MPa].  complementarity: largest |p g| [MPa mm].  All are >= 0, best 0.
    rounding: the equilibrium that rounding alone would explain [-]; it excuses nothing above itself.
    """

    equilibrium: float
    penetration: float
    tension: float
    complementarity: float
    rounding: float

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
            "equilibrium": max(equilibrium, min(self.rounding, WORST_ROUNDING)),
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
    return Verdict(
        equilibrium=float(np.linalg.norm(lin.residual - contact)) / scale,
        penetration=float(np.max(-gap, initial=0.0)),
        tension=float(np.max(-pressure, initial=0.0)),
        complementarity=float(np.max(np.abs(pressure * gap), initial=0.0)),
        rounding=rounding_floor(lin, u) / scale,
    )
