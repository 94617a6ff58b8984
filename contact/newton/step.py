"""The one Newton that all algorithms share: a linear step on a given contact set, and the tests of convergence.

Which nodes belong to the set is the algorithm's business and must not enter here.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import Protocol

import numpy as np
from scipy import sparse
from scipy.linalg import norm

from contact.newton.condensed import Condensed, Linear
from contact.newton.held import Held, holdable
from contact.newton.pivots import Pivots
from contact.newton.state import Iterate, Tally
from contact.problem import ContactProblem, ContactSolution, Linearised, Outcome
from contact.rounding import ROUNDING_ALONE, decides, excused, met, rounding_floor
from contact.scales import Stiffness, length
from contact.solvers.sparse import AUTO, Factor, SingularMatrixError, checked_solve, factorise, instead

RESIDUAL_TOLERANCE = 1e-9  # relative to the forces in balance; what every algorithm's ``tolerance`` is by default
GAP_TOLERANCE = 1e-12  # relative to a large gap
ROUNDING_MARGIN = 10.0
BLOW_UP = 1e12  # residual, relative to the forces at the start, beyond which nothing can be rescued


def gap_rounding(problem: ContactProblem, large: float) -> float:
    """Size [mm] of a gap that is none where one of the size ``large`` [mm] is a large one."""
    return GAP_TOLERANCE * large + ROUNDING_MARGIN * float(np.finfo(float).eps) * problem.gap_size


class LinearStep(Protocol):
    """A linearised problem that knows its step on any set."""

    def near(self, active: np.ndarray) -> LinearStep:
        """The one to ask for the step on a set (m,): this one, or one that is factorised anew."""

    def step(self, active: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """du (n,) and pressures (m,) on the set (m,); raises SingularMatrixError."""

    def foreseen(self, active: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Gaps and pressures (m,) after that step, less exact where that is cheaper."""


