"""Trial and error, the paper's method: Newton to convergence on a fixed set, then swap every violating node.

With friction who is open, sticks and slips, and where to, is guessed; who slips does so in the direction of the last
equilibrium, against its friction where it has stuck there; who comes back to the foundation sticks. That cycles: the
GRECO plate with mu = 1 on every mesh (studies.experiments.friction), a plate that is dragged once all of it slips,
since one that sticks tilts until nodes are let go, which then come back. It is the rule for those who come back that
does. At states seen before, the problem linearised at their equilibrium is settled, and from then on who comes back
sticks or slips as Alart and Curnier's function says. A second cycle ends the solve, as CYCLING, and so does the first
of the naive set, which is the one without that answer.
"""

from dataclasses import dataclass, replace
from typing import ClassVar

import numpy as np

from contact.algorithms.base import NewtonAlgorithm
from contact.coulomb import State
from contact.events import Event, EventKind
from contact.newton.friction_loop import settled
from contact.newton.friction_run import FAILURES, FrictionalRun, Point
from contact.newton.friction_states import Laws
from contact.newton.loop import CYCLE, StepError, first_of, only_released, settle_exactly
from contact.newton.step import Iterate, NewtonRun
from contact.problem import ContactProblem, ContactSolution, Outcome
from contact.solvers.sparse import SingularMatrixError

STATES_CYCLE = "cycle detected: these states were tried {} sets before"


