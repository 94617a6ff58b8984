"""The scales of a contact problem at a state: what is a large gap, and how stiff a candidate's own unknowns are.

Whatever is compared with a gap, by an algorithm or by the judge, is relative to these, so that no unit, no size of the
body and no travel is a special one. No tolerance and no algorithm may enter here.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from contact.problem import ContactProblem, Linearised


@dataclass(frozen=True)
class Stiffness:
    """How the unknowns of the candidates are held, each by its own diagonal entry of K alone.

    most: the largest k_i [N/mm] with 1/k_i = sum_j G_ij^2/|K_jj|, the force that moves candidate i by 1 mm along its
    gap while everything else stands still: a force moves it by no less than that over most.
    per_area: the median of k_i/w_i [MPa/mm], which weighs pressure against gap. Both are 0 without a candidate or a K.
    """

    most: float = 0.0
    per_area: float = 0.0

    @classmethod
    def of(cls, problem: ContactProblem, lin: Linearised, u: np.ndarray) -> Stiffness:
        """At u (n,)."""
        if not len(problem.weights):
            return cls()
        rows, own = problem.push(u), np.abs(lin.tangent.diagonal())
        soft = np.divide(1.0, own, out=np.zeros_like(own), where=own > np.finfo(float).tiny)
        gives = np.asarray(rows.multiply(rows) @ soft).ravel()
        held = gives > 0
        if not held.any():
            return cls()
        k, areas = 1.0 / gives[held], problem.weights[held]
        return cls(float(np.max(k)), float(np.median(k[areas > 0] / areas[areas > 0])) if np.any(areas > 0) else 0.0)


def motion(problem: ContactProblem, u: np.ndarray) -> float:
    """The largest (|G| |u|)_i [mm]: how far the candidates have come along their gaps."""
    return float(np.max(abs(problem.gap_jacobian(u)) @ np.abs(u), initial=0.0))


def length(problem: ContactProblem, stiffness: Stiffness, u: np.ndarray, force: float) -> float:
    """A large gap [mm]: the motion of the candidates, or that by which ``force`` [N] moves one whose all else is held.

    A body that is pressed where it already lies does not move along any gap, and still has the second.
    """
    return max(motion(problem, u), force / stiffness.most if stiffness.most > 0 else 0.0)
