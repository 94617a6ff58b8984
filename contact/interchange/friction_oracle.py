"""An oracle of steps with friction: Tresca problems by an interior-point solver, none of our algorithms.

For given bounds b (m,) of friction [N] a step is a convex programme, with the disc |t| <= b as a second-order cone::

    min 1/2 du.K.du + r.du + sum b_i |s0_i + S_i du|    subject to    g + G du >= 0

whose multipliers are the forces. K may leave motions free, which contacts then hold; where it is not symmetric, the
programme has its symmetric part, and the other acts by the motion of the pass before. The bounds are mu f of that pass,
damped where they do not contract; an infinite coefficient has a bound beyond all forces of it. An
interior-point solver knows forces to 1e-6 and no closer, so it is asked for states alone, open, stick or slip: where a
pass has those of the one before, or nearly its bounds. The exact answer on them
(:mod:`contact.interchange.friction_states`) then has to obey every condition. That it is the only one nobody
says: at large mu it need not be, and where contacts are redundant forces are not. Its linear systems are
solved by SciPy's SuperLU, without our fronts and checks.

Lengths and forces are scaled first: a unit diagonal of K, unit rows, displacements of about one.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy import sparse

from contact.coulomb import State
from contact.interchange.friction_states import Known, on_states, settle
from contact.interchange.linearised_step import FrozenFrictionalStep
from contact.interchange.oracle import (
    AGREEMENT,
    TOLERANCES,
    Confirmation,
    OracleError,
    positive_definite,
    solve_tightly,
    solved,
)

PASSES = 100
NEAR = 1e-3  # change of bounds from pass to pass, of the largest, below which states are tried
ROUGH = 1e-6  # of the interior-point solver at worst: forces are not taken from it
CONTRACTS = 0.9  # a change that falls by less is damped
SINGULAR = 1e-11  # of its diagonal: what may be added to K to make it definite
TIED = 10.0  # times the largest force: the bound of an infinite coefficient
BEYOND = 1e3  # times the load: a bound that holds whatever else is free


def refusal(step: FrozenFrictionalStep) -> str | None:
    """Why there is no sequence of convex programmes, or None."""
    if step.coupling is not None:
        return "with consistent coupling the pressures are not multipliers of the gaps"
    even = _even(step.K)
    if not positive_definite(sparse.csc_matrix(even + SINGULAR * sparse.diags_array(_positive(even.diagonal())))):
        return "K is not positive: the programme is not convex"
    return None


def minimise(step: FrozenFrictionalStep) -> Known:
    """The oracle's answer; raises OracleError."""
    reason = refusal(step)
    if reason is not None:
        raise OracleError(reason)
    try:
        scaled = Scaled.of(step)
        known, passes = _fixed_point(scaled.step)
    except (RuntimeError, np.linalg.LinAlgError) as error:
        raise OracleError(f"the oracle failed: {error}") from None
    return scaled.back(known, passes)


def _fixed_point(step: FrozenFrictionalStep) -> tuple[Known, int]:
    """The answer of a scaled step, and the passes; raises OracleError."""
    solve, bound, damping, before, last = tresca(step), _first_bound(step), 1.0, np.inf, b""
    du = np.zeros(len(step.r))
    for passes in range(1, PASSES + 1):
        near = solve(bound, du)
        wanted = _bound(step.mu, near)
        change = float(np.max(np.abs(wanted - bound), initial=0.0))
        if near.state.tobytes() == last or change <= NEAR * float(np.max(wanted, initial=0.0)):
            settled = settle(step, near)
            if settled is not None:
                return settled, passes
        damping = damping / 2 if change > CONTRACTS * before else damping
        bound, before, last, du = bound + damping * (wanted - bound), change, near.state.tobytes(), near.du
    raise OracleError(f"Tresca bounds came to no fixed point in {PASSES} passes")


def _first_bound(step: FrozenFrictionalStep) -> np.ndarray:
    """(m,): none, or where K leaves motions free one that may hold them all."""
    held = positive_definite(_even(step.K))
    return np.where(step.mu > 0, 0.0 if held else BEYOND * float(np.max(np.abs(step.r), initial=0.0)), 0.0)


def _bound(mu: np.ndarray, near: Known) -> np.ndarray:
    """mu f (m,)."""
    normal = np.where(near.state == State.OPEN, 0.0, np.maximum(near.normal, 0.0))
    tied = np.isinf(mu)
    largest = max(float(np.max(normal, initial=0.0)), float(np.max(np.abs(near.friction), initial=0.0)))
    return np.where(tied, TIED * largest * (normal > 0), np.where(tied, 0.0, mu) * normal)


def on_its_states(step: FrozenFrictionalStep, known: Known) -> Known:
    """The exact answer on the states of one that is nearly right, whatever its signs; raises OracleError for none."""
    try:
        scaled = Scaled.of(step)
        solved = on_states(scaled.step, scaled.forth(known))
    except RuntimeError as error:
        raise OracleError(f"the equations on the states are singular: {error}") from None
    if solved is None:
        raise OracleError("the equations on the states have no answer near that one")
    return scaled.back(solved, 0)


