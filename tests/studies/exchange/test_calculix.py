"""CalculiX on decks of ours, where it is installed: what it finds is what we find."""

from __future__ import annotations

import shutil
import subprocess
from pathlib import Path

import pytest

from studies.exchange.deck import deck
from studies.exchange.judging import Comparison, compared, our_solution
from studies.exchange.of_scene import problem_of
from studies.exchange.results import read_results

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
    found = read_results(tmp_path / "scene.dat", problem)
    assert [each.load for each in found] == [step.load for step in problem.steps]
    ours = our_solution(problem, [each.load for each in found], settings, finer, measure=measure)
    rows: list[Comparison] = compared(problem, found, ours, WITHIN)
    assert wanted <= {row.quantity for row in rows}
    assert [row for row in rows if not row.within] == []
