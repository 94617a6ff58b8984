"""Solids as bodies of pairs: derivatives of the whole, Hertz between cylinders, a ring on a layer stiff and soft."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from contact.faces.pair import between
from contact.faces.sampling import PAIRINGS
from contact.verify import PAIR
from studies.ask.scene import Reference, UsageError
from studies.output.vtu import read_vtu
from studies.scenes import SCENES
from studies.scenes.closed_forms.contact import hertz_pressure, pressed_cylinders
from studies.scenes.complete import complete
from studies.scenes.faces.ring_on_layer import BED, STIFF
from studies.scenes.faces.solids import towards_start
from studies.solving.refinement.grids import near
from studies.solving.result import Result
from studies.solving.solve import solve
from support.problems.differences import fitted_order

BY_DIFFERENCES = 1e-6  # of the size
FIRST = {"delta_mm": "0.025"}
RIGID = {key: str(value) for key, value in STIFF.items() if key != "measure"}


def solved(scene: str, mesh: str, contact: str = "semismooth", **settings: Any) -> Result:
    result = solve(*complete(scene, settings, mesh, contact=contact))
    assert result.outcome.converged, result.reason
    for step in result.steps:
        pairs = {name: value for name, value in step["balances"].items() if name.startswith("pair_")}
        assert "pair_force" in pairs  # planes of symmetry that cross carry all moments, and there is none to look at
        assert max(pairs.values()) <= PAIR
    return result


@pytest.mark.parametrize("pairing", PAIRINGS)
@pytest.mark.parametrize("slave", ["first", "second"])
def test_the_tangent_of_a_shell_and_a_solid_that_press_each_other_is_a_derivative(
    rng, pairing: str, slave: str
) -> None:
    """Of residual less contact forces; both without a resultant."""
    scene, request = complete("ring-on-layer", {"pairing": pairing, "slave": slave, "layer_law": "neo-hooke"}, "1x8")
    model = scene.build(replace(request, newton="plain"))
    bodies, pair = model.bodies_at(35.0), model.pairs_at(35.0)[0]
    u, du = rng.normal(size=(2, model.n_unknowns)) * 0.02
    problem = between(bodies.linearise, pair)
    pressure = rng.uniform(0.5, 1.0, len(pair.weights))

    def out_of_balance(at: np.ndarray) -> np.ndarray:
        return bodies.residual(at) - problem.contact_force(at, pressure)

    t = 1e-4
    slope = (out_of_balance(u + t * du) - out_of_balance(u - t * du)) / (2 * t)
    exact = problem.stiffness(bodies.linearise(u), u, pressure) @ du
    np.testing.assert_allclose(exact, slope, rtol=0, atol=BY_DIFFERENCES * np.max(np.abs(exact)))
    x, forces = pair.positions(u), pair.forces(u, pair.weights * pressure)
    size = np.sum(np.linalg.norm(forces, axis=1))
    assert np.linalg.norm(forces.sum(axis=0)) <= PAIR * size
    assert np.linalg.norm(np.cross(x, forces).sum(axis=0)) <= PAIR * size * np.max(np.abs(x))


def test_lines_get_closer_and_those_of_half_the_size_contain_them() -> None:
    lines = towards_start(8, 50.0, 0.3, 0.25)
    assert lines[2] == pytest.approx(0.3, rel=1e-12)
    assert np.all(np.diff(lines, 2) > 0)
    np.testing.assert_allclose(towards_start(16, 50.0, 0.3, 0.25)[::2], lines, rtol=1e-12)
    np.testing.assert_allclose(towards_start(4, 50.0, 40.0, 0.25), [0, 12.5, 25, 37.5, 50])


def test_cylinders_approach_as_their_halves_are_compressed() -> None:
    """F from the closed form in the other direction: both halves, each by F/(pi E*)(2 ln(4R/a) - 1)."""
    moduli = 300.0, 800.0
    force, a = pressed_cylinders(0.05, 100.0, moduli)
    together = 1 / (1 / moduli[0] + 1 / moduli[1])
    assert sum(force / np.pi / each * (2 * np.log(400 / a) - 1) for each in moduli) == pytest.approx(0.05, rel=1e-12)
    width, peak = hertz_pressure(force, 50.0, together)
    assert width == pytest.approx(a, rel=1e-12)
    assert np.pi / 2 * a * peak == pytest.approx(force, rel=1e-12)
    with pytest.raises(ValueError, match="small"):
        pressed_cylinders(20.0, 100.0, moduli)


def test_cylinders_on_a_coarse_mesh_have_the_force_of_hertz(tmp_path) -> None:
    """And a file with all of both where they are: eight hexahedra an element."""
    result = solved("two-cylinders", "1x8", **FIRST)
    assert result.quantities["P_over_ER"] == pytest.approx(
        pressed_cylinders(0.05, 100.0, (1000 / 0.91,) * 2)[0] / 1e5, rel=0.01
    )
    result.model.write_fields(tmp_path / "fields.vtu", result.last)
    fields = read_vtu(tmp_path / "fields.vtu")
    at = fields.points + fields.data["displacement"]
    first, second = (at[np.unique(fields.cells[fields.data["body"] == number])] for number in (0, 1))
    assert np.max(first[:, 0]) == pytest.approx(np.min(second[:, 0]), abs=2e-3)  # averaged gaps; they approach by 0.05
    assert np.ptp(second[:, 0]) == pytest.approx(np.ptp(first[:, 0]), abs=0.05)
    assert np.max(fields.data["pressure"]) == pytest.approx(np.max(result.last.pressure))
    corners = fields.points[fields.cells]
    sides = [corners[:, end] - corners[:, 0] for end in (1, 3, 4)]
    volumes = np.einsum("ec,ec->e", np.cross(sides[0], sides[1]), sides[2])
    assert np.all(volumes > 0)
    assert len(fields.cells) == 8 * (8 * 6 + 6 * 4)


@pytest.mark.parametrize(
    ("settings", "said"),
    [
        ({"other_elements": "10"}, "8 and 1 elements along the faces, each must have 4"),
        ({"delta_mm": "2"}, r"delta_mm = '2' must be increasing numbers in \(0, 1\]"),
    ],
)
def test_bad_input_is_refused_in_one_line(settings: dict[str, str], said: str) -> None:
    with pytest.raises(UsageError, match=said):
        built(settings)


def test_half_spheres_of_too_few_elements_are_refused() -> None:
    """Half of a mesh, for its error, may be too coarse: the next one that is not is taken."""
    scene, request = complete("half-spheres", {}, "8x1")
    half = near(scene, request, 0.5)
    assert half.mesh[0] > 4
    with pytest.raises(UsageError, match=r"mesh 4x1: .* too coarse"):
        scene.build(replace(request, mesh=(4, 1)))


def test_a_measure_is_refused() -> None:
    with pytest.raises(UsageError, match="a solid has none"):
        complete("two-cylinders", {}, measure="linear")


def built(settings: dict[str, str]) -> object:
    scene, request = complete("two-cylinders", settings, "1x8")
    return scene.build(request)


def by_hertz(ratio: float = 1.0) -> float:
    """P over E R at half an approach of 0.025 mm."""
    return pressed_cylinders(0.05, 100.0, (1000 / 0.91, ratio * 1000 / 0.91))[0] / 1e5


@pytest.mark.slow
@pytest.mark.parametrize(("slave", "ratio"), [("second", 1), ("first", 10), ("second", 10)])
def test_cylinders_converge_to_hertz_whoever_is_the_master_and_the_stiffer(slave: str, ratio: float) -> None:
    """Pressures fall to zero as a root does: means over elements miss half of the last one, which is of order one."""
    values = [
        solved("two-cylinders", mesh, slave=slave, E_ratio=ratio, **FIRST).quantities for mesh in ("1x16", "1x32")
    ]
    half_width = [abs(each["half_width_over_hertz"] - 1) for each in values]
    assert half_width[1] <= 0.06
    assert fitted_order([2.0, 1.0], half_width) >= 0.9
    assert values[1]["P_over_ER"] == pytest.approx(by_hertz(ratio), rel=1e-2)
    assert values[1]["peak_over_hertz"] == pytest.approx(1, abs=2e-2)


@pytest.mark.slow
def test_nodes_against_patches_have_the_force_of_hertz_and_peaks_that_scatter() -> None:
    actual = solved("two-cylinders", "1x32", pairing="nodes", **FIRST).quantities
    assert actual["P_over_ER"] == pytest.approx(by_hertz(), rel=1e-2)
    assert actual["half_width_over_hertz"] == pytest.approx(1, abs=2e-2)
    assert actual["peak_over_hertz"] == pytest.approx(1, abs=4e-2)


@pytest.mark.slow
def test_a_ring_on_a_stiff_layer_is_that_on_a_plate() -> None:
    """Nodes against a flat face to what the layer yields; the soft one of the same thickness yields far more."""
    plate = solve(*complete("ring", {"delta_mm": "50"}, "1x20")).quantities
    layer = solved("ring-on-layer", "1x20", pairing="nodes", delta_mm="50", **RIGID).quantities
    for name in ("P_R2_over_EI", "flat_half_length"):
        assert layer[name] == pytest.approx(plate[name], rel=1e-6)
    soft = solved("ring-on-layer", "1x20", pairing="nodes", delta_mm="50", slave="first").quantities
    assert abs(soft["P_R2_over_EI"] / plate["P_R2_over_EI"] - 1) > 1e-3


@pytest.mark.slow
def test_a_ring_on_a_stiff_layer_has_the_force_of_the_elastica() -> None:
    actual = solved("ring-on-layer", "1x64", delta_mm="50", **RIGID).quantities
    assert actual["P_R2_over_EI"] == pytest.approx(5.742160, rel=1e-3)
    assert actual["flat_half_length"] == pytest.approx(0.476577, rel=1e-3)


@pytest.mark.slow
@pytest.mark.parametrize(("law", "push"), [("svk", 0.995 * (1 - 0.995**2) / 2), ("hencky", -np.log(0.995) / 0.995)])
def test_a_thin_soft_layer_is_a_bed_of_springs(law: str, push: float) -> None:
    """The peak by the law of what is pressed by 0.005 alone; the force of the circle on springs, a/t = 23."""
    actual = solved(
        "ring-on-layer", "1x48", layer_law=law, **{key: str(value) for key, value in BED.items()}
    ).quantities
    assert actual["peak_over_springs"] == pytest.approx(push / 0.005, rel=1e-3)
    assert actual["force_over_springs"] == pytest.approx(1, rel=1.5e-2)


@pytest.mark.slow
def test_a_thin_layer_is_the_law_of_a_finite_epsilon_on_a_plate() -> None:
    """epsilon = E/t: another formulation, without a second body. Springs have no shear, so the rim differs."""
    ring = solve(*complete("ring", {"delta_mm": "5", "epsilon": "50"}, "1x128")).quantities
    layer = {"layer_mm": "0.5", "E_layer_MPa": "25", "other_elements": "100"}
    actual = solved("ring-on-layer", "1x128", delta_mm="5", **layer).quantities
    assert actual["P_R2_over_EI"] == pytest.approx(ring["P_R2_over_EI"], rel=1e-3)
    assert actual["flat_half_length"] == pytest.approx(ring["flat_half_length"], rel=5e-2)  # on a rigid plate it is 0


HALVES: dict[str, str] = {"delta_mm": "1,2,3,4", "surfaces": "5"}


def test_half_spheres_rub_on_each_other_and_not_on_the_plane() -> None:
    result = solved("half-spheres", "8x1", through=1, delta_mm="0.5", mu="0.5")
    assert result.verdict == "converged"
    pressure, t = result.last.pressure, np.linalg.norm(result.last.friction.force, axis=1)
    rubs = result.model.pair_of_candidate == 0
    assert np.all(t[~rubs] == 0)
    assert np.any(pressure[~rubs] > 0)
    assert np.max(t[rubs]) > 0
    assert result.steps[-1]["dissipation_N_mm"] > 0


@pytest.mark.slow
def test_half_spheres_that_rub_take_the_steps_that_are_asked_for() -> None:
    """Slips beside the planes of symmetry would have Newton's iteration cycle, and steps cut, from 0.5 mm on."""
    scene, request = complete("half-spheres", {"through": "1", "delta_mm": "1", "mu": "0.5"}, "16x1", steps=2)
    assert solve(scene, request).ways == [("load", (0.5, 1.0))]


