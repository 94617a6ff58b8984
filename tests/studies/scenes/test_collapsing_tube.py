"""The collapsing tube against the inextensible ring: buckled, touching, in point and in line contact."""

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import solve_bvp

from contact.algorithms.semismooth import Semismooth
from contact.continuation.stability import STABLE
from studies.scenes.closed_forms import collapsed_tube as ring
from studies.scenes.complete import complete
from studies.scenes.contact.collapsing_tube import LINE, LINE_FORCE, POINT, RADIUS, TOUCH, line_contact
from studies.scenes.walk import walk
from studies.solving.refinement.mesh_error import solve_with_error
from support.problems.solved import read, referenced, solved

SCENE, THIN = "collapsing-tube", "0.1"  # mm: h/R = 0.001
FORCES = 1e-8  # relative, of one exact algorithm to another
LOADS = "2,3,4,6"
LOAD = np.array([2.0, 3.0, 4.0, 6.0])
QUANTITIES = ("touch_pressure_EI_R3", "contact_force_EI_R2", "line_contact_pressure_EI_R3", "line_contact_force_EI_R2")


def exact() -> np.ndarray:
    return np.array([TOUCH, ring.pressed(3 * LOAD[-1]).force, LINE, LINE_FORCE])


def off(mesh: str, h: str) -> np.ndarray:
    """Relative, of the headline quantities at the last load."""
    solution = solved(SCENE, mesh, h_mm=h, load_fraction=LOADS)
    assert all(step["stability"]["word"] == STABLE for step in solution.steps)
    return np.array([solution.quantities[name] for name in QUANTITIES]) / exact() - 1


# --- the ring ---------------------------------------------------------------------------------------------------------


@pytest.mark.slow
def test_the_digits_of_the_scene_are_those_of_the_ring() -> None:
    touch, straight = ring.touch(), ring.straight()
    assert touch.pressure == pytest.approx(TOUCH, rel=1e-9)
    assert touch.curvature == pytest.approx(1, rel=1e-12)  # what it was at rest, the other way round
    assert (touch.half_width, touch.area / math.pi) == pytest.approx((1.369545759, 0.270947667), rel=2e-9)
    assert (straight.pressure, straight.force) == pytest.approx((LINE, LINE_FORCE), rel=1e-9)
    for load, force in POINT.items():
        assert ring.pressed(3 * load).force == pytest.approx(force, rel=1e-8)
    gaps = [ring.free(p).gap for p in (3.1, 3.3, 3.5, 3.7)]
    assert gaps == pytest.approx([0.783324, 0.612418, 0.495235, 0.402671], abs=6e-7)  # computed elsewhere
    for pressure, what in ((2.9, "free"), (5.3, "free"), (5.2, "in contact")):
        with pytest.raises(ValueError, match=f"no ring is {what}"):
            (ring.free if what == "free" else ring.pressed)(pressure)


def test_line_contact_is_similar_and_goes_over_from_the_point() -> None:
    """By collocation, with the length of the flat part and the force at its end for unknowns: no similarity."""
    p = 18.0

    def along(s: np.ndarray, state: np.ndarray, unknown: np.ndarray) -> np.ndarray:
        x, y, t, k = state
        length, force = unknown
        return length * np.array([np.cos(t), np.sin(t), k, -p * y * np.sin(t) - (p * x - force) * np.cos(t)])

    def ends(a: np.ndarray, b: np.ndarray, unknown: np.ndarray) -> np.ndarray:
        return np.array([*a, b[1], b[2] + np.pi / 2])

    s = np.linspace(0, 1, 41)
    t = np.pi * s * (1 - 1.5 * s)
    guess = np.array([1.4 * s, 0.5 * s * (1 - s), t, np.pi * (1 - 3 * s)])
    actual = solve_bvp(along, ends, s, guess, p=[1.3, 6.0], tol=1e-9, max_nodes=20000)
    assert actual.success
    pressed, (length, force) = ring.pressed(p), actual.p
    assert np.pi / 2 - length == pytest.approx(pressed.flat, rel=1e-7)
    assert 2 * (force + p * pressed.flat) == pytest.approx(pressed.force, rel=1e-7)
    below, above = (ring.pressed(LINE * (1 + sign * 1e-5)) for sign in (-1, 1))
    assert (above.force - below.force) == pytest.approx(2e-5 * LINE * 1.57, rel=0.05)  # and no jump


