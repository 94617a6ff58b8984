"""The judge on results that are known: our own, exact ones, and ones with a planted fault."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from studies.cli import main
from studies.exchange.judging import Comparison, compared, energy_balance, force_balance, our_solution
from studies.exchange.of_scene import problem_of
from studies.exchange.problem import Problem
from studies.exchange.results import GROWTH, Found
from studies.scenes.benchmarks import cantilever as scene
from studies.scenes.statics import StaticModel
from studies.solving.result import Result

MESH = "8x1"


@pytest.fixture(scope="module")
def cantilever() -> Problem:
    return problem_of("cantilever", {"load_fraction": "1"}, MESH)


@pytest.fixture(scope="module")
def ours() -> Result:
    return our_solution(problem_of("cantilever", {}, MESH), [1.0], {})


@pytest.fixture(scope="module")
def field(cantilever: Problem, ours: Result) -> np.ndarray:
    """Our own displacements at the nodes of the shell, nothing elsewhere."""
    assert cantilever.shell is not None
    assert ours.last is not None
    u = np.full_like(cantilever.bricks.x, np.nan)
    assert isinstance(ours.model, StaticModel)
    for face, displacement in enumerate(ours.model.shell.discretisation.cartesian(ours.last.u)):
        u[cantilever.shell[:, face]] = displacement
    return u


def test_our_own_field_is_ours_and_is_held_against_the_references(
    cantilever: Problem, ours: Result, field: np.ndarray
) -> None:
    rows = compared(cantilever, [Found(1.0, {}, field)], ours, 1e-9)
    assert {row.quantity: row.difference for row in rows if row.against == "ours"} == pytest.approx(
        {"tip_shortening_mm": 0.0, "tip_deflection_mm": 0.0}, abs=1e-12
    )
    exact = {row.quantity: row.value for row in rows if "elastica" in row.against}
    assert exact == dict(zip(("tip_shortening_mm", "tip_deflection_mm"), scene.ELASTICA[-1][1:], strict=True))


def test_small_displacements_are_not_held_against_references_of_large_ones() -> None:
    linear = problem_of("cantilever", {"load_fraction": "1"}, MESH, measure="linear")
    rows = compared(
        linear, [Found(1.0, {"tip_deflection_mm": 40.0})], our_solution(linear, [1.0], {}, measure="linear"), 0.01
    )
    assert [row.against for row in rows] == ["ours"]


def test_growth_under_inflation_is_compared_with_that_of_our_column() -> None:
    problem = problem_of("tyre", {"delta_mm": "0"}, "8x8")
    ours = our_solution(problem, [0.0], {"delta_mm": "0"}, "12x12")
    (row,) = compared(problem, [Found(0.0, {GROWTH: 1.1 * ours.quantities[GROWTH]})], ours, 0.01)
    assert row.against == "ours"
    assert row.difference == pytest.approx(-0.1)  # it shrinks


def test_a_wrong_field_is_beyond_and_one_with_a_hole_is_not_read(
    cantilever: Problem, ours: Result, field: np.ndarray
) -> None:
    rows = compared(cantilever, [Found(1.0, {}, 1.02 * field)], ours, 0.01)
    beyond = {row.quantity: row.difference for row in rows if row.against == "ours" and not row.within}
    assert beyond == pytest.approx({"tip_shortening_mm": 0.02, "tip_deflection_mm": 0.02})
    assert cantilever.shell is not None
    holed = field.copy()
    holed[cantilever.shell[3, 1]] = np.nan
    assert compared(cantilever, [Found(1.0, {}, holed)], ours, 0.01) == []


def test_strain_energy_is_compared_with_ours(cantilever: Problem, ours: Result) -> None:
    assert ours.last is not None
    assert isinstance(ours.model, StaticModel)
    shell = ours.model.shell.scaled(0.0)
    value = shell.energy(ours.last.u)
    (row,) = compared(cantilever, [Found(1.0, {"strain_energy_Nmm": 1.5 * value})], ours, 0.01)
    assert row.difference == pytest.approx(0.5)
    assert not row.within


REACTION = {"reaction_x_N": 0.0, "reaction_y_N": 0.0, "reaction_z_N": -scene.P_MAX}


def test_supports_carry_the_loads(cantilever: Problem) -> None:
    (step,) = cantilever.steps
    assert force_balance(cantilever, step, Found(1.0, REACTION)) == pytest.approx((0.0, scene.P_MAX), abs=1e-12)
    less = {**REACTION, "reaction_z_N": -0.9 * scene.P_MAX}
    left = force_balance(cantilever, step, Found(1.0, less))
    assert left == pytest.approx((0.1 * scene.P_MAX, scene.P_MAX))
    assert force_balance(cantilever, step, Found(1.0, {})) is None


def test_the_plane_carries_what_supports_do_not() -> None:
    problem = problem_of("strip-contact", {"load_fraction": "5"}, "4x1")
    (step,) = problem.steps
    lift = float(step.forces[:, 2].sum())
    record = {**REACTION, "reaction_z_N": -0.25 * lift, "plane_force_N": 0.75 * lift}
    balance = force_balance(problem, step, Found(5.0, record))
    assert balance is not None
    assert balance[0] < 1e-12 * lift
    assert force_balance(problem, step, Found(5.0, REACTION)) is None  # the plane is not told


def test_the_pressure_is_part_of_the_balance() -> None:
    """A sector of a sphere under p: p A e_n over its flat shadow, seen from the rest position."""
    problem = problem_of("pressurised-cylinder", {"load_fraction": "1"}, "2x4")
    (step,) = problem.steps
    still = np.zeros_like(problem.bricks.x)
    balance = force_balance(problem, step, Found(1.0, dict.fromkeys(REACTION, 0.0), still))
    # the chord of the inner circle of the sector, 30 degrees, times the length and the pressure by area
    chord = 2 * (100.0 - 0.05) * np.sin(np.pi / 12) * 50.0
    assert balance is not None
    assert balance[0] == pytest.approx(chord * step.pressure[0], rel=1e-6)
    assert force_balance(problem, step, Found(1.0, dict.fromkeys(REACTION, 0.0))) is None  # where is the face?


def test_energy_is_half_of_the_work_where_all_is_linear(cantilever: Problem) -> None:
    linear = problem_of("cantilever", {"load_fraction": "1"}, MESH, measure="linear")
    (step,) = linear.steps
    u = np.zeros_like(linear.bricks.x)
    u[:, 2] = 3.0
    actual = Found(1.0, {"strain_energy_Nmm": 5.0}, u)
    assert energy_balance(linear, step, actual) == pytest.approx((5.0, 1.5 * scene.P_MAX))
    assert energy_balance(cantilever, step, actual) is None  # large displacements
    assert energy_balance(linear, step, replace(actual, u=None)) is None


def test_what_is_no_number_is_not_within() -> None:
    for actual, within in ((1.0099, True), (1.0101, False), (float("nan"), False)):
        assert Comparison(1.0, "w_mm", actual, "ours", 1.0, 0.01).within is within


def test_a_force_on_the_plane_is_compared_in_the_units_of_the_scene() -> None:
    """half_force of the strip is a number over D g/a^3; one of the plane of the part makes it."""
    problem = problem_of("strip-contact", {"load_fraction": "5"}, "16x1", measure="linear")
    ours = our_solution(problem, [5.0], {}, measure="linear")
    assert ours.end is not None
    force = float(np.sum(ours.end.problem.nodal_forces(ours.end.point.solution.pressure)))
    rows = compared(problem, [Found(5.0, {"plane_force_N": 1.1 * force})], ours, 0.01)
    assert {row.quantity for row in rows} == {"half_force"}
    (own,) = [row for row in rows if row.against == "ours"]
    assert own.difference == pytest.approx(0.1)


# --- the command ----------------------------------------------------------------------------------------------------

ASKED = ["cantilever", "--mesh", MESH, "--set", "load_fraction=1"]


def test_the_command(
    cantilever: Problem, field: np.ndarray, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Exit code 1 where a quantity is beyond, 2 in one line for wrong use."""
    there = np.flatnonzero(np.isfinite(field).all(axis=1))
    table = pd.DataFrame(field[there], columns=["ux_mm", "uy_mm", "uz_mm"])
    file = tmp_path / "field.csv"
    for factor, code in ((1.0, 0), (1.1, 1)):
        (factor * table).assign(load_fraction=1.0, node=there + 1).to_csv(file, index=False)
        words = ["--tolerance", "5%"]  # more than this coarse mesh is off the references
        assert main(["judge-field", *ASKED, str(file), *words]) == code
        printed = capsys.readouterr().out
        assert "tip_deflection_mm" in printed
        assert ("beyond" in printed) is (code == 1)
    curve = tmp_path / "curve.csv"
    curve.write_text("load_fraction,colour\n1,2\n", encoding="utf-8")
    for results, words, said in (
        (file, ["--tolerance", "70%"], "[0.01%, 50%]"),
        (file, ["--through", "17"], "[1, 16]"),
        (file, ["--mesh", "0x1"], "mesh '0x1'"),
        (file, ["--set", "load_fraction=11"], "load_fraction = '11'"),
        (curve, [], "no quantity of cantilever"),
    ):
        assert main(["judge-field", *ASKED, str(results), *words]) == 2
        (line,) = capsys.readouterr().err.splitlines()
        assert said in line
