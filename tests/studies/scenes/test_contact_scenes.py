"""Contact through the shell element against closed forms of beam, plate and elastica: errors on three meshes, rates."""

import math

import numpy as np
import pytest

from contact.catalogue import ALGORITHMS
from studies.scenes.closed_forms.contact import flattened_ring, lifted_strip, plate_contact, strip_contact
from studies.scenes.complete import complete as resolve
from studies.scenes.contact.strip import contact_edge
from studies.scenes.data import read_reference
from studies.solving.result import CONVERGED, Result
from studies.solving.solve import solve
from support.problems.differences import fitted_order

DIGITS = 6e-7  # of the tables, relative: they have eight
GAP = 1e-12  # mm
COMPLEMENTARITY = 1e-9  # MPa mm, the judge's own bound


def solved(scene: str, mesh: str, measure: str = "linear", **settings: str) -> Result:
    result = solve(*resolve(scene, settings, mesh, measure=measure))
    assert result.outcome.converged
    for step in result.steps:
        kkt = step["kkt"]
        assert kkt["equilibrium"] <= max(1e-8, step["rounding"])
        assert kkt["penetration"] <= GAP
        assert kkt["tension"] == 0
        assert kkt["complementarity"] <= COMPLEMENTARITY
    return result


def errors(scene: str, meshes: tuple[str, ...], exact: dict[str, float], **settings: str) -> dict[str, list[float]]:
    """Relative errors of the last step, mesh by mesh."""
    last = [solved(scene, mesh, **settings).steps[-1] for mesh in meshes]
    return {name: [abs(step[name] / value - 1) for step in last] for name, value in exact.items()}


# --- the closed forms themselves --------------------------------------------------------------------------------


def test_strip_agrees_with_the_table() -> None:
    rows = read_reference("contact_clamped_strip_flat_obstacle.csv").to_numpy()
    compared = 0
    for lam, ratio, length, edge_force, edge_pressure, half_force in rows:
        q = 24 * ratio
        if lam == 0 and ratio <= 3:  # a point, not a zone
            with pytest.raises(ValueError, match="contact zone"):
                strip_contact(q, 0.0)
            continue
        actual = strip_contact(q, lam)
        assert actual.free_length == pytest.approx(length, rel=DIGITS)
        assert actual.half_force == pytest.approx(half_force, rel=DIGITS)
        assert actual.half_force == pytest.approx(q * (1 - length) + edge_force, rel=DIGITS)
        if lam > 0:
            assert actual.edge_pressure == pytest.approx(float(edge_pressure), rel=DIGITS)
        compared += 1
    assert compared == 36


def test_shear_vanishes_continuously() -> None:
    """Timoshenko's strip tends to Euler and Bernoulli's with the order of lam, its force with lam^2."""
    thin = strip_contact(120.0, 0.0)
    off = [strip_contact(120.0, lam) for lam in (0.02, 0.01, 0.005)]
    np.testing.assert_allclose([x.free_length - thin.free_length for x in off], [-0.0216, -0.0104, -0.0051], atol=3e-4)
    forces = [x.half_force - thin.half_force for x in off]
    np.testing.assert_allclose([forces[0] / forces[1], forces[1] / forces[2]], 4, rtol=0.05)


@pytest.mark.parametrize(
    ("lam", "length", "force"), [(0.0, 2.21336, 1.10668), (0.2, 2.00608, 1.09397), (0.5, 1.68598, 1.03581)]
)
def test_lifted_strip_agrees_with_the_reference_sheet(lam, length, force) -> None:
    assert lifted_strip(lam) == (pytest.approx(length, abs=5e-6), pytest.approx(force, abs=5e-6))


def test_plate_agrees_with_the_table() -> None:
    rows = read_reference("contact_clamped_circular_plate_flat_obstacle.csv").to_numpy()
    assert len(rows) == 11
    for radius, load, line_force, force in rows:
        actual = plate_contact(load)
        assert actual == (pytest.approx(radius, rel=DIGITS), pytest.approx(force, rel=DIGITS))
        assert actual[1] == pytest.approx(np.pi * load * radius**2 + 2 * np.pi * radius * line_force, rel=DIGITS)
    with pytest.raises(ValueError, match="64"):
        plate_contact(64.0)


def test_ring_agrees_with_the_table() -> None:
    table = read_reference("contact_ring_between_rigid_plates_elastica.csv")
    flat = table[table["H_over_2R[-]"] <= 0.7].to_numpy()
    assert len(flat) == 13
    for load, height, _, length, _ in flat:
        actual = flattened_ring(height)
        assert actual == (pytest.approx(load, rel=DIGITS), pytest.approx(length, abs=DIGITS))
        assert actual[0] * (2 * height) ** 2 == pytest.approx(5.742160, abs=1e-6)
    with pytest.raises(ValueError, match=r"0\.717770"):
        flattened_ring(0.72)


