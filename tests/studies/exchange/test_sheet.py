"""Sheets and bodies read back: everything of the problem is there, bit by bit."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import meshio
import numpy as np
import pytest

from studies.exchange.of_scene import problem_of
from studies.exchange.problem import Problem
from studies.exchange.sheet import FORMAT, write_body, write_sheet
from studies.output.vtu import read_vtu
from studies.scenes import SCENES


@pytest.fixture(scope="module", params=["tyre", "pressurised-cylinder", "scordelis-lo", "crushed-ring-solid"])
def problem(request: pytest.FixtureRequest) -> Problem:
    return problem_of(request.param, {}, {"tyre": "8x8", "crushed-ring-solid": "1x8"}.get(request.param, "3x3"))


def test_everything_comes_back(problem: Problem, tmp_path: Path) -> None:
    write_sheet(tmp_path / "sheet.json", problem)
    read: dict[str, Any] = json.loads((tmp_path / "sheet.json").read_text(encoding="utf-8"))
    assert read["format"] == FORMAT
    np.testing.assert_array_equal(read["nodes"], problem.bricks.x)
    np.testing.assert_array_equal(np.array(read["elements"]) - 1, problem.bricks.elements)
    np.testing.assert_array_equal(np.array(read["element_ply"]) - 1, problem.bricks.ply)
    np.testing.assert_array_equal(read["element_axes"], problem.bricks.frame[:, :2])
    assert [i for i, _ in read["faces"]["inner"]] == (problem.bricks.inner + 1).tolist()
    assert {face for _, face in read["faces"]["outer"]} == {2}
    np.testing.assert_array_equal(np.array(read["supports"]["nodes"]) - 1, problem.supports.nodes)
    np.testing.assert_array_equal(read["supports"]["axes"], problem.supports.axes)
    np.testing.assert_array_equal(read["supports"]["held"], problem.supports.held)
    for told, step in zip(read["steps"], problem.steps, strict=True):
        forces, pressure = np.zeros_like(step.forces), np.zeros(len(problem.bricks.elements))
        for node, *force in told["forces_N"]:
            forces[node - 1] = force
        for element, value in told["following_pressure_MPa"]:
            pressure[element - 1] = value
        np.testing.assert_array_equal(forces, step.forces)
        np.testing.assert_array_equal(pressure[problem.bricks.inner], step.pressure)
        assert (told[problem.key], told["plane_offset_mm"]) == (step.load, step.offset)
    assert [(ply["E_11"], ply["nu_23"], ply["G_13"], ply["angle"]) for ply in read["plies"]] == [
        (ply.E_L, ply.nu_TT, ply.shears[1], ply.angle) for ply in problem.materials
    ]
    references = SCENES[problem.request.scene].references
    assert [(each["quantity"], each["value"]) for each in read["references"]] == [
        (each.quantity, each.value) for each in references
    ]


def test_the_body_comes_back(problem: Problem, tmp_path: Path) -> None:
    write_body(tmp_path / "body.vtu", problem)
    fields, bricks = read_vtu(tmp_path / "body.vtu"), problem.bricks
    number = fields.data["node"].astype(int)
    there = number > 0
    np.testing.assert_array_equal(fields.points[there], bricks.x[number[there] - 1])
    assert sorted(number[there]) == list(range(1, len(bricks.x) + 1))
    np.testing.assert_array_equal(number[fields.cells[:, :20]] - 1, bricks.elements)  # the same order as in the deck
    np.testing.assert_array_equal(fields.data["force"][there], problem.steps[-1].forces[number[there] - 1])
    # another reader sees the plies
    mesh = meshio.read(tmp_path / "body.vtu")
    (ply,) = mesh.cell_data["ply"]
    np.testing.assert_array_equal(ply, problem.bricks.ply + 1)
    fibre = np.stack([mesh.cell_data[f"fibre_{axis}"][0] for axis in "xyz"], axis=-1)
    np.testing.assert_allclose(np.linalg.norm(fibre, axis=1), 1)
