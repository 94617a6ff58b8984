"""Grids that follow the need: their lines, the estimate behind them, the choice of a mesh, and what they save."""

from dataclasses import replace

import numpy as np
import pytest

from formulations.recovery import energy_products, recovery_errors, refined
from studies.analysis.tyre import reaching
from studies.ask.scene import UsageError
from studies.experiments.work_precision import work_precision
from studies.scenes.complete import complete as resolve
from studies.scenes.tyre.grid_lines import GROWTH, LineSize, tyre_lines
from studies.scenes.tyre.model import TyreModel
from studies.solving.solve import solve

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


@pytest.mark.parametrize("grading", ["uniform", "patch"])
def test_lines_are_symmetric_to_the_last_digit(grading: str) -> None:
    """numpy's 23 lines from -120 to 120 have -1e-14 in their middle, and a quarter that begins there."""
    assert np.linspace(-120, 120, 23)[11] != 0
    for n in range(6, 120, 2):
        for lines in tyre_lines((n, n), 120.0, grading):
            assert lines[n // 2] == 0
            np.testing.assert_array_equal(lines, -lines[::-1])


def test_a_refined_quarter_shows_the_whole_tyre() -> None:
    scene, request = resolve("tyre", {"E_MPa": "20", "nu": "0.45", "grading": "uniform"}, "22x44")
    leaves = tuple((1, i, j) for i in range(22) for j in range(44))
    part = scene.build(replace(request, leaves=leaves)).part
    assert part.shape == (45, 88)
    np.testing.assert_array_equal(np.min(part.angles, axis=0), [-np.deg2rad(120), -np.pi])


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


@pytest.mark.slow
@pytest.mark.parametrize("element", ["paper", "refined"])
def test_adapted_grids_save_two_thirds_of_the_unknowns(element: str) -> None:
    """1 % from some grid on: the adapted family needs at most a third of the unknowns of the uniform one."""
    meshes = {"uniform": [(n, n) for n in range(36, 84, 4)]}
    table = work_precision({"element": element, "delta_mm": "20"}, meshes, reference=LIMITS[element])
    uniform, adapted = (reaching(table[table["family"] == family], 0.01) for family in ("uniform", "adapted"))
    assert adapted["unknowns"] <= uniform["unknowns"] / 3
