"""The fuzzer: cases replay to the last digit, keep the laws, and what breaks one is found."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy import sparse

from contact.algorithms.semismooth import Semismooth
from contact.catalogue import ALGORITHMS
from contact.problem import Linearisation
from studies.ask.scene import has_contact
from studies.ask.settings import parameters_of
from studies.cli import main
from studies.fuzz import comparing, posed
from studies.fuzz.attempt import CONVERGED, Asked, Broken, attempt
from studies.fuzz.cases import COMMANDS, FRICTION, KINDS, asked_of, changed, first_asked, kind_of, parsed, request_of
from studies.fuzz.comparing import AGREES, Answer, compared, error_of, unstable
from studies.fuzz.examine import BROKEN, command_of, examine, run
from studies.fuzz.state_laws import Slipped, mismatches
from studies.fuzz.values import drawn
from studies.scenes import SCENES
from studies.scenes.benchmarks.quads import OnQuads

SEEDS = st.integers(0, 2**32 - 1)
MANY = range(10_000, 10_080)  # none of a campaign


@settings(derandomize=True, max_examples=20, deadline=None, database=None)
@given(SEEDS)
def test_drawn_matrices_keep_their_laws(seed: int) -> None:
    posed.check_matrices(seed)  # raises Broken


def test_the_last_digit_of_loads_that_need_no_foundation_is_no_fault() -> None:
    """A residual of 1.4 last digits of the loads, which the rounding of K u alone does not explain."""
    assert posed.check_matrices(1914).word == CONVERGED


@pytest.mark.slow
@settings(derandomize=True, max_examples=4, deadline=None, database=None)
@given(SEEDS)
def test_drawn_panels_keep_their_laws(seed: int) -> None:
    posed.check_panel(seed)


@pytest.mark.slow
def test_eighty_cases_keep_their_laws() -> None:
    broken = [report for report in map(examine, MANY) if report.verdict == BROKEN]
    assert [f"{command_of(report.seed, report.kind)}: {report.law}: {report.said}" for report in broken] == []


@settings(derandomize=True, max_examples=60, deadline=None, database=None)
@given(SEEDS, st.sampled_from(sorted(SCENES)))
def test_a_drawn_value_is_one_that_its_setting_takes(seed: int, scene: str) -> None:
    for setting in SCENES[scene].settings:
        setting.parse(drawn(setting, seed))  # raises UsageError


def test_every_kind_is_drawn_slender_grids_too_and_most_settings_are_changed_somewhere() -> None:
    """The values of a case do not depend on one another: what is drawn once stays as it is."""
    assert {kind_of(seed) for seed in range(60)} == set(KINDS)
    asked = [asked_of(seed) for seed in range(12 * len(SCENES)) if kind_of(seed) == "scene"]
    keys = {key for each in asked if each.scene == "panel" for key in each.settings}
    assert len(keys) > 0.5 * len(SCENES["panel"].settings)
    grids = [[int(n) for n in each.options["mesh"].split("x")] for each in asked]
    assert sum(max(grid) >= 16 * min(grid) for grid in grids) > 1


def test_a_case_replays_to_the_last_digit() -> None:
    one, other = (posed.made(5, np.inf) for _ in range(2))
    assert np.array_equal(one[1].u, other[1].u)
    assert asked_of(7) == asked_of(7)
    assert examine(4) == examine(4)


def test_the_made_answer_is_an_answer() -> None:
    """By its own definition, with the weights and the gaps of the problem; and it is stable."""
    for seed in range(30):
        problem, answer = posed.made(seed, np.inf)
        lin = problem.linearise(answer.u, None)
        assert lin.residual == pytest.approx(problem.contact_force(answer.u, answer.pressure), abs=1e-10 * lin.scale)
        gap = problem.gap(answer.u)
        assert np.min(gap) > -1e-12
        assert np.max(np.abs(gap * answer.pressure)) < 1e-9 * max(np.max(answer.pressure), 1.0)


def test_a_difference_is_explained_only_where_it_is() -> None:
    """The answer of another problem has no explanation, the same one agrees, a loose one is as good as it claims."""
    problem, answer = posed.made(3, np.inf)
    one = Answer(problem, answer, Semismooth())
    assert compared(one, one) == AGREES
    assert unstable(one) == 0
    force = np.linspace(1.0, 2.0, len(answer.u)) * problem.linearise(answer.u, None).scale

    def heavier(u: np.ndarray, memory: object) -> Linearisation:
        lin = problem.linearise(u, memory)
        return Linearisation(lin.residual - force, lin.tangent, lin.scale)

    other = replace(problem, linearise=heavier)
    solution = Semismooth().solve(other, answer)
    assert solution.outcome.converged
    assert compared(one, Answer(other, solution, Semismooth())) == ""
    loose = replace(one, state=replace(answer, u=answer.u * (1 + 1e-4)))
    assert "tolerance" in compared(one, loose)


def test_a_difference_is_that_of_a_tolerance_or_confirmed_from_both_sides(monkeypatch: pytest.MonkeyPatch) -> None:
    problem, answer = posed.made(3, np.inf)
    one, other = (Answer(problem, replace(answer), Semismooth()) for _ in range(2))
    sure, error = list[Answer](), 0.0
    monkeypatch.setattr(comparing, "difference", lambda *_: 1e-3)
    monkeypatch.setattr(comparing, "error_of", lambda _: error)
    monkeypatch.setattr(comparing, "confirms", lambda who, state: who in sure)
    for confirming in ([], [one], [other]):
        sure = confirming
        assert compared(one, other) == ""
    sure = [one, other]
    assert compared(one, other).startswith(comparing.BRANCHES)
    for share, word in ((0.9, comparing.BRANCHES), (1.1, comparing.TOLERANCE)):
        error = share * 1e-3 / comparing.MARGIN
        assert compared(one, other).startswith(word)


def test_friction_is_no_error_of_a_state() -> None:
    """One more step of a dragged panel moves it by rounding alone; its friction is among the forces in balance."""
    one = attempt(Asked("panel", {"mesh": "4x4"}, {"shape": "sphere", "mu": "0.5", "drag_mm": "0.5"}), 0)
    assert one.found.end is not None
    assert error_of(Answer(one.found.end.problem, one.found.end.point.solution, Semismooth())) < 1e-9


def test_a_wall_inside_out_is_an_end_of_a_path() -> None:
    """No algorithm has lied: it is an equilibrium, of a panel that a plane pushes far through its clamp."""
    one = attempt(Asked("panel", {"mesh": "4x4"}, {"delta_mm": "31.6", "h_over_R": "0.1"}), 0)
    assert one.word == "ended: inverted"
    assert one.reason.startswith("inverted: 12 of 16 elements are inside out")


def test_a_wrong_derivative_is_seen() -> None:
    problem, answer = posed.made(3, np.inf)
    rng = np.random.default_rng(0)
    assert mismatches(problem, answer.u, answer.pressure, rng) == {}
    signs = sparse.diags_array(np.append(-1.0, np.ones(len(answer.pressure) - 1)))
    wrong = replace(problem, gap_jacobian=lambda u: sparse.csr_matrix(signs @ problem.gap_jacobian(u)))
    assert "gap jacobian" in mismatches(wrong, answer.u, answer.pressure, rng)


@pytest.mark.slow
def test_a_campaign_is_resumed_and_replayed(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """The cells of the pool are its cases; a seed that it lists is replayed by one command."""
    assert run(tmp_path, range(3)).solved == 3
    again = run(tmp_path, range(4), resume=True)
    assert again.solved == 1
    assert again.broken == 0
    table = pd.read_csv(tmp_path / "tables" / "fuzz.csv")
    assert list(table["seed"]) == [0, 1, 2, 3]
    words = table["command"].iloc[2].split()
    assert main(words[1:]) == 0
    assert str(table["kind"].iloc[2]) in capsys.readouterr().out


def test_friction_is_drawn_with_ways_that_turn_back() -> None:
    """By all algorithms, on all scenes with contact that are drawn, from next to none to infinite."""
    asked = [first_asked(seed, FRICTION)[0] for seed in range(6 * len(SCENES))]
    assert all("mu" in asked_of(seed, FRICTION).settings for seed in range(10))  # it is kept where a request is refused
    touching = {name for name, scene in SCENES.items() if has_contact(scene) and not isinstance(scene, OnQuads)}
    assert {each.scene for each in asked} == touching
    assert {each.options.get("contact", "semismooth") for each in asked} == set(ALGORITHMS)
    coefficients = [float(each.settings["mu"]) for each in asked]
    assert min(coefficients) == 0
    assert min(mu for mu in coefficients if mu) < 1e-6
    assert max(coefficients) == np.inf
    for key in ("drag_mm", "turn_deg"):
        ways = [[float(stop) for stop in each.settings[key].split(",")] for each in asked if key in each.settings]
        assert sum(np.any(np.diff(np.sign(np.diff([0.0, *way])))) for way in ways) > 0.3 * len(ways)


def test_a_hard_request_is_changed_in_one_thing() -> None:
    parents = [parsed(command) for command in COMMANDS]
    for seed in range(60):
        parent = parents[seed % len(parents)]
        asked = changed(parent, seed)
        mine, theirs = ({**each.options, **each.settings, "scene": each.scene} for each in (asked, parent))
        assert asked == changed(parent, seed)
        assert len(dict(mine.items() ^ theirs.items())) <= 1
    assert any(request_of(seed, FRICTION) != asked_of(seed, FRICTION) for seed in range(20))


def test_every_hard_request_is_one_that_is_taken() -> None:
    for command in COMMANDS:
        parsed(command).request(0)


def slipped(friction: float) -> Slipped:
    """A candidate that has slipped along x under a bound of 1 N."""
    along = np.array([[1e-3, 0.0, 0.0]])
    return Slipped(along, friction * np.array([[1.0, 0.0, 0.0]]), np.array([2.0]), np.array([1.0]), 1.0)


def test_friction_opposes_its_slip_within_its_bound() -> None:
    slipped(-1.0).check()
    for friction, law in ((1.0, "opposes"), (-1.1, "bound")):
        with pytest.raises(Broken) as broken:
            slipped(friction).check()
        assert broken.value.law == law


def test_wrong_use_is_one_line(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    store = ["--store", str(tmp_path)]
    for words in (
        ["fuzz", "--seed", "-1"],
        ["run", "fuzz", "--seeds", "0:0", *store],
        ["run", "fuzz", "--seeds", "3:3", *store],
        ["run", "fuzz", "--seeds", "3", *store],
        ["run", "quick", "--kind", "friction", *store],
        ["run", "quick", "--seeds", "0:5", *store],
        ["run", "fuzz", "--resume", "--seeds", "0:1", *store],
    ):
        assert main(words) == 2
        assert capsys.readouterr().err.count("\n") == 1


def test_parameters_of_an_algorithm_are_drawn_within_their_ranges() -> None:
    for seed in range(50):
        contact, given = posed.algorithm_of(seed)
        for setting in parameters_of(contact):
            if setting.key in given:
                setting.parse(given[setting.key])
