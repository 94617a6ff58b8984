"""A state that the judge refuses is not converged: in the result, its file, Python, and on the terminal."""

from __future__ import annotations

import json
from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, ClassVar

import numpy as np
import pytest

import studies.footprint
from contact.algorithms.semismooth import Semismooth
from contact.catalogue import ALGORITHMS
from contact.problem import ContactProblem, ContactSolution, Outcome
from studies.cli import main
from studies.output.atomic import as_text
from studies.scenes.complete import complete
from studies.solving import recording
from studies.solving.refinement.error_control import solve_to_error
from studies.solving.refinement.grids import coarsest
from studies.solving.result import Result
from studies.solving.solve import solve

LOADS = {"delta_mm": "5,10,20"}


@dataclass(frozen=True)
class Liar(Semismooth):
    """Right at the first touch, and then a claim that the foundation is not there."""

    name: ClassVar[str] = "liar"

    def solve(self, problem: ContactProblem, start: ContactSolution) -> ContactSolution:
        solution = super().solve(problem, start)
        if not start.active.any():
            return solution
        return replace(solution, u=np.zeros_like(solution.u), pressure=np.zeros_like(solution.pressure))


@pytest.fixture(autouse=True)
def liar(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(ALGORITHMS, "liar", Liar)


@pytest.fixture
def lied() -> Result:
    return solve(*complete("ring", LOADS, "1x16", contact="liar"))


def test_the_path_ends_at_the_load_that_the_judge_refuses(lied: Result) -> None:
    assert (lied.outcome, lied.verdict) == (Outcome.WRONG, "wrong")
    assert not lied.outcome.converged
    assert [step["failures"] for step in lied.steps] == [[], ["penetration"]]
    assert lied.unstable == []
    assert lied.steps[-1]["stability"]["word"] == "not counted"
    record = lied.as_json()
    assert (record["outcome"], record["class"]) == ("wrong", "wrong")
    (size, bound) = record["steps"][-1]["exceeded"]["penetration"]
    assert record["reason"] == f"penetration {size:.3g} mm above {bound:.3g} mm at delta_mm 10"
    assert size == 10
    assert "exceeded" not in record["steps"][0]


def test_what_was_refused_is_written_all_the_same(lied: Result, tmp_path: Path) -> None:
    assert not lied.last.u.any()
    lied.write(tmp_path)
    assert {"fields.vtu", "result.json"} <= {path.name for path in tmp_path.iterdir()}


def test_the_terminal_ends_with_the_condition_and_the_code_is_that_of_a_failed_check(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    words = ["ring", "--mesh", "1x16", "--contact", "liar", "--set", "delta_mm=5,10,20", "--out", str(tmp_path)]
    assert main(["solve", *words]) == 1
    said = capsys.readouterr()
    head, first, second, outcome = said.out.splitlines()
    assert (head.split()[-1], second.split()[-1]) == ("judge", "wrong")
    assert "wrong" not in first
    assert outcome.startswith("wrong: ")
    assert said.err == f"footprint: judged wrong: {json.loads((tmp_path / 'result.json').read_text())['reason']}\n"


def test_a_notebook_reads_the_same() -> None:
    run = studies.footprint.solve("ring", mesh="1x16", contact="liar", **LOADS)
    assert (run.outcome, run.verdict) == ("wrong", "wrong")
    assert run.reason.startswith("penetration ")
    assert studies.footprint.solve("ring", mesh="1x16", **LOADS).verdict == "converged"


def test_a_refinement_ends_with_a_state_that_is_wrong() -> None:
    actual, enough = solve_to_error(*coarsest("ring", LOADS, "1x8", contact="liar"), 0.1)
    assert (actual.outcome, enough) == (Outcome.WRONG, False)
    assert not [name for name in actual.quantities if name.startswith("extrapolated")]


@pytest.mark.parametrize("path", ["arc-length", "series"])
def test_a_traced_curve_ends_at_the_point_that_the_judge_refuses(path: str, monkeypatch: pytest.MonkeyPatch) -> None:
    judge = recording.certificate

    def planted() -> Iterator[bool]:
        yield from (False, False)
        while True:
            yield True

    wrong = planted()

    def refusing(*asked: object) -> dict[str, object]:
        more = {"failures": ["equilibrium"], "exceeded": {"equilibrium": (0.5, 1e-8)}}
        return judge(*asked) | (more if next(wrong) else {})

    monkeypatch.setattr(recording, "certificate", refusing)
    solution = solve(*complete("roof-b", {"path": path}, "4x4"))
    curve = solution.table("curve").columns
    assert len(solution.steps) == 3
    assert (len(curve["load_fraction"]) == 3) == (path == "arc-length")
    assert curve["load_fraction"][-1] == solution.steps[-1]["load_fraction"]
    assert solution.outcome is Outcome.WRONG
    assert solution.reason.startswith("equilibrium 0.5 above 1e-08 at load_fraction ")
    assert not [name for name in solution.quantities if "limit" in name]  # what only the whole curve has


@dataclass(frozen=True)
class Stopped(Semismooth):
    """The user stops it at the second load."""

    name: ClassVar[str] = "stopped"

    def solve(self, problem: ContactProblem, start: ContactSolution) -> ContactSolution:
        if start.active.any():
            raise KeyboardInterrupt
        return super().solve(problem, start)


def test_an_interrupted_solve_writes_the_loads_that_were_finished(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(ALGORITHMS, "stopped", Stopped)
    words = ["ring", "--mesh", "1x16", "--contact", "stopped", "--set", "delta_mm=5,10,20", "--out", str(tmp_path)]
    assert main(["solve", *words]) == 130
    assert capsys.readouterr().err == "footprint: interrupted with 1 loads finished; they are written\n"
    record = json.loads((tmp_path / "result.json").read_text())
    assert (record["outcome"], record["class"], len(record["steps"])) == ("interrupted", "not-converged", 1)
    assert record["steps"][0] == _whole()["steps"][0]
    with pytest.raises(KeyboardInterrupt):  # a loop in a notebook ends, too
        studies.footprint.solve("ring", mesh="1x16", contact="stopped", **LOADS)


def _whole() -> dict[str, Any]:
    return dict(json.loads(as_text(solve(*complete("ring", {"delta_mm": "5"}, "1x16")).as_json())))


@dataclass(frozen=True)
class Never(Semismooth):
    """It says of no load that it converges."""

    name: ClassVar[str] = "never"

    def solve(self, problem: ContactProblem, start: ContactSolution) -> ContactSolution:
        return replace(super().solve(problem, start), outcome=Outcome.DIVERGED)


@pytest.mark.parametrize(("scene", "mesh"), [("ring", "1x8"), ("panel", "4x4"), ("cantilever", "4x1")])
def test_steps_have_their_columns_where_no_load_was_reached(
    scene: str, mesh: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(ALGORITHMS, "never", Never)
    none, some = (studies.footprint.solve(scene, mesh=mesh, contact=contact) for contact in ("never", "semismooth"))
    assert (none.outcome, len(none.steps)) == ("step-limit", 0)
    seen = list(some.result.loads[0].seen)
    assert list(none.steps.columns) == seen == list(some.steps.columns)[: len(seen)]
    assert none.steps[seen[0]].tolist() == []


class Inflation(Semismooth):
    """A claim that inflating moves nothing."""

    def solve(self, problem: ContactProblem, start: ContactSolution) -> ContactSolution:
        solution = super().solve(problem, start)
        return solution if len(problem.weights) else replace(solution, u=np.zeros_like(solution.u))


def test_what_no_step_shows_is_judged_too(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(ALGORITHMS, "semismooth", Inflation)
    solution = solve(*complete("tyre", {"delta_mm": "5"}, "8x8"))
    assert (solution.outcome, solution.verdict) == (Outcome.WRONG, "wrong")
    assert solution.reason.startswith("equilibrium ")
    assert solution.reason.endswith(" in column at 1")
    assert solution.steps == []


def test_a_path_through_an_unstable_state_says_so() -> None:
    """Two ways of Newton reach two states, both stable once the tyre is pressed: inflated, neither was."""
    asked = ("tyre", {"delta_mm": "13.6", "load": "follower", "nu_TT": "0.2889"}, "6x8")
    ways = [
        solve(*complete(*asked, measure="moderate-rotation", model="full", newton=way)) for way in ("mixed", "plain")
    ]
    one, other = (way.quantities["force_N"] for way in ways)
    assert abs(one - other) > 1
    for way in ways:
        assert way.verdict == "converged"
        assert any(note.startswith("inflation at 1: unstable: ") for note in way.as_json()["notes"])
    steady = solve(*complete("tyre", {"delta_mm": "13.6"}, "20x20"))
    assert steady.on_the_way == []
