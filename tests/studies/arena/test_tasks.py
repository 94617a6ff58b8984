"""Graded tasks: the data, what a secret draws, submissions of all kinds, and what claims cost."""

from __future__ import annotations

import json
import math
from dataclasses import replace
from pathlib import Path
from unittest.mock import patch

import pytest

from contact.algorithms.semismooth import Semismooth
from contact.catalogue import ALGORITHMS
from contact.problem import ContactProblem, ContactSolution
from studies.arena.tasks.catalogue import EXACT, HIDDEN, OPTIONS, Need, tasks
from studies.arena.tasks.grading import CANNOT, MET, Claim, Grade, grade, read_submission, values_of
from studies.cli import main
from studies.commands import problems as command
from studies.scenes import SCENES
from studies.scenes.complete import complete
from studies.solving.solve import solve

REFERENCE = Path(__file__).parent / "graded.toml"
KEY, OTHER = b"a secret of the tests", b"another secret of the tests"
TASKS = tasks()
BEYOND = [name for name, task in TASKS.items() if task.beyond({})]


def graded(claims: dict[str, Claim], key: bytes | None = KEY, **more: float) -> dict[str, Grade]:
    return {each.task: each for each in grade(claims, key, **more)}


# --- the data ---------------------------------------------------------------------------------------------------------


def test_there_are_twenty_and_four_of_them_cannot_be_met() -> None:
    assert len(TASKS) == 20
    assert BEYOND == ["soft-plates", "plate-dragged-560N", "cap-that-carries", "strip-that-carries"]


@pytest.mark.parametrize("name", TASKS)
def test_a_task_is_whole(name: str) -> None:
    """It asks for what its scene admits, draws what its run has or its scene knows, and nothing that may be chosen."""
    task = TASKS[name]
    scene, request = task.cell({}, {}).resolved()
    assert scene is SCENES[task.scene]
    assert {*task.choose} <= {*OPTIONS, *request.settings, *(setting.key for setting in scene.settings)} | {"drag_mm"}
    assert {*task.hidden} <= {*request.settings}
    assert not {*task.hidden} & {*task.choose}
    assert all(len(among) in (0, 2) and [*among] == sorted(among) for among in task.choose.values())
    assert {need.of for need in task.needs} | {need.bound for need in task.needs} <= {"", *EXACT}
    assert all(math.isfinite(EXACT[need.of](request, need.name)) for need in task.needs if need.of)
    assert name in "\n".join(task.lines)


def test_every_reference_is_used() -> None:
    assert {each for task in TASKS.values() for need in task.needs for each in (need.of, need.bound)} == {"", *EXACT}


@pytest.mark.parametrize("key", [KEY, OTHER])
def test_what_is_drawn_is_asked_and_leaves_what_cannot_be_met(key: bytes) -> None:
    for name, task in TASKS.items():
        drawn = task.drawn(key)
        assert len(drawn) == HIDDEN
        for each in drawn:
            assert each.keys() == task.hidden.keys()
            task.cell({}, each).resolved()
            assert bool(task.beyond(each)) == (name in BEYOND)


def test_a_secret_draws_the_same_again_and_another_one_does_not() -> None:
    """Of words there are few; numbers differ, and so do both configurations of a task."""
    for task in TASKS.values():
        assert task.drawn(KEY) == task.drawn(KEY)
        if any(not isinstance(among[0], str) for among in task.hidden.values()):
            first, second = task.drawn(KEY)
            assert len({str(each) for each in (first, second, *task.drawn(OTHER))}) == 4


def test_what_is_needed_is_held_against_the_value_the_reference_and_the_bound() -> None:
    _, request = TASKS["plate-dragged-400N"].cell({}, {}).resolved()  # Coulomb's 0.3 x 1600 N
    assert Need("x", least=1, most=2).missed({"x": 2.0}, request) == ""
    assert Need("x", least=1, most=2).missed({"x": 2.1}, request) == "x is 2.1"
    assert Need("x", most=2).missed({}, request) == "x is not known"
    close = Need("friction_N", of="Coulomb's law", within=0.01)
    assert close.missed({"friction_N": 484.0}, request) == ""
    assert close.missed({"friction_N": 486.0}, request) == "friction_N is 486, +1.2 % off"
    for within, least, met in ((0.0, 479, True), (0.0, 481, False), (0.01, 484, True), (0.01, 486, False)):
        asked = Need("friction_N", least=least, of="Coulomb's law", within=within)
        assert (asked.beyond(request) == "") == met
    assert Need("friction_N", most=470, bound="Coulomb's law").beyond(request).startswith("friction_N is at least 480")


