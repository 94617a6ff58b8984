"""Quadrilaterals whose thickness differs: rigid motions, tapered and stepped cantilevers in closed form."""

from dataclasses import replace

import numpy as np
import pytest

from formulations.conditions.boundary import Supports
from formulations.discretisation import Discretisation
from formulations.element.on_grid import Walls
from formulations.geometry.grid import Grid, QuadGrid
from formulations.geometry.surfaces import NodalSurface, cylinder
from formulations.section.laminate import Laminate, Ply
from formulations.shell import ShellModel
from formulations.strains.catalogue import MEASURES

E, WIDTH, LENGTH, FORCE = 1000.0, 2.0, 20.0, 1e-4


def walled(
    grid: Grid,
    x: np.ndarray,
    normals: np.ndarray,
    first: np.ndarray,
    thickness: np.ndarray,
    held: np.ndarray,
    nu: float,
) -> Discretisation:
    """thickness (E, 4); of two laminates, those of even and of odd elements, of the same material."""
    laminates = tuple(Laminate.single(Ply.isotropic(E, nu, h)) for h in (1.0, 0.5))
    walls = Walls(laminates, np.arange(len(grid.elements)) % 2, thickness)
    surface = NodalSurface.of(x, normals, first)
    return Discretisation.build(
        surface, QuadGrid.over(grid.elements), laminates[0], held, None, interpolation="quads", walls=walls
    )


@pytest.mark.parametrize("steps", [False, True])
@pytest.mark.parametrize("measure", ["exact", "linear"])
def test_rigid_motions_of_walls_of_any_thickness(measure, steps) -> None:
    """On a distorted piece of a cylinder: finite ones of the exact measure, small rotations of the linear one."""
    grid = Grid.tensor(np.linspace(0, 3, 5), np.linspace(0, 0.8, 4))
    rng = np.random.default_rng(3)
    a1, a2 = (grid.nodes + rng.uniform(-1, 1, grid.nodes.shape) * [0.1, 0.03]).T
    surface = cylinder(5.0)
    frame = surface.frame(a1, a2)
    thickness = rng.uniform(0.1, 0.4, grid.n_nodes)[grid.elements]
    thickness = thickness * rng.uniform(0.5, 2.0, (len(grid.elements), 1)) if steps else thickness
    free = np.zeros((grid.n_nodes, 6), bool)
    shell = walled(grid, surface.position(a1, a2), frame[:, 2], frame[:, 0], thickness, free, 0.3)
    model = ShellModel(shell, MEASURES[measure], thickness_strain="balanced", membrane="relaxed")
    axis = np.array([0.36, 0.48, 0.8])
    spin = np.cross(np.eye(3), axis).T
    turn = 2.0 * np.outer(axis, axis) + np.cos(2.0) * (np.eye(3) - np.outer(axis, axis)) + np.sin(2.0) * spin
    turn = turn - np.outer(axis, axis)
    moved = [x @ (turn - np.eye(3) if measure == "exact" else spin).T + axis for x in shell.positions()]
    u = shell.map.restrict(np.stack(moved, axis=-1).reshape(-1, 6))
    size = np.abs(model.gauss_strains(rng.normal(size=u.shape))).max()
    assert size > 1
    assert np.abs(model.gauss_strains(u)).max() < 1e-11
    assert np.abs(model.linearise(u).residual).max() < 1e-11 * E


