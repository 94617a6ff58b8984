"""Limits of ladders of grids: sequences of a known order, with and without scatter, and what says nothing."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from studies.solving.refinement.limits import FEW, GROWING, NARROW, SAFETY, Estimate, Seen, estimate_of, three_of


def ladder(order: float, count: int = 5, factor: float = 2.0, scatter: float = 0.0, seed: int = 0) -> list[Seen]:
    """100 + 8 h^order (1 + scatter) from h = 1 on."""
    rng = np.random.default_rng(seed)
    sizes = [factor**-k for k in range(count)]
    return [Seen(h, 100 + 8 * h**order * (1 + scatter * rng.normal())) for h in sizes]


def known(*asked: object, **more: object) -> Estimate:
    actual = estimate_of(*asked, **more)
    assert isinstance(actual, Estimate)
    return actual


@pytest.mark.parametrize("touching", [False, True])
@pytest.mark.parametrize("order", [1.0, 1.5, 2.0, 3.0, 4.0])
def test_the_limit_of_any_order_lies_inside(order: float, touching: bool) -> None:
    for count in (3, 4, 5):
        actual = known(ladder(order, count), touching=touching)
        assert abs(actual.limit - 100) <= actual.uncertainty * abs(actual.limit)


@pytest.mark.parametrize(("count", "share"), [(3, 1.0), (4, 0.25), (5, 0.25)])
def test_a_smooth_sequence_of_the_order_two_is_known_to_a_part_of_its_correction(count: int, share: float) -> None:
    """Of three grids the coarsest has often no order yet: they are not that sure."""
    grids = ladder(2.0, count)
    actual = known(grids)
    assert actual.limit == pytest.approx(100)
    assert actual.uncertainty * 100 == pytest.approx(share * (grids[-1].value - 100))
    assert actual.error * 100 == pytest.approx(grids[-1].value - 100)


@pytest.mark.parametrize(("order", "wide"), [(1.0, 4), (1.5, 4), (2.0, 6)])
def test_scatter_about_an_order_makes_the_interval_as_wide(order: float, wide: float) -> None:
    """In contact: at least nineteen of twenty hold, on ladders whose errors scatter by a third of themselves.

    wide: what half of them are narrower than, over the error of the last grid.
    """
    inside, widths = 0, []
    for seed in range(200):
        actual = known(ladder(order, 5, math.sqrt(2), 1 / 3, seed), touching=True)
        inside += abs(actual.limit - 100) <= actual.uncertainty * abs(actual.limit)
        widths.append(actual.uncertainty)
    assert inside >= 190
    assert np.median(widths) < wide * 8 * math.sqrt(2) ** (-4 * order) / 100


def test_differences_that_change_their_sign_are_a_bound() -> None:
    actual = known([Seen(4, 101.0), Seen(2, 99.0), Seen(1, 100.0)])
    assert actual.uncertainty * actual.limit >= 1.0


def test_small_differences_that_grow_make_the_interval_wide() -> None:
    actual = known([Seen(4, 100.0), Seen(2, 100.1), Seen(1, 101.0)])
    assert actual.uncertainty * actual.limit >= SAFETY * 0.9


def test_large_differences_that_grow_and_gaps_say_nothing() -> None:
    assert estimate_of([Seen(4, 1.0), Seen(2, 2.0), Seen(1, 4.0)]) == GROWING
    assert estimate_of([Seen(4, 1.0), Seen(2, math.nan), Seen(1, 1.0)]) == GROWING
    assert estimate_of([Seen(k, math.nan) for k in (8, 4, 2, 1)], touching=True) == GROWING
    assert estimate_of([Seen(2, 1.0), Seen(1, 1.0)]) == FEW


@pytest.mark.parametrize("count", [4, 5])
def test_large_differences_that_grow_say_nothing_of_contact_on_any_number_of_grids(count: int) -> None:
    """The force on the clamped panel, pressed by a plane: it grows on, to twice and four times as much."""
    force = {7: 81.95, 10: 147.23, 14: 273.51, 20: 504.11, 28: 851.51}
    grids = [Seen(1 / n, value) for n, value in force.items()]
    assert estimate_of(grids[-count:], touching=True) == GROWING


def test_three_grids_are_each_about_twice_as_coarse_as_the_next() -> None:
    sizes = [math.sqrt(2) ** -k for k in range(6)]
    actual = three_of([Seen(h, 0.0) for h in sizes])
    assert actual is not None
    assert [each.size for each in actual] == pytest.approx([sizes[1], sizes[3], sizes[5]])


def test_a_quantity_that_is_nothing_has_a_limit() -> None:
    actual = known([Seen(h, 0.0) for h in (4, 2, 1)])
    assert (actual.limit, actual.error) == (0.0, 0.0)
    assert actual.interval == {"low": 0.0, "high": 0.0}


def test_three_grids_in_contact_are_guarded_by_their_largest_difference() -> None:
    grids = ladder(2.0, 3)
    assert known(grids, touching=True).uncertainty * 100 == pytest.approx(grids[0].value - grids[1].value)


def test_what_falls_faster_than_the_order_two_is_bound_by_the_order_one() -> None:
    """Where elements lock on coarse grids; not where a difference has another sign, which is luck as well."""
    values = (20.0, 80.0, 98.0, 99.6)
    sizes = [2.0**-k for k in range(4)]
    actual = known(list(map(Seen, sizes, values)))
    assert actual.limit == pytest.approx(99.6 + 1.6 / 3)
    assert actual.uncertainty * actual.limit == pytest.approx(1.6 * (1 - 1 / 3))
    turned = known(list(map(Seen, sizes, (99.0, *values[1:]))))
    assert turned.uncertainty * turned.limit == pytest.approx(SAFETY * (98 + 18 / 3 - actual.limit))


def test_one_ratio_of_the_order_two_is_not_enough_to_be_sure() -> None:
    """The last three grids are those of errors of h^2; the one before says another limit."""
    sizes = [math.sqrt(2.0) ** -k for k in range(6)]
    exact = [Seen(h, 100 + 8 * h**2) for h in sizes]
    off = [replace(each, value=each.value + (k == 4)) for k, each in enumerate(exact)]
    sure, unsure = known(exact), known(off)
    correction = abs(exact[-1].value - 100)
    assert sure.uncertainty * sure.limit == pytest.approx(0.25 * correction)
    assert unsure.uncertainty * unsure.limit >= 0.99 * correction


def test_a_limit_takes_the_grid_before_to_have_had_one() -> None:
    """Deflection of the hemisphere by Sanders at 0.8 of the load: 3.67 at 23 elements, 4.39 at 64, growing."""
    value = {4: 4.634, 6: 4.598, 8: 4.225, 11: 3.959, 16: 3.709, 23: 3.668, 32: 3.828}
    grids = [Seen(1 / n, each) for n, each in value.items()]
    assert estimate_of(grids[:-1]) == GROWING
    assert estimate_of(grids) == GROWING


def test_a_limit_in_contact_is_not_better_known_than_its_rim() -> None:
    """Edge pressure of a strip, which is 889.2 on 1024 elements."""
    grids = [Seen(1 / n, each) for n, each in ((16, 889.854), (32, 889.843), (64, 889.866))]
    assert known(grids, touching=True).uncertainty < 1e-4
    assert known(grids, touching=True, rim=0.7).uncertainty * 889.9 == pytest.approx(0.7, rel=1e-3)
    assert estimate_of(grids, touching=True, rim=math.inf) == NARROW


def test_three_grids_in_contact_below_the_order_one_are_bound_by_what_is_to_come() -> None:
    """Lift of a heavy strip, 1.474 on 256 elements, where it falls on by more than a hundredth a halving."""
    lift = known(list(map(Seen, (4, 2, 1), (1.79541, 1.6943, 1.60016))), touching=True)
    assert lift.interval["low"] < 1.39
