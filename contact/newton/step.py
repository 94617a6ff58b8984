"""The one Newton that all algorithms share: its iterates, a linear step on a given contact set, tests of convergence.

Which nodes belong to the set is the algorithm's business and must not enter here.
"""

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from scipy.linalg import norm

from contact.newton.solves import LinearSolves, LinearStep, Substituted, holdable
from contact.problem import ContactProblem, ContactSolution, Linearised, Outcome
from contact.rounding import ROUNDING_ALONE, decides, excused, met, rounding_floor
from contact.scales import Stiffness, length
from contact.solvers.sparse import SingularMatrixError

GAP_TOLERANCE = 1e-12  # relative to a large gap
ROUNDING_MARGIN = 10.0
SETTLED = 1e-3  # of all displacement: a step no longer than this leaves no rounding of its own
BLOW_UP = 1e12  # residual, relative to the forces at the start, beyond which nothing can be rescued


@dataclass(frozen=True, eq=False)
class Iterate:
    """Where an iteration is, and the sizes that its tests of convergence compare with.

    lin: linearisation at u (n,).  gap, pressure (m,), set (m,) bool; of the iterate that a step starts from, ``active``
    is the set expected to press.
    push [N]: |G^T W p|.  scale, first_scale [N]: of the forces in balance, now and at the start.  residual:
    |r - G^T W p| over the scale, infinite once the iteration has blown up.  length, first_length [mm]: a large gap, now
    and the first not zero.  stiffness: of the candidates at the start.
    stepped (m,): set of the last step, None before it.  moved, moved_before: |du| of the last step and of the one
    before it on the same set.
    again: whether an iterate before had this set.  updates: of the set on one linearisation, in all so far.
    short: steps in succession, up to here, that have left some of the set to settle.
    """

    lin: Linearised
    u: np.ndarray
    gap: np.ndarray
    pressure: np.ndarray
    active: np.ndarray
    push: float
    scale: float
    first_scale: float
    residual: float
    length: float
    first_length: float
    stiffness: Stiffness
    stepped: np.ndarray | None = None
    moved: float = np.inf
    moved_before: float = np.inf
    again: bool = False
    updates: int = 0
    short: int = 0

    @cached_property
    def rounding(self) -> float:
        """What rounding alone may leave of the residual."""
        return rounding_floor(self.lin, self.u) / self.scale if self.scale > 0 else 0.0


def gap_rounding(problem: ContactProblem, large: float) -> float:
    """Largest gap [mm] that counts as closed where one of the size ``large`` [mm] is a large one."""
    return GAP_TOLERANCE * large + ROUNDING_MARGIN * float(np.finfo(float).eps) * problem.gap_size


