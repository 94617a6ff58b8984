"""What the pages compute from numbers: comparisons, printed patches, orders, formats, crossings."""

from __future__ import annotations

import math

import numpy as np
import pandas as pd
import pytest

from reports.chapters.shells.measures import crossing
from reports.chapters.tyre.paper_table import FILE, HALF, IMAGES, LITERAL, asymmetry, compare, core, force, printed_map
from reports.compare import differences, same_number
from reports.markdown import NOTHING, digits, fixed, machine, percent, prose, scientific
from reports.orders import MeshSequence, extrapolated, fitted_order, order_against, self_order
from studies.scenes.data import read_reference

TYRE_SETTINGS = {"R1_mm": 50.0, "R0_mm": 250.0, "plies": 4, "ply_thickness_mm": 1.2}


@pytest.mark.parametrize(
    ("a", "b", "same"),
    [
        ("12.34", "12.35", True),
        ("12.34", "12.36", False),
        ("211", "212", False),
        ("211", "211", True),
        ("1959.049892", "1959.049999", True),
        ("1959.049892", "1959.149892", False),
        ("3.0e-13", "7.1e-09", True),
        ("0", "7.1e-09", True),
        ("0", "0.3", False),
        ("3.0e-13", "2.0e-08", False),
        ("-8.02e-07", "-8.03e-07", True),
        ("-8.02e-07", "+8.02e-07", False),
    ],
)
def test_numbers_agree_to_their_last_digit(a: str, b: str, same: bool) -> None:
    assert same_number(a, b) is same


def test_inserted_and_lost_lines_are_differences_of_their_own() -> None:
    assert len(differences("p.md", "a 1\nb 2\n", "a 1\nnew\nb 2\n")) == 1
    assert differences("p.md", "a 1\nb 2\n", "b 2\n") == ["p.md:1: committed 'a 1', regenerated ''"]
    assert differences("p.md", f"x\n{machine('9 s')}\ny 1", f"x\n{machine('8 s')}\n\ny 1") != []
    assert differences("p.md", f"x\n{machine('9 s')}", "x") != []


def hand_made() -> tuple[pd.DataFrame, pd.DataFrame]:
    """Printed: 7 x 7 of 1 MPa without a corner; ours: 1.1 MPa without a core node and without row 15."""
    angles = np.arange(-15.0, 16.0, 5.0)
    printed = pd.DataFrame(1.0, index=pd.Index(angles), columns=pd.Index(angles))
    ours = 1.1 * printed
    printed.iloc[0, 0] = np.nan
    ours.iloc[2, 2] = np.nan
    ours.iloc[6] = np.nan
    return ours, printed


def test_comparison_of_two_patches_by_hand() -> None:
    ours, printed = hand_made()
    c = compare(ours, printed)
    assert (c.printed_nodes, c.nodes, c.both) == (48, 41, 40)
    assert (c.symmetric_difference, c.outside) == (9, 8)
    assert c.core_nodes == 8  # 3 x 3 in the middle of 7 x 7, less the one that is not in ours
    assert c.core_rms == pytest.approx(0.1, rel=1e-12)
    assert (c.centre, c.printed_centre) == (1.1, 1.0)


def test_core_keeps_its_distance_along_both_directions() -> None:
    patch = np.ones((7, 7), bool)
    assert core(patch).sum() == 9
    patch[3, 0] = False
    assert core(patch).sum() == 8
    assert not core(patch)[3, 2]
    assert core(patch)[2, 2]
    assert core(np.ones((4, 9), bool)).sum() == 0


def test_force_is_pressure_times_mid_surface_area() -> None:
    _, printed = hand_made()
    psi = np.deg2rad(np.asarray(printed.columns, dtype=float))
    r = 200.0 + 52.4 * np.cos(psi)  # mid-surface, 2.4 mm outside the inner face
    areas = np.deg2rad(5.0) * np.deg2rad(2.5) * 52.4 * r
    expected = 7 * areas.sum() - areas[0]  # one corner is blank
    assert force(printed, HALF, TYRE_SETTINGS) == pytest.approx(expected, rel=1e-12)


def test_symmetries_of_the_printed_table() -> None:
    printed = printed_map(read_reference(FILE))
    central, *mirrors = (asymmetry(printed, image) for image in IMAGES)
    assert central == (0.0, 0.0)
    for mirror in mirrors:
        assert mirror == pytest.approx((0.039, 0.039), abs=1e-12)
    patch = printed.notna().to_numpy()
    assert patch.sum() == 277
    assert np.array_equal(patch, patch[::-1, ::-1])
    assert force(printed, LITERAL, TYRE_SETTINGS) == pytest.approx(2 * force(printed, HALF, TYRE_SETTINGS))


