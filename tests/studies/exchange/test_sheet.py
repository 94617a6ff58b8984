"""Sheets and bodies read back: everything of the problem is there, bit by bit.

``footprint export``: one file, whole or not at all.

CalculiX on decks of ours, where it is installed: what it finds is what we find.
"""

from __future__ import annotations

import json
import shutil
import subprocess
from pathlib import Path
from typing import Any

import meshio
import numpy as np
import pytest

from studies.cli import main
from studies.exchange.deck import deck
from studies.exchange.judging import Comparison, compared, our_solution
from studies.exchange.of_scene import problem_of
from studies.exchange.problem import Problem
from studies.exchange.results import read_results
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
    for stated, step in zip(read["steps"], problem.steps, strict=True):
        forces, pressure = np.zeros_like(step.forces), np.zeros(len(problem.bricks.elements))
        for node, *force in stated["forces_N"]:
            forces[node - 1] = force
        for element, value in stated["following_pressure_MPa"]:
            pressure[element - 1] = value
        np.testing.assert_array_equal(forces, step.forces)
        np.testing.assert_array_equal(pressure[problem.bricks.inner], step.pressure)
        assert (stated[problem.key], stated["plane_offset_mm"]) == (step.load, step.offset)
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


BEGINS = {"inp": "*HEADING", "vtu": '<?xml version="1.0"?>', "json": "{"}
ASKED = ["export", "cantilever", "--mesh", "2x1"]


def test_every_format_is_one_file(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    for kind, begins in BEGINS.items():
        out = tmp_path / kind / f"scene.{kind}"
        assert main([*ASKED, "--format", kind, "--out", str(out)]) == 0
        assert out.read_text(encoding="utf-8").splitlines()[0] == begins
        assert [path.name for path in out.parent.iterdir()] == [out.name]
        assert "2 bricks, 4 steps" in capsys.readouterr().out


def test_wrong_use_is_one_line_and_writes_nothing(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    out = tmp_path / "scene"
    for words, said in (
        ("--format json --through 0", "through = 0 must be a whole number in [1, 16]"),
        ("--format vtu --measure round", "measure 'round' must be one of"),
        ("--format vtu --set load_fraction=0", "load_fraction = '0' must be increasing numbers in (0, 10]"),
        (f"--format inp --out {tmp_path}", "is a directory, not a file"),
    ):
        assert main([*ASKED, "--out", str(out), *words.split()]) == 2
        (line,) = capsys.readouterr().err.splitlines()
        assert said in line
        assert list(tmp_path.iterdir()) == []
    with pytest.raises(SystemExit, match="2"):
        main([*ASKED, "--out", str(out), "--format", "odb"])
    assert "'odb'" in capsys.readouterr().err


def test_cords_that_turn_within_a_brick_are_told(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """On the coarse torus; on Pagano's plate axes do not turn at all."""
    for scene, mesh, stated in (("tyre", "8x8", True), ("pagano", "2x2", False)):
        assert main(["export", scene, "--mesh", mesh, "--format", "inp", "--out", str(tmp_path / "scene.inp")]) == 0
        assert ("each brick has one ply direction" in capsys.readouterr().out) is stated


CCX = shutil.which("ccx")
WITHIN = 0.01
CASES = {
    # scene: settings, measure, mesh of the bricks, mesh of ours; quantities that must be among those compared
    "scordelis-lo": ({}, "linear", "8x8", "32x32", {"edge_deflection_mm", "strain_energy_Nmm", "unbalanced_N"}),
    "pinched-cylinder": ({}, "linear", "16x16", "32x32", {"deflection_mm", "strain_energy_Nmm"}),
    "pressurised-cylinder": ({}, "exact", "2x4", "2x4", {"stretch", "thickness_ratio", "unbalanced_N"}),
    "strip-contact": ({"load_fraction": "5"}, "linear", "16x2", "64x1", {"half_force", "unbalanced_N"}),
    "cantilever": ({"load_fraction": "0.5"}, "exact", "32x1", "32x1", {"tip_deflection_mm", "tip_shortening_mm"}),
}


@pytest.mark.slow
@pytest.mark.skipif(CCX is None, reason="needs CalculiX: Debian's package calculix-ccx")
@pytest.mark.parametrize("name", CASES)
def test_calculix_finds_what_we_find(name: str, tmp_path: Path) -> None:
    settings, measure, mesh, finer, wanted = CASES[name]
    problem = problem_of(name, settings, mesh, measure=measure)
    (tmp_path / "scene.inp").write_text("\n".join(deck(problem)) + "\n", encoding="ascii")
    assert CCX is not None
    run = subprocess.run([CCX, "scene"], cwd=tmp_path, capture_output=True, text=True, timeout=300, check=False)
    assert "Job finished" in run.stdout, run.stdout[-2000:]
    actual = read_results(tmp_path / "scene.dat", problem)
    assert [each.load for each in actual] == [step.load for step in problem.steps]
    ours = our_solution(problem, [each.load for each in actual], settings, finer, measure=measure)
    rows: list[Comparison] = compared(problem, actual, ours, WITHIN)
    assert wanted <= {row.quantity for row in rows}
    assert [row for row in rows if not row.within] == []
