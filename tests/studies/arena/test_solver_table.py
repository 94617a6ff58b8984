"""The table: who lies is caught, who is slow and right is not accused, who hangs or dies stops nobody else."""

from __future__ import annotations

import csv
import os
from contextlib import closing
from dataclasses import replace
from functools import partial
from itertools import product
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest
from scipy import sparse

from contact.interchange.linearised_step import FrozenStep
from studies.arena.solver_table import COLUMNS, SAMPLE_COLUMNS, kind, read, recorded, samples, solver_table
from studies.arena.solvers.base import Answer, Solver
from studies.arena.solvers.catalogue import SOLVERS
from studies.arena.solvers.process import PATIENCE, Child
from support.problems.contact_problems import Dies, Greedy, Hangs, Told, indefinite, known_step, lopsided

pytestmark = pytest.mark.slow  # processes

LIMIT_S = 0.3
ERROR = 1e-5  # of a pressure: between two of the tolerances


@pytest.fixture(scope="module")
def table() -> pd.DataFrame:
    """Of a problem in three kinds, before whoever tells the truth about it, and whoever does not."""
    step, du, pressure = known_step()
    answer: dict[str, Any] = {"du": du, "pressure": pressure}
    field = [
        Told("right", **answer),
        Told("slow", **answer, spends=0.15),
        Told("liar", **answer, error=1.0),
        Told("rough", **answer, error=ERROR),
        Told("honest", **answer, error=1.0, claims=False),
        Told("absent", "no_such_module"),
        SOLVERS["Clarabel"],
        SOLVERS["semismooth"],
    ]
    problems = [("a", step), ("b", indefinite(step))]
    return solver_table(pd.DataFrame(samples(problems, field, (1e-4, 1e-6), rounds=2)))


def one(table: pd.DataFrame, solver: str, tolerance: float = 1e-4, problem: str = "a") -> pd.Series:
    rows = table[(table["solver"] == solver) & (table["tolerance"] == tolerance) & (table["problem"] == problem)]
    return rows.iloc[0]


def test_every_solver_has_a_row_for_each_problem_and_tolerance(table: pd.DataFrame) -> None:
    assert tuple(table.columns) == COLUMNS
    assert len(table) == 8 * 2 * 2
    assert not table.duplicated(["solver", "problem", "tolerance"]).any()


def test_who_lies_is_caught_and_who_is_right_or_claims_nothing_is_not(table: pd.DataFrame) -> None:
    liar, honest = one(table, "liar"), one(table, "honest")
    assert liar["claimed"]
    assert liar["false"]
    assert liar["accuracy"] == honest["accuracy"] > 1e-2
    assert not honest["claimed"]
    assert not honest["false"]
    for solver, tolerance in product(("right", "slow"), (1e-4, 1e-6)):
        row = one(table, solver, tolerance)
        assert row["claimed"]
        assert not row["false"]
    assert one(table, "slow")["seconds"] >= 0.15 > 10 * one(table, "right")["seconds"]
    assert one(table, "slow")["samples"] == 2
    assert not one(table, "rough", 1e-4)["false"]  # what is asked decides
    assert one(table, "rough", 1e-6)["false"]
    assert one(table, "right", problem="b")["false"]  # answers are judged by the problem that was put


def test_who_hangs_or_dies_stops_nobody() -> None:
    """A sleeper by how long it sleeps, who spins by the processor, who dies by its own hand; each is asked once."""
    step, du, pressure = known_step()
    answer: dict[str, Any] = {"du": du, "pressure": pressure}
    field = [Hangs("hangs"), Told("spins", **answer, spends=600), Dies("dies"), Told("right", **answer)]
    rows = list(samples([("a", step)], field, (1e-4,), rounds=2, limit_s=LIMIT_S))
    assert [row["solver"] for row in rows] == ["hangs", "spins", "dies", "right", "right"]
    assert [row["reason"] for row in rows[:4]] == [
        f"killed after {PATIENCE * LIMIT_S:g} s asleep",
        f"killed after {LIMIT_S:g} s",
        "the process died",
        "as told",
    ]
    assert [row["claimed"] for row in rows] == [False, False, False, True, True]
    assert all(row["asked"] for row in rows)
    assert all(np.isnan(float(str(row["seconds"]))) for row in rows[:3])


@pytest.mark.skipif(not Path("/proc/self/stat").exists(), reason="only Linux tells who sleeps")
def test_who_works_is_not_killed_by_the_clock(monkeypatch: pytest.MonkeyPatch) -> None:
    """As on a machine that leaves a solve one part in a hundred of a processor."""
    step, du, pressure = known_step()
    monkeypatch.setattr("studies.arena.solvers.process.PATIENCE", 0.2)
    with closing(Child(2.0)) as child:
        assert child.solve(Told("works", du=du, pressure=pressure, spends=1.0), step, 1e-4)[0].claimed
        assert child.solve(Hangs("hangs"), step, 1e-4)[0].reason == "killed after 0.4 s asleep"


def test_who_was_killed_is_not_asked_for_more() -> None:
    """Tolerances are asked for from loose to strict, whatever their order; progress counts what is left out, too."""
    step, du, pressure = known_step()
    spins, reports = Told("spins", du=du, pressure=pressure, spends=600), list[tuple[int, int, str]]()
    rows = list(
        samples(
            [("a", step)], [spins], (1e-8, 1e-4), rounds=2, limit_s=LIMIT_S, tell=lambda *report: reports.append(report)
        )
    )
    assert [(row["tolerance"], row["asked"], row["reason"]) for row in rows] == [
        (1e-4, True, f"killed after {LIMIT_S:g} s"),
        (1e-8, True, f"killed after {LIMIT_S:g} s"),
    ]
    assert reports == [(done, 4, "a: spins") for done in range(4)]