def cantilever(n: int, thickness: np.ndarray, nodal: bool) -> float:
    """Deflection of the tip of n x 1 elements under a transverse force; thickness (n + 1,) or (n,) along it."""
    grid = Grid.tensor(np.linspace(0, LENGTH, n + 1), np.linspace(0, WIDTH, 2))
    x = np.column_stack([grid.nodes, np.zeros(grid.n_nodes)])
    place = np.rint(grid.nodes[:, 0] * n / LENGTH).astype(int)
    corners = thickness[place][grid.elements] if nodal else np.repeat(thickness[:, None], 4, axis=1)
    held = Supports.none(grid).clamped(grid.on_line(0, 0.0)).held
    up, along = np.tile([0.0, 0.0, 1.0], (len(x), 1)), np.tile([1.0, 0.0, 0.0], (len(x), 1))
    shell = walled(grid, x, up, along, corners, held, 0.0)
    nodal_forces = np.zeros((grid.n_nodes, 6))
    nodal_forces[grid.on_line(0, LENGTH), 4:] = FORCE / 4
    model = ShellModel(shell, MEASURES["linear"], forces=shell.reduce(nodal_forces), thickness_strain="balanced")
    step = model.linearise(np.zeros(shell.n_free))
    u = np.linalg.solve(step.tangent.toarray(), -step.residual)
    return float(np.mean(shell.cartesian(u), axis=0)[grid.on_line(0, LENGTH), 2].mean())


def test_a_tapered_cantilever() -> None:
    """w = P int s^2/(E I) ds + P int ds/(G A) with h = a + b s from the tip: by parts, a closed form."""
    a, b = 0.2, 0.02
    h1 = a + b * LENGTH
    bending = (np.log(h1 / a) + 2 * a / h1 - a**2 / (2 * h1**2) - 1.5) / b**3
    exact = FORCE * (12 / (E * WIDTH) * bending + 2 / (E * WIDTH) * np.log(h1 / a) / b)
    errors = []
    for n in (8, 16, 32):
        thickness = a + b * LENGTH * (1 - np.arange(n + 1) / n)
        errors.append(abs(cantilever(n, thickness, nodal=True) / exact - 1))
    assert errors[2] < 2e-3
    assert np.all(np.log2(np.divide(errors[:-1], errors[1:])) > 1.8)


@pytest.mark.parametrize("thin_first", [False, True])
def test_a_stepped_cantilever(thin_first) -> None:
    """Two lengths of 0.3 and 0.6 mm, of any meshes: P (int s^2/(E I) + int 1/(G A)) piece by piece."""
    h = (0.3, 0.6) if thin_first else (0.6, 0.3)  # at the clamp, at the tip
    half = LENGTH / 2
    moments = [(LENGTH**3 - half**3) / 3, half**3 / 3]
    exact = sum(FORCE / (E * WIDTH) * (12 * moment / t**3 + 2 * half / t) for t, moment in zip(h, moments, strict=True))
    errors = [abs(cantilever(n, np.repeat(h, n // 2), nodal=False) / exact - 1) for n in (8, 16, 32)]
    assert errors[2] < 2e-3
    assert np.all(np.log2(np.divide(errors[:-1], errors[1:])) > 1.8)


def test_walls_that_do_not_differ_are_one_laminate() -> None:
    """Of another reference thickness, and of a step that is none."""
    uniform = cantilever(8, np.full(8, 0.4), nodal=False)
    grid = Grid.tensor(np.linspace(0, LENGTH, 9), np.linspace(0, WIDTH, 2))
    x = np.column_stack([grid.nodes, np.zeros(grid.n_nodes)])
    held = Supports.none(grid).clamped(grid.on_line(0, 0.0)).held
    along = np.tile([1.0, 0.0, 0.0], (len(x), 1))
    surface = NodalSurface.of(x, np.tile([0.0, 0.0, 1.0], (len(x), 1)), along)
    laminate = Laminate.single(Ply.isotropic(E, 0.0, 0.4))
    plain = Discretisation.build(surface, QuadGrid.over(grid.elements), laminate, held, None, interpolation="quads")
    forces = np.zeros((grid.n_nodes, 6))
    forces[grid.on_line(0, LENGTH), 4:] = FORCE / 4
    model = ShellModel(plain, MEASURES["linear"], forces=plain.reduce(forces), thickness_strain="balanced")
    step = replace(model).linearise(np.zeros(plain.n_free))
    u = np.linalg.solve(step.tangent.toarray(), -step.residual)
    tip = float(np.mean(plain.cartesian(u), axis=0)[grid.on_line(0, LENGTH), 2].mean())
    assert uniform == pytest.approx(tip, rel=1e-9)
