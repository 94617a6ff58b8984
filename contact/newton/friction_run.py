"""One solve of a problem with friction: the tests of convergence of contact alone, with friction in the balance.

What the law expects of the next step is asked here; which states are taken is the algorithm's business and must not
enter.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Protocol

import numpy as np
from scipy.linalg import norm

from contact.coulomb import Coulomb, Friction, State
from contact.events import Event, EventKind
from contact.newton.friction_held import Directions, NotHeldError
from contact.newton.friction_states import Laws, Local, Margins, expected, friction_of
from contact.newton.friction_step import FrictionalStep, Linear, SprungStep, Stepped
from contact.newton.loop import StepError
from contact.newton.step import GAP_TOLERANCE, ROUNDING_MARGIN, Iterate, NewtonRun
from contact.problem import ContactSolution, Linearisation, Linearised, Outcome
from contact.rounding import rounding_floor
from contact.slip import stretched
from contact.solvers.sparse import SingularMatrixError

EPS = float(np.finfo(float).eps)
Failure = SingularMatrixError | NotHeldError | StepError
FAILURES = (SingularMatrixError, NotHeldError, StepError)  # why there is no step


class LinearStep(Protocol):
    """A linearised problem that knows its step under any states."""

    def near(self, laws: Laws) -> LinearStep:
        """The one to ask for the step under the laws: this one, or one that is factorised anew; raises NotHeldError."""

    def step(self, laws: Laws) -> Stepped:
        """The step under the laws; raises SingularMatrixError, NotHeldError."""

    def foreseen(self, laws: Laws) -> Stepped:
        """The same for the choice of states, less exact where that is cheaper."""

    def under(self, residual: np.ndarray, now: np.ndarray) -> LinearStep:
        """The same tangent for another residual (n,) and other gaps and slips (3m,) before the step."""


@dataclass(frozen=True, eq=False)
class Point:
    """An iterate: that of the contact problem with friction among its loads, and what the candidates do there.

    lin: the mechanics alone.  local: with a finite epsilon gap and slip are without what springs give way, g + f/k and
    s + t/k.  laws: of the last step.  friction (m, 2) [N]: of the laws, where ``local`` has that of
    the linear step.
    """

    newton: Iterate
    lin: Linearised
    local: Local
    laws: Laws
    friction: np.ndarray


@dataclass(frozen=True, eq=False)
class FrictionalRun:
    """The run of a contact problem, which factorises, solves and counts, with the law of friction in it.

    law: of the problem, its slips counted from the anchors of the start, or from where the candidates are there.
    begun: the start; who is in contact and has never rubbed sticks.
    lawful: friction is that of the law at every point, else as it comes out of the linear step under given laws.
    """

    newton: NewtonRun
    law: Coulomb
    begun: ContactSolution
    lawful: bool = True

    @classmethod
    def of(cls, newton: NewtonRun, begun: ContactSolution, *, lawful: bool = True) -> FrictionalRun:
        """On a problem with friction, from a start."""
        law = newton.problem.coulomb
        assert law is not None
        if law.sliding is not None:
            law = law.since(law.sliding.places(begun.u) if begun.friction is None else begun.friction.anchors)
        return cls(newton, law, begun, lawful)

    def start(self) -> Point:
        """The first point, by the states of the start; slips begin anew, and so do their directions."""
        begun, m = self.begun, len(self.law.mu)
        friction = begun.friction
        if friction is None:
            friction = Friction(np.zeros((m, 2)), np.where(begun.active, State.STICK, State.OPEN).astype(np.int8))
        laws = Laws(friction.state, np.zeros((m, 2)), np.zeros(m))
        normal = self.newton.problem.nodal_forces(begun.pressure)
        return self.at(self.newton.linearise(begun.u, None), begun.u, normal, friction.force, laws)

    def at(
        self,
        lin: Linearised,
        u: np.ndarray,
        normal: np.ndarray,
        friction: np.ndarray,
        laws: Laws,
        before: Iterate | None = None,
    ) -> Point:
        """The point at u (n,) with the forces (m,), (m, 2) of a step under the laws."""
        contact, law = self.newton.problem, self.law
        c = np.zeros_like(normal) if before is None else before.stiffness.per_area * contact.weights
        give = self.give
        gap, slip = contact.gap(u) + give * normal, law.slip(u)
        local = Local(gap, slip + give[:, None] * friction, normal, friction, c)
        # a spring that slips is stretched along the whole slip, which no friction of the linear step turns
        whole = replace(local, slip=slip)
        rubbing = friction_of(whole, laws, law.mu, self.slip_rounding(u)) if self.lawful else friction
        rubbed = np.asarray(law.slip_jacobian(u).T @ rubbing.ravel())
        scale = max(lin.scale, float(norm(rubbed, check_finite=False)))
        loaded = Linearisation(lin.residual - rubbed, lin.tangent, scale, lin.remember)
        newton = self.newton.at(loaded, u, self._pressure(normal), laws.closed, before)
        if before is None:
            local = replace(local, c=newton.stiffness.per_area * contact.weights)
        return Point(newton, lin, local, laws, rubbing)

    @property
    def give(self) -> np.ndarray:
        """1/(w epsilon) (m,) [mm/N]: what gaps and slips give way under a unit force."""
        w = self.newton.problem.weights
        return np.divide(1 / self.newton.epsilon, w, out=np.zeros_like(w), where=w > 0)

    def slip_rounding(self, u: np.ndarray, length: float = 0.0) -> float:
        """Size [mm] of a slip that is none."""
        way = float(np.max(abs(self.law.slip_jacobian(u)) @ np.abs(u), initial=0.0))
        return GAP_TOLERANCE * max(way, length) + ROUNDING_MARGIN * EPS * self.law.slip_size

    def margins(self, at: Point, moved: float = 0.0) -> Margins:
        """What rounding explains at a point; ``moved`` [mm]: how far a candidate has come since.

        A spring has the rounding of what stretches it, which may be far less than that of the forces in balance.
        """
        force = ROUNDING_MARGIN * rounding_floor(at.lin, at.newton.u, at.newton.scale)
        gap = self.newton.gap_rounding(at.newton, moved)
        slip = self.slip_rounding(at.newton.u, max(at.newton.length, moved))
        if np.isfinite(self.newton.epsilon):
            stiffest = self.newton.epsilon * float(np.max(self.newton.problem.weights, initial=0.0))
            force = min(force, stiffest * max(gap, slip))
        return Margins(force, gap, slip)

    def expected(self, at: Point) -> Laws:
        """The laws that the next step is to obey.

        At the start who sticks has not slipped: a foundation that has moved in the meantime takes it along first.
        """
        local = at.local
        if at.newton.stepped is None:
            local = replace(local, slip=np.where((at.laws.state == State.STICK)[:, None], 0.0, local.slip))
        return self._expected(at, local, at.laws, 0.0)

    def foreseen(self, at: Point, stepped: Stepped, laws: Laws) -> Laws:
        """The laws after a linear step under ``laws``; those who slip on keep the direction of its linearisation."""
        moved = float(np.max(np.abs(stepped.gap - at.local.gap), initial=0.0))
        moved = max(moved, float(np.max(np.abs(stepped.slip - at.local.slip), initial=0.0)))
        local = Local(stepped.gap, stepped.slip, stepped.normal, stepped.friction, at.local.c)
        after = self._expected(at, local, laws, moved)
        same = after.state == laws.state
        direction = np.where(same[:, None], laws.direction, after.direction)
        return Laws(after.state, direction, np.where(same, laws.across, after.across))

    def _expected(self, at: Point, local: Local, laws: Laws, moved: float) -> Laws:
        return expected(local, laws, self.law.mu, self.margins(at, moved), self._led(at.newton.u))

    def _led(self, u: np.ndarray) -> np.ndarray:
        """Candidates (m,) that slip whatever they do: nothing of theirs follows the foundation along their slip."""
        slips = self.law.slip_jacobian(u)
        if np.isfinite(self.newton.epsilon):
            return np.zeros(len(self.law.mu), bool)
        fixed = (np.asarray(abs(slips).sum(axis=1)).reshape(-1, 2) == 0) & (
            np.abs(self.law.slip(u)) > self.slip_rounding(u)
        )
        return np.asarray(fixed.any(axis=1))

    def settled(self, at: Point) -> bool:
        """True where the set obeys g = 0, and who sticks s = 0."""
        sticks = at.laws.state == State.STICK
        slip = np.max(np.abs(at.local.slip[sticks]), initial=0.0)
        return self.newton.closed(at.newton) and bool(slip <= self.slip_rounding(at.newton.u, at.newton.length))

    def ended(self, at: Point, laws: Laws) -> Outcome | None:
        """How a point ends the iteration when the next step is to obey ``laws``, if it does."""
        if np.isinf(at.newton.residual):
            return Outcome.DIVERGED
        if not (laws.same(at.laws) and self.settled(at)):
            return None
        if self.newton.balanced(at.newton):
            return Outcome.CONVERGED
        return Outcome.ROUNDING if self.newton.stuck(at.newton) else None

    def linear(self, at: Point, laws: Laws) -> LinearStep:
        """The linearised problem, factorised under the laws; raises SingularMatrixError, NotHeldError."""
        u, contact, law = at.newton.u, self.newton.problem, self.law
        K = law.on_tangent(contact.stiffness(at.lin, u, at.newton.pressure), u, at.friction)
        ways = Directions.of(contact.gap_jacobian(u), law.slip_jacobian(u))
        now = np.column_stack([contact.gap(u), law.slip(u)]).ravel()
        linear = Linear(K, at.lin.residual, ways, now, law.mu)
        if np.isfinite(self.newton.epsilon):
            k = self.newton.epsilon * contact.weights
            return SprungStep(self.newton, linear, k)
        return FrictionalStep(self.newton, linear, laws)

    def by_law(self, at: Point) -> Point:
        """The same point with the friction of the law."""
        run, local = replace(self, lawful=True), at.local
        return run.at(at.lin, at.newton.u, local.normal, local.friction, at.laws, at.newton)

    def advance(self, at: Point, stepped: Stepped, laws: Laws) -> Point:
        """The next point: one Newton iteration."""
        run, same = self.newton, at.newton.stepped is not None and at.laws.same(laws)
        run.tally.counters["newton_iterations"] += 1
        memory, moved = run.remember(at.lin, stepped.du)
        moved_before = at.newton.moved if same else np.inf
        before = replace(at.newton, stepped=laws.closed, moved=moved, moved_before=moved_before)
        if at.newton.stepped is None:
            asked = self._force(at.newton.u, stepped)
            before = replace(before, first_scale=max(at.newton.first_scale, float(norm(asked, check_finite=False))))
        u = at.newton.u + stepped.du
        return self.at(run.linearise(u, memory), u, stepped.normal, stepped.friction, laws, before)

    def _force(self, u: np.ndarray, stepped: Stepped) -> np.ndarray:
        """G^T f + S^T t (n,) of a step."""
        pushed = self.newton.problem.gap_jacobian(u).T @ stepped.normal
        return np.asarray(pushed + self.law.slip_jacobian(u).T @ stepped.friction.ravel())

    def finish(self, at: Point, outcome: Outcome) -> ContactSolution:
        """The solution record; normal forces of a converged one that rounding made negative become zero."""
        normal, force, tally = at.local.normal, at.friction, self.newton.tally
        if outcome.converged:
            normal = np.maximum(normal, 0.0)
            force = within(force, self.law.bound(normal))
        frictionless = ContactSolution(
            at.newton.u, self._pressure(normal), at.laws.closed, outcome, dict(tally.counters), tuple(tally.history)
        )
        return replace(frictionless, friction=self._remembered(at.newton.u, force, at.laws.state))

    def _remembered(self, u: np.ndarray, force: np.ndarray, state: np.ndarray) -> Friction:
        """Friction with the anchors that it leaves: where a spring is still stretched, its end on the foundation."""
        still = stretched(self.newton.problem, force, self.newton.epsilon)
        before = 0.0 if self.begun.friction is None else self.begun.friction.dissipation
        lost = before - float(np.sum(force * (self.law.slip(u) - still)))
        if self.law.sliding is None:
            return Friction(force, state, dissipation=lost)
        return Friction(force, state, self.law.sliding.anchors, self.law.sliding.left(u, still), lost)

    def _pressure(self, normal: np.ndarray) -> np.ndarray:
        """f/w (m,), 0 where a candidate has no area."""
        weights = self.newton.problem.weights
        return np.divide(normal, weights, out=np.zeros_like(normal), where=weights > 0)

    def failed(self, error: Failure) -> Outcome:
        """How a solve ends that has no step; the history says why."""
        self.newton.tally.tell(Event(EventKind.FAILED, str(error)))
        if isinstance(error, StepError):
            return error.outcome
        return Outcome.REFUSED if isinstance(error, NotHeldError) else Outcome.SINGULAR

    def note(self, at: Point, laws: Laws, before: Laws, event: Event | None = None) -> None:
        """One row of history: how many stick and slip, and how many states have changed."""
        self.newton.tally.note(at.newton.residual, laws.closed, before.closed, event)
        row = self.newton.tally.history[-1]
        row["sticking"], row["slipping"] = (int(np.sum(laws.state == each)) for each in (State.STICK, State.SLIP))
        row["changed"] = int(np.sum(laws.state != before.state))


def within(friction: np.ndarray, bound: np.ndarray) -> np.ndarray:
    """Friction (m, 2) on discs of the radii (m,): what rounding has put beyond them is pulled back."""
    size = np.linalg.norm(friction, axis=1)
    share = np.divide(bound, size, out=np.ones_like(size), where=size > bound)
    return np.asarray(share[:, None] * friction)
