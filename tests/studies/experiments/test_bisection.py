"""Boundaries on synthetic maps: found to the point for a part of the points, and honest when they are not.

Limits: the first failure on the way, what is right before it, and the closed forms that say so.
"""

import math
from itertools import product

import numpy as np
import pytest
from scipy.integrate import quad

from studies.experiments import extreme_limits as limits
from studies.experiments.bisection import Located, distance, edges, locate
from studies.experiments.extreme_limits import ALGORITHM, LIMITS, MEASURE, RESOLUTION, limits_table, search
from studies.experiments.extremes import CONVERGED, FAILED, REFUSED, Found
from studies.scenes.closed_forms.contact import flattened_ring, pinched_ring
from studies.scenes.complete import Cell
from studies.scenes.complete import complete as resolve

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
        actual, calls = asked(classes)
        assert actual.asked.mean() <= 0.4, name
        assert len(calls) == len(set(calls)) == actual.asked.sum(), name
        np.testing.assert_array_equal(actual.classes, classes, name)


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
        actual = locate(lambda i, j: "a" if t[i] + 0.8 * t[j] < 0.83 else "b", (n, n), (n - 1) // 4)
        return int(actual.asked.sum())

    coarse, fine, finest = (cost(n) for n in (33, 65, 129))
    assert finest - fine < 2.6 * (fine - coarse)
    assert finest < 0.06 * 129**2


def test_rows_that_are_apart_are_searched_each_by_itself() -> None:
    ends = [0.31, 0.92, 0.05, 2.0]
    classes = np.array([np.where(np.linspace(0, 1, 65) < end, "a", "b") for end in ends])
    actual = locate(lambda i, j: str(classes[i, j]), classes.shape, 16, rows_apart=True)
    assert actual.asked.mean() <= 0.25
    np.testing.assert_array_equal(actual.classes, classes)


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


def test_a_limit_is_between_the_last_success_and_the_first_failure() -> None:
    for limit, (start, bound) in product((3e-5, 0.2, 0.999), ((1.0, 1e-6), (1e-6, 1.0))):
        last, fails = search(lambda value, limit=limit, up=start < bound: (value < limit) == up, start, bound)
        assert min(last, fails) <= limit <= max(last, fails)
        assert max(fails / last, last / fails) <= RESOLUTION
    last, fails = search(lambda value: not 20 < value < 900, 1.0, 1e6)  # and not a failure behind the first
    assert last <= 20 < fails < 900


def test_a_way_without_failure_ends_at_its_bound_and_one_without_success_at_its_start() -> None:
    asked: list[float] = []
    assert search(lambda value: bool(asked.append(value)) or True, 2.0, 50.0) == (50.0, None)
    assert asked == pytest.approx(np.geomspace(2, 50, limits.SCAN + 1))
    assert search(lambda value: False, 2.0, 50.0) == (None, 2.0)


def made_up(cell: Cell, smallest: float) -> Found:
    """Rings thinner than 0.1 mm are lost, from 0.3 mm on they are 5 % off."""
    if "epsilon" in cell.settings:
        return Found(REFUSED, "it is made up")
    h, travel = float(cell.settings.get("h_mm", 1)), float(cell.settings.get("delta_mm", 0)) / 100
    if h < 0.1:
        return Found(FAILED, "too thin")
    load = pinched_ring(travel) if travel < 0.1 else flattened_ring(1 - travel)[0]
    seen = {"P_R2_over_EI": load * (1.05 if h < 0.3 else 1.002), "w_bar": 1.0, "force_N": 2.0}
    return Found(CONVERGED, "", {**seen, "tip_shortening_mm": 0.0, "tip_deflection_mm": 0.0})


def test_a_row_tells_what_is_certified_from_what_is_right() -> None:
    table = limits_table(("exact",), ("qp",), made_up).set_index(["part", "limit"])
    assert len(table) == len(LIMITS[MEASURE]) + len(LIMITS[ALGORITHM])
    for part in (MEASURE, ALGORITHM):
        thin, soft, far = (table.loc[part, name] for name in ("thinnest shell", "stiffest ε", "largest travel"))
        assert thin["fails"] < 1e-3 <= thin["value"] <= 1e-3 * RESOLUTION
        assert 3e-3 <= thin["right"] <= 3e-3 * RESOLUTION
        assert thin[["error", "error_ordinary"]].tolist() == pytest.approx([0.05, 0.002])
        assert (thin["kind"], thin["reason"], thin["bound"]) == (FAILED, "too thin", False)
        assert math.isnan(soft["value"])
        assert (soft["kind"], soft["fails"]) == (REFUSED, 1e4)
        assert far["bound"]
        assert far[["value", "right"]].tolist() == [80.0, 80.0]
    fibres = table.loc[ALGORITHM, "largest ratio of moduli"]
    assert fibres["error"] == 0  # the other route gives the same
    assert fibres["command"].startswith(
        "footprint solve panel --mesh 4x4 --measure exact --contact qp --set gamma_deg=30"
    )


def test_both_ends_of_every_way_are_valid_requests() -> None:
    for limit in (*LIMITS[MEASURE], *LIMITS[ALGORITHM]):
        for value in (limit.start, limit.bound):
            cell = limit.cell("exact", limit.contact, value)
            resolve(cell.scene, cell.settings, **cell.options)


def test_the_pinched_ring_is_that_of_castigliano() -> None:
    """A quarter under P/2 = 1 with R = EI = 1: the moment at the load turns nothing, and the force does the work."""

    def moment(t: float, at_load: float) -> float:
        return at_load - math.sin(t)

    at_load = quad(math.sin, 0, math.pi / 2)[0] / (math.pi / 2)
    travel = quad(lambda t: moment(t, at_load) * -math.sin(t), 0, math.pi / 2)[0]
    assert pinched_ring(travel) == pytest.approx(2.0, rel=1e-12)


@pytest.mark.slow
def test_what_the_exact_measure_reaches() -> None:
    """Against closed forms; the bounds are looser than the limits, which rounding and the algorithms decide."""
    table = limits_table(("exact",), ()).set_index("limit")
    assert (table["error_ordinary"] < 0.005).all()
    assert table.loc["thinnest shell", "right"] < 2e-3
    assert table.loc["largest rotation in one step", "right"] > 180
    assert table.loc["smallest travel", "right"] <= 1e-8
    assert table.loc["largest travel", "right"] == 80
    assert table.loc["stiffest ε", "right"] >= 1e14
    assert table.loc["largest ratio of moduli", "right"] > 1000
