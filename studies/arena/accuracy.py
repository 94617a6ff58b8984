"""What an answer (du, p) of a frozen contact problem is worth, from the file alone.

With nodal forces f = W p and gaps s = g + G du after the step, four residuals, each over a scale (:class:`Scales`)::

    equilibrium      |K du + r - G^T f| / F                 complementarity  sum_i |w_i p_i s_i| / (F L)
    penetration      max_i max(-s_i, 0) / L                 tension          max_i max(-w_i p_i, 0) / F

The sum of complementarity is the duality gap of the quadratic programme. The accuracy is the largest of the four.

Why the scales are what they are. A solver that measures the balance of forces by the forces of its own answer can be
satisfied by making the answer larger: for any f with a positive response, du = K^-1 (G^T f - r) balances to rounding,
and t f with t -> infinity leaves r itself below every relative tolerance, while all gaps stay open (OSQP's two
residuals accept that; a test shows it). So F comes from the file alone. L is bounded from the file: it grows with the
motion of the answer only up to the largest gap there is, since no candidate has to come further to touch, and a
smaller motion is judged more strictly. Nothing that an answer can say makes F or that bound larger.

What rounding explains is no error: of each residual eps times the terms that it is the sum of is taken off. An answer
with nothing left solves a problem whose entries differ from the file's in their last digit (Oettli, Prager, Numer.
Math. 6 (1964) 405-409), however large it is; thin shells get no further (1e-9 of F, measured elsewhere).
"""

from __future__ import annotations

from dataclasses import asdict, dataclass

import numpy as np

from contact.interchange.linearised_step import FrozenStep
from contact.scales import Stiffness
from contact.solvers.sparse import SingularMatrixError, checked_solve, factorise

EPS = float(np.finfo(float).eps)


@dataclass(frozen=True)
class Scales:
    """What residuals of a problem are measured by.

    force F [N]: the largest of the forces in balance that the file states, of the imbalance |r|, and of the force that
    the deepest candidate, alone, takes to be pushed out of the foundation; where nothing moves at all, of the force
    that moves the stiffest candidate by the largest gap.
    length [mm]: the larger of the deepest penetration before the step and of the way that F moves the stiffest
    candidate when all else is held.  reach [mm]: the largest gap, the most by which the motion of an answer counts.
    """

    force: float
    length: float
    reach: float

    @classmethod
    def of(cls, step: FrozenStep) -> Scales:
        """Of a problem; one factorisation of K where a candidate penetrates."""
        problem, rest = step.problem(), np.zeros_like(step.r)
        held = Stiffness.of(problem, problem.linearise(rest, None), rest).most
        deepest = float(np.max(-step.gap, initial=0.0))
        reach = float(np.max(np.abs(step.gap), initial=0.0))
        force = max(step.scale, float(np.linalg.norm(step.r)), _pushed_out(step, held)) or held * reach or 1.0
        return cls(force, max(deepest, force / held if held > 0 else 0.0), reach)

    def gap(self, moved: np.ndarray) -> float:
        """L [mm] of an answer that moves the candidates by ``moved`` (m,) [mm] along their gaps."""
        return max(self.length, min(float(np.max(np.abs(moved), initial=0.0)), self.reach)) or 1.0


@dataclass(frozen=True)
class Accuracy:
    """The four residuals, relative, best 0; infinite where an answer is no number."""

    equilibrium: float
    penetration: float
    tension: float
    complementarity: float

    @property
    def worst(self) -> float:
        """The accuracy: the largest residual."""
        return max(asdict(self).values())


RESIDUALS = tuple(Accuracy.__dataclass_fields__)
NONE = Accuracy(np.inf, np.inf, np.inf, np.inf)


def accuracy(step: FrozenStep, du: np.ndarray, pressure: np.ndarray, scales: Scales | None = None) -> Accuracy:
    """What du (n,) [mm] and pressure (m,) [MPa] are worth; ``scales``: of the step, where known.

    Raises ValueError when they do not fit the step.
    """
    if du.shape != step.r.shape or pressure.shape != step.gap.shape:
        raise ValueError(f"{du.shape} and {pressure.shape} for {step.r.shape} unknowns, {step.gap.shape} candidates")
    by = scales or Scales.of(step)
    with np.errstate(over="ignore", invalid="ignore"):  # of numbers that solvers leave where they have no answer
        found = _residuals(step, du, pressure, by)
    return found if np.isfinite(found.worst) and np.all(np.isfinite(du)) and np.all(np.isfinite(pressure)) else NONE


def _residuals(step: FrozenStep, du: np.ndarray, pressure: np.ndarray, by: Scales) -> Accuracy:
    weighed = step.weights * pressure
    forces = weighed if step.coupling is None else step.coupling @ pressure
    terms = abs(step.K) @ np.abs(du) + np.abs(step.r) + abs(step.G).T @ np.abs(forces)
    imbalance = np.linalg.norm(step.K @ du + step.r - step.G.T @ forces) - EPS * np.linalg.norm(terms)
    moved = step.G @ du
    gap, rounding = step.gap + moved, EPS * (np.abs(step.gap) + abs(step.G) @ np.abs(du))
    length = by.gap(moved)
    open_or_not = np.maximum(np.abs(gap) - rounding, 0.0)
    return Accuracy(
        equilibrium=max(float(imbalance), 0.0) / by.force,
        penetration=(float(np.max(-gap - rounding, initial=0.0)) + 0.0) / length,
        tension=(float(np.max(-weighed, initial=0.0)) + 0.0) / by.force,
        complementarity=float(np.sum(np.abs(weighed) * open_or_not)) / (by.force * length),
    )


def _pushed_out(step: FrozenStep, held: float) -> float:
    """Force [N] on the deepest candidate i that closes its gap with no other pushed: |G_i| (-g_i)/(G K^-1 G^T)_ii.

    Where K has no such compliance, as of a body that only the foundation holds, it takes no force at all; where the
    file knows no other force either, that with all else held.
    """
    if not np.any(step.gap < 0):
        return 0.0
    deepest = int(np.argmin(step.gap))
    row = np.asarray(step.G[[deepest]].todense(), float).ravel()
    size, depth = float(np.linalg.norm(row)), -float(step.gap[deepest])
    try:
        compliance = float(row @ checked_solve(factorise(step.K), step.K, row))
    except SingularMatrixError:
        compliance = 0.0
    if compliance > 0:
        return size * depth / compliance
    return 0.0 if step.scale > 0 or np.any(step.r) else size * depth * held