def test_residuals_are_the_worst_of_all_loads_and_none_is_infinite() -> None:
    steps = [{"kkt": {"equilibrium": 1e-3, "penetration": None}}, {"kkt": {"equilibrium": 1e-9}, "w": 2.0, "error": 0}]
    counters = {"dofs": 3, "operations": 40, "error": 0}  # of the last, which an algorithm has counted, nothing is read
    values = values_of({"steps": steps, "quantities": {"limit": None}, "counters": counters})
    assert values == {"w": 2.0, "dofs": 3.0, "operations": 40.0, "equilibrium": 1e-3, "penetration": math.inf}


# --- submissions ------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("[no-task]", "'no-task' is none of the 20 tasks"),
        ("trapezoids = 3", "'3' must be a table"),
        ("[trapezoids]\nmesh = '24x4'", "claim is missing: it must be met or cannot"),
        ("[trapezoids]\nclaim = 'maybe'", "claim = 'maybe' must be met or cannot"),
        ("[trapezoids]\nclaim = ['met']", "must be met or cannot"),
        ("[trapezoids]\nclaim = 'cannot'\nmesh = '6x1'", "stands alone, without mesh"),
        ("[trapezoids]\nshape = 'rectangle'", "'shape' may not be chosen; mesh, thickness_strain"),
        ("[trapezoids]\nmesh = '0x0'", "mesh"),
        ("[trapezoids]\nmesh = [6, 1]", "must be N1xN2"),
        ("[trapezoids]\nmesh = '9999999x9999999'", "mesh"),
        ("[trapezoids]\nsurfaces = 4", "surfaces = '4' must be one of"),
        ("[trapezoids]\nsurfaces = true", "must be a text, a number or a list of numbers"),
        ("[trapezoids]\nsurfaces = {a = 1}", "must be a text, a number or a list of numbers"),
        ("[trapezoids]\nsurfaces = 1979-05-27", "must be a text, a number or a list of numbers"),
        ("[trapezoids]\nsurfaces = []", "must be a text, a number or a list of numbers"),
        (f"[trapezoids]\nmesh = '{'9' * 200_000}'", "has more than 80 characters"),
        (f"[trapezoids]\nsurfaces = 0x{'f' * 50_000}", "has more than 80 characters"),
        (f"[{'x' * 1000}]", "is none of the 20 tasks"),
        ("[soft-plates]\nepsilon = 2e4", "epsilon = '20000' must be in [1, 10000]"),
        ("[soft-plates]\nepsilon = nan", "epsilon = 'nan' must be in"),
        ("[soft-plates]\nepsilon = inf", "epsilon = 'inf' must be in"),
        ("[soft-plates]\nepsilon = 'much'", "epsilon = 'much' must be in"),
        ("[rolled-in-one-step]\nsteps = 51", "steps = '51' must be in [1, 50]"),
        ("[rolled-in-one-step]\nsteps = 1.5", "steps = '1.5' must be a whole number"),
        ("[rolled-by-donnell]\nmeasure = 'mine'", "measure 'mine' must be one of"),
        ("[trapezoids", "is not a submission"),
        ("[trapezoids]\n[trapezoids]", "is not a submission"),
        ("\xff", "is not a submission"),
        ("a" * 300_000, "is not a submission"),
        ("x = " + "[" * 100 + "]" * 100, "is not a submission"),
    ],
)
def test_what_is_no_submission_is_one_line(
    text: str, said: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "s.toml"
    path.write_text(text, encoding="latin-1")
    assert main(["tasks", str(path)]) == 2
    printed = capsys.readouterr()
    assert printed.out == ""
    assert said in printed.err
    assert printed.err.count("\n") == 1
    assert len(printed.err) < 600


@pytest.mark.parametrize(
    "words",
    [
        ["--held-out"],
        ["--out", "grades.json"],
        ["--limit", "5"],
        [str(REFERENCE), "--held-out", ""],
        [str(REFERENCE), "--held-out", "."],
        [str(REFERENCE), "--out", "/dev/null"],
        [str(REFERENCE), "--out", str(REFERENCE)],
        [str(REFERENCE), "--held-out", "nothing.txt"],
        [str(REFERENCE), "--limit", "0"],
        [str(REFERENCE), "--out", "."],
        ["nothing.toml"],
    ],
)
def test_wrong_words_are_one_line(words: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["tasks", *words]) == 2
    assert capsys.readouterr().err.count("\n") == 1


def test_an_empty_submission_claims_nothing(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "s.toml"
    path.write_text("")
    assert main(["tasks", str(path), "--out", str(tmp_path / "g.json")]) == 0
    assert "score 0 of 20: 0 true, 0 false, 20 without a claim" in capsys.readouterr().out
    assert json.loads((tmp_path / "g.json").read_text())["score"] == 0


def test_the_tasks_are_listed(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["tasks"]) == 0
    assert capsys.readouterr().out.count("\n") == 5 * len(TASKS)


def test_what_an_algorithm_counts_is_not_added_to_what_the_solve_counts() -> None:
    """An algorithm that claims other unknowns and operations than it had, and a quantity of the scene."""

    class Liar(Semismooth):
        def solve(self, problem: ContactProblem, start: ContactSolution) -> ContactSolution:
            solution = super().solve(problem, start)
            lies = {"dofs": 10**9, "operations": 1e15, "P_R2_over_EI": 1, "kkt": 1, "peak_over_hertz": 1}
            return replace(solution, counters={**solution.counters, **lies})

    values = []
    for kind in (Semismooth, Liar):
        with patch.dict(ALGORITHMS, {"semismooth": kind}):
            scene, request = complete("ring", {"delta_mm": "5"}, "1x8")
            values.append(values_of(solve(scene, request).as_json()))
    assert "P_R2_over_EI" in values[0]
    assert values[1] == values[0]


# --- grades -----------------------------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def of_a_few() -> dict[str, Grade]:
    return graded(
        {
            "rolled-by-donnell": Claim(MET, {"measure": "exact"}),
            "trapezoids": Claim(MET),
            "thick-cross-ply": Claim(MET, {"shear_correction": "0.7"}),
            "turned-piece": Claim(CANNOT),
            "cap-that-carries": Claim(MET),
            "strip-that-carries": Claim(CANNOT),
            "scattering-rim": Claim("", {"lines": "rim"}),
        }
    )


@pytest.mark.parametrize(
    ("task", "score", "held", "hidden", "said"),
    [
        ("rolled-by-donnell", 1, True, 2, ""),
        ("trapezoids", -1, False, None, "tip_deflection_mm is 0.004775, -96 % off"),
        ("thick-cross-ply", -1, True, 0, "not met on 2 of 2 hidden configurations"),  # tuned on the open one
        ("turned-piece", -1, False, 0, "nothing forbids it"),
        ("cap-that-carries", -1, False, None, "limit_load_fraction is at most 0.575, by the shallow-shell equations"),
        ("strip-that-carries", 1, True, 2, ""),
        ("scattering-rim", 0, None, None, ""),
        ("locking-hemisphere", 0, None, None, ""),
    ],
)
def test_a_claim_is_held_to_all_configurations(
    of_a_few: dict[str, Grade], task: str, score: int, held: bool | None, hidden: int | None, said: str
) -> None:
    actual = of_a_few[task]
    assert (actual.score, actual.open, actual.hidden, actual.said) == (score, held, hidden, said)


def test_the_run_of_a_coarse_grid_is_not_believed() -> None:
    """It says more than what is asked for; the equations of the cap forbid that."""
    task = TASKS["cap-that-carries"]
    _, request = task.cell({}, {}).resolved()
    actual = solve(*task.cell({}, {}).resolved()).quantities["limit_load_fraction"]
    assert actual > task.needs[0].least
    assert task.needs[0].missed({"limit_load_fraction": actual}, request) != ""
    assert task.needs[0].beyond(request) != ""


def test_a_task_that_takes_too_long_is_not_met() -> None:
    actual = graded({"trapezoids": Claim(MET, {"mesh": "24x4"})}, None, limit_s=1e-3)["trapezoids"]
    assert (actual.score, actual.open) == (-1, False)
    assert actual.said.startswith("time: killed after")


def test_what_is_interrupted_writes_nothing(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def stopped(*_: object, **__: object) -> list[Grade]:
        raise KeyboardInterrupt

    monkeypatch.setattr(command, "grade", stopped)
    assert main(["tasks", str(REFERENCE), "--out", str(tmp_path / "g.json")]) == 130
    assert not (tmp_path / "g.json").exists()


@pytest.mark.slow
def test_the_reference_meets_all_that_can_be_met(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    secret, out = tmp_path / "secret.txt", tmp_path / "grades.json"
    secret.write_bytes(OTHER)
    assert main(["tasks", str(REFERENCE), "--held-out", str(secret), "--out", str(out)]) == 0
    assert "score 20 of 20" in capsys.readouterr().out
    record = json.loads(out.read_text())
    assert record["score"] == record["of"] == 20
    assert all(each["open"] and each["hidden"] == HIDDEN for each in record["tasks"])
    assert OTHER.decode() not in out.read_text()


@pytest.mark.slow
def test_no_run_meets_its_task_as_it_stands() -> None:
    actual = graded(dict.fromkeys(TASKS, Claim(MET)), None)
    assert {name: each.said for name, each in actual.items() if each.score != -1} == {}


def test_the_reference_says_what_cannot_be_met() -> None:
    claims = read_submission(REFERENCE)
    assert [name for name, claim in claims.items() if claim.said == CANNOT] == BEYOND
    assert claims.keys() == TASKS.keys()
