"""The laws that every solver of frozen problems keeps; it is asked in a process of its own, as in the tries."""

from __future__ import annotations

import math
from collections.abc import Iterator
from contextlib import closing

import numpy as np
from scipy import sparse

from contact.interchange.linearised_step import FrozenStep
from studies.arena.accuracy import Scales
from studies.arena.card.laws import KINDS, STATES, Law
from studies.arena.card.quadratics import Quadratic, manufactured
from studies.arena.solver_table import judged
from studies.arena.solvers.base import Solver
from studies.arena.solvers.catalogue import SOLVERS
from studies.arena.solvers.process import Child

LIMIT_S, TOLERANCE = 5.0, 1e-6
LAWS = (
    "an answer has the shape of its problem",
    "a claim of a built-in answer is true",
    "what has no answer is not said to be solved",
)


def solver_laws(name: str) -> Iterator[Law]:
    """How many answers break each; where it is not installed, or applies to none, it has refused."""
    solver = SOLVERS[name]
    missing = solver.missing()
    if missing:
        yield from (Law(law, math.nan, refused=missing) for law in LAWS)
        return
    with closing(Child(LIMIT_S)) as child:
        yield from _built_in(child, solver)
        yield _hopeless(child, solver)


def _built_in(child: Child, solver: Solver) -> Iterator[Law]:
    shapes, false, asked, reason = [], [], 0, ""
    for said, states in STATES.items():
        for kind in KINDS:
            step = frozen(manufactured(np.random.default_rng(7), kind, np.array(states))[0])
            refused = solver.applies(step)
            if refused is not None:
                reason = refused
                continue
            asked += 1
            answer, _ = child.solve(solver, step, TOLERANCE)
            if answer.du.shape != step.r.shape or answer.pressure.shape != step.gap.shape:
                shapes.append(f"{kind}, {said}")
            elif judged(answer, step, TOLERANCE, Scales.of(step))["false"]:
                false.append(f"{kind}, {said}")
    refusal = "" if asked else reason
    for law, wrong in zip(LAWS, (shapes, false), strict=False):
        yield Law(law, len(wrong), refused=refusal, said=", ".join(wrong))


def _hopeless(child: Child, solver: Solver) -> Law:
    """No numbers, and -x - 1 = p with no p >= 0 where x >= 0."""
    eye = np.eye(2)
    cases = {
        "no number": Quadratic(eye, np.array([np.nan, 0.5]), -eye, np.array([10.0, 10.0]), np.ones(2)),
        "no solution": Quadratic(np.diag([-1.0, 1.0]), np.array([1.0, 0.0]), eye, np.zeros(2), np.ones(2)),
    }
    claimed, reasons = [], []
    for said, data in cases.items():
        step = frozen(data)
        refused = solver.applies(step)
        if refused is not None:
            reasons.append(refused)
        elif child.solve(solver, step, TOLERANCE)[0].claimed:
            claimed.append(said)
    refusal = reasons[0] if len(reasons) == len(cases) else ""
    return Law(LAWS[2], len(claimed), refused=refusal, said=", ".join(claimed))


def frozen(data: Quadratic) -> FrozenStep:
    """A random problem as a step from u = 0."""
    size = float(np.linalg.norm(np.nan_to_num(data.f)))
    rows = sparse.csr_matrix(data.G)
    return FrozenStep(sparse.csc_matrix(data.K), -data.f, rows, data.g0, data.w, size)