def test_asymmetry_counts_blanks_as_zero_or_leaves_them_out() -> None:
    p = pd.DataFrame([[np.nan, 2.0, 3.0], [1.0, 2.0, 1.5]], index=[-1.0, 1.0], columns=[-1.0, 0.0, 1.0])
    image = next(name for name in IMAGES if "p(-psi, phi)" in name)
    assert asymmetry(p, image) == (3.0, 0.5)


@pytest.mark.parametrize("order", [1.0, 2.0, 3.5])
def test_orders_and_limit_of_a_power_law(order: float) -> None:
    f = [7.0 + 0.3 * h**order for h in (1.0, 0.5, 0.25)]
    assert order_against(f[0], f[1], 7.0) == pytest.approx(order, abs=1e-10)
    assert self_order(*f) == pytest.approx(order, abs=1e-10)
    assert extrapolated(*f) == pytest.approx(7.0, abs=1e-12)


def test_orders_that_mean_nothing_are_not_given() -> None:
    assert order_against(1.2, 0.9, 1.0) is None  # the error changes its sign
    assert order_against(1.2, 1.01, 1.0, noise=0.05) is None  # below the error of the reference
    assert self_order(1.0, 2.0, 1.5) is None
    assert self_order(1.0, 2.0, 2.0) is None
    assert extrapolated(1.0, 2.0, 4.0) is None  # diverges


def power_law(order: float, sizes: tuple[float, ...], limit: float = 7.0, c: float = 0.3) -> MeshSequence:
    return MeshSequence(sizes, tuple(limit + c * h**order for h in sizes))


@pytest.mark.parametrize("sizes", [(1.0, 0.5, 0.25), (1.0, 2 / 3, 1 / 3), (1.0, 0.6, 0.5)])
@pytest.mark.parametrize("order", [0.5, 1.0, 2.0, 3.5])
def test_order_and_limit_through_meshes_of_any_sizes(order: float, sizes: tuple[float, ...]) -> None:
    s = power_law(order, sizes)
    assert fitted_order(s.sizes, s.values) == pytest.approx(order, abs=1e-6)
    assert s.limit == pytest.approx(7.0, abs=1e-8)


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
    "same on every mesh": (1.0, 1.0 + 1e-7, 1.0, 1.0),
    "not solved on every mesh": (1.0, math.nan, 1.2, 1.25),
}


@pytest.mark.parametrize(("verdict", "values"), VERDICTS.items(), ids=list(VERDICTS))
def test_verdicts_of_four_meshes(verdict: str, values: tuple[float, ...]) -> None:
    s = MeshSequence((1.0, 0.5, 0.25, 0.125), values)
    assert s.verdict == verdict
    assert s.asymptotic is (verdict in ("asymptotic", "same on every mesh"))


def test_three_meshes_are_held_against_the_order_of_the_element() -> None:
    sizes = (1.0, 0.5, 0.25)
    assert power_law(2.2, sizes).verdict == "asymptotic"
    assert power_law(1.4, sizes).verdict == "not asymptotic: one order, not 2"


def test_uncertainty_of_the_limit_is_larger_outside_the_asymptotic_range() -> None:
    good, poor = power_law(2.0, (1.0, 0.5, 0.25)), power_law(1.0, (1.0, 0.5, 0.25))
    assert good.uncertainty == pytest.approx(1.25 * abs(good.values[-1] - 7.0))
    assert poor.uncertainty == pytest.approx(3.0 * abs(poor.values[-1] - 7.0))
    assert power_law(0.1, (1.0, 0.5, 0.25)).limit is None  # too slow to be extrapolated
    assert MeshSequence((1.0, 0.5, 0.25), (1.0, 2.0, 1.5)).uncertainty is None


def test_zero_has_no_sign_in_any_format() -> None:
    assert fixed(-0.0004, 2) == "0.00"
    assert fixed(-0.0004, 2, sign=True) == "0.00"
    assert percent(-1e-9) == "0.00 %"
    assert digits(-0.0, 3) == "0.00"
    assert scientific(-0.0) == "0"
    assert fixed(None, 2) == scientific(None) == percent(None) == "–"


def test_prose_joins_lines_but_not_items() -> None:
    assert prose("a\nb\n\n- c\n  d\n- e") == "a b\n\n- c d\n- e"


def test_the_load_from_which_an_error_stays_above_a_level() -> None:
    error = pd.DataFrame({"load": [1.0, 2.0, 3.0, 4.0], "a": [0.0, 0.02, 0.0, -0.02], "b": [0.02] * 4, "c": [0.0] * 4})
    assert crossing(error, "a", 0.01) == "3.50"  # the visit at 2 does not last
    assert crossing(error, "b", 0.01) == "below 1.00"
    assert crossing(error, "c", 0.01) == NOTHING