def test_edge_of_the_contact_from_lumped_pressures() -> None:
    """A linear pressure from any place between two nodes: the first node has the share of its width that touches."""
    x = np.linspace(0, 1, 11)
    for begins in (0.37, 0.41, 0.449):
        pressure = np.where(x > begins, 5 - 2 * (x - begins), 0.0)
        first = int(np.argmax(x >= begins - 0.05))
        pressure[first] = (5 - 2 * (x[first] - begins)) * (x[first] + 0.05 - begins) / 0.1
        assert contact_edge(x, pressure) == (pytest.approx(begins, abs=1e-12), pytest.approx(5.0, abs=1e-12))
    assert all(math.isnan(value) for value in contact_edge(x, np.where(x > 0.85, 1.0, 0.0)))


# --- strips -----------------------------------------------------------------------------------------------------

STRIP = ("32x1", "64x1", "128x1")
SIZES = (4.0, 2.0, 1.0)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("lam", "ratio"),
    [(0.1, 5.0), (0.05, 10.0), (0.2, 2.0)],
)
def test_clamped_strip_converges_to_timoshenko(lam, ratio) -> None:
    exact = strip_contact(24 * ratio, lam)
    values = {name: getattr(exact, name) for name in ("half_force", "free_length", "edge_pressure")}
    actual = errors("strip-contact", STRIP, values, lam_over_a=f"{lam}", load_fraction=f"{ratio}")
    assert fitted_order(SIZES, actual["half_force"]) >= 1.5
    assert actual["half_force"][-1] <= 1e-4
    within = np.array(actual["free_length"]) * exact.free_length * [32, 64, 128]  # elements: no rate, the edge wanders
    assert np.max(within) <= 0.1
    layer = 1 / (lam * np.array([32, 64, 128]))  # element over boundary layer
    assert np.all(np.array(actual["edge_pressure"]) <= layer**2)


def test_clamped_strip_without_shear_is_euler_bernoullis() -> None:
    for ratio in ("5", "20"):
        exact = {"half_force": strip_contact(24 * float(ratio), 0.0).half_force}
        settings = {"lam_over_a": "0.001", "load_fraction": ratio}
        actual = errors("strip-contact", ("16x1", "32x1", "64x1"), exact, **settings)
        assert fitted_order(SIZES, actual["half_force"]) >= 1.4
        assert actual["half_force"][-1] <= 3e-4


def test_without_shear_the_edge_force_stands_where_contact_begins() -> None:
    """q l/3 on the two or three nodes around l, beside which a node carries q times its width."""
    result = solved("strip-contact", "64x1", lam_over_a="0.001", load_fraction="5")
    exact = strip_contact(120.0, 0.0)
    force = result.last.pressure[::2]  # one side of the strip, all widths alike but the last
    x = np.arange(1, 65) / 64
    near = np.abs(x - exact.free_length) <= 2 / 64
    unit = force[(x > 0.95) & (x < 0.99)].mean()  # q
    assert (force[near].sum() / unit - near[x > exact.free_length].sum()) / 64 == pytest.approx(
        exact.free_length / 3, rel=0.05
    )


def test_a_strip_with_shear_touches_in_a_zone_one_without_in_a_point() -> None:
    """First at q = g/(a^4/24 D + a^2 lam^2/2 D); up to 3 q0 Euler and Bernoulli's strip has F = q a - 24 D g/a^3."""
    first = 1 / (1 + 12 * 0.1**2)  # over 24 D g/a^4
    soft = solved("strip-contact", "64x1", load_fraction=f"{0.99 * first},{1.01 * first},2").steps
    assert [step["contact_nodes"] for step in soft] == [0, 2, 10]  # rows of two nodes
    assert soft[0]["half_force"] == 0
    stiff = solved("strip-contact", "64x1", load_fraction="0.99,1.01,2", lam_over_a="0.001").steps
    assert [step["contact_nodes"] for step in stiff] == [0, 2, 2]
    assert stiff[2]["half_force"] == pytest.approx((24 * 2 - 24) / 2, rel=1e-3)


@pytest.mark.slow
@pytest.mark.parametrize("lam", [0.2, 0.5])
def test_heavy_strip_converges(lam) -> None:
    length, force = lifted_strip(lam)
    exact = {"free_length": length, "lift_force": force}
    actual = errors("heavy-strip", STRIP, exact, lam_over_unit=f"{lam}")
    assert fitted_order(SIZES, actual["lift_force"]) >= 1.5
    assert actual["lift_force"][-1] <= 1e-4
    assert fitted_order(SIZES, actual["free_length"]) >= 1.0
    assert actual["free_length"][-1] <= 5e-4