def test_what_forces_at_nodes_say_of_line_contact() -> None:
    """p on 0 < x < c and a force at c, in lumps; the crown has half of its own in a quarter."""
    p, c, force, n = 18.0, 0.25, 5.0, 100
    x = np.append(np.linspace(0, c, n + 1), 0.4)
    lumps = np.full(n + 2, p * c / n)
    lumps[[0, n]] /= 2
    lumps[n], lumps[-1] = lumps[n] + force, 0
    actual = line_contact(p, lumps, x)
    s = 1 - 2 * c / np.pi
    assert actual["flat_half_length"] == pytest.approx(c, rel=1e-12)
    assert actual["line_contact_pressure_EI_R3"] == pytest.approx(p * s**3, rel=1e-12)
    assert actual["line_contact_force_EI_R2"] == pytest.approx(2 * force * s**2, rel=1e-12)
    point = line_contact(6.0, np.array([1.0, 0.0]), x[:2])
    np.testing.assert_array_equal(list(point.values()), [2.0, 0.0, math.nan, math.nan])


def test_no_limit_is_stated_of_a_line_where_a_point_touches() -> None:
    """At 3.5 a flat part has begun, which 1x64 does not see: 1x1024 has 10.32 and 7.93."""
    solution = solve_with_error(*complete(SCENE, {"h_mm": "1", "load_fraction": "3.5"}, "1x64"))
    assert solution.quantities["flat_half_length"] == 0.0
    assert {"touch_pressure_EI_R3", "contact_force_EI_R2"} == set(solution.errors)


# --- the shell --------------------------------------------------------------------------------------------------------


def test_the_tube_buckles_at_three_and_comes_down_as_the_ring() -> None:
    """The pressure at four gaps, of the path to touch; the first state is found from the mode of buckling."""
    scene, request = complete(SCENE, {"h_mm": THIN}, "1x64")
    pressures = (3.02, 3.1, 3.3, 3.7)
    closing, _ = scene.build(request).stages()
    stage = replace(closing, targets=tuple(1 - ring.free(p).gap for p in pressures))
    actual = list(walk([stage], Semismooth()))
    assert all(each.converged for each in actual)
    assert [3 * each.point.solution.u[-1] / RADIUS for each in actual] == pytest.approx(pressures, rel=2e-3)


@pytest.mark.slow
def test_errors_fall_with_the_square_of_the_elements() -> None:
    """1x32 and 1x64 at h/R = 0.001: 0.6 to 3.4 % and 0.04 to 0.4 %."""
    coarse, fine = (np.abs(off(mesh, THIN)) for mesh in ("1x32", "1x64"))
    assert np.all(coarse > 3.5 * fine)
    assert np.all(fine < 4e-3)


@pytest.mark.slow
def test_load_steps_change_nothing() -> None:
    """Not even the first ones, on the way from touch: no pressure below that is on the path."""
    once, often = (read(solved(SCENE, "1x16", steps=steps), "contact_force_EI_R2") for steps in (1, 3))
    np.testing.assert_allclose(once, often, rtol=FORCES)


@pytest.mark.slow
@pytest.mark.parametrize("h", ["1", THIN])
def test_touch_point_and_line_contact_are_those_of_the_ring(h: str) -> None:
    """To 0.1 % and what the thickness makes of it: three times as much of a force that has only begun."""
    of_thickness = (float(h) / RADIUS) ** 2
    assert np.all(np.abs(off("1x256", h)) < 1e-3 + 12 * of_thickness)
    solution = solved(SCENE, "1x256", h_mm=h, load_fraction=LOADS)
    forces = [ring.pressed(3 * load).force for load in LOAD]
    np.testing.assert_allclose(read(solution, "contact_force_EI_R2"), forces, rtol=1e-3 + 35 * of_thickness)
    similar = np.array([[step[name] for name in QUANTITIES[2:]] for step in solution.steps[2:]])  # on two loads
    np.testing.assert_allclose(similar[0], similar[1], rtol=1e-3)
    known = referenced(SCENE, "exact", "line_contact_pressure_EI_R3", h_mm=float(h), measure="exact", load_fraction=6.0)
    assert known == pytest.approx([LINE])


@pytest.mark.slow
def test_the_thickness_counts_by_its_square() -> None:
    """On one mesh: touch falls by about 4, p_line by about 11 (h/R)^2 of it."""
    actual = np.array([off("1x128", h) for h in ("2", "4", "8")])
    first, second = np.diff(actual, axis=0)
    np.testing.assert_allclose(second[[0, 2]] / first[[0, 2]], 4, rtol=0.1)
    assert first[[0, 2]] / 12e-4 == pytest.approx([-4.1, -11.0], rel=0.15)
