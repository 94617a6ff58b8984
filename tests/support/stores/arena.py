"""Made-up tables of the arena: a quick solver that is right, one that claims too much, one that is slow or refuses."""

from __future__ import annotations

from itertools import product

import numpy as np
import pandas as pd

from studies.arena.solver_run import PROBLEM_COLUMNS
from studies.arena.solver_summaries import data_profiles, effects, performance_profiles, summary
from studies.arena.solver_table import COLUMNS, TOLERANCES

LIMIT_S = 2.0
PROBLEMS = {"a": ("convex", 88), "b": ("convex", 2_000), "c": ("convex", 20_000), "d": ("not symmetric", 300)}
RIGHT, BOLD, SLOW = "semismooth", "OSQP", "quadprog"


def made_up_arena() -> dict[str, pd.DataFrame]:
    """All tables of the page by name."""
    table = _table((RIGHT, BOLD, SLOW))
    variants = _table(("OSQP: defaults", "OSQP: polished"))
    profiles = pd.concat([performance_profiles(table), data_profiles(table)], ignore_index=True)
    rows = [(name, "0123", kind, n, n // 4, 9 * n) for name, (kind, n) in PROBLEMS.items()]
    about = {"limit_s": repr(LIMIT_S), "cpu": "made up", "cores": "2", "osqp": "1.1"}
    return {
        "solver_problems": pd.DataFrame(rows, columns=list(PROBLEM_COLUMNS)),
        "solver_summary": summary(table, LIMIT_S),
        "solver_profiles": profiles,
        "solver_run": pd.DataFrame(about.items(), columns=["name", "value"]),
        "osqp_effects": effects(summary(variants, LIMIT_S)),
        "problems": _collection(),
        "problems_left_out": pd.DataFrame(
            [
                ("tyre-1", "tyre", "9.3 MB are too many"),
                ("tyre-2", "tyre", "8.1 MB are too many"),
                ("ring-1", "ring", "semismooth: the linear system is singular to working precision"),
            ],
            columns=["name", "family", "why"],
        ),
    }


def _collection() -> pd.DataFrame:
    """Four problems of two families; one is certified by a third way, one touches."""
    shared = {"bytes": 250_000, "coupling": "lumped", "touching": 0, "confirmed_by": "equations on the set"}
    rows = [
        {"name": "a", "family": "ring", "unknowns": 88, "candidates": 9, "kind": "definite"},
        {"name": "b", "family": "ring", "unknowns": 2_000, "candidates": 90, "kind": "indefinite", "touching": 3},
        {"name": "c", "family": "tyre", "unknowns": 20_000, "candidates": 900, "kind": "definite"},
        {"name": "d", "family": "tyre", "unknowns": 300, "candidates": 30, "kind": "not symmetric"},
    ]
    rows[0]["confirmed_by"] = "equations on the set and convex programme by an interior point"
    rows[3]["coupling"] = "consistent"
    return pd.DataFrame([shared | row for row in rows])


def _table(solvers: tuple[str, ...]) -> pd.DataFrame:
    """RIGHT solves all; all others refuse d. SLOW is killed over c; whoever is neither claims too much for 1e-8."""
    rows = []
    for solver, (name, (kind, n)), tolerance in product(solvers, PROBLEMS.items(), TOLERANCES):
        refused = solver != RIGHT and kind != "convex"
        killed = solver == SLOW and n > 10_000
        wrong = solver not in (RIGHT, SLOW) and not refused and tolerance < 1e-7
        claimed = not refused and not killed
        row = {"solver": solver, "problem": name, "tolerance": tolerance, "kind": kind, "unknowns": n, "candidates": 9}
        row |= {"asked": not refused, "claimed": claimed, "false": wrong, "kept": None if solver == RIGHT else claimed}
        row |= {"accuracy": np.inf if not claimed else 1e-3 if wrong else 1e-12, "memory_MB": 1.0, "samples": 1}
        row |= {"seconds": n / (2e5 if solver == RIGHT else 1e5) if claimed else np.nan, "factorisation_s": n / 1e6}
        row |= {"reason": "not symmetric" if refused else "killed after 2 s" if killed else "", "iterations": 3.0}
        rows.append(row | dict.fromkeys(("equilibrium", "penetration", "tension", "complementarity"), 0.0))
    return pd.DataFrame(rows)[list(COLUMNS)]
