"""What a solution changes by with a parameter of its problem: direct differentiation on its contact set.

Where a solution obeys r(u) = G^T W p + S^T t with a gap closed or a pressure zero at each candidate, its rates with the
parameter obey the same equations, linearised::

    K du - G^T W dp - S^T dt = -R',    G_A du + dp_A/epsilon = -g'_A,    dp = 0 outside A

and the linearised laws of stick and slip. R', g' and s' are what the parameter changes of residual, gaps and slips
while the state is held. One factorisation serves all parameters. Where a candidate touches without pressure there is no
one derivative: rates are then positively homogeneous, and solve a linear complementarity problem on those candidates.
Sources: Michaleris, Tortorelli, Vidal, Int. J. Numer. Methods Eng. 37 (1994) 2471-2499; for one-sided rates Klarbring,
in: Optimization of Large Structural Systems (1993), and Robinson, Math. Oper. Res. 5 (1980) 43-62.

What a parameter is, and where problems come from, does not enter here.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import TypeVar

import numpy as np

from contact.continuation.spectrum import spectrum
from contact.coulomb import State
from contact.newton.friction_run import FrictionalRun
from contact.newton.friction_states import Laws, directed
from contact.newton.solves import Response, holdable
from contact.newton.step import NewtonRun
from contact.problem import ContactProblem, ContactSolution, Linearised
from contact.scales import Stiffness, length
from contact.solvers.lcp_pivoting import lemke
from contact.solvers.sparse import symmetric

OFFSETS = (-2, -1, 1, 2)  # steps, of central differences of the fourth order
STEP = 2.0**-12  # of a parameter; of second order a thin ring loses seven digits of ten at the best step (measured)
BESIDE = 1e-4  # of the displacement at a limit point, along its mode
WEAK = 1e-9  # of the largest force, and of a large gap: a candidate with less of both is in no set for certain


Posed = tuple[ContactProblem, float]  # a problem, and the epsilon [MPa/mm] of its contact law
Value = TypeVar("Value", float, np.ndarray)


def slope(values: Sequence[Value], step: float) -> Value:
    """The derivative of what takes these values at :data:`OFFSETS` of a step."""
    one, two, three, four = values
    return (8 * (three - two) - (four - one)) / (12 * step)


@dataclass(frozen=True, eq=False)
class Change:
    """What a unit of the parameter changes while the state is held.

    residual (n,) [N]: of r - G^T W p - S^T t.  gap (m,) [mm]: of g + p/epsilon.  slip (m, 2) [mm], and stretched, the
    same with what springs give way under t.  bound (m,) [N]: of mu f.
    """

    residual: np.ndarray
    gap: np.ndarray
    slip: np.ndarray
    stretched: np.ndarray
    bound: np.ndarray

    @classmethod
    def between(cls, posed: Sequence[Posed], state: ContactSolution, step: float) -> Change:
        """By differences of the problems with the parameter changed by :data:`OFFSETS` of a step."""
        ends = (_held(*each, state) for each in posed)
        return cls(*(slope(parts, step) for parts in zip(*ends, strict=True)))


@dataclass(frozen=True, eq=False)
class Rates:
    """du (n,), dp (m,) and dt (m, 2) with the parameter; dt None without friction."""

    u: np.ndarray
    pressure: np.ndarray
    friction: np.ndarray | None = None

    def moved(self, state: ContactSolution, by: float) -> ContactSolution:
        """The state after ``by`` of the parameter, to first order; anchors stay."""
        friction = state.friction
        if friction is not None and self.friction is not None:
            friction = replace(friction, force=friction.force + by * self.friction)
        return replace(state, u=state.u + by * self.u, pressure=state.pressure + by * self.pressure, friction=friction)


class Sensitivity:
    """Of a solution of a problem, slips counted from the anchors of its step.

    undecided (k,): candidates whose state any change of the parameter may decide: that touch without pressure; with
    friction also those that are about to slip, or have come to rest.
    """

    def __init__(self, problem: ContactProblem, state: ContactSolution, epsilon: float) -> None:
        """Factorise; raises SingularMatrixError, and ValueError where gaps are dependent."""
        self._problem, self._state = problem, state
        run = NewtonRun(problem, epsilon)
        lin = problem.linearise(state.u, None)
        self.undecided = _touching(problem, lin, state)
        if problem.coulomb is None or state.friction is None:
            certain = state.active.copy()
            certain[self.undecided] = False
            K = problem.stiffness(lin, state.u, state.pressure)
            self._respond: Callable[[Change], Rates] = self._without_friction(
                Response(run, state.u, K, np.flatnonzero(certain))
            )
        else:
            laws = replace(Laws.none(len(problem.weights)), state=state.friction.state)
            self._respond = self._with_friction(run, lin, laws)

    @property
    def one_sided(self) -> bool:
        """Whether rates differ from side to side: without friction, where a candidate touches without pressure."""
        return bool(len(self.undecided)) and self._problem.coulomb is None

    def rates(self, change: Change) -> tuple[Rates, Rates]:
        """Where the parameter grows, and, of the other side, the same with its sign: equal unless one_sided.

        Raises SingularMatrixError, LcpError, and ValueError where undecided candidates are coupled.
        """
        if not self.one_sided:
            answer = self._respond(change)
            return answer, answer
        grows, shrinks = (self._on_side(change, sign) for sign in (1.0, -1.0))
        return grows, Rates(-shrinks.u, -shrinks.pressure)

    def _without_friction(self, response: Response) -> Callable[[Change], Rates]:
        self._response = response

        def respond(change: Change) -> Rates:
            return Rates(*response(-change.residual, change.gap[response.nodes]))

        return respond

    def _on_side(self, change: Change, sign: float) -> Rates:
        """With f >= 0, v >= 0, f v = 0 of the undecided: v = sign (g' + G du) + M f their gaps with their springs."""
        problem, nodes, still = self._problem, self.undecided, np.zeros(len(self._response.nodes))
        if not holdable(problem):
            raise ValueError("candidates that touch without pressure need lumped coupling: each force its own")
        pushes, rows = problem.push(self._state.u)[nodes], problem.gap_jacobian(self._state.u)[nodes]
        free = self._respond(change)
        pushed = [self._response(push, still) for push in pushes.toarray()]
        M = np.column_stack([rows @ du for du, _ in pushed])
        M += np.diag(self._response.compliance(nodes))
        forces = lemke(M, sign * (change.gap[nodes] + rows @ free.u)).z
        u = sign * free.u + sum(f * du for f, (du, _) in zip(forces, pushed, strict=True))
        pressure = sign * free.pressure + sum(f * dp for f, (_, dp) in zip(forces, pushed, strict=True))
        pressure[nodes] = forces / problem.weights[nodes]
        return Rates(u, pressure)

    def _with_friction(self, run: NewtonRun, lin: Linearised, laws: Laws) -> Callable[[Change], Rates]:
        problem, state = self._problem, self._state
        law, friction = problem.coulomb, state.friction
        assert law is not None
        assert friction is not None
        normal = problem.nodal_forces(state.pressure)
        bound = law.bound(normal)
        frictional = FrictionalRun(run, law, state, lawful=False)
        at = frictional.at(lin, state.u, normal, friction.force, laws)
        laws = directed(at.local, friction.state, bound)
        step = frictional.linear(at, laws)
        slips, S = (laws.state == State.SLIP)[:, None], law.slip_jacobian(state.u)
        size = np.linalg.norm(friction.force, axis=1)
        sticks = (laws.state == State.STICK) & (normal > 0) & np.isfinite(bound)
        self.undecided = np.union1d(self.undecided, np.flatnonzero(sticks & (size >= (1 - WEAK) * bound)))

        def respond(change: Change) -> Rates:
            # friction that slips follows its bound where it is: that is a load
            given = np.where(slips, -change.bound[:, None] * laws.direction, 0.0)
            ways = np.column_stack([change.gap, np.where(slips, change.slip, change.stretched)])
            stepped = step.under(change.residual - S.T @ given.ravel(), ways.ravel()).step(laws)
            weights = problem.weights
            pressure = np.divide(stepped.normal, weights, out=np.zeros_like(weights), where=weights > 0)
            return Rates(stepped.du, pressure, stepped.friction + given)

        return respond


class Fold:
    """Of a limit point: how its load or travel moves with a parameter, by the mode phi that is soft there.

    phi.K = f_A G_A with the forces f that hold the set; where t and the parameter change the conditions together by
    nothing along (phi, -f), the path still turns back::

        dt/ds = -(phi.R'_s - f.g'_s)/(phi.R'_t - f.g'_t)

    A path knows its limit point to five digits or so; two states beside it, along the mode, are weighed by their
    eigenvalues so that theirs is zero. How the state moves there needs second derivatives and is left out.
    """

    def __init__(
        self, problem_at: Callable[[float], ContactProblem], t: float, state: ContactSolution, epsilon: float
    ) -> None:
        """Raises SingularMatrixError, and ValueError where the tangent is not symmetric, or the mode moves no load."""
        problem = problem_at(t)
        mode = spectrum(problem, state, epsilon).modes[:, 0]
        beside = BESIDE * (float(np.linalg.norm(state.u)) or 1.0)
        ends = [replace(state, u=state.u + sign * beside * mode) for sign in (-1, 1)]
        self.modes = [SoftMode(problem_at, t, each, epsilon) for each in ends]
        one, other = (each.eigenvalue for each in self.modes)
        if one == other:
            raise ValueError("the mode of its limit point does not turn the path back")
        self._shares = other / (other - one), one / (one - other)

    def rate(self, changes: Sequence[Change]) -> float:
        """dt/ds of the changes at the states of the modes."""
        rates = (mode.rate(change) for mode, change in zip(self.modes, changes, strict=True))
        return sum(share * rate for share, rate in zip(self._shares, rates, strict=True))


class SoftMode:
    """The softest motion of a state (n,) at t, and the parameter's share in its balance with the load."""

    def __init__(
        self, problem_at: Callable[[float], ContactProblem], t: float, state: ContactSolution, epsilon: float
    ) -> None:
        """As for a Fold."""
        problem = problem_at(t)
        K = problem.stiffness(problem.linearise(state.u, None), state.u, state.pressure)
        if not symmetric(K):
            raise ValueError("the tangent of its limit point is not symmetric")
        soft = spectrum(problem, state, epsilon)
        self.state, self.eigenvalue = state, float(soft.eigenvalues[0])
        self._set, self._mode = np.flatnonzero(state.active), soft.modes[:, 0]
        rows = problem.push(state.u)[self._set]
        own = np.asarray(rows.multiply(rows).sum(axis=1)).ravel()
        self._forces = np.asarray(rows @ (K @ self._mode)).ravel() / own  # no two candidates share an unknown
        h = STEP * (abs(t) or 1.0)
        beside = [(problem_at(t + k * h), epsilon) for k in OFFSETS]
        self._along = self._work(Change.between(beside, state, h))
        if self._along == 0:
            raise ValueError("the mode of its limit point does no work with the load")

    def rate(self, change: Change) -> float:
        """-(phi.R'_s - f.g'_s)/(phi.R'_t - f.g'_t)."""
        return -self._work(change) / self._along

    def _work(self, change: Change) -> float:
        return float(self._mode @ change.residual - self._forces @ change.gap[self._set])


def _held(problem: ContactProblem, epsilon: float, state: ContactSolution) -> tuple[np.ndarray, ...]:
    """Residual with the forces of the foundation, gaps, slips, slips with their springs, and bounds, as of a Change."""
    u, law, m = state.u, problem.coulomb, len(problem.weights)
    forces = problem.contact_force(u, state.pressure, None if state.friction is None else state.friction.force)
    residual = problem.linearise(u, None).residual if problem.residual is None else problem.residual(u)
    gap = problem.gap(u) + state.pressure / epsilon
    if law is None or state.friction is None:
        nothing = np.zeros((m, 2))
        return residual - forces, gap, nothing, nothing, np.zeros(m)
    slip, normal = law.slip(u), problem.nodal_forces(state.pressure)
    give = np.divide(1 / epsilon, problem.weights, out=np.zeros(m), where=problem.weights > 0)
    bound = np.where(np.isfinite(law.mu), law.bound(normal), 0.0)
    return residual - forces, gap, slip, slip + give[:, None] * state.friction.force, bound


def _touching(problem: ContactProblem, lin: Linearised, state: ContactSolution) -> np.ndarray:
    """Candidates (k,) with neither a gap nor a pressure to speak of."""
    if not len(problem.weights):
        return np.zeros(0, np.intp)
    forces = np.abs(problem.nodal_forces(state.pressure))
    large = length(problem, Stiffness.of(problem, lin, state.u), state.u, lin.scale)
    pressed = forces > WEAK * max(lin.scale, float(np.max(forces)))
    return np.flatnonzero(~pressed & (state.active | (np.abs(problem.gap(state.u)) <= WEAK * large)))
