"""A quadratic programme at each Newton step, solved by a public solver and finished by one exact step on its set.

With friction it is that of Tresca's friction in the forces (:mod:`contact.algorithms.tresca`), with bounds from pass to
pass. Clarabel has the disc |t| <= b as a second-order cone, the others a polygon in it of so many ``sides``, on which
friction is up to 1 - cos(pi/sides) short. ``finish``: whether exact steps on the states of the answer follow, so that
no digit comes from a backend; without, a step ends with the forces of the programme, which the judge refuses.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import partial, reduce
from operator import add
from typing import ClassVar

import numpy as np
from scipy import sparse

from contact.algorithms.base import NewtonAlgorithm
from contact.algorithms.tresca import by_passes
from contact.events import Event, EventKind
from contact.newton.condensed import Condensed
from contact.newton.friction_compliance import SIDES, Block, Chosen, no_polygon
from contact.newton.friction_loop import finished, unfinished
from contact.newton.loop import Step, StepError, decide_set, iterate, settle_set
from contact.newton.step import Iterate, NewtonRun
from contact.operations import DENSE_PIVOTS, eigenvalues_alone, spend
from contact.parameters import SHARED, SYSTEM, Parameter
from contact.problem import ContactProblem, ContactSolution, Outcome
from contact.solvers.lcp_pivoting import LcpError, principal_pivot, unit
from contact.solvers.qp_backends import BACKENDS, DISCS, Answer, Programme, ask, missing
from contact.solvers.sparse import SingularMatrixError, asymmetry, negative_pivots, symmetric

NEAR, SAME = 1e-3, 1e-7  # change of bounds, of the largest, at which passes end: before exact steps, and without
SHIFTS = tuple(10.0**k for k in range(-6, 3))  # of the diagonal, tried on a tangent that is not convex


@dataclass(frozen=True)
class Qp(NewtonAlgorithm):
    """min du.K.du/2 + r.du subject to g + G du >= 0; a finite epsilon gives every gap a spring of stiffness epsilon w.

    system: ``full`` is this programme, sparse, with all displacements. ``condensed`` is its dual on the candidates
    whose expected state is wrong, joined by those whose state its solution makes wrong: min f.C.f/2 + q.f, f >= 0,
    dense and small, where C is the compliance of the forces f with all other candidates in their expected state
    (:class:`Condensed`). Where the tangent is not definite on that set, ``full`` is used: the dual would have a maximum
    or no extremum.
    backend: ``osqp``, ``clarabel``; with the extra qp also ``proxqp``, ``piqp`` and ``daqp`` (dense: small problems).
    eps, polish: tolerance of the backend, absolute and relative; whether OSQP polishes.
    The programme is scaled (unit diagonal, unit rows, displacements and energy about 1). Only the contact set of its
    solution is used: exact linear steps start from this set and correct it where it is wrong, so a false "solved" costs
    time but no accuracy. The history records when the solver did not claim success and how often the set was corrected.
    A non-convex tangent is shifted until it is convex, only to find the set; the history records this, too.
    A non-symmetric tangent has no energy and is refused. Where the travel of the foundation (arc length) or a
    multiplier is an unknown, there is no programme either: the set is found by exact steps alone, and the history
    records this.
    Source: Stellato et al., Math. Program. Comput. 12 (2020) 637-672; its false "solved": osqp#790, osqp#273.
    """

    backend: str = "osqp"
    eps: float = 1e-8
    polish: bool = True
    system: str = "condensed"
    sides: int = SIDES
    finish: bool = True
    name: ClassVar[str] = "qp"
    friction: ClassVar[bool] = True
    parameters: ClassVar[tuple[Parameter, ...]] = (
        *SHARED,
        Parameter("backend", "solver of the quadratic programmes", kind="choice", choices=tuple(BACKENDS)),
        Parameter("eps", "tolerance of the quadratic programmes", low=1e-14, high=1),
        SYSTEM,
    )

    def supports(self, problem: ContactProblem) -> str | None:
        """Needs its backend installed, and lumped coupling."""
        if problem.coulomb is not None:
            refused = no_polygon(self.sides, problem.coulomb.mu, "gives no bound of friction")
            return refused or super().supports(problem) or missing(self.backend)
        if problem.coupling is not None:
            return "consistent coupling makes the problem non-symmetric: there is no energy to minimise"
        return missing(self.backend)

    def solve(self, problem: ContactProblem, start: ContactSolution) -> ContactSolution:
        """Newton from ``start``; the outcome is REFUSED where the tangent is not symmetric."""
        if problem.coulomb is not None:
            run, by = self.rubbing(problem, start, lawful=self.finish), finished if self.finish else unfinished
            words = list[str]()
            return run.finish(*by(run, run.start(), partial(self._choose, words), words, self.max_iterations))
        step = self._condensed if self.system == "condensed" else self._full
        step = _settled if problem.driven or problem.multipliers else step
        return iterate(self.run(problem), start, step, self.max_iterations)

    def _choose(self, words: list[str], block: Block) -> Chosen:
        """Forces and states with friction; raises StepError."""
        sides, near = 0 if self.backend in DISCS else self.sides, NEAR if self.finish else SAME
        chosen, answer = by_passes(
            block, sides, near, partial(ask, self.backend, eps=self.eps, polish=self.polish), words
        )
        if not answer.claimed:
            words.append(f"{self.backend} says {answer.status!r}")
        return chosen

    def _condensed(self, run: NewtonRun, at: Iterate) -> Step:
        _must_be_symmetric(run.problem.stiffness(at.lin, at.u, at.pressure))
        try:
            linear = run.linear(at.lin, at.u, at.pressure, at.active)
        except SingularMatrixError:  # only the foundation holds the body
            return self._full(run, at)
        if not isinstance(linear, Condensed) or linear.negative_pivots():
            return self._full(run, at)
        words, shifts = dict[str, None](), [0.0]

        def decide(M: np.ndarray, q: np.ndarray, base: np.ndarray, left: np.ndarray) -> np.ndarray:
            with run.tally.timed("contact_s"):
                programme, shift = _dual(M, q, base)
                answer = ask(self.backend, programme, self.eps, self.polish)
            shifts.append(shift)
            if not answer.claimed:
                words[f"{self.backend} says {answer.status!r}"] = None
            return (answer.x > programme.P @ answer.x + programme.q) ^ base

        step, linear = decide_set(run, at, linear, decide)
        settled = settle_set(run, at, step.active, linear=linear)
        return self._finished(settled, step.active, max(shifts), list(words))

    def _full(self, run: NewtonRun, at: Iterate) -> Step:
        if len(at.gap) == 0:
            return settle_set(run, at, at.active)
        with run.tally.timed("contact_s"):
            scaled, shift = _convex(run, at)
            known = scaled.multipliers(run.problem.nodal_forces(at.pressure))
            answer = self._answer(scaled.convexified(shift), at, known)
        claimed = _pressing(scaled, answer)
        words = [] if answer.claimed else [f"{self.backend} says {answer.status!r}"]
        return self._finished(settle_set(run, at, claimed), claimed, shift, words)

    def _finished(self, step: Step, claimed: np.ndarray, shift: float, words: Sequence[str]) -> Step:
        """The step with what the history says of it; claimed (m,): the set that the backend has found."""
        messages = [f"not convex: set found with a shift of {shift:g} of the diagonal"] if shift else []
        messages += words
        wrong = int(np.sum(claimed ^ step.active))
        if wrong:
            messages.append(f"set of {self.backend} corrected at {wrong} nodes by exact steps")
        events = [Event(EventKind.SUBSTITUTE, text) for text in messages] + ([step.event] if step.event else [])
        return replace(step, event=reduce(add, events) if events else None, updates=0)

    def _answer(self, whole: Programme, at: Iterate, y: np.ndarray) -> Answer:
        """Of the candidates expected to press, and the nearest, joined by those pushed in until there are no more.

        The others do not decide, but beside a small step their gaps are so large that OSQP hardly converges: on the
        tyre of 42 x 40 elements up to 8400 iterations with all, 75 without, 50 from the multipliers known already.
        """
        x, near = np.zeros_like(whole.q), at.active | (at.gap <= np.min(at.gap))
        while True:
            part = Programme(whole.P, whole.q, sparse.csc_matrix(whole.A[near]), whole.b[near], (x, y[near]))
            answer = ask(self.backend, part, self.eps, self.polish)
            x, y = answer.x, np.zeros_like(whole.b)
            y[near] = answer.y
            pushed_in = (whole.A @ x < whole.b) & ~near
            if not (answer.claimed and pushed_in.any()):
                return Answer(x, y, answer.claimed, answer.status)
            near |= pushed_in


def _settled(run: NewtonRun, at: Iterate) -> Step:
    """The step of a body with the travel of its foundation, or a multiplier, for an unknown."""
    step = settle_set(run, at, at.active)
    substitute = Event(
        EventKind.SUBSTITUTE, "an unknown is not a displacement, no programme has it: set found by exact steps"
    )
    return replace(step, event=substitute + step.event if step.event else substitute)


def _must_be_symmetric(K: sparse.csc_matrix) -> None:
    """Raises StepError."""
    if not symmetric(K):
        off = f"the tangent differs from its transpose by {asymmetry(K):.1e} of its size"
        raise StepError(Outcome.REFUSED, f"{off}: no energy to minimise")


def _dual(M: np.ndarray, q: np.ndarray, base: np.ndarray) -> tuple[Programme, float]:
    """The programme in the forces of all, scaled to a unit diagonal and to gaps of 1, and its shift; raises StepError.

    Of x > C x + q the left is a force, the right the gap that it leaves.
    """
    size = unit(M)
    try:
        C, gap = principal_pivot(size[:, None] * M * size, size * q, base)
    except LcpError as error:
        raise StepError(Outcome.UNSOLVED, f"the programme of the candidates: {error}") from None
    again = unit(C)
    C, gap = again[:, None] * C * again, again * gap
    spend(DENSE_PIVOTS, eigenvalues_alone(len(q)))
    lowest = float(np.linalg.eigvalsh(C)[0])
    shift = next((s for s in (0.0, *SHIFTS) if lowest + s > 0), None)
    if shift is None:
        raise StepError(Outcome.UNSOLVED, "the tangent is far from convex: no programme was made of it")
    n = len(gap)
    P = sparse.csc_matrix((C + C.T) / 2 + shift * np.eye(n))
    whole = sparse.eye_array(n, format="csc")
    return Programme(P, gap / (float(np.max(np.abs(gap))) or 1.0), sparse.csc_matrix(whole), np.zeros(n)), shift


def _convex(run: NewtonRun, at: Iterate) -> tuple[Scaled, float]:
    """The programme of an iterate, and the least shift with which it is convex; raises StepError."""
    K = run.problem.stiffness(at.lin, at.u, at.pressure)
    _must_be_symmetric(K)
    scaled = Scaled.of(K, at.lin.residual, run.problem.gap_jacobian(at.u), at.gap, run.problem.weights, run.epsilon)
    shift = next((s for s in (0.0, *SHIFTS) if not negative_pivots(scaled.convexified(s).P)), None)
    if shift is None:
        raise StepError(Outcome.UNSOLVED, "the tangent is far from convex: no programme was made of it")
    return scaled, shift


def _pressing(scaled: Scaled, answer: Answer) -> np.ndarray:
    """The set (m,) of an answer: multiplier above slack, both in the units of the scaled programme."""
    programme = scaled.programme
    return np.asarray(answer.y > programme.A @ answer.x - programme.b)


@dataclass(frozen=True, eq=False)
class Scaled:
    """The programme in x = du/(size stretch), multipliers y = f row/size, f the nodal forces.

    size: a typical displacement in the norm of the diagonal of K.  stretch (n,): 1/sqrt(diag K).  row (m,): the lengths
    of the rows of G diag(stretch).  With a finite epsilon the penetrations follow the displacements in x.
    """

    programme: Programme
    size: float
    stretch: np.ndarray
    row: np.ndarray

    @classmethod
    def of(
        cls,
        K: sparse.csc_matrix,
        residual: np.ndarray,
        G: sparse.csr_matrix,
        gap: np.ndarray,
        weights: np.ndarray,
        epsilon: float,
    ) -> Scaled:
        """Scale K du + r, g + G du and the springs of a finite epsilon."""
        diagonal = np.abs(K.diagonal())
        stretch = 1 / np.sqrt(np.where(diagonal > 0, diagonal, np.max(diagonal, initial=0.0) or 1.0))
        D = sparse.diags_array(stretch)
        P, A = sparse.csc_matrix(D @ K @ D), sparse.csr_matrix(G @ D)
        if np.isfinite(epsilon):
            P = sparse.csc_matrix(sparse.block_diag([P, sparse.eye_array(len(gap))]))
            A = sparse.csr_matrix(sparse.hstack([A, sparse.diags_array(1 / np.sqrt(epsilon * weights))]))
        row = np.sqrt(np.asarray(A.multiply(A).sum(axis=1)).ravel())
        row[row == 0] = 1.0
        # what closes the deepest penetration, or what the imbalance asks for along one unknown
        size = max(float(np.max(-gap / row, initial=0.0)), float(np.max(np.abs(stretch * residual)))) or 1.0
        q = np.append(stretch * residual / size, np.zeros(P.shape[0] - len(residual)))
        programme = Programme(
            sparse.csc_matrix((P + P.T) / 2), q, sparse.csc_matrix(sparse.diags_array(1 / row) @ A), -gap / (row * size)
        )
        return cls(programme, size, stretch, row)

    def convexified(self, shift: float) -> Programme:
        """The programme with ``shift`` added to its unit diagonal."""
        p = self.programme
        if shift == 0:
            return p
        return Programme(sparse.csc_matrix(p.P + shift * sparse.eye_array(len(p.q))), p.q, p.A, p.b)

    def multipliers(self, forces: np.ndarray) -> np.ndarray:
        """The y (m,) >= 0 of nodal forces (m,)."""
        return np.asarray(np.maximum(forces, 0.0) * self.row / self.size)

    def unscaled(self, answer: Answer) -> tuple[np.ndarray, np.ndarray]:
        """du (n,) and nodal forces (m,) of an answer."""
        n = len(self.stretch)
        return self.size * self.stretch * answer.x[:n], self.size * answer.y / self.row
