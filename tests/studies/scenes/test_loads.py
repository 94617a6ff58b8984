"""Loads of scenes by themselves: over areas, along edges, and pressure on interpolated positions.

Grids that follow the need: their lines, the estimate behind them, the choice of a mesh, and what they save.
"""

from dataclasses import replace

import numpy as np
import pytest

from formulations.discretisation import Discretisation
from formulations.geometry.grid import Grid, graded_lines
from formulations.geometry.surfaces import cylinder, torus
from formulations.loads import Pressure
from formulations.recovery import energy_products, recovery_errors, refined
from formulations.section.laminate import Laminate, Ply
from formulations.shell import ShellModel
from formulations.strains.catalogue import EXACT
from studies.analysis.tyre import reaching
from studies.ask.scene import UsageError
from studies.experiments.work_precision import work_precision
from studies.scenes.benchmarks.obstacle_course import ScordelisLo
from studies.scenes.benchmarks.sze import SlitAnnulus
from studies.scenes.complete import complete
from studies.scenes.complete import complete as resolve
from studies.scenes.statics import area_load
from studies.scenes.tyre.grid_lines import GROWTH, LineSize, pressed, strain_errors, tyre_lines
from studies.scenes.tyre.model import TyreModel, inflated_shell
from studies.scenes.tyre.parts import part_of
from studies.solving.refinement.adaptive_grids import Family
from studies.solving.solve import solve
from support.problems.differences import fitted_order


def test_area_load_along_the_normal_is_the_dead_pressure() -> None:
    """The same force as that of formulations.loads, which knows no frame; here on a torus, split between the faces."""
    grid = Grid.tensor(graded_lines([-0.5, 0.2, 1.0], [2, 3]), np.linspace(0, 0.7, 4))
    laminate = Laminate((Ply.isotropic(1.0, 0.3, 0.1),), -0.02)
    nothing_fixed = np.zeros((grid.n_nodes, 6), bool)
    surface = torus(3.0, 1.0)
    discretisation = Discretisation.build(surface, grid, laminate, nothing_fixed)
    forces = area_load(discretisation, lambda a1, a2: 0.7 * surface.frame(a1, a2)[..., 2, :], shares=(0.3, 0.7))
    dead = discretisation.gather(Pressure(0.7).dead_force(discretisation.geometry)).reshape(-1, 6)
    np.testing.assert_allclose(forces[:, 4] / 0.3, dead[:, 4], rtol=1e-12)
    np.testing.assert_allclose(forces[:, 5] / 0.7, dead[:, 4], rtol=1e-12)
    np.testing.assert_allclose(forces[:, :4], 0, atol=1e-14)


def test_weight_of_the_roof_is_all_there() -> None:
    """Sum of the vertical nodal forces against weight times area; the frames of nodes and Gauss points differ."""
    meshes = np.array([4, 8, 16])
    exact = ScordelisLo.WEIGHT * ScordelisLo.RADIUS * ScordelisLo.HALF_ANGLE * ScordelisLo.LENGTH / 2
    errors = []
    for n in meshes:
        grid = Grid.tensor(np.linspace(0, ScordelisLo.LENGTH / 2, 3), np.linspace(0, ScordelisLo.HALF_ANGLE, n + 1))
        surface = cylinder(ScordelisLo.RADIUS)
        laminate = Laminate.single(Ply.isotropic(1.0, 0.0, 0.25))
        discretisation = Discretisation.build(surface, grid, laminate, np.zeros((grid.n_nodes, 6), bool))
        down = np.array([-ScordelisLo.WEIGHT, 0, 0])
        forces = area_load(discretisation, lambda a1, a2, p=down: np.broadcast_to(p, (*a1.shape, 3)))
        errors.append(abs(-_cartesian(discretisation, forces)[:, 0].sum() / exact - 1))
    assert errors[-1] <= 1e-3
    assert fitted_order(1 / meshes, errors) == pytest.approx(2, abs=0.1)


def _cartesian(discretisation: Discretisation, forces: np.ndarray) -> np.ndarray:
    frame = discretisation.surface.frame(*discretisation.grid.nodes.T)
    return np.einsum("nfi,nij->nj", forces.reshape(-1, 3, 2).swapaxes(1, 2), frame)


@pytest.mark.parametrize("lines", ["even", "edges"])
@pytest.mark.parametrize("cut", [False, True])
def test_an_edge_load_is_uniform_on_lines_of_any_spacing(lines: str, cut: bool) -> None:
    """The side of the slit annulus, its elements of different size: resultant and moment about the axis."""
    scene, request = complete("sze-annulus", {"lines": lines}, "6x20")
    if cut:
        tree = Family.of(scene, request).tree
        leaves = tree.refined(tree.leaves[:, 1] < 2).leaves
        request = replace(request, leaves=tuple(map(tuple, leaves.tolist())))
    shell = scene.build(request).shell
    force, radii = (
        shell.discretisation.map.placed(shell.forces)[:, 4:].sum(axis=1),
        shell.discretisation.grid.nodes[:, 0],
    )
    inner, outer = shell.discretisation.grid.ends[0]
    assert force.sum() == pytest.approx(SlitAnnulus.P_MAX * (outer - inner))
    assert force @ radii == pytest.approx(SlitAnnulus.P_MAX * (outer**2 - inner**2) / 2)
    if not cut:  # no node hangs: each carries what its hat function does
        side = shell.discretisation.grid.on_line(1, 0.0)
        fine = np.linspace(inner, outer, 20001)
        hats = [np.trapezoid(np.interp(fine, radii[side], unit), fine) for unit in np.eye(len(side))]
        np.testing.assert_allclose(force[side], SlitAnnulus.P_MAX * np.array(hats), rtol=1e-6)