def tresca(step: FrozenFrictionalStep) -> Callable[[np.ndarray, np.ndarray], Known]:
    """The programme of a scaled step as a function of the bounds (m,) and the du (n,) before; it raises OracleError."""
    import cvxpy as cp

    m = len(step.mu)
    y, tau = cp.Variable(len(step.r)), cp.Variable(m)
    b, load, even = cp.Parameter(m, nonneg=True), cp.Parameter(len(step.r)), _even(step.K)
    room = step.G @ y + step.gap
    slip = step.S @ y + step.slip.ravel()
    cost = cp.quad_form(y, cp.psd_wrap(even)) / 2 + load @ y + b @ tau
    cone = cp.SOC(tau, cp.reshape(slip, (2, m), order="F"))
    programme = cp.Problem(cp.Minimize(cost), [room >= 0, cone])

    def solve(bound: np.ndarray, before: np.ndarray) -> Known:
        b.value, load.value = bound, step.r + step.K @ before - even @ before
        solve_tightly(programme, (*TOLERANCES, ROUGH))
        f = np.atleast_1d(programme.constraints[0].dual_value)
        t = np.asarray(cone.dual_value[1]).reshape(2, m, order="F").T
        s = np.linalg.norm(slip.value.reshape(m, 2), axis=1)
        slips = (s > bound - np.linalg.norm(t, axis=1)) & ~np.isinf(step.mu)
        state = np.where(f <= room.value, State.OPEN, np.where(slips, State.SLIP, State.STICK))
        return Known(np.asarray(y.value), f, t, state)

    return solve


@dataclass(frozen=True, eq=False)
class Scaled:
    """A step in unknowns y, du = size unit y, and its forces; across, along (m,): what its gaps and slips are over."""

    step: FrozenFrictionalStep
    unit: np.ndarray
    across: np.ndarray
    along: np.ndarray
    size: float

    @classmethod
    def of(cls, step: FrozenFrictionalStep) -> Scaled:
        """In unknowns with a unit diagonal of K; raises RuntimeError."""
        m = len(step.mu)
        unit = 1 / np.sqrt(_positive(step.K.diagonal()))
        D = sparse.diags_array(unit)
        K, G, S = (sparse.csr_matrix(A) for A in (D @ step.K @ D, step.G @ D, step.S @ D))
        across = _positive(np.sqrt(np.asarray(G.multiply(G).sum(axis=1)).ravel()))
        along = _positive(np.sqrt(np.asarray(S.multiply(S).sum(axis=1)).reshape(m, 2).sum(axis=1)))
        G, S = (sparse.csr_matrix(sparse.diags_array(1 / by) @ A) for by, A in ((across, G), (np.repeat(along, 2), S)))
        every = sparse.csc_matrix(K + G.T @ G + S.T @ S)  # definite wherever contacts hold what K leaves free
        reach = [
            np.abs(solved(every, -unit * step.r)),
            np.abs(step.gap / across),
            np.linalg.norm(step.slip, axis=1) / along,
        ]
        size = max(float(np.max(part, initial=0.0)) for part in reach) or 1.0
        r, gap = unit * step.r / size, step.gap / (across * size)
        slip, mu = step.slip / (along * size)[:, None], step.mu * along / across
        scaled = FrozenFrictionalStep(sparse.csc_matrix(K), r, G, gap, np.ones(m), 1.0, S=S, slip=slip, mu=mu)
        return cls(scaled, unit, across, along, size)

    def forth(self, known: Known) -> Known:
        """In the units of the scaled step."""
        du, normal = known.du / (self.size * self.unit), known.normal * self.across / self.size
        return Known(du, normal, known.friction * (self.along / self.size)[:, None], known.state)

    def back(self, known: Known, passes: int) -> Known:
        """In the units of the step."""
        normal, friction = known.normal * self.size / self.across, known.friction * (self.size / self.along)[:, None]
        return Known(self.size * self.unit * known.du, normal, friction, known.state, passes)


def _even(K: sparse.csc_matrix) -> sparse.csc_matrix:
    """The symmetric part."""
    return sparse.csc_matrix((K + K.T) / 2)


def _positive(sizes: np.ndarray) -> np.ndarray:
    """The same with ones for what is not positive."""
    return np.where(sizes > 0, sizes, 1.0)


def confirm(step: FrozenFrictionalStep, du: np.ndarray, normal: np.ndarray, friction: np.ndarray) -> Confirmation:
    """Compare an answer of the step with the oracle's; raises OracleError where that has none.

    Displacements in units of a unit diagonal of K. Where answers are several, both may be right.
    """
    return compared(step, minimise(step), du, normal, friction)


def compared(
    step: FrozenFrictionalStep, own: Known, du: np.ndarray, normal: np.ndarray, friction: np.ndarray
) -> Confirmation:
    """The same where the oracle's answer is known."""
    scaled = Scaled.of(step)
    apart = float(np.max(np.abs(du - own.du) / scaled.unit, initial=0.0))
    size = max(scaled.size, float(np.max(np.abs(own.du) / scaled.unit, initial=0.0)))
    theirs, ours = np.column_stack([normal, friction]), np.column_stack([own.normal, own.friction])
    largest = float(max(np.max(np.abs(theirs), initial=0.0), np.max(np.abs(ours), initial=0.0))) or 1.0
    error = np.linalg.norm(theirs - ours, axis=1) / largest
    return Confirmation(
        apart / size,
        float(np.max(error, initial=0.0)),
        np.flatnonzero(error > AGREEMENT),
    )
