"""A sector of a tyre: its error against the whole, the estimate that bounds it, and what is refused."""

from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from studies.ask.scene import UsageError
from studies.cli import WRONG_USE, main
from studies.scenes.complete import complete as resolve
from studies.scenes.tyre import sector
from studies.scenes.tyre.sector import check_patch, check_reach, with_line_at, within
from studies.solving.result import Result
from studies.solving.solve import solve
from support.problems.solved import solved

MESH = "16x48"  # uniform: lines every 7.5 degrees
CUTS = (45, 60, 90, 135)
ROUNDING = 1e-8  # relative: forces of converged states agree no better
NOT_ABSURD = 30.0
ISOTROPIC = {"E_MPa": "20", "nu": "0.45", "load": "follower", "pressure_area": "face"}


def run(model: str, settings: dict[str, str], **more: str) -> Result:
    return solved("tyre", MESH, model=model, grading="uniform", **settings, **more)


@pytest.mark.slow
@pytest.mark.parametrize(
    "settings",
    [
        {"delta_mm": "20"},
        {**ISOTROPIC, "delta_mm": "20"},
        {"gamma_deg": "30", "p0_MPa": "0.3", "delta_mm": "15"},
    ],
    ids=str,
)
def test_the_estimate_bounds_the_error_of_the_cut(settings: dict[str, str]) -> None:
    whole = run("full", settings)
    force = whole.quantities["force_N"]
    sizes = []
    for cut in CUTS:
        sector = run("sector", settings, sector_deg=str(cut))
        error, estimate = abs(sector.quantities["force_N"] / force - 1), sector.quantities["truncation_estimate"]
        assert estimate >= error
        if error > ROUNDING:
            assert estimate <= NOT_ABSURD * error
        for name in ("inflated_equator_inner_mm", "inflated_equator_outer_mm"):  # one column: the cut changes nothing
            assert sector.quantities[name] == pytest.approx(whole.quantities[name], rel=1e-9)
        sizes.append((sector.model.n_unknowns, estimate))
    unknowns, estimates = np.array(sizes).T
    assert np.all(np.diff(unknowns) > 0)
    assert np.all(np.diff(estimates) < 0)
    assert unknowns[0] < 0.3 * whole.model.n_unknowns / 2 * 1.05


def test_a_wrong_seam_breaks_the_bound(monkeypatch: pytest.MonkeyPatch) -> None:
    """Must fail beside must pass: inflated against a seam that mirrors, angle plies are not in equilibrium."""
    settings = {"delta_mm": "10", "sector_deg": "60"}
    right = run("sector", settings).quantities["force_N"]
    monkeypatch.setattr("studies.scenes.tyre.parts.TURN_OF_FRAME", np.array([-1.0, 1.0, 1.0]))
    wrong = solve(*resolve("tyre", {"grading": "uniform", **settings}, MESH, model="sector"))
    assert not wrong.outcome.converged or abs(wrong.quantities["force_N"] / right - 1) > 1e-4


def test_lines_of_a_sector() -> None:
    phi = np.deg2rad(np.linspace(-180, 180, 25))
    cut = np.deg2rad(50)
    moved = with_line_at(phi, cut)
    np.testing.assert_allclose(moved, -moved[::-1], atol=1e-15)
    inside = within(moved, cut)
    assert inside[-1] == cut == -inside[0]
    assert len(inside) % 2 == 1
    assert len(moved) == len(phi)
    with pytest.raises(UsageError, match="fewer than two elements"):
        with_line_at(phi, np.deg2rad(8))


def test_a_cut_between_lines_is_solved() -> None:
    solution = run("sector", {"delta_mm": "10"}, sector_deg="70")
    assert np.rad2deg(solution.model.part.cut) == pytest.approx(70)
    assert 0 < solution.quantities["truncation_estimate"] < 0.05


@pytest.mark.parametrize(
    ("arguments", "reason"),
    [
        (["--model", "sector", "--set", "sector_deg=0"], "in (0, 180)"),
        (["--model", "sector", "--set", "sector_deg=180"], "in (0, 180)"),
        (["--model", "sector", "--set", "sector_deg=15"], "may reach it"),
        (["--set", "sector_deg=60"], "sector_deg needs --model sector"),
    ],
)
def test_wrong_cuts_are_refused(
    arguments: list[str], reason: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["solve", "tyre", *arguments, "--mesh", MESH, "--out", str(tmp_path / "out")]) == WRONG_USE
    said = capsys.readouterr().err
    assert reason in said
    assert said.count("\n") == 1


def test_a_patch_at_the_cut_is_refused() -> None:
    """Before the solve by the chord of the plane, after it, whatever the foundation, by the nodes in contact."""
    check_reach(np.deg2rad(21.5), 304.8, 20.0)
    with pytest.raises(UsageError, match="may reach it"):
        check_reach(np.deg2rad(20.5), 304.8, 20.0)
    part = run("sector", {"delta_mm": "5", "sector_deg": "60"}).model.part
    phi = part.grid.nodes[:, 1]
    check_patch(part, phi <= np.deg2rad(45) + 1e-9)
    with pytest.raises(UsageError, match="patch reaches the cut"):
        check_patch(part, phi <= np.deg2rad(52.5) + 1e-9)


def test_auto_never_cuts() -> None:
    assert resolve("tyre", {})[1].model == "half"
    assert resolve("tyre", {}, model="sector")[1].settings["sector_deg"] == 90.0


def test_all_parts_that_show_the_patch_have_the_error_of_their_cut(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sector, "disturbance", lambda *_: (np.array([0.5, 1.4]), np.array([9.0, 1.0])))
    one, four = (
        sector.truncation_estimate(None, SimpleNamespace(copies=n, cut=1.5), np.zeros(1), np.zeros(1), 2.0, -3.0)
        for n in (1, 4)
    )
    assert four == 4 * one == pytest.approx(4 * sector.SAFETY * 4 * 1.5 / sector.DECAY / 6)
