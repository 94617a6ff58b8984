"""Ten problems of all kinds: what the table says of an answer is what dense numpy makes of it, line by line."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy import sparse

from contact.interchange.linearised_step import FrozenStep
from studies.arena.collected.candidates import frozen
from studies.arena.solver_table import samples
from studies.arena.solvers.catalogue import SOLVERS
from studies.experiments.obstacles import classic, obstacle, torsion
from support.problems.arena_steps import indefinite, known_step, lopsided
from support.problems.by_hand import residuals_by_hand

ROUNDING = 1e-14


def ten() -> dict[str, FrozenStep]:
    """Convex, not convex, not symmetric and coupled; with and without penetration at the start."""
    step, *_ = known_step(5)
    coupled = sparse.csr_matrix(np.diag(step.weights) + 0.02)
    bodies = {
        "membrane": obstacle("OBSTCLAL", 5),
        "between obstacles": obstacle("OBSTCLBL", 10),
        "torsion": torsion(5.0, 10),
        "Murty": classic("Murty", 10),
        "Fathi": classic("Fathi", 10),
    }
    return {name: frozen(body) for name, body in bodies.items()} | {
        "definite": known_step(6)[0],
        "penetrating": replace(step, gap=step.gap - 0.5),
        "not convex": indefinite(step),
        "lopsided": lopsided(step),
        "coupled": replace(step, coupling=coupled),
    }


@pytest.mark.slow
def test_ten_problems_by_hand() -> None:
    """By an exact algorithm, by a first-order method that stops early, and by one that ends far from the answer."""
    problems, field = ten(), [SOLVERS[name] for name in ("semismooth", "OSQP", "SCS, scaled")]
    rows = [row for row in samples(list(problems.items()), field, (1e-2, 1e-4), rounds=1) if row["asked"]]
    seen = set()
    for row in rows:
        step = problems[str(row["problem"])]
        answer = SOLVERS[str(row["solver"])].solve(step, float(str(row["tolerance"])))
        if not np.isfinite(answer.du).all():
            continue
        by_hand = residuals_by_hand(step, answer.du, answer.pressure)
        assert {name: row[name] for name in by_hand} == pytest.approx(by_hand, rel=1e-6, abs=ROUNDING), row
        assert row["accuracy"] == max(float(str(row[name])) for name in by_hand)
        assert row["false"] == (row["claimed"] and max(by_hand.values()) > float(str(row["tolerance"])))
        seen |= {(row["problem"], name) for name, value in by_hand.items() if value > 1e-8}
    assert {problem for problem, _ in seen} >= {"membrane", "between obstacles", "torsion", "Fathi", "definite"}
    assert {name for _, name in seen} >= {"equilibrium", "penetration", "complementarity"}
    assert {row["problem"] for row in rows} == set(problems)
    assert len(problems) == 10
