"""What a plain solve says of the error of its mesh: against finer grids, and where it has nothing to say."""

from __future__ import annotations

import json
import math
from collections.abc import Sequence
from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import pytest

from contact.algorithms.semismooth import Semismooth
from contact.catalogue import ALGORITHMS
from contact.problem import ContactProblem, ContactSolution, Outcome
from studies.ask.request import Request
from studies.ask.scene import Scene
from studies.cli import main
from studies.scenes.closed_forms.contact import flattened_ring
from studies.scenes.complete import complete
from studies.scenes.contact.ring import RADIUS
from studies.solving.refinement import mesh_error
from studies.solving.refinement.mesh_error import COLD, HALF_SIZE, TABLE, coarser_grids, solve_with_error
from studies.solving.refinement.nested import sketch
from studies.solving.result import Result, Step
from studies.solving.solve import solve

ONE_LOAD = ("solve", "ring", "--mesh", "1x64", "--set", "delta_mm=20")


def stated(scene: str, mesh: str | None = None, settings: dict[str, str] | None = None, **options: str) -> Result:
    return solve_with_error(*complete(scene, settings or {}, mesh, **options))


@pytest.mark.slow
@pytest.mark.parametrize(
    ("scene", "mesh", "finer", "settings"),
    [
        ("ring", "1x64", ("1x96", "1x192"), {"delta_mm": "45"}),
        ("cantilever", "16x1", ("64x1", "128x1"), {}),
        pytest.param("plate-contact", "64x1", ("128x1", "256x1"), {"load_fraction": "7"}, marks=pytest.mark.slow),
        pytest.param("manufactured", "16x16", ("24x24", "48x48"), {}, marks=pytest.mark.slow),
        pytest.param("hemisphere", "16x16", ("24x24", "48x48"), {"load_fraction": "0.5"}, marks=pytest.mark.slow),
    ],
)
def test_the_limit_lies_in_the_interval(
    scene: str, mesh: str, finer: tuple[str, str], settings: dict[str, str]
) -> None:
    """The limit of two finer grids of twice the elements from one to the next, of the order 2."""
    seen = stated(scene, mesh, settings)
    before, last = (solve(*complete(scene, settings, each)).quantities for each in finer)
    assert seen.errors
    for name, interval in seen.errors.items():
        limit = (4 * last[name] - before[name]) / 3
        assert interval["low"] < limit < interval["high"], name


def test_the_answer_is_the_same_from_rest_and_without_an_error() -> None:
    asked = complete("ring", {"delta_mm": "30,45"}, "1x64")
    nested, cold = solve_with_error(*asked), solve_with_error(*asked, start=COLD, error=False)
    assert nested.quantities == pytest.approx(cold.quantities, rel=1e-7, abs=1e-9)
    assert nested.verdict == cold.verdict == "converged"
    assert nested.errors
    assert TABLE in nested.tables
    assert not cold.errors
    assert TABLE not in cold.tables
    assert HALF_SIZE not in cold.timing


def test_every_load_has_its_error() -> None:
    result = stated("ring", "1x64")
    rows = list(result.table(TABLE).rows())
    assert [row["load"] for row in rows if row["quantity"] == "P_R2_over_EI"] == [0, 1, 2]
    for row in rows:
        assert row["low"] < row["limit"] < row["high"]
        value = result.loads[row["load"]].quantities[row["quantity"]]
        assert row["value"] == value
        assert row["error"] == pytest.approx(abs(value / row["limit"] - 1))
    assert not {row["quantity"] for row in rows} & {"contact_nodes"}  # a count has no limit


def test_the_work_on_elements_of_half_the_size_is_foreseen() -> None:
    result = stated("cantilever", "64x1")
    finer = stated("cantilever", "128x1")
    assert 0.3 < result.timing[HALF_SIZE] / finer.timing["cpu"] < 4


def test_coarser_grids_are_no_coarser_than_a_quarter_of_the_mesh_of_the_scene() -> None:
    for scene, mesh, coarser in (
        ("tyre", "42x40", [(20, 20), (10, 10)]),
        ("tyre", "20x20", [(10, 10)]),
        ("tyre", "10x10", []),
        ("ring", "1x64", [(1, 32), (1, 16)]),
        ("scordelis-lo", "64x1", []),  # their limit would be that of one element along a2
        ("slender-beam", "64x1", []),
    ):
        assert [each.mesh for each in coarser_grids(*complete(scene, {}, mesh))] == coarser


