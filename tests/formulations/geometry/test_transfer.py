"""Fields carried between grids: cubics exactly, circles closed, modes as derivatives."""

import numpy as np
import pytest

from formulations.geometry.grid import Grid
from formulations.geometry.quadtree import Quadtree
from formulations.geometry.transfer import Transfer

LINES = np.array([0.0, 0.1, 0.4, 0.5, 0.9, 1.0]), np.linspace(-1.0, 2.0, 8)
FINER = np.linspace(0.0, 1.0, 14), np.linspace(-1.0, 2.0, 10)
POWERS = ((0, 0), (1, 0), (0, 1), (1, 1))


def between(here: Grid, there: Grid) -> Transfer:
    found = Transfer.between(here, there)
    assert found is not None
    return found


def with_hanging_nodes() -> Grid:
    tree = Quadtree.over(*LINES)
    return tree.refined(np.arange(len(tree.leaves)) == len(tree.leaves) // 2).grid()


def cubic(x: np.ndarray) -> np.ndarray:
    return np.stack([x[:, 0] ** 3 - x[:, 1] ** 2 * x[:, 0], 2 + x[:, 1] ** 3], axis=1)


def test_cubics_are_carried_exactly() -> None:
    here, there = Grid.tensor(*LINES), Grid.tensor(*FINER)
    assert between(here, there).nodal(cubic(here.nodes)) == pytest.approx(cubic(there.nodes))


def test_a_grid_with_hanging_nodes_takes_them_too() -> None:
    here, there = Grid.tensor(*LINES), with_hanging_nodes()
    assert there.hanging is not None
    assert between(here, there).nodal(cubic(here.nodes)) == pytest.approx(cubic(there.nodes))


def test_the_same_grid_keeps_every_value() -> None:
    here, rng = Grid.tensor(*LINES), np.random.default_rng(3)
    values = rng.normal(size=(here.n_nodes, 6))
    assert between(here, here).nodal(values) == pytest.approx(values)
    modes = rng.normal(size=(len(here.elements), 4))
    assert between(here, here).modes(modes, POWERS) == pytest.approx(modes)


@pytest.mark.parametrize("degree", [1, 3])
def test_on_a_circle_the_error_falls_with_the_order_everywhere(degree: int) -> None:
    errors = []
    for n in (16, 32):
        lines = np.linspace(0, 1, 3), np.linspace(0, 2 * np.pi, n + 1)
        here = Grid.tensor(*lines, periodic=True)
        there = Grid.tensor(lines[0], np.linspace(0, 2 * np.pi, 3 * n + 1), periodic=True)
        carried = between(here, there).nodal(np.sin(here.nodes[:, 1]), degree)
        errors.append(np.abs(carried - np.sin(there.nodes[:, 1])).max())
    assert np.log2(errors[0] / errors[1]) == pytest.approx(degree + 1, abs=0.2)


def test_modes_of_a_bilinear_field_are_those_of_the_other_grid() -> None:
    def modes(grid: Grid) -> np.ndarray:
        """Of 1 + 2 x + 3 y + 4 x y in each element."""
        (x, y), (h, k) = grid.centre.T, grid.half.T
        return np.stack([1 + 2 * x + 3 * y + 4 * x * y, (2 + 4 * y) * h, (3 + 4 * x) * k, 4 * h * k], axis=1)

    here, there = Grid.tensor(*LINES), Grid.tensor(*FINER)
    assert between(here, there).modes(modes(here), POWERS) == pytest.approx(modes(there))


def test_grids_that_do_not_fit_have_no_transfer() -> None:
    here = Grid.tensor(*LINES)
    assert Transfer.between(here, Grid.tensor(LINES[0], 1.01 * LINES[1])) is None
    assert Transfer.between(here, Grid.tensor(*LINES, periodic=True)) is None
    assert Transfer.between(with_hanging_nodes(), here) is None


def test_one_element_along_a_coordinate_is_enough() -> None:
    here, there = Grid.tensor(np.array([0.0, 1.0]), FINER[1]), Grid.tensor(FINER[0], FINER[1])
    values = here.nodes[:, 0] + here.nodes[:, 1] ** 2
    assert between(here, there).nodal(values) == pytest.approx(there.nodes[:, 0] + there.nodes[:, 1] ** 2)
    modes = np.ones((len(here.elements), 1))
    assert between(here, there).modes(modes, ((0, 0),)) == pytest.approx(np.ones((len(there.elements), 1)))