def test_who_is_missing_or_does_not_apply_is_listed(table: pd.DataFrame) -> None:
    absent, refused, asked = one(table, "absent"), one(table, "Clarabel", problem="b"), one(table, "Clarabel")
    assert not absent["asked"]
    assert absent["reason"] == "not installed: pip install no_such_module"
    assert refused["kind"] == "not convex"
    assert not refused["asked"]
    assert "not convex" in refused["reason"]
    assert asked["asked"]
    assert asked["kept"]


def test_a_run_that_was_interrupted_goes_on(tmp_path: Path) -> None:
    """Nothing is asked twice, nothing is left out, and what is read is what was written."""
    step, du, pressure = known_step()
    field = [Told("right", du=du, pressure=pressure), Told("liar", du=du, pressure=2 * pressure), Told("absent", "no")]
    problems = [("a", step), ("b", step)]
    path, run = tmp_path / "samples.csv", partial(recorded, tolerances=(1e-4,), rounds=2)
    path.write_text(",".join(SAMPLE_COLUMNS) + "\n")  # interrupted before the first answer
    first = run(problems[:1], path, field)
    assert len(first) == 5  # two solvers in two rounds, and one that is refused in the first
    path.write_text(path.read_text() + "0,liar,b,1e-4,conv")  # interrupted in the middle of a row
    whole = run(problems, path, field)
    assert len(whole) == 10
    pd.testing.assert_frame_equal(whole.iloc[:5], first)
    assert not whole.duplicated(["round", "solver", "problem", "tolerance"]).any()
    assert tuple(whole.columns) == SAMPLE_COLUMNS
    pd.testing.assert_frame_equal(run(problems, path, field), whole)
    table = solver_table(whole).set_index(["solver", "problem"])
    assert table["false"].to_dict() == {
        (name, at): name == "liar" for at in "ab" for name in ("right", "liar", "absent")
    }
    assert table["samples"].to_dict() == {
        (name, at): 0 if name == "absent" else 2 for at in "ab" for name in ("right", "liar", "absent")
    }
    assert read(tmp_path / "nothing.csv").empty


def test_the_own_criterion_survives_a_file(tmp_path: Path) -> None:
    row = dict.fromkeys(SAMPLE_COLUMNS, 1)
    with (tmp_path / "samples.csv").open("w", newline="") as file:
        writer = csv.DictWriter(file, SAMPLE_COLUMNS)
        writer.writeheader()
        writer.writerows({**row, "kept": kept, "reason": ""} for kept in (True, False, None))
    table = read(tmp_path / "samples.csv")
    assert table["kept"].tolist()[:2] == [True, False]
    assert pd.isna(table["kept"].iloc[2])
    assert (table["reason"] == "").all()


def test_one_lie_in_many_rounds_is_a_lie() -> None:
    step, du, pressure = known_step()
    solvers = [Told("wavering", du=du, pressure=pressure * t) for t in (1, 2, 1)]
    row = solver_table(pd.DataFrame(samples([("a", step)], solvers, (1e-4,), rounds=1))).iloc[0]
    assert row["samples"] == 3
    assert row["false"]
    assert row["accuracy"] > 1e-2


def test_kinds() -> None:
    step, *_ = known_step()
    coupled = replace(step, coupling=sparse.csr_matrix(np.diag(step.weights)))
    kinds = [kind(each) for each in (step, indefinite(step), lopsided(step), coupled)]
    assert kinds == ["convex", "not convex", "not symmetric", "consistent coupling"]


def test_a_child_has_no_more_memory_than_it_is_given_and_leaves_the_environment_alone() -> None:
    step, *_ = known_step()
    before = dict(os.environ)
    with closing(Child(20.0, memory_MB=500.0)) as child:
        answer, _ = child.solve(Greedy("greedy"), step, 1e-4)
    assert answer.reason == "out of memory"
    assert not answer.claimed
    assert dict(os.environ) == before


class Eats(Solver):
    """Touches so many MB, as its tolerance says."""

    def answer(self, step: FrozenStep, tolerance: float) -> Answer:
        taken = np.ones(int(tolerance * 2**20 / 8))
        return Answer(np.zeros_like(step.r), np.zeros_like(step.gap), bool(taken[-1]))


@pytest.mark.skipif(not os.path.exists("/proc/self/clear_refs"), reason="only Linux tells the peak")  # noqa: PTH110
def test_peak_memory_is_that_of_one_solve() -> None:
    """A small solve after a large one is small again."""
    from studies.arena.solvers.process import measured

    step, *_ = known_step()
    peaks = [measured(Eats("eats"), step, taken)[1] for taken in (200.0, 20.0, 200.0)]
    assert peaks == pytest.approx([200.0, 20.0, 200.0], abs=8.0)


def test_a_millisecond_is_told_from_four() -> None:
    """The clock of the process is not that of the scheduler's ticks, which a timer of the kernel would make of it."""
    step, du, pressure = known_step()
    quick = Told("quick", du=du, pressure=pressure, spends=1e-3)
    with closing(Child(20.0)) as child:
        spent = [child.solve(quick, step, 1e-4)[0].seconds for _ in range(5)]
    assert 1e-3 <= min(spent) < 3e-3
