"""Boundaries on synthetic maps: found to the point for a part of the points, and honest when they are not."""

import numpy as np
import pytest

from studies.experiments.bisection import Located, distance, edges, locate

N = 33
Y, X = np.meshgrid(np.linspace(0, 1, N), np.linspace(0, 1, N), indexing="ij")
MAPS: dict[str, np.ndarray] = {
    "straight": np.where(X < 0.37, "a", "b"),
    "slanted": np.where(0.6 * X + Y < 0.71, "a", "b"),
    "bulge": np.where((X - 1) ** 2 + (Y - 0.5) ** 2 < 0.3**2, "a", "b"),
    "island": np.where((X - 0.45) ** 2 + (Y - 0.55) ** 2 < 0.3**2, "a", "b"),
    "three classes": np.where(X < 0.4, "a", np.where(Y < 0.5 + 0.2 * X, "b", "c")),
    "wave": np.where(0.5 + 0.2 * np.sin(5 * X) > Y, "a", "b"),
    "corner": np.where((X < 0.2) & (Y < 0.2), "a", "b"),
    "one class": np.full(X.shape, "a"),
}


def asked(classes: np.ndarray, **options) -> tuple[Located, list[tuple[int, int]]]:
    calls: list[tuple[int, int]] = []

    def class_at(i: int, j: int) -> str:
        calls.append((i, j))
        return str(classes[i, j])

    return locate(class_at, classes.shape, 8, **options), calls


def test_a_boundary_is_found_to_the_point_for_a_part_of_the_points() -> None:
    for name, classes in MAPS.items():
        found, calls = asked(classes)
        assert found.asked.mean() <= 0.4, name
        assert len(calls) == len(set(calls)) == found.asked.sum(), name
        np.testing.assert_array_equal(found.classes, classes, name)


def test_a_point_away_from_all_boundaries_is_passed_by() -> None:
    """Which is why the size of the first blocks stands beside a map; one that touches a boundary is not."""
    island, pinned = MAPS["straight"].copy(), MAPS["straight"].copy()
    island[21, 27], pinned[21, 10] = "b" if island[21, 27] == "a" else "a", "b"
    assert np.argwhere(asked(island)[0].classes != island).tolist() == [[21, 27]]
    np.testing.assert_array_equal(asked(pinned)[0].classes, pinned)


def test_the_cost_is_that_of_the_boundary() -> None:
    """Twice as many points each way ask for twice as many, not four times."""

    def cost(n: int) -> int:
        t = np.linspace(0, 1, n)
        found = locate(lambda i, j: "a" if t[i] + 0.8 * t[j] < 0.83 else "b", (n, n), (n - 1) // 4)
        return int(found.asked.sum())

    coarse, fine, finest = (cost(n) for n in (33, 65, 129))
    assert finest - fine < 2.6 * (fine - coarse)
    assert finest < 0.06 * 129**2


def test_rows_that_are_apart_are_searched_each_by_itself() -> None:
    ends = [0.31, 0.92, 0.05, 2.0]
    classes = np.array([np.where(np.linspace(0, 1, 65) < end, "a", "b") for end in ends])
    found = locate(lambda i, j: str(classes[i, j]), classes.shape, 16, rows_apart=True)
    assert found.asked.mean() <= 0.25
    np.testing.assert_array_equal(found.classes, classes)


def test_distances_of_boundaries() -> None:
    a, b = MAPS["straight"], np.roll(MAPS["straight"], 3, axis=1)
    b[:, :3] = "a"
    assert distance(a, a) == 0
    assert distance(a, b) == 3
    assert distance(a, MAPS["one class"]) == np.inf
    assert distance(MAPS["one class"], MAPS["one class"]) == 0
    rows = np.array([["a", "b", "b"], ["a", "a", "b"]])
    other = np.array([["a", "b", "b"], ["a", "b", "b"]])
    assert distance(rows, other, rows_apart=True) == 1
    np.testing.assert_array_equal(edges(rows, rows_apart=True), [[0, 0.5], [1, 1.5]])
    assert len(edges(rows)) == 3


def test_blocks_must_divide_the_grid() -> None:
    with pytest.raises(ValueError, match="blocks of 8 do not divide a grid of 32 x 33 points"):
        asked(np.full((32, 33), "a"))