@dataclass(frozen=True)
class TrialAndError(NewtonAlgorithm):
    """Guess a set, solve, release nodes under tension, add nodes that penetrate, repeat.

    epsilon [MPa/mm]: the regularisation, 1e4 in the paper; infinity enforces the constraint exactly.
    Swapping all violators at once can cycle, even on a symmetric positive definite matrix of three unknowns (Curtis,
    Han, Robinson, Comput. Optim. Appl. 60 (2015) 311-341). The paper does not treat this. Here, when a set recurs, the
    problem linearised at its equilibrium is solved by principal pivots, and its set is the next guess. With linear
    mechanics and a P-matrix that set is the solution. Otherwise, when a set recurs again, only the first violator is
    swapped (Murty's least index), until a set recurs under that rule, too. The history records this.
    At the rim of a beam, plate or membrane one row of elements is released at a time, so the number of sets grows with
    the mesh (plate-contact: 209 iterations on 64 elements, 551 on 256). In semismooth, lcp and qp it does not.
    max_sets: sets that only release nodes do not count; between two others there are at most as many as candidates.
    naive: with friction, whether the first cycle stops the solve.
    Sources: Grigolyuk et al. (2004), eqs 14-16; Murty, Linear Algebra Appl. 5 (1972) 65-108.
    """

    epsilon: float = 1e4
    max_sets: int = 200
    naive: bool = False
    name: ClassVar[str] = "trial-and-error"
    friction: ClassVar[bool] = True

    def solve(self, problem: ContactProblem, start: ContactSolution) -> ContactSolution:
        """Start from the set, or the states, of ``start`` and the nodes that already penetrate."""
        if problem.coulomb is not None:
            return self._with_friction(self.rubbing(problem, start, lawful=False))
        run = self.run(problem)
        u, pressure, before = start.u, start.pressure, start.active
        active = before | (problem.gap(u) < 0)
        seen: set[bytes] = set()
        counted, cycles = 0, 0
        at: Iterate | None = None
        while counted < self.max_sets and cycles < 3:
            pressed = np.where(active, pressure, 0.0)
            at, outcome = self._equilibrium(run, run.at(run.linearise(u, None), u, pressed, active, at), before)
            if not outcome.converged:
                return run.finish(at, outcome)
            own = np.where(active, 0.0, at.gap)  # in the set only the pressure decides, out of it only the gap
            violated = run.misplaced(replace(at, gap=own))
            if not violated.any():
                return run.finish(at, Outcome.CONVERGED)
            u, pressure, before = at.u, at.pressure, active
            again = active.tobytes() in seen
            if again:
                cycles += 1
                seen.clear()
            seen.add(active.tobytes())
            if again and cycles == 1:
                active, event = _settled(run, at)
                run.tally.tell(event)
            else:
                if again and cycles == 2:
                    run.tally.tell(CYCLE)
                active = active ^ (first_of(violated) if cycles > 1 else violated)
            counted += not only_released(before, active)
        assert at is not None  # there is at least one set
        ended = Outcome.CYCLING if cycles else Outcome.ITERATION_LIMIT
        return run.finish(replace(at, active=active), ended)

    def _with_friction(self, run: FrictionalRun) -> ContactSolution:
        at = run.start()
        laws, tried, again = _next_states(run, at), list[bytes](), False
        for _ in range(self.max_sets):
            tried.append(laws.key)
            try:
                at, outcome = self._under(run, at, laws)
                after = _next_states(run, at, by_function=again)
                cycles = outcome.converged and not after.same(laws) and after.key in tried
                if cycles:
                    ago = len(tried) - tried.index(after.key)
                    run.newton.tally.tell(Event(EventKind.CYCLE, STATES_CYCLE.format(ago)))
                    if again or self.naive:
                        return run.finish(at, Outcome.CYCLING)
                    again, tried = True, []
                    _, after, _ = settled(run, at, run.linear(at, after), after)
            except FAILURES as error:
                return run.finish(at, run.failed(error))
            if not outcome.converged:
                return run.finish(at, outcome)
            if after.same(laws):
                lawful = run.by_law(at)
                if run.newton.balanced(lawful.newton):
                    return run.finish(lawful, Outcome.CONVERGED)
            laws = after
        return run.finish(at, Outcome.ITERATION_LIMIT)

    def _under(self, run: FrictionalRun, at: Point, laws: Laws) -> tuple[Point, Outcome]:
        """Newton under these laws, whether what comes out obeys them or not; raises FAILURES."""
        run.note(at, laws, at.laws)
        for _ in range(self.max_iterations):
            at = run.advance(at, run.linear(at, laws).step(laws), laws)
            run.note(at, laws, laws)
            ended = run.ended(at, laws)
            if ended is not None:
                return at, ended
        return at, Outcome.ITERATION_LIMIT

    def _equilibrium(self, run: NewtonRun, at: Iterate, before: np.ndarray) -> tuple[Iterate, Outcome]:
        """Newton on the set of the iterate; ``before`` (m,): the set before it."""
        for iteration in range(self.max_iterations + 1):
            run.tally.note(at.residual, at.active, before if iteration == 0 else at.active)
            if np.isinf(at.residual):
                return at, Outcome.DIVERGED
            closed = run.closed(at)
            if closed and run.balanced(at):
                return at, Outcome.CONVERGED
            if closed and run.stuck(at):
                return at, Outcome.ROUNDING
            if iteration == self.max_iterations:
                break
            try:
                du, pressure = run.step(at.lin, at.u, at.pressure, at.active)
            except SingularMatrixError:
                return at, Outcome.SINGULAR
            at = run.advance(at, du, pressure, at.active)
        return at, Outcome.ITERATION_LIMIT


def _settled(run: NewtonRun, at: Iterate) -> tuple[np.ndarray, Event]:
    """The set (m,) that solves the linearised problem at an equilibrium, or the same one where that has no end."""
    try:
        step = settle_exactly(run, at, run.linear(at.lin, at.u, at.pressure, at.active), at.active)
    except (SingularMatrixError, StepError) as error:
        return at.active, Event(EventKind.CYCLE, str(error))
    return step.active, step.event or CYCLE


def _next_states(run: FrictionalRun, at: Point, *, by_function: bool = False) -> Laws:
    """The laws expected at a point, with the direction of the slip itself where a candidate slips on.

    by_function: whether who comes back to the foundation may slip, as Alart and Curnier's function says.
    """
    laws, slip, was = run.expected(at), at.local.slip, at.laws.state
    size = np.linalg.norm(slip, axis=1)
    on = (laws.state == State.SLIP) & (was == State.SLIP) & (size > 0)
    direction = np.divide(slip, size[:, None], out=laws.direction.copy(), where=on[:, None])
    returns = (was == State.OPEN) & laws.closed & (run.law.mu > 0) & (not by_function)
    direction[returns] = 0.0
    return Laws(np.where(returns, State.STICK, laws.state).astype(np.int8), direction, np.zeros_like(laws.across))