def half_pipe(interpolation: str, pressure: Pressure) -> ShellModel:
    grid = Grid.tensor(np.array([0.0, 0.4, 1.0]), np.linspace(0, np.pi, 7))
    fixed = np.zeros((grid.n_nodes, 6), bool)
    laminate = Laminate.single(Ply.isotropic(1.0, 0.3, 0.2))
    discretisation = Discretisation.build(cylinder(2.0), grid, laminate, fixed, interpolation=interpolation)
    return ShellModel(discretisation, EXACT, pressure=pressure)


def total(shell: ShellModel, forces: np.ndarray) -> np.ndarray:
    """Sum of nodal forces (n,) in Cartesian components."""
    nodal = forces.reshape(-1, 3, 2).sum(axis=2)
    frame = shell.discretisation.surface.frame(*shell.discretisation.grid.nodes.T)
    return np.einsum("ni,nix->x", nodal, frame)


def test_follower_pressure_on_interpolated_positions_is_the_area_vector_of_the_bilinear_faces(rng) -> None:
    """p int n dA of a bilinear face depends on its rim only: half the cross product of its diagonals."""
    shell = half_pipe("isoparametric", pressure=Pressure(0.7, follower=True, area="face"))
    u = 0.2 * rng.normal(size=shell.discretisation.n_free)
    force = shell.scaled(0.0).linearise(u).residual - shell.linearise(u).residual
    x = shell.discretisation.positions()[0] + shell.discretisation.cartesian(u)[0]
    corner = x[shell.discretisation.grid.elements]
    area = 0.5 * np.cross(corner[:, 2] - corner[:, 0], corner[:, 3] - corner[:, 1]).sum(axis=0)
    outwards = np.sign(area @ total(shell, force))
    assert total(shell, force) == pytest.approx(0.7 * outwards * area, rel=1e-10)


@pytest.mark.parametrize("interpolation", ["curvilinear", "isoparametric"])
def test_dead_loads_of_an_area_have_their_resultant(interpolation: str) -> None:
    """Normal pressure on a half pipe pushes by p times its diameter; a constant traction by itself times the area.

    A translation is in the space of the isoparametric element, so the sum is that of the Gauss points, 1e-4 for 30
    degrees each; of the curvilinear one only to O(l^2), the cosine of half an element.
    """
    shell = half_pipe(interpolation, pressure=Pressure(0.7))
    at_rest = np.zeros(shell.discretisation.n_free)
    force = total(shell, shell.scaled(0.0).linearise(at_rest).residual - shell.linearise(at_rest).residual)
    slack = 1e-3 if interpolation == "isoparametric" else np.pi**2 / 12**2 / 2
    assert np.abs(force) == pytest.approx([0.0, 0.7 * 2 * 2.0, 0.0], abs=0.7 * 4.0 * slack)
    dead = shell.discretisation.reduce(
        area_load(shell.discretisation, lambda a1, a2: np.broadcast_to([0.0, 0.0, -1.0], (*a1.shape, 3)))
    )
    assert total(shell, dead) == pytest.approx([0.0, 0.0, -2 * np.pi], abs=2 * np.pi * slack)


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
    actual = LineSize.equidistributing(lines, np.exp(-6 * np.abs(middle)) * h**3)
    inside = (actual.at > 0.02) & (actual.at < 0.6)
    wanted = np.exp(2 * actual.at[inside])
    np.testing.assert_allclose(actual.shape[inside] / actual.shape[inside][0], wanted / wanted[0], rtol=1e-3)
    halves = LineSize.equidistributing(lines[200:], 2 * (np.exp(-6 * np.abs(middle)) * h**3)[200:])
    np.testing.assert_allclose(halves.shape, actual.shape, rtol=1e-12)


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
    values = []
    for n in (12, 24):
        lines = tyre_lines((n, n), 120.0, "uniform")
        scene, request = resolve("tyre", {"delta_mm": "8", "grading": "uniform"}, f"{n}x{n}", model="full")
        result = solve(scene, request)
        finer = TyreModel.on(request, *(refined(line) if k == axis else line for k, line in enumerate(lines)))
        errors = recovery_errors(result.model.shell, result.last.u, finer.shell, axis)
        values.append(energy_products(result.model.shell, errors, errors).sum())
    assert values[1] < 0.5 * values[0]


@pytest.mark.parametrize("surfaces", ["2", "3"])
def test_an_estimate_on_half_a_tyre_is_that_of_the_whole(surfaces: str) -> None:
    """What each coordinate adds to the error of the force, by both faces and by surfaces between them."""
    psi, phi = tyre_lines((12, 12), 120.0)
    sums = []
    for model, copies in (("half", 2), ("full", 1)):
        _, request = resolve("tyre", {"delta_mm": "9,10", "surfaces": surfaces}, "12x12", model=model)
        tyre = TyreModel.on(request, psi, phi)
        before, state = pressed(request, tyre)
        for axis in (0, 1):
            finer = part_of(model, *(refined(line) if k == axis else line for k, line in enumerate((psi, phi))))
            whole = Grid.tensor(psi, phi, periodic=True)
            errors = strain_errors(tyre, before, state, inflated_shell(request, finer), whole, axis)
            sums.append(copies * errors.sum())
    assert sums[:2] == pytest.approx(sums[2:], rel=1e-3)


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