@dataclass(frozen=True, eq=False)
class NewtonRun:
    """One solve: a problem, a solver, an epsilon, a tolerance, and the tally of what is spent on them.

    The iterate comes in and the next one goes out: linearise and at for the first, then the tests, step, advance.
    """

    problem: ContactProblem
    epsilon: float = np.inf
    solver: str = AUTO
    tolerance: float = RESIDUAL_TOLERANCE
    tally: Tally = field(default_factory=Tally)

    def linearise(self, u: np.ndarray, memory: object) -> Linearised:
        """Linearise the mechanics, counted and timed."""
        self.tally.counters["assemblies"] += 1
        with self.tally.timed("assembly_s"):
            return self.problem.linearise(u, memory)

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
        found = Iterate(lin, u, gap, pressure, active, push, scale, first, residual, *sizes)
        if before is None:
            return found
        return replace(found, stepped=before.stepped, moved=before.moved, moved_before=before.moved_before)

    def balanced(self, at: Iterate) -> bool:
        """True when the relative residual is within tolerance, or is rounding and does not matter.

        What it still asks for is taken to be what the last step has moved.
        """
        if at.residual <= self.tolerance:
            share = at.push / at.scale if at.scale > 0 else 0.0
            return at.residual <= met(self.tolerance, share, _rounding(at)) or at.moved > 0.5 * at.moved_before
        size = float(norm(at.u, check_finite=False))
        return excused(at.residual, _rounding(at), at.moved / size if size > 0 else np.inf)

    def known(self, at: Iterate, last: Iterate | None) -> Iterate | None:
        """Of a balanced iterate and the ``last`` one on its set, the first whose rounding moves nothing, if any.

        The last step has told what the residual before it asked for. What the next one will ask for is worked out
        without the memory of the way there, of which the judge knows nothing: one linearisation and one factorisation
        more.
        """
        if last is None or at.residual <= max(self.tolerance, min(ROUNDING_ALONE, _rounding(at))):
            return at
        same = np.array_equal(last.active, at.active) and self.closed(last)
        return next((each for each in ((at, last) if same else (at,)) if self._moves_nothing(each)), None)

    def _moves_nothing(self, at: Iterate) -> bool:
        pressure = np.maximum(at.pressure, 0.0)
        anew = self.at(self.linearise(at.u, None), at.u, pressure, at.active)
        rounding, asked = _rounding(anew), np.inf
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

    def response(
        self, u: np.ndarray, K: sparse.csc_matrix, nodes: np.ndarray, force: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray]:
        """du (n,) under forces (n,) while the gaps of these candidates stay, and the pressures (m,) that hold them.

        K du - G^T W dp = force,   G_A du + dp_A/epsilon = 0,   dp = 0 outside A.
        Raises SingularMatrixError, ValueError.
        """
        pressures = np.zeros(len(self.problem.weights))
        if holdable(self.problem):
            held, still = Held.on(self.problem, u, nodes, K, self.epsilon), np.zeros(len(nodes))
            y = self.solution(self.factorise(held.matrix), held.matrix, held.load(force, still))
            du = held.motion(y, still)
            pressures[nodes] = held.forces(y, du, -force) / self.problem.weights[nodes]
        else:
            pivots = Pivots.choose(self.problem, u, nodes, K, self.epsilon).homogeneous()
            A, load = pivots.substitute(K, force)
            du, pressures[nodes] = pivots.resolve(self.solution(self.factorise(A), A, load))
        return du, pressures

    def stuck(self, at: Iterate) -> bool:
        """True when the residual is rounding and the steps no longer shrink; without balance, that is the end."""
        return at.residual <= _rounding(at) and at.moved > 0.5 * at.moved_before

    def closed(self, at: Iterate) -> bool:
        """True when the nodes of the set obey g + p/epsilon = 0."""
        sprung = at.pressure / self.epsilon
        mismatch, largest = np.abs(at.gap + sprung)[at.active], float(np.max(np.abs(sprung), initial=0.0))
        return bool(np.max(mismatch, initial=0.0) <= self.gap_rounding(at, largest))

    def gap_rounding(self, at: Iterate, moved: float = 0.0) -> float:
        """Size [mm] of a gap that is none; ``moved`` [mm]: how far a gap has come since the iterate."""
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
            return Condensed(self, Linear.at(self, lin, u, pressure), active)
        return Substituted(self, lin, u, pressure)

    def factorise(self, A: sparse.csc_matrix) -> Factor:
        """Factorise, counted and timed; raises SingularMatrixError."""
        with self.tally.timed("factorisation_s"):
            factor = factorise(A, self.solver, ordered=self.problem.ordered)
        self.tally.counters["factorisations"] += 1
        if instead(factor, self.solver, ordered=self.problem.ordered):
            self.tally.counters["superlu_instead"] = self.tally.counters.get("superlu_instead", 0) + 1
        return factor

    def solution(self, factor: Factor, A: sparse.csc_matrix, b: np.ndarray) -> np.ndarray:
        """The checked solution, timed; raises SingularMatrixError."""
        with self.tally.timed("solve_s"):
            return checked_solve(factor, A, b)

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

    def remember(self, lin: Linearised, du: np.ndarray) -> tuple[object, float]:
        """The memory of the step, timed as assembly, and its size |du|."""
        with self.tally.timed("assembly_s"):
            memory = lin.remember(du)
        return memory, float(norm(du, check_finite=False))

    def finish(self, at: Iterate, outcome: Outcome) -> ContactSolution:
        """The solution record of this run; pressures of a converged set that rounding made negative become zero."""
        pressure = np.maximum(at.pressure, 0.0) if outcome.converged else at.pressure
        return ContactSolution(at.u, pressure, at.active, outcome, dict(self.tally.counters), tuple(self.tally.history))


@dataclass(frozen=True, eq=False)
class Substituted:
    """The linearised problem, factorised anew on each set: the only way where pressures have to be unknowns."""

    run: NewtonRun
    lin: Linearised
    u: np.ndarray
    pressure: np.ndarray
    found: dict[bytes, tuple[np.ndarray, np.ndarray]] = field(default_factory=dict)

    def near(self, active: np.ndarray) -> Substituted:
        """The same for every set."""
        return self

    def step(self, active: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """du (n,) and pressures (m,) on the set; raises SingularMatrixError."""
        if active.tobytes() not in self.found:
            self.found[active.tobytes()] = self._solved(active)
        return self.found[active.tobytes()]

    def foreseen(self, active: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Gaps and pressures (m,) after the step."""
        du, pressure = self.step(active)
        return self.run.problem.gap(self.u) + self.run.problem.gap_jacobian(self.u) @ du, pressure

    def _solved(self, active: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        run, nodes, found = self.run, np.flatnonzero(active), np.zeros_like(self.pressure)
        pivots: Pivots | None = None
        with run.tally.timed("contact_s"):
            A, b = run.problem.stiffness(self.lin, self.u, self.pressure), -self.lin.residual
            if len(nodes):
                pivots = Pivots.choose(run.problem, self.u, nodes, A, run.epsilon)
                A, b = pivots.substitute(A, b)
        du = run.solution(run.factorise(A), A, b)
        if pivots is not None:
            with run.tally.timed("contact_s"):
                du, found[nodes] = pivots.resolve(du)
        return du, found


def _rounding(at: Iterate) -> float:
    return rounding_floor(at.lin, at.u) / at.scale if at.scale > 0 else 0.0
