"""The tyre on ground that deforms: rigid ground as the limit, Navier's plate, springs, compliances in series."""

from typing import Any

import numpy as np
import pytest

from contact.faces.sampling import PAIRINGS
from contact.verify import PAIR
from studies.ask.scene import UsageError
from studies.output.vtu import read_vtu
from studies.scenes.closed_forms.plates import navier_deflection
from studies.scenes.complete import complete
from studies.solving.result import Result
from studies.solving.solve import solve
from support.problems.differences import fitted_order

ISOTROPIC: dict[str, Any] = {"E_MPa": 20, "nu": 0.45, "plies": 1, "ply_thickness_mm": 4.8, "load": "follower"}
PRESSED: dict[str, Any] = {**ISOTROPIC, "delta_mm": "20"}
STIFF = "1e10"  # MPa
PRINTED = 0.01160  # w D/(F a^2) of a square; Timoshenko, Woinowsky-Krieger, art. 34, recalled


def solved(scene: str, mesh: str, model: str = "auto", **settings: Any) -> Result:
    result = solve(*complete(scene, settings, mesh, model=model))
    assert result.outcome.converged, result.reason
    for step in result.steps:
        balances = step["balances"]
        assert max(balances.get("pair_force", 0.0), balances.get("pair_moment", 0.0)) <= PAIR
    return result


def built(scene: str, settings: dict[str, Any], model: str) -> object:
    actual, request = complete(scene, settings, "8x8", model=model)
    return actual.build(request)


def force(scene: str, mesh: str, model: str = "auto", **settings: Any) -> float:
    return float(solved(scene, mesh, model, **settings).quantities["force_N"])


@pytest.mark.parametrize("ratio", [1.0, 1.4, 3.0])
def test_navier_has_the_deflection_of_levy_under_a_force_in_the_middle(ratio: float) -> None:
    """w = F a^2/(2 pi^3 D) sum_m (tanh s - s/cosh^2 s)/m^3, s = m pi b/(2 a), which forgets b far faster."""
    actual = navier_deflection((3.0, 3.0 * ratio), 7.0, np.zeros(1), np.zeros(1), np.array([2.0]))
    m = np.arange(1, 60, 2)
    s = m * np.pi * ratio / 2
    levy = 2.0 * 9.0 / (2 * np.pi**3 * 7.0) * np.sum((np.tanh(s) - s / np.cosh(s) ** 2) / m**3)
    assert actual == pytest.approx(levy, rel=3e-4)
    if ratio == 1.0:
        assert actual * 7.0 / (2.0 * 9.0) == pytest.approx(PRINTED, abs=1e-6)


@pytest.mark.parametrize("model", ["quarter", pytest.param("full", marks=pytest.mark.slow)])
def test_a_stiff_plate_is_the_rigid_plane(model: str) -> None:
    """Nodes against a flat face; a plate as it is by default yields by a tenth of the force."""
    plane = force("tyre", "14x14", **PRESSED)
    assert force("tyre-on-plate", "14x14", model, E_plate_MPa=STIFF, **PRESSED) == pytest.approx(plane, rel=1e-5)
    assert force("tyre-on-plate", "14x14", model, **PRESSED) < 0.9 * plane


def test_a_plate_that_bends_by_little_does_so_as_navier_says() -> None:
    actual = solved("tyre-on-plate", "28x28", E_plate_MPa="1e7", **PRESSED).quantities
    assert actual["deflection_over_navier"] == pytest.approx(1, rel=1e-3)
    assert 0.02 < actual["deflection_mm"] < 0.03
    held = solved("tyre-on-plate", "28x28", E_plate_MPa="1e7", edges="clamped", **PRESSED).quantities
    ratio = held["deflection_mm"] / actual["deflection_mm"]
    assert 0.00126 / 0.00406 < ratio < 0.0056 / 0.0116  # of a load all over it and of one in its middle
    assert "deflection_over_navier" not in held


def test_the_file_has_the_tyre_and_its_ground(tmp_path) -> None:
    result = solved("tyre-on-drum", "14x14", through=1, **PRESSED)
    result.model.write_fields(tmp_path / "fields.vtu", result.last)
    fields = read_vtu(tmp_path / "fields.vtu")
    at = fields.points + fields.data["displacement"]
    bodies = (at[np.unique(fields.cells[fields.data["body"] == number])] for number in (0, 1))
    tyre, coat = (each[np.linalg.norm(each[:, 1:], axis=1) < 1.0, 0] for each in bodies)
    assert np.max(tyre) == pytest.approx(np.min(coat), abs=1e-6)  # a node of each in the middle
    assert np.max(fields.data["pressure"]) == pytest.approx(np.max(result.last.pressure))


