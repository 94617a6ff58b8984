"""Grids that follow the need: their lines, the estimate behind them, the choice of a mesh, and what they save."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from formulations.recovery import energy_products, recovery_errors, refined
from studies.analysis.comparisons.tyre_models import reaching
from studies.cli import NOT_CONVERGED, OK, WRONG_USE, main
from studies.error_control import AdaptiveScene, extrapolate, parse_error
from studies.experiments.work_precision import work_precision
from studies.scene import UsageError
from studies.scenes.tyre.grid_lines import GROWTH, LineSize, tyre_lines
from studies.scenes.tyre.model import TyreModel
from studies.solving import resolve, solve

LIMITS = {"paper": 1880.2, "refined": 1879.9}  # N, adapted grids of 74x94 and 90x112, which agree to 0.05 %


def peaked(width: float) -> LineSize:
    at = np.linspace(0.0, np.pi, 4000)
    return LineSize(at, 0.05 + np.abs(at - 0.3) / width, 1.0)


@pytest.mark.parametrize("n", [6, 8, 20, 52, 200])
@pytest.mark.parametrize("width", [0.05, 1.0, 100.0])
def test_sized_lines(n: int, width: float) -> None:
    lines = peaked(width).lines(n, np.pi / 8)
    assert len(lines) == n + 1
    assert lines[n // 2] == 0
    np.testing.assert_allclose(lines, -lines[::-1], atol=1e-14)
    assert lines[-1] == np.pi
    sizes = np.diff(lines)
    assert np.all(sizes > 0)
    assert np.max(np.maximum(sizes[1:] / sizes[:-1], sizes[:-1] / sizes[1:])) <= GROWTH
    if n >= 20:
        assert sizes.max() <= np.pi / 8 * (1 + 1e-3)


def test_equidistribution_of_a_known_density() -> None:
    """Errors e h^3 with e = exp(-6 x) ask for h ~ exp(2 x), up to the floor, on both halves alike."""
    lines = np.linspace(-1, 1, 401)
    middle, h = 0.5 * (lines[1:] + lines[:-1]), np.diff(lines)
    found = LineSize.equidistributing(lines, np.exp(-6 * np.abs(middle)) * h**3)
    inside = (found.at > 0.02) & (found.at < 0.6)
    wanted = np.exp(2 * found.at[inside])
    np.testing.assert_allclose(found.shape[inside] / found.shape[inside][0], wanted / wanted[0], rtol=1e-3)
    halves = LineSize.equidistributing(lines[200:], 2 * (np.exp(-6 * np.abs(middle)) * h**3)[200:])
    np.testing.assert_allclose(halves.shape, found.shape, rtol=1e-12)


def test_uniform_and_patch_lines() -> None:
    psi, phi = tyre_lines((20, 24), 120.0, "uniform")
    assert np.ptp(np.diff(psi)) < 1e-12
    assert np.ptp(np.diff(phi)) < 1e-12
    np.testing.assert_allclose([psi[0], phi[-1]], [-np.deg2rad(120), np.pi])
    assert np.ptp(np.diff(tyre_lines((20, 24), 120.0)[1])) > 0.05
    with pytest.raises(UsageError, match="even"):
        tyre_lines((21, 20), 120.0, "uniform")


@pytest.mark.slow
@pytest.mark.parametrize("axis", [0, 1])
def test_recovery_error_falls_with_the_size(axis: int) -> None:
    """The energy of the recovery error of an inflated and pressed tyre falls about as h^2, per direction."""
    found = []
    for n in (12, 24):
        lines = tyre_lines((n, n), 120.0, "uniform")
        scene, request = resolve("tyre", {"delta_mm": "8", "grading": "uniform"}, f"{n}x{n}", model="full")
        result = solve(scene, request)
        finer = TyreModel.on(request, *(refined(line) if k == axis else line for k, line in enumerate(lines)))
        errors = recovery_errors(result.model.shell, result.last.u, finer.shell, axis)
        found.append(energy_products(result.model.shell, errors, errors).sum())
    assert found[1] < 0.5 * found[0]


@pytest.mark.slow
def test_the_lines_keep_the_symmetry_of_the_parts() -> None:
    forces = []
    for model in ("half", "full"):
        result = solve(*resolve("tyre", {"delta_mm": "10", "grading": "adapted"}, "16x18", model=model))
        assert result.outcome.converged
        assert result.steps[-1]["failures"] == []
        forces.append(result.steps[-1]["force_N"])
    assert forces[0] == pytest.approx(forces[1], rel=1e-9)


def test_fit_of_a_ladder() -> None:
    elements = [400, 600, 900, 1350]
    exact = extrapolate(elements, [100 + 2000 / n for n in elements])
    assert exact.limit == pytest.approx(100, rel=1e-9)
    assert exact.error == pytest.approx(2000 / 1350 / 100, rel=1e-6)
    assert exact.high - exact.low < 1e-6
    noisy = extrapolate(elements, [100 + (2000 + 400 * s) / n for n, s in zip(elements, (1, -1, 1, -1), strict=True)])
    assert abs(noisy.limit - 100) < noisy.limit_uncertainty
    assert noisy.high > noisy.error > noisy.low >= 0
    with pytest.raises(ValueError, match="3 rungs"):
        extrapolate([1, 2], [1, 2])


@pytest.mark.parametrize(("text", "value"), [("1%", 0.01), ("0.02", 0.02), ("0.5%", 0.005)])
def test_an_error_is_read(text: str, value: float) -> None:
    assert parse_error(text) == pytest.approx(value)


@pytest.mark.parametrize("text", ["", "x%", "0", "nan", "-1%", "60%", "1e-9"])
def test_a_wrong_error_is_refused(text: str) -> None:
    with pytest.raises(UsageError, match="part of the force"):
        parse_error(text)


@pytest.mark.slow
@pytest.mark.parametrize("element", ["paper", "refined"])
def test_mesh_for_an_error(element: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """The mesh that is chosen has the error asked for, and the band covers the true one."""
    arguments = ["solve", "tyre", "--set", "delta_mm=20", "--set", f"element={element}", "--error", "1%"]
    assert main([*arguments, "--out", str(tmp_path)]) == OK
    seen = json.loads((tmp_path / "result.json").read_text())["quantities"]
    true = abs(seen["force_N"] / LIMITS[element] - 1)
    assert true <= 0.01
    assert seen["error_low"] <= true <= seen["error_high"] <= 0.01 == seen["error_asked"]
    assert abs(seen["force_limit_N"] - LIMITS[element]) <= seen["force_limit_uncertainty_N"]
    assert (tmp_path / "ladder.csv").exists()
    assert "mesh for 1 %" in capsys.readouterr().out


@pytest.mark.slow
def test_no_mesh_reaches_too_small_an_error(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("studies.error_control.solve_to_error.__defaults__", (lambda text: None, (200, 300, 400)))
    arguments = ["solve", "tyre", "--set", "delta_mm=10", "--error", "0.01%", "--out", str(tmp_path)]
    assert main(arguments) == NOT_CONVERGED
    assert "none" in capsys.readouterr().out
    found = json.loads((tmp_path / "result.json").read_text())
    assert "no mesh of up to 400 elements" in found["reason"]
    assert found["quantities"]["error_high"] > 1e-4


@pytest.mark.parametrize(
    "wrong", [["tyre", "--mesh", "20x20"], ["tyre", "--set", "grading=patch"], ["hemisphere"], ["tyre-solid"]]
)
def test_an_error_excludes_a_mesh(wrong: list[str], tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["solve", *wrong, "--error", "1%", "--out", str(tmp_path / "out")]) == WRONG_USE
    assert capsys.readouterr().err.count("\n") == 1


@pytest.mark.slow
@pytest.mark.parametrize("element", ["paper", "refined"])
def test_adapted_grids_save_two_thirds_of_the_unknowns(element: str) -> None:
    """1 % from some grid on: the adapted family needs at most a third of the unknowns of the uniform one."""
    meshes = {"uniform": [(n, n) for n in range(36, 84, 4)]}
    table = work_precision({"element": element, "delta_mm": "20"}, meshes, reference=LIMITS[element])
    uniform, adapted = (reaching(table[table["family"] == family], 0.01) for family in ("uniform", "adapted"))
    assert uniform is not None
    assert adapted is not None
    assert adapted["unknowns"] <= uniform["unknowns"] / 3


def test_the_scene_says_what_it_can_adapt() -> None:
    scene, _ = resolve("tyre", {})
    assert isinstance(scene, AdaptiveScene)