def test_fewer_grids_state_nothing_and_say_which_do() -> None:
    result = stated("tyre", "20x20", {"delta_mm": "5"})
    assert not result.errors
    assert TABLE not in result.tables
    assert result.notes[-1] == (
        "the error of the mesh is not known: grids with half and a quarter of the elements need a mesh of 40x40 or more"
    )
    kept = stated("shallow-cap", "32x4", {"load_fraction": "0.05"})  # 16x4 and 8x4
    assert kept.notes[-1] == result.notes[-1].replace("40x40", "32x16")


class Picky(Semismooth):
    """Solves neither to wide tolerances nor on grids of few candidates."""

    name = "picky"
    loosest, fewest = 1.0, 0

    def solve(self, problem: ContactProblem, start: ContactSolution) -> ContactSolution:
        if self.tolerance > self.loosest or len(problem.weights) < self.fewest:
            return replace(start, outcome=Outcome.UNSOLVED, counters={}, history=())
        return super().solve(problem, start)


@pytest.fixture
def picky(monkeypatch: pytest.MonkeyPatch) -> type[Picky]:
    own = type("Own", (Picky,), {})
    monkeypatch.setitem(ALGORITHMS, "picky", own)
    return own


def test_a_coarser_grid_that_does_not_carry_the_load_is_named_with_the_reason(picky: type[Picky]) -> None:
    picky.fewest = 30
    result = stated("ring", "1x64", {"delta_mm": "20"}, contact="picky")
    assert not result.errors
    (note,) = (each for each in result.notes if each.startswith("the error of the mesh is not known"))
    why = "(load at 20: the linearised contact problem was not solved; the load step was cut to its smallest size"
    assert f"not known: the path does not reach the last load on 1x16 {why}" in note
    assert note in result.as_json()["notes"]


def test_a_part_that_does_not_solve_to_a_wide_tolerance_has_an_error_of_its_mesh(picky: type[Picky]) -> None:
    picky.loosest = 1e-9
    result = stated("ring", "1x64", {"delta_mm": "20"}, contact="picky")
    usual = stated("ring", "1x64", {"delta_mm": "20"})
    assert result.errors["P_R2_over_EI"] == pytest.approx(usual.errors["P_R2_over_EI"], rel=1e-4)


@pytest.mark.slow
def test_two_bodies_have_an_interval_that_is_true() -> None:
    """Nothing is carried from their coarser grids: they say of the limit alone."""
    result = stated("two-rings", "1x64", {"delta_mm": "50"})
    low, high = (result.errors["P_R2_over_EI"][end] for end in ("low", "high"))
    assert low < flattened_ring(1 - 50 / RADIUS)[0] < high
    assert high - low < 0.2 * low


def test_grids_that_do_not_follow_the_mesh_state_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    def alike(scene: Scene, request: Request, coarser=None, **more):
        solution = sketch(scene, request, coarser, **more)
        return solution and replace(solution, unknowns=1000)

    monkeypatch.setattr(mesh_error, "sketch", alike)
    result = stated("ring", "1x64", {"delta_mm": "20"})
    assert not result.errors
    assert "the error of the mesh is not known: the unknowns do not follow the mesh" in result.notes


def test_a_deflection_under_a_point_load_has_no_limit() -> None:
    """It grows with every halving in a theory with shear; what is left without the growth converges."""
    result = stated("roof-a", "16x16", {"until": "limit"})
    rows = {row["quantity"]: row for row in result.table(TABLE).rows()}
    assert "under a point load" in rows["w_C_mm"]["unknown"]
    assert "w_C_mm" not in result.errors
    assert "w_C_even_mm" in result.errors
    assert any(line.startswith("limit not known, it grows by") for line in mesh_error.lines(result))


@pytest.mark.slow
def test_with_friction_the_interval_is_that_of_grids_and_of_load_steps() -> None:
    from studies.solving import load_steps

    result = stated("heavy-strip", "64x1", {"mu": "0.2"})
    grids = dict(result.errors["friction_N"])
    load_steps.estimate(result)
    both, steps = result.errors["friction_N"], {r["quantity"]: r for r in result.table(load_steps.TABLE).rows()}
    width = steps["friction_N"]["high"] - steps["friction_N"]["value"]
    assert width > 0
    assert both == pytest.approx({"low": grids["low"] - width, "high": grids["high"] + width})