@pytest.mark.parametrize(
    ("scene", "model", "settings", "said"),
    [
        ("tyre-on-plate", "auto", {"plate_length_mm": 200}, "plate_length_mm must be above 201.9"),
        ("tyre-on-plate", "quarter", {}, "model 'quarter' needs isotropic plies"),
        ("tyre-on-plate", "auto", {"delta_mm": "0"}, "delta_mm"),
        ("tyre-on-plate", "auto", {"E_MPa": 20}, "needs both E_MPa and nu"),
        ("tyre-on-drum", "auto", {"layer_mm": 100, "drum_radius_mm": 100}, "layer_mm must be below drum_radius_mm"),
        pytest.param(
            *("tyre-on-drum", "auto", {"p0_MPa": 5}, "p0_MPa = 5: the inflation of this tyre stops at 1.67"),
            marks=pytest.mark.slow,
        ),
    ],
)
def test_bad_input_is_refused_in_one_line(scene: str, model: str, settings: dict[str, Any], said: str) -> None:
    with pytest.raises(UsageError, match=said):
        built(scene, settings, model)


@pytest.mark.slow
@pytest.mark.parametrize("slave", ["first", "second"])
def test_a_mesh_without_a_node_that_may_touch_is_refused(slave: str) -> None:
    scene, request = complete("tyre-on-drum", {"delta_mm": "2.22", "slave": slave}, "6x6")
    with pytest.raises(UsageError, match="mesh 6x6 leaves no node where tyre and ground may touch"):
        scene.build(request)


@pytest.mark.slow
def test_a_stiff_coat_is_the_rigid_drum_but_for_the_facets() -> None:
    """Whose chords lie inside the circle: of the second order in their length."""
    drum = force("tyre", "28x28", foundation="drum", **PRESSED)
    own, shares = {"E_layer_MPa": "1e4", "nu_layer": 0, "through": 1}, (50, 100, 200)
    errors = [1 - force("tyre-on-drum", "28x28", other_elements=share, **own, **PRESSED) / drum for share in shares]
    assert fitted_order(np.divide(1, shares), errors) == pytest.approx(2, abs=0.2)
    assert 0 < errors[-1] <= 3e-4


@pytest.mark.slow
def test_a_thin_coat_is_a_bed_of_springs_on_the_drum() -> None:
    """epsilon = E/t: another formulation, without a second body. At the rim springs have no shear beside them."""
    drum, springs = (
        force("tyre", "28x28", foundation="drum", epsilon=epsilon, **PRESSED) for epsilon in ("inf", "2.5")
    )
    thin = {"layer_mm": 2, "E_layer_MPa": 5, "nu_layer": 0, "through": 1, "layer_law": "hencky"}
    coat = force("tyre-on-drum", "28x28", slave="second", other_elements=200, **thin, **PRESSED)
    assert coat == pytest.approx(springs, rel=1e-3)
    assert drum - coat == pytest.approx(drum - springs, rel=0.2)


@pytest.mark.slow
def test_compliances_of_tyre_and_plate_are_in_series() -> None:
    """The tyre goes as far in as on the plane, less what the plate gives way: to its slope beside the centre."""
    actual = solved("tyre-on-plate", "28x28", E_plate_MPa="1e6", **PRESSED).quantities
    less = force("tyre", "28x28", **{**PRESSED, "delta_mm": f"{20 - actual['deflection_mm']!r}"})
    assert actual["force_N"] == pytest.approx(less, rel=1.5e-3)
    assert less < 0.99 * force("tyre", "28x28", **PRESSED)


@pytest.mark.slow
def test_the_force_on_a_plate_is_known_whatever_the_mesh_the_pairing_and_the_slave() -> None:
    """112x112 says 1113.4."""
    forces = [
        force("tyre-on-plate", "42x40", pairing=pairing, slave=slave, **PRESSED)
        for pairing, slave in ((PAIRINGS[0], "first"), (PAIRINGS[1], "first"), (PAIRINGS[1], "second"))
    ]
    np.testing.assert_allclose(forces, 1113.0, rtol=5e-3)
    assert force("tyre-on-plate", "28x28", **PRESSED) == pytest.approx(forces[0], rel=5e-3)


@pytest.mark.slow
@pytest.mark.parametrize("scene", ["tyre-on-plate", "tyre-on-drum"])
def test_the_tyre_of_the_paper_is_pressed_on_the_mesh_of_the_scene(scene: str) -> None:
    """By less than on rigid ground of the same mesh, and by more the deeper it goes."""
    forces = [step["force_N"] for step in solved(scene, "28x28", delta_mm="10,20").steps]
    rigid = {"foundation": "drum"} if scene == "tyre-on-drum" else {}
    beside = [step["force_N"] for step in solved("tyre", "28x28", delta_mm="10,20", **rigid).steps]
    assert np.all(np.diff(forces) > 0)
    assert np.all(np.array(forces) < beside)
