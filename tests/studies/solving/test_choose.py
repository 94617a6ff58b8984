"""Choosing on small scenes: what is recommended holds on finer grids, what is off is named, and budgets are kept."""

from __future__ import annotations

import json
import math
import shlex
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from pathlib import Path

import pytest

from contact.catalogue import ALGORITHMS
from studies.ask.scene import UsageError
from studies.cli import INTERRUPTED, NOT_CONVERGED, OK, WRONG_USE, main
from studies.footprint import choose as choose_in_notebook
from studies.scenes.complete import complete
from studies.solving import choose as choosing
from studies.solving import trials
from studies.solving.choice import ANSWERED, NOT_ANSWERED
from studies.solving.choose import choose, loosened
from studies.solving.solve import solve
from studies.solving.trials import SLOWER, Clock, Trial, race
from studies.solving.verdict import ENOUGH, NOT_ENOUGH, WORDS

PLUGIN = Path(__file__).parents[2] / "plugin" / "stranger.py"
RING = ["ring", "--set", "delta_mm=50"]


@pytest.fixture(scope="module")
def ring(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The answer on a ring, as files."""
    out = tmp_path_factory.mktemp("ring")
    assert main(["choose", *RING, "--error", "2%", "--out", str(out)]) == OK
    return out


def told(out: Path) -> dict:
    return json.loads((out / "choice.json").read_text())


@pytest.mark.slow
def test_what_is_recommended_is_within_the_error_of_a_closed_form(ring: Path, tmp_path: Path) -> None:
    """The elastica, whose P R²/EI is 5.74216 at R/2, higher than that of this wall by 2.4e-4."""
    actual = told(ring)
    words = shlex.split(actual["recommended"]["command"])
    assert words[:3] == ["footprint", "solve", "ring"]
    assert main([*words[1:-1], str(tmp_path)]) == OK
    value = json.loads((tmp_path / "result.json").read_text())["quantities"]["P_R2_over_EI"]
    assert value == pytest.approx(5.74216, rel=0.02)
    assert actual["reference"]["limit"] == pytest.approx(5.74216, rel=actual["reference"]["uncertainty"] + 3e-4)


@pytest.mark.slow
def test_a_classical_measure_is_off_in_the_limit_as_on_a_fine_grid(ring: Path) -> None:
    rows = {row["name"]: row for row in told(ring)["variants"]}
    for name in ("donnell", "thin-green-lagrange"):
        fine = {
            measure: solve(*complete("ring", {"delta_mm": "50"}, "1x256", measure=measure)).quantities["P_R2_over_EI"]
            for measure in (name, "exact")
        }
        off = fine[name] / fine["exact"] - 1
        assert rows[name]["formulation_error"] == pytest.approx(off, abs=rows[name]["within"])
        assert (rows[name]["verdict"], rows[name]["mesh"]) == (NOT_ENOUGH, None)


@pytest.mark.slow
def test_a_thick_laminate_needs_surfaces_inside_its_wall() -> None:
    """Pagano's 2.82: a limit of two faces, a quarter less, is no truth however fine the mesh."""
    choice = choose("pagano", {"S": "4"}, 0.01, 600.0)  # more than it takes on a busy machine
    rows = {row["name"]: row for row in choice.variants}
    assert choice.truth.limit == pytest.approx(2.82, rel=choice.truth.uncertainty)
    assert (choice.wall.name, choice.recommended.settings["surfaces"]) == ("4/ply", "4/ply")
    assert {*choice.recommended.settings} <= {"surfaces", "thickness_strain"}  # which of two as good is quicker
    assert choice.recommended.data["error_at_most"] <= 0.01
    assert rows["exact"]["verdict"] == rows["2/ply"]["verdict"] == NOT_ENOUGH
    assert rows["exact"]["formulation_error"] == pytest.approx(2.0547 / 2.82 - 1, abs=rows["exact"]["within"])
    assert (rows["donnell"]["verdict"], rows["donnell"]["surfaces"]) == (ENOUGH, "4/ply")  # rotations are small
    looser = loosened(choice, 0.05)
    assert looser.recommended.settings["surfaces"] == "2/ply"
    assert looser.recommended.data["error_at_most"] <= 0.05


@pytest.mark.slow
def test_a_recommendation_says_that_nothing_can_stand_on_it() -> None:
    """By the linear law a thin tube has lost three quarters of its wall, and pressure falls as it grows."""
    thin = {"surfaces": "3", "law": "svk", "h_over_R": "0.01", "load_fraction": "0.41"}
    choice = choose("rubber-tube", thin, 0.05, 30.0)
    assert any("not a stable equilibrium" in each for each in choice.uncertain)


@pytest.mark.slow
def test_where_two_faces_are_enough_more_are_tried_once(ring: Path) -> None:
    rows = [row for row in told(ring)["variants"] if row["axis"] == "surfaces"]
    assert [(row["name"], row["verdict"]) for row in rows] == [("3", ENOUGH)]
    assert "surfaces" not in told(ring)["recommended"]["command"]


@pytest.mark.slow
def test_the_files_of_an_answer(ring: Path) -> None:
    actual = told(ring)
    assert actual["outcome"] == ANSWERED
    keys = {"scene", "quantity", "error_asked", "budget_s", "settings", "reference", "recommended", "runner_up"}
    assert keys <= {*actual}
    assert {row["verdict"] for row in actual["variants"]} <= {*WORDS}
    assert actual["variants"][0]["name"] == "exact"
    enough = [row for row in actual["variants"] if row["verdict"] == ENOUGH]
    for row in enough:
        own = [grid for grid in actual["grids"] if (grid["axis"], grid["name"]) == (row["axis"], row["name"])]
        meshes = [grid["mesh"] for grid in own]
        rest = own[meshes.index(row["mesh"]) :]
        assert all(grid["error_at_most"] <= 0.02 for grid in rest)
        before = own[: meshes.index(row["mesh"])][-1:]
        assert all(grid["error_at_most"] > 0.02 for grid in before)
    by_name = {row["name"]: row for row in actual["algorithms"] if row["mesh"] != "1x16"}
    assert by_name["lcp"]["agrees"]
    assert {*actual["files"]} == {path.relative_to(ring).as_posix() for path in ring.rglob("*") if path.is_file()} - {
        "choice.json"
    }
    for name in ("measures", "surfaces", "elements"):
        drawn = (ring / "figures" / f"{name}.svg").read_text()
        assert drawn.startswith("<?xml")


def test_another_contact_condition_is_named_where_values_differ() -> None:
    asked, springs = Trial("converged", value=1.0, contact="qp"), Trial("converged", value=1.0001, epsilon=1e4)
    assert springs.against(replace(asked, epsilon=math.inf)) == "its epsilon is 10000, that of qp inf"
    assert replace(springs, said="stopped").against(replace(asked, epsilon=math.inf)) == "stopped"
    assert springs.against(replace(asked, epsilon=1e4)) == replace(springs, value=1.0).against(asked) == ""


def test_a_budget_that_is_spent_names_what_was_not_tried(monkeypatch: pytest.MonkeyPatch) -> None:
    """A clock of its own: every look at it is a minute, beside which a slow machine's seconds are few."""
    looks = []

    def now() -> float:
        looks.append(None)
        return 60.0 * len(looks)

    monkeypatch.setattr(choosing, "Clock", lambda budget: Clock(budget, now, lambda: 60.0 * len(looks)))
    choice = choose("ring", {"delta_mm": "50"}, 0.05, 1500.0)
    assert choice.limit is not None
    assert choice.dropped
    assert any("no time" in sentence for sentence in choice.uncertain)
    spent = choose("ring", {"delta_mm": "50"}, 0.01, 1e-3)
    assert spent.recommended is None
    assert spent.as_json()["outcome"] == NOT_ANSWERED
    assert "fewer than three grids" in spent.reason
    for known, error in ((spent, 0.05), (choice, 0.01)):
        with pytest.raises(ValueError, match="no quantity of ring is known to 1 %"):
            loosened(known, error)


@dataclass
class Race:
    """Of algorithms that take a second each but for qp, which takes three; at: the time [s]."""

    contact: str = "semismooth"
    scene: None = None
    at: float = 0.0

    def asked(self, mesh: str, options: Mapping[str, str], settings: Mapping[str, str]) -> tuple[None, str]:
        return None, options["contact"]

    def tried(self, ask: Callable[[], tuple[None, str]], quantity: str, seconds: float, progress: object) -> Trial:
        needs = 3.0 if ask()[1] == "qp" else 1.0
        spent = min(needs, seconds)
        self.at += spent
        return Trial("converged" if spent == needs else SLOWER, seconds=spent)


@pytest.mark.parametrize(("budget", "slower"), [(0.6, set()), (2.5, set()), (5.5, set()), (30.0, {"qp"})])
def test_an_algorithm_is_slower_once_it_has_had_its_time(monkeypatch, budget: float, slower: set[str]) -> None:
    """Twice that of the one asked for: a budget that ends before says nothing of it."""
    of = Race()
    monkeypatch.setattr(trials, "tried", of.tried)
    actual = race(of, "force_N", ("1x4", "1x8"), 1.0, Clock(budget, lambda: of.at, lambda: of.at), lambda text: None)
    assert {each.contact for each in actual if each.ended == SLOWER} == slower
    assert {each.contact for each in actual} == {*ALGORITHMS}
    assert of.at <= budget


@pytest.mark.slow
def test_a_point_load_has_no_limit() -> None:
    """It grows by ln 2/(2 pi S) with every halving; an interval that is narrow on each ladder of grids would lie."""
    choice = choose("pinched-cylinder", {}, 0.005, 10.0, mesh="4x4")
    assert (choice.recommended, choice.limit) == (None, None)
    assert "has no limit in a theory with shear under a point load: it grows by 0.1" in choice.reason


@pytest.mark.parametrize(
    ("words", "says"),
    [
        (["no-such-scene"], "must be one of"),
        (["ring", "--error", "0"], "must be a relative error in"),
        (["ring", "--budget", "-1s"], "seconds above 0"),
        (["ring", "--set", "delta_mm=-3"], "delta_mm"),
        (["ring", "--set", "thickness=3"], "has no setting 'thickness'"),
        (["ring", "--contact", "magic"], "must be one of"),
        (["ring", "--mesh", "big"], "N1xN2"),
        (["ring", "--mesh", "1x1"], "mesh 1x1 must have 2 or more elements along one coordinate"),
        ([*RING, "--of", "weight_N"], "has no quantity 'weight_N'; it has P_R2_over_EI"),
        ([*RING, "--of", "weight_N", "--budget", "0.01s"], "has no quantity 'weight_N'; it has P_R2_over_EI"),
    ],
)
def test_wrong_use_is_one_line_and_writes_nothing(words, says, tmp_path, capsys) -> None:
    out = tmp_path / "out"
    given = words if "--error" in words else [*words, "--error", "1%"]
    assert main(["choose", *given, "--out", str(out)]) == WRONG_USE
    (line,) = capsys.readouterr().err.splitlines()
    assert says in line
    assert not out.exists()


def test_what_is_interrupted_writes_nothing(tmp_path, capsys, monkeypatch) -> None:
    def interrupted(*asked, **more):
        raise KeyboardInterrupt

    monkeypatch.setattr(choosing, "_compare", interrupted)
    out = tmp_path / "out"
    assert main(["choose", *RING, "--error", "5%", "--out", str(out)]) == INTERRUPTED
    assert "nothing is written" in capsys.readouterr().err
    assert not out.exists()


def test_nothing_that_is_enough_is_not_converged(tmp_path, capsys) -> None:
    assert main(["choose", *RING, "--error", "1%", "--budget", "0.01s", "--out", str(tmp_path)]) == NOT_CONVERGED
    assert capsys.readouterr().out.splitlines()[-1].startswith("no recommendation: ")
    actual = told(tmp_path)
    assert (actual["outcome"], actual["recommended"], actual["variants"]) == (NOT_ANSWERED, None, [])


def test_a_grid_that_cannot_be_refined_is_named(monkeypatch) -> None:
    monkeypatch.setattr(choosing, "near", lambda *_: None)
    assert "measure exact: no grid is finer than 1x8" in choose("ring", {}, 0.01, 20.0, mesh="1x8").uncertain


@pytest.mark.slow
def test_a_scene_from_outside(tmp_path, capsys, put_back) -> None:
    words = ["choose", "pressed-arch", "--error", "3%", "--use", str(PLUGIN), "--out", str(tmp_path)]
    assert main(words) == OK
    lines = capsys.readouterr().out.splitlines()
    command = told(tmp_path)["recommended"]["command"]
    assert command.startswith("footprint solve pressed-arch --mesh 1x")
    assert f"  {command}" in lines
    assert main([*shlex.split(command)[1:-1], str(tmp_path / "solved")]) == OK
    names = [row["name"] for row in told(tmp_path)["variants"]]
    assert "no-drilling" in names


@pytest.mark.slow
def test_a_notebook_has_tables(tmp_path: Path) -> None:
    actual = choose_in_notebook("ring", "5%", budget=2.0, delta_mm=50)
    assert {"name", "formulation_error", "within", "mesh"} <= {*actual.variants.columns}
    assert actual.recommended["error_at_most"] <= 0.05
    actual.write(tmp_path)
    assert told(tmp_path)["scene"] == "ring"
    with pytest.raises(UsageError, match="error"):
        choose_in_notebook("ring", 7.0)