def test_fields_of_half_spheres_have_what_deforms(tmp_path) -> None:
    result = solved("half-spheres", "8x1", through=1, delta_mm="0.1")
    result.model.write_fields(tmp_path / "fields.vtu", result.last)
    fields = read_vtu(tmp_path / "fields.vtu")
    assert set(fields.data["body"]) == {0.0, 1.0}  # and not the plane
    assert np.max(np.abs(fields.points)) == pytest.approx(14.0)
    assert np.max(fields.data["pressure"]) == pytest.approx(np.max(result.last.pressure))


def half_spheres(kind: str, mu: float) -> dict[float, Reference]:
    values = [each for each in SCENES["half-spheres"].references if each.kind == kind and each.at["mu"] == mu]
    return {float(each.at["delta_mm"]): each for each in values}


def in_band(result: Result, mu: float) -> None:
    known = half_spheres("read", mu)
    assert len(known) == len(result.steps)
    for step in result.steps:
        reference = known[step["delta_mm"]]
        assert abs(step["quarter_N"] / reference.value - 1) <= reference.uncertainty


@pytest.mark.slow
def test_half_spheres_are_inside_the_band_of_four_codes() -> None:
    """And stable, unlike shells."""
    result = solved("half-spheres", "30x1", through=1, delta_mm="1,2,3,4")
    assert result.verdict == "converged"
    in_band(result, 0.0)