@dataclass(frozen=True, eq=False)
class NewtonRun(LinearSolves):
    """One solve: the iterate comes in and the next one goes out.

    linearise and at for the first, then the tests, step, advance.
    """

    def at(
        self, lin: Linearised, u: np.ndarray, pressure: np.ndarray, active: np.ndarray, before: Iterate | None = None
    ) -> Iterate:
        """The iterate at u (n,), the first one or after another: gap, scales and residual are worked out."""
        gap, contact = self.problem.gap(u), self.problem.contact_force(u, pressure)
        push = float(norm(contact, check_finite=False))
        scale = max(lin.scale, push)
        first = (before.first_scale if before else 0.0) or scale
        imbalance = float(norm(lin.residual - contact, check_finite=False))
        if not imbalance <= BLOW_UP * max(first, np.finfo(float).tiny):
            residual = float("inf")
        else:
            residual = imbalance / scale if scale > 0 else imbalance
        stiffness = before.stiffness if before else Stiffness.of(self.problem, lin, u)
        # a body that goes back to zero brings the rounding of its way with it: no less than the first that was not zero
        # a start may have pressures that balance nothing, as springs do into which a foundation has been pushed
        large = length(self.problem, stiffness, u, scale if before else lin.scale)
        first_length = (before.first_length if before else 0.0) or large
        sizes = (max(large, first_length), first_length, stiffness)
        reached = Iterate(lin, u, gap, pressure, active, push, scale, first, residual, *sizes)
        if before is None:
            return reached
        return replace(reached, stepped=before.stepped, moved=before.moved, moved_before=before.moved_before)

    def balanced(self, at: Iterate) -> bool:
        """True when the relative residual is within tolerance, or is rounding and does not matter.

        What it still asks for is taken to be what the last step has moved. A long step brings the rounding of its own
        way with it: after one a thin plate is 6e-8 from its place of rest, and the sum of its forces shows it.
        """
        if at.residual <= self.tolerance:
            share = at.push / at.scale if at.scale > 0 else 0.0
            return at.residual <= met(self.tolerance, share, at.rounding) or at.moved > 0.5 * at.moved_before
        size = float(norm(at.u, check_finite=False))
        summed = np.sqrt(len(at.u)) * at.residual  # of nodes, at most
        if summed > ROUNDING_ALONE and at.stepped is not None and at.moved > SETTLED * size and not self.stuck(at):
            return False
        return excused(at.residual, at.rounding, at.moved / size if size > 0 else np.inf)

    def known(self, at: Iterate, last: Iterate | None) -> Iterate | None:
        """Of a balanced iterate and the ``last`` one on its set, the first whose rounding moves nothing, if any.

        The last step has told what the residual before it asked for. What the next one will ask for is worked out
        without the memory of the way there, of which the judge knows nothing: one linearisation and one factorisation
        more.
        """
        if last is None or at.residual <= max(self.tolerance, min(ROUNDING_ALONE, at.rounding)):
            return at
        same = np.array_equal(last.active, at.active) and self.closed(last)
        return next((each for each in ((at, last) if same else (at,)) if self._moves_nothing(each)), None)

    def _moves_nothing(self, at: Iterate) -> bool:
        pressure = np.maximum(at.pressure, 0.0)
        anew = self.at(self.linearise(at.u, None), at.u, pressure, at.active)
        rounding, asked = anew.rounding, np.inf
        if decides(anew.residual, rounding):
            asked = self._asked(anew)
        return anew.residual <= self.tolerance or excused(anew.residual, rounding, asked)

    def _asked(self, at: Iterate) -> float:
        """|du|/|u|: the displacement that the imbalance still asks for, on the pressed nodes held at their gaps."""
        left = self.problem.contact_force(at.u, at.pressure) - at.lin.residual
        try:
            K = self.problem.stiffness(at.lin, at.u, at.pressure)
            du, _ = self.response(at.u, K, np.flatnonzero(at.pressure > 0), left)
        except SingularMatrixError:
            return float("inf")
        return float(np.linalg.norm(du) / np.linalg.norm(at.u))

    def stuck(self, at: Iterate) -> bool:
        """True when the residual is rounding and the steps no longer shrink; without balance, that is the end."""
        return at.moved > 0.5 * at.moved_before and at.residual <= at.rounding

    def closed(self, at: Iterate) -> bool:
        """True when the nodes of the set obey g + p/epsilon = 0."""
        sprung = at.pressure / self.epsilon
        mismatch, largest = np.abs(at.gap + sprung)[at.active], float(np.max(np.abs(sprung), initial=0.0))
        return bool(np.max(mismatch, initial=0.0) <= self.gap_rounding(at, largest))

    def gap_rounding(self, at: Iterate, moved: float = 0.0) -> float:
        """Largest gap [mm] that counts as closed; ``moved`` [mm]: how far a gap has come since the iterate."""
        return gap_rounding(self.problem, max(at.length, moved))

    def misplaced(self, at: Iterate, c: float = 1.0, *, solved: bool = False) -> np.ndarray:
        """Candidates (m,) on the wrong side: in the set with p - c g < 0, or out of it with p - c g > 0.

        c [-]: over the stiffness of the candidates per area.
        A node that just touches without pressure has p and g of the size of rounding, and no set is the right one:
        near equilibrium, and where p and g have just been ``solved`` for, what rounding explains swaps nothing.
        """
        c *= at.stiffness.per_area or 1.0
        excess = np.where(at.active, 1.0, -1.0) * (at.pressure - c * at.gap)
        wrong = excess < 0
        if wrong.any() and (solved or at.residual <= ROUNDING_ALONE):
            force = ROUNDING_MARGIN * rounding_floor(at.lin, at.u, at.scale)
            in_pressure, in_gap = force / self.problem.weights, c * self.gap_rounding(at)
            # a solved step leaves a pressure in the set and a gap out of it; rounding of the other is none of theirs
            wrong = excess < -(np.where(at.active, in_pressure, in_gap) if solved else in_pressure + in_gap)
        return wrong

    def step(
        self, lin: Linearised, u: np.ndarray, pressure: np.ndarray, active: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray]:
        """One linear step du (n,) on the set ``active``, with the pressures (m,) it brings.

        K du - G^T W p = -r,   G_A du + p_A/epsilon = -g_A,   p = 0 outside the set A.
        Raises SingularMatrixError.
        """
        return self.linear(lin, u, pressure, active).step(active)

    def linear(self, lin: Linearised, u: np.ndarray, pressure: np.ndarray, active: np.ndarray) -> LinearStep:
        """The linearised problem, factorised on the set ``active``; raises SingularMatrixError."""
        if holdable(self.problem):
            from contact.newton.condensed import Condensed, Linear  # loaded with candidates alone

            return Condensed(self, Linear.at(self, lin, u, pressure), active)
        return Substituted(self, lin, u, pressure)

    def advance(self, at: Iterate, du: np.ndarray, pressure: np.ndarray, active: np.ndarray) -> Iterate:
        """The next iterate: one Newton iteration, however many linear systems its step and its set took.

        The forces of a start are joined by those that the first step asks of the foundation: a body that is hardly
        loaded before it is pressed has not blown up when it is.
        """
        same = at.stepped is not None and np.array_equal(active, at.stepped)
        self.tally.counters["newton_iterations"] += 1
        memory, moved = self.remember(at.lin, du)
        before = replace(at, stepped=active, moved=moved, moved_before=at.moved if same else np.inf)
        if at.stepped is None:
            push = float(norm(self.problem.contact_force(at.u, pressure), check_finite=False))
            before = replace(before, first_scale=max(at.first_scale, push))
        return self.at(self.linearise(at.u + du, memory), at.u + du, pressure, active, before)

    def finish(self, at: Iterate, outcome: Outcome) -> ContactSolution:
        """The solution record of this run; pressures of a converged set that rounding made negative become zero."""
        pressure = np.maximum(at.pressure, 0.0) if outcome.converged else at.pressure
        return ContactSolution(at.u, pressure, at.active, outcome, dict(self.tally.counters), tuple(self.tally.history))