@pytest.mark.parametrize("counts", [(7, 15, 30), (4, 8, 18), (8, 16, 32)])
@pytest.mark.parametrize("order", [1.0, 2.0, 3.5])
def test_the_order_is_that_of_three_grids_of_any_sizes(counts: tuple[int, int, int], order: float) -> None:
    assert shown(counts, [3.0 + n**-order for n in counts]) == pytest.approx(order)


def test_grids_that_show_no_order() -> None:
    for values in ((1.0, 2.0, 3.1), (1.0, 2.0, 1.5), (1.0, 1.0, 1.0)):  # apart, turning, the same
        assert shown((8, 16, 32), values) is None


def shown(counts: tuple[int, int, int], values: Sequence[float]) -> float | None:
    """The order of values on rings of so many elements, where nothing touches."""
    grids = [coarse_grid(n) for n in counts[:2]]
    result = SimpleNamespace(request=complete("ring", {}, (1, counts[2]))[1])
    return mesh_error._limit(result, grids, 0, "f", values, last=False).order


def coarse_grid(n: int, **known: object) -> Any:
    """What is known on a ring of n elements that touches nothing."""
    end = SimpleNamespace(point=SimpleNamespace(solution=SimpleNamespace(active=[])))
    return SimpleNamespace(size=1 / n, end=end, **known)


def test_an_interval_is_that_of_the_load_that_the_headline_value_is_of() -> None:
    """A drag leaves the force of the press there; one that turns back may leave nothing of friction."""

    def loads(n: int) -> list[dict[str, float]]:
        error = 16 / n**2
        return [{"force_N": 100 + error, "friction_N": 30 + error}, {"force_N": 50 + error, "friction_N": 0.0}]

    grids = [coarse_grid(n, loads=loads(n), seconds=1.0) for n in (16, 32)]
    press, drag = loads(64)
    steps = [Step({"delta_mm": 1.0, **press}, {}, {}, frozenset(press))]
    steps.append(Step({"drag_mm": 1.0, **drag}, {}, {}, frozenset({"friction_N"})))
    quantities = {"force_N": press["force_N"], "friction_N": 0.0}
    result = Result(complete("ring", {}, "1x64")[1], loads=steps, quantities=quantities, timing={"cpu": 1.0})
    mesh_error._state(result, grids, "")
    assert list(result.errors) == ["force_N"]
    assert result.errors["force_N"]["low"] < 100 < result.errors["force_N"]["high"]
    said = mesh_error.lines(result)
    assert said[0].startswith("force_N 50.0039: limit 50 ")
    assert not any("friction_N" in line for line in said)


def test_the_command_prints_and_stores_it(tmp_path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main([*ONE_LOAD, "--out", str(tmp_path)]) == 0
    said = capsys.readouterr().out
    assert "P_R2_over_EI" in said
    assert ": limit " in said
    assert "elements of half the size would take about" in said
    written = json.loads((tmp_path / "result.json").read_text())
    low, high = (written["errors"]["P_R2_over_EI"][end] for end in ("low", "high"))
    assert low < written["quantities"]["P_R2_over_EI"] < high
    assert math.isfinite(written["timing_s"]["half_size"])
    assert (tmp_path / "mesh_error.csv").exists()


def test_the_command_leaves_it_out(tmp_path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main([*ONE_LOAD, "--no-error", "--out", str(tmp_path)]) == 0
    assert "limit" not in capsys.readouterr().out.split("converged:")[1]
    assert "errors" not in json.loads((tmp_path / "result.json").read_text())


@pytest.mark.slow
def test_the_command_starts_cold(tmp_path) -> None:
    def spent(start: str) -> int:
        asked = ["solve", "hemisphere", "--set", "load_fraction=1", "--mesh", "32x32", "--start", start]
        assert main([*asked, "--out", str(tmp_path)]) == 0
        return json.loads((tmp_path / "result.json").read_text())["counters"]["newton_iterations"]

    assert spent("nested") < 0.7 * spent("cold")


def test_the_mesh_that_is_named_has_two_coarser_ones() -> None:
    for scene in ("panel", "tyre", "ring", "plate-contact", "slender-beam"):
        named = mesh_error.enough(complete(scene, {})[0])
        assert len(coarser_grids(*complete(scene, {}, named))) == 2
