"""Orders, limits and verdicts of sequences of meshes whose law is known."""

from __future__ import annotations

import math

import pytest

from studies.solving.refinement.richardson import SAME, MeshSequence, correction, limit_of, order_of

SIZES = (1.0, 0.5, 0.25)


@pytest.mark.parametrize("order", [1.0, 2.0, 3.5])
def test_correction_of_a_power_law(order: float) -> None:
    f = [7.0 + 0.3 * h**order for h in SIZES]
    assert f[-1] + correction(SIZES, f, order) == pytest.approx(7.0, abs=1e-12)


def test_orders_that_mean_nothing_are_not_given() -> None:
    assert math.isnan(order_of(SIZES, (1.0, 2.0, 1.5)))
    assert math.isnan(order_of(SIZES, (1.0, 2.0, 2.0)))
    assert math.isnan(order_of(SIZES, (1.0, 2.0, 4.0)))  # diverges
    assert math.isnan(order_of(SIZES, (1.0, 2.0, math.nan)))
    assert math.isnan(order_of(SIZES, (1.0, 1 + 2e-6, 1 + 3e-6)))  # nothing but what Newton leaves


def power_law(order: float, sizes: tuple[float, ...], limit: float = 7.0, c: float = 0.3) -> MeshSequence:
    return MeshSequence(sizes, tuple(limit + c * h**order for h in sizes))


@pytest.mark.parametrize("sizes", [(1.0, 0.5, 0.25), (1.0, 2 / 3, 1 / 3), (1.0, 0.6, 0.5)])
@pytest.mark.parametrize("order", [0.5, 1.0, 1.8, 2.0, 4.0])
def test_order_and_limit_through_meshes_of_any_sizes(order: float, sizes: tuple[float, ...]) -> None:
    s = power_law(order, sizes)
    assert order_of(s.sizes, s.values) == pytest.approx(order, rel=1e-8)
    assert s.limit == pytest.approx(7.0, rel=1e-10)
    assert s.asymptotic == (order in (1.8, 2.0))
    assert s.uncertainty == pytest.approx((1.25 if s.asymptotic else 3) * 0.3 * sizes[-1] ** order, rel=1e-6)


def test_order_is_that_of_the_last_three_meshes() -> None:
    """A fourth-order error that leads on coarse meshes and a second-order one that is left."""
    sizes = (1.0, 0.5, 0.25, 0.125, 0.0625)
    s = MeshSequence(sizes, tuple(7 + 10 * h**4 + h**2 for h in sizes))
    first, second, third = s.orders
    assert 4 > first > second > third > 2
    assert MeshSequence(sizes[:4], s.values[:4]).verdict == "not asymptotic: the orders differ"
    fine = MeshSequence(sizes, tuple(7 + 1e-6 * value for value in s.values))
    assert fine.verdict == "same on every mesh"
    assert fine.limit == fine.values[-1]


VERDICTS = {
    "asymptotic": power_law(1.4, (1, 0.5, 0.25, 0.125)).values,
    "not asymptotic: no order": (1.0, 2.0, 1.5, 1.8),
    "not asymptotic: no order before the last": (2.0, 1.0, 1.5, 1.6),
    "not asymptotic: the orders differ": (0.0, 4.0, 5.0, 5.5),
    "same on the last three meshes": (1.1, 1.0 + 1e-6, 1.0, 1.0 + 4e-6),
    "same on every mesh": (1.0, 1.0 + 1e-7, 1.0, 1.0),
    "not solved on every mesh": (1.0, math.nan, 1.2, 1.25),
}


@pytest.mark.parametrize(("verdict", "values"), VERDICTS.items(), ids=list(VERDICTS))
def test_verdicts_of_four_meshes(verdict: str, values: tuple[float, ...]) -> None:
    s = MeshSequence((1.0, 0.5, 0.25, 0.125), values)
    assert s.verdict == verdict
    assert s.asymptotic is (verdict == "asymptotic" or verdict.startswith("same"))


def test_three_meshes_are_held_against_the_order_of_the_element() -> None:
    sizes = (1.0, 0.5, 0.25)
    assert power_law(2.2, sizes).verdict == "asymptotic"
    assert power_law(1.4, sizes).verdict == "not asymptotic: one order, not 2"


def test_a_limit_is_there_for_every_sequence_and_says_what_the_sequence_says() -> None:
    """Without an order the finest value stands for it, and three times what the last meshes are apart."""
    for values in VERDICTS.values():
        if not any(map(math.isnan, values)):
            sequence, actual = MeshSequence((1.0, 0.5, 0.25, 0.125), values), limit_of((1.0, 0.5, 0.25, 0.125), values)
            assert actual.asymptotic is sequence.asymptotic
            if math.isnan(sequence.limit):
                assert (actual.value, actual.uncertainty) == (values[-1], 3 * (max(values[-3:]) - min(values[-3:])))
            else:
                assert (actual.value, actual.uncertainty) == (sequence.limit, sequence.uncertainty)
    with pytest.raises(ValueError, match="a limit takes three"):
        limit_of((1, 0.5), (1.0, 1.0))


def test_what_is_the_same_on_every_mesh_is_as_uncertain_as_all_of_them() -> None:
    actual = MeshSequence((1.0, 0.5, 0.25, 0.125), (1 + 8e-6, 1 + 1e-6, 1.0, 1.0))
    assert (actual.verdict, actual.limit) == (SAME, 1.0)
    assert actual.uncertainty == pytest.approx(8e-6)
