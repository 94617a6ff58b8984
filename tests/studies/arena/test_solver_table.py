"""The table: who lies is caught, who is slow and right is not accused, who hangs or dies stops nobody else."""

from __future__ import annotations

import os
from dataclasses import replace

import numpy as np
import pandas as pd
import pytest
from scipy import sparse

from studies.arena.solver_table import COLUMNS, kind, solver_table
from studies.arena.solvers.base import Answer, Solver
from studies.arena.solvers.catalogue import SOLVERS
from studies.arena.solvers.child import Child
from support.problems.arena_steps import Dies, Greedy, Hangs, Told, indefinite, known_step, lopsided

LIMIT_S = 1.0
ERROR = 1e-5  # of a pressure: between two of the tolerances


@pytest.fixture(scope="module")
def table() -> pd.DataFrame:
    """Of a problem in three kinds, before whoever tells the truth about it, and whoever does not."""
    step, du, pressure = known_step()
    told = {"du": du, "pressure": pressure}
    field = [
        Told("right", **told),
        Told("slow", **told, spends=0.15),
        Told("liar", **told, error=1.0),
        Told("rough", **told, error=ERROR),
        Told("honest", **told, error=1.0, claims=False),
        Hangs("hangs"),
        Dies("dies"),
        Solver("absent", "no_such_module"),
        SOLVERS["Clarabel"],
        SOLVERS["semismooth"],
    ]
    problems = [("a", step), ("b", indefinite(step))]
    return solver_table(problems, field, (1e-4, 1e-6), rounds=2, limit_s=LIMIT_S)


def one(table: pd.DataFrame, solver: str, tolerance: float = 1e-4, problem: str = "a") -> pd.Series:
    rows = table[(table["solver"] == solver) & (table["tolerance"] == tolerance) & (table["problem"] == problem)]
    return rows.iloc[0]


def test_every_solver_has_a_row_for_each_problem_and_tolerance(table: pd.DataFrame) -> None:
    assert tuple(table.columns) == COLUMNS
    assert len(table) == 10 * 2 * 2
    assert not table.duplicated(["solver", "problem", "tolerance"]).any()


def test_a_liar_is_caught(table: pd.DataFrame) -> None:
    assert one(table, "liar")["claimed"]
    assert one(table, "liar")["false"]
    assert one(table, "liar")["accuracy"] > 1e-2


def test_who_is_right_is_not_accused_however_slow(table: pd.DataFrame) -> None:
    for solver in ("right", "slow"):
        for tolerance in (1e-4, 1e-6):
            row = one(table, solver, tolerance)
            assert row["claimed"]
            assert not row["false"]
    assert one(table, "slow")["seconds"] >= 0.15 > 10 * one(table, "right")["seconds"]
    assert one(table, "slow")["samples"] == 2


def test_what_is_asked_decides(table: pd.DataFrame) -> None:
    assert not one(table, "rough", 1e-4)["false"]
    assert one(table, "rough", 1e-6)["false"]


def test_who_does_not_claim_does_not_lie(table: pd.DataFrame) -> None:
    row = one(table, "honest")
    assert not row["claimed"]
    assert not row["false"]
    assert row["accuracy"] == one(table, "liar")["accuracy"]


def test_who_hangs_or_dies_stops_nobody(table: pd.DataFrame) -> None:
    for solver, reason in (("hangs", f"killed after {LIMIT_S:g} s"), ("dies", "the process died")):
        row = one(table, solver)
        assert row["asked"]
        assert not row["claimed"]
        assert row["reason"] == reason
        assert np.isnan(row["seconds"])
    assert not one(table, "semismooth")["false"]


def test_who_is_missing_is_listed(table: pd.DataFrame) -> None:
    row = one(table, "absent")
    assert not row["asked"]
    assert row["reason"] == "not installed: pip install no_such_module"


def test_no_programme_of_what_is_not_convex(table: pd.DataFrame) -> None:
    row = one(table, "Clarabel", problem="b")
    assert row["kind"] == "not convex"
    assert not row["asked"]
    assert "not convex" in row["reason"]
    assert one(table, "Clarabel")["asked"]
    assert one(table, "Clarabel")["kept"]


def test_the_liar_of_one_problem_has_the_same_answer_for_the_other(table: pd.DataFrame) -> None:
    """What is right for a is wrong for b: answers are judged by the problem that was put."""
    assert one(table, "right", problem="b")["false"]


def test_kinds() -> None:
    step, *_ = known_step()
    coupled = replace(step, coupling=sparse.csr_matrix(np.diag(step.weights)))
    kinds = [kind(each) for each in (step, indefinite(step), lopsided(step), coupled)]
    assert kinds == ["convex", "not convex", "not symmetric", "consistent coupling"]


def test_a_child_has_no_more_memory_than_it_is_given() -> None:
    step, *_ = known_step()
    child = Child(20.0, memory_MB=500.0)
    try:
        answer, _ = child.solve(Greedy("greedy"), step, 1e-4)
        assert answer.reason == "out of memory"
        assert not answer.claimed
    finally:
        child.close()


class Eats(Solver):
    """Touches so many MB, as its tolerance says."""

    def answer(self, step, tolerance):
        taken = np.ones(int(tolerance * 2**20 / 8))
        return Answer(np.zeros_like(step.r), np.zeros_like(step.gap), bool(taken[-1]))


@pytest.mark.skipif(not os.path.exists("/proc/self/clear_refs"), reason="only Linux tells the peak")  # noqa: PTH110
def test_peak_memory_is_that_of_one_solve() -> None:
    """A small solve after a large one is small again."""
    from studies.arena.solvers.child import _measured

    step, *_ = known_step()
    peaks = [_measured(Eats("eats"), step, taken)[1] for taken in (200.0, 20.0, 200.0)]
    assert peaks == pytest.approx([200.0, 20.0, 200.0], abs=8.0)


def test_other_names_of_the_environment_are_left_alone() -> None:
    before = dict(os.environ)
    child = Child(20.0)
    step, *_ = known_step()
    child.solve(SOLVERS["semismooth"], step, 1e-8)
    child.close()
    assert dict(os.environ) == before