@pytest.mark.slow
def test_half_spheres_that_rub_converge_inside_the_band_of_three_codes_up_to_5_mm() -> None:
    """On three meshes of half the elements each, in steps of 1 mm that are never cut."""
    limits = half_spheres("refined", 0.5)
    for mesh in ("20x1", "40x1", "80x1"):
        result = solved("half-spheres", mesh, mu="0.5", delta_mm="1,2,3,4,5")
        assert [way for _, way in result.ways] == [(1.0,), (2.0,), (3.0,), (4.0,), (5.0,)]
        in_band(result, 0.5)
    for step in result.steps:
        limit = limits[step["delta_mm"]]
        assert abs(step["quarter_N"] / limit.value - 1) <= limit.uncertainty


@pytest.mark.slow
@pytest.mark.parametrize(("pairing", "slave"), [(PAIRINGS[0], "second"), (PAIRINGS[1], "first")])
def test_half_spheres_rub_up_to_5_mm_whoever_is_the_master(pairing: str, slave: str) -> None:
    settings: dict[str, Any] = {"mu": 0.5, "through": 1, "delta_mm": "1,2,3,4,5", "pairing": pairing, "slave": slave}
    in_band(solved("half-spheres", "30x1", **settings), 0.5)


@pytest.mark.slow
def test_half_spheres_are_the_same_as_shells_and_whoever_is_the_master() -> None:
    solid = solved("half-spheres", "40x1", delta_mm="1,2,3,4")
    swapped = solved("half-spheres", "40x1", slave="first", delta_mm="1,2,3,4")
    shell = solved("half-spheres", "40x1", bodies="shells", **HALVES)
    limits = [each.value for each in half_spheres("refined", 0.0).values()]
    for limit, one, other, third in zip(limits, solid.steps, swapped.steps, shell.steps, strict=True):
        assert one["quarter_N"] == pytest.approx(limit, rel=5e-3)
        assert other["quarter_N"] == pytest.approx(one["quarter_N"], rel=2e-3)
        assert third["quarter_N"] == pytest.approx(one["quarter_N"], rel=7e-3)
    assert solid.verdict == "converged"
    assert shell.verdict == "unstable"