@pytest.mark.parametrize("contact", ALGORITHMS)
def test_every_algorithm_peels_the_strip_off(contact) -> None:
    """All of it lies on the plane at first, with gaps that are rounding and nothing but the plane's place to say so."""
    solution = solve(*resolve("heavy-strip", {}, "16x1", measure="linear", contact=contact))
    assert solution.verdict == CONVERGED
    assert solution.quantities["lift_force"] == pytest.approx(lifted_strip(0.2)[1], rel=4e-3)
    assert solution.counters["factorisations"] <= 16


@pytest.mark.slow
def test_lifting_twice_as_high_follows_the_scaling_of_the_beam() -> None:
    """Lengths grow with (D delta/q)^(1/4): lam/unit falls, which the closed form must foresee."""
    step = solved("heavy-strip", "128x1", load_fraction="2").steps[-1]
    unit = 2**0.25
    length, force = lifted_strip(0.2 / unit)
    assert step["free_length"] == pytest.approx(length * unit, rel=1e-3)
    assert step["lift_force"] == pytest.approx(force * unit, rel=3e-4)


# --- plate ------------------------------------------------------------------------------------------------------


@pytest.mark.slow
@pytest.mark.parametrize(
    ("fraction", "order", "cap"),
    [
        (2.0, 1.5, 5e-4),
        (5.0, 1.5, 3e-4),
        (20.0, 1.5, 1e-4),
    ],
)
def test_circular_plate_converges(fraction, order, cap) -> None:
    radius, force = plate_contact(64 * fraction)
    actual = errors("plate-contact", ("32x1", "64x1", "128x1"), {"contact_force": force}, load_fraction=f"{fraction}")
    assert fitted_order(SIZES, actual["contact_force"]) >= order
    assert actual["contact_force"][1] <= cap
    last = solved("plate-contact", "64x1", load_fraction=f"{fraction}").steps[-1]
    assert abs(last["contact_radius"] - radius) <= 0.5 / 64


def test_hole_of_the_plate_costs_nothing_that_counts() -> None:
    _, force = plate_contact(320.0)
    for hole in ("0.001", "0.01", "0.05"):
        step = solved("plate-contact", "64x1", load_fraction="5", hole=hole).steps[-1]
        assert step["contact_force"] == pytest.approx(force, rel=3e-4)


# --- ring -------------------------------------------------------------------------------------------------------


def test_flattened_ring_converges_to_the_elastica() -> None:
    """P H^2/EI = 5.742160 for every distance of the plates, and the load stands on the ends of the flat part."""
    load, flat = flattened_ring(0.5)
    exact = {"P_R2_over_EI": load, "P_H2_over_EI": 5.742160, "flat_half_length": flat}
    actual = errors("ring", ("1x16", "1x32", "1x64"), exact, measure="exact", delta_mm="50")
    assert fitted_order(SIZES, actual["P_H2_over_EI"]) >= 1.5
    assert actual["P_H2_over_EI"][-1] <= 5e-4
    assert fitted_order(SIZES, actual["flat_half_length"]) >= 1.5
    assert actual["flat_half_length"][-1] <= 5e-4


def test_flat_part_of_the_ring_carries_nothing() -> None:
    result = solved("ring", "1x64", "exact", delta_mm="40,50")
    for step, delta in zip(result.steps, (40.0, 50.0), strict=True):
        assert step["P_H2_over_EI"] == pytest.approx(5.742160, rel=5e-4)
        assert step["flat_half_length"] == pytest.approx(flattened_ring(1 - delta / 100)[1], abs=5e-4)
    pressure = result.last.pressure.reshape(2, -1)[0]
    problem = result.model.problem_at(50.0)
    gap = problem.gap(result.last.u).reshape(2, -1)[0]
    position = result.model.candidates.positions(result.last.u)[: len(gap), 1] / 100
    flat = flattened_ring(0.5)[1]
    inside = np.abs(position) < flat - 2 * np.pi / 128
    assert inside.sum() >= 15
    assert np.max(pressure[inside]) <= 1e-6 * np.max(pressure)
    assert np.max(gap[inside]) <= 0.01  # mm; a hundredth of the thickness


@pytest.mark.slow
def test_thickness_of_the_ring_counts_by_its_square() -> None:
    """Shear and extension, which the elastica has not: P falls by 2.4 (h/R)^2 of it."""
    load = [solved("ring", "1x64", "exact", delta_mm="50", h_mm=f"{h}").steps[-1]["P_H2_over_EI"] for h in (2, 4, 8)]
    first, second = (load[0] - load[1]) / 5.742160, (load[1] - load[2]) / 5.742160
    assert first / 12e-4 == pytest.approx(2.4, abs=0.3)
    assert second / 48e-4 == pytest.approx(2.4, abs=0.3)


def test_a_linear_ring_must_fail() -> None:
    """Linear strains know no flattening at constant P H^2."""
    steps = solved("ring", "1x32", "linear", delta_mm="40,50").steps
    assert abs(steps[1]["P_H2_over_EI"] / 5.742160 - 1) > 0.2
