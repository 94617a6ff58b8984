"""Who solves which frozen problem, asked for which tolerance: each answer judged from the file alone, each solve timed.

Rounds are interleaved: in each, every problem is put to every solver with every tolerance, one after another in one
process that may be killed; times are medians over the rounds. What was killed once is not asked again.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Callable, Iterable, Sequence
from contextlib import closing
from dataclasses import asdict, dataclass, field
from statistics import median

import numpy as np
import pandas as pd

from contact.interchange.linearised_step import FrozenStep
from contact.interchange.oracle import positive_definite
from contact.solvers.sparse import factorise, symmetric
from studies.arena.accuracy import NONE, Scales, accuracy
from studies.arena.solvers.base import Answer, Solver
from studies.arena.solvers.catalogue import SOLVERS
from studies.arena.solvers.child import Child

TOLERANCES = (1e-4, 1e-6, 1e-8)
LIMIT_S = 20.0  # of a solve
ROUNDS = 3
RESIDUALS = ("equilibrium", "penetration", "tension", "complementarity")
COLUMNS = (
    *("solver", "problem", "tolerance", "kind", "unknowns", "candidates", "asked", "claimed", "accuracy", *RESIDUALS),
    *("false", "kept", "seconds", "samples", "iterations", "memory_MB", "factorisation_s", "reason"),
)
Ask = Callable[[Solver, FrozenStep, float], tuple[Answer, float]]


def solver_table(
    problems: Iterable[tuple[str, FrozenStep]],
    solvers: Iterable[Solver] = tuple(SOLVERS.values()),
    tolerances: Sequence[float] = TOLERANCES,
    *,
    rounds: int = ROUNDS,
    limit_s: float = LIMIT_S,
    progress: Callable[[str], None] = lambda text: None,
) -> pd.DataFrame:
    """One row a solver, problem and tolerance, with COLUMNS.

    asked: whether the solver is there and applies; ``reason`` says why not, or what it said.  accuracy, RESIDUALS: of
    the answer, claimed or not, see :mod:`studies.arena.accuracy`.  false: claimed, and less accurate than asked.
    kept: whether a claim keeps the tolerance by the solver's own criterion, where it has one; NaN elsewhere.
    seconds: of the processor, the median of so many ``samples``.  memory_MB: at its peak, of the first round.
    factorisation_s: of K on this problem, the unit of data profiles.  kind: see :func:`kind`.
    """
    solvers, known = list(solvers), [(name, step, Scales.of(step)) for name, step in problems]
    found: dict[tuple[str, str, float], _Samples] = {}
    units: dict[str, list[float]] = defaultdict(list)
    with closing(Child(limit_s)) as child:
        for turn in range(rounds):
            for name, step, scales in known:
                progress(f"round {turn + 1}: {name}")
                units[name].append(child.solve(FACTORISATION, step, 0.0)[0].seconds)
                for solver in _turned(solvers, turn):
                    for tolerance in tolerances:
                        place = (solver.name, name, tolerance)
                        found.setdefault(place, _Samples()).add(child.solve, solver, step, tolerance, scales)
    rows = []
    for name, step, _ in known:
        about = {"problem": name, "kind": kind(step), "unknowns": len(step.r), "candidates": len(step.gap)}
        about["factorisation_s"] = median(units[name])
        for solver in solvers:
            for tolerance in tolerances:
                own = found[solver.name, name, tolerance].row
                rows.append({"solver": solver.name, "tolerance": tolerance, **about, **own})
    return pd.DataFrame(rows, columns=list(COLUMNS))


def kind(step: FrozenStep) -> str:
    """What a problem is, from its file: ``convex``, ``not convex``, ``not symmetric`` or ``consistent coupling``."""
    if step.coupling is not None:
        return "consistent coupling"
    if not symmetric(step.K):
        return "not symmetric"
    return "convex" if positive_definite(step.K) else "not convex"


@dataclass
class _Samples:
    """What one solver makes of one problem and tolerance, over the rounds."""

    row: dict[str, object] = field(default_factory=dict)
    seconds: list[float] = field(default_factory=list)

    def add(self, ask: Ask, solver: Solver, step: FrozenStep, tolerance: float, scales: Scales) -> None:
        """Ask once more, unless it was not asked, or was killed, before."""
        if self.row and not self.seconds:
            return
        reason = solver.missing() or solver.applies(step)
        if reason is not None:
            self.row = {**judged(None, step, tolerance, scales), "asked": False, "reason": reason}
            return
        answer, peak = ask(solver, step, tolerance)
        if np.isfinite(answer.seconds):
            self.seconds.append(answer.seconds)
        if not self.row:
            kept = solver.keeps(step, answer, tolerance) if answer.claimed else None
            self.row = {**judged(answer, step, tolerance, scales), "asked": True, "reason": answer.reason}
            self.row |= {"kept": kept, "iterations": answer.iterations, "memory_MB": peak}
        self.row |= {"samples": len(self.seconds), "seconds": median(self.seconds) if self.seconds else np.nan}


def judged(answer: Answer | None, step: FrozenStep, tolerance: float, scales: Scales) -> dict[str, object]:
    """claimed, accuracy, RESIDUALS and false of an answer, or of none."""
    worth = NONE if answer is None else accuracy(step, answer.du, answer.pressure, scales)
    claimed = answer is not None and answer.claimed
    wrong = claimed and not worth.worst <= tolerance
    return {"claimed": claimed, "accuracy": worth.worst, **asdict(worth), "false": wrong}


@dataclass(frozen=True)
class _Factorisation(Solver):
    """One factorisation of K: no solver, but the unit in which data profiles count."""

    def answer(self, step: FrozenStep, tolerance: float) -> Answer:
        factorise(step.K)
        return Answer.none(step, "a factorisation")


FACTORISATION = _Factorisation("factorisation")


def _turned(solvers: list[Solver], turn: int) -> list[Solver]:
    """Another order in each round, so that no solver always follows the same one."""
    at = turn % max(len(solvers), 1)
    return solvers[at:] + solvers[:at]
