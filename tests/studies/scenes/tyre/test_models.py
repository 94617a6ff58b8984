"""Parts of a tyre against the whole: the same displacements, pressures and forces; what is not symmetric is refused."""

import numpy as np
import pytest

from formulations.conditions.dof_map import DofMap, Images
from studies.ask.scene import UsageError
from studies.scenes.complete import complete as resolve
from studies.scenes.foundations import PARAMETERS
from studies.solving.result import Result
from studies.solving.solve import solve
from support.problems.solved import solved

EXACT = 1e-9  # relative
ISOTROPIC = {"E_MPa": "20", "nu": "0.45", "load": "follower", "pressure_area": "face"}
MESH = "16x18"


def run(model: str, settings: dict[str, str], mesh: str = MESH, **options: str) -> Result:
    return solved("tyre", mesh, model=model, **settings, **options)


def fields(result: Result) -> dict[str, np.ndarray]:
    """What the whole tyre looks like at the end, and its forces on the way."""
    wall = result.model.wall
    steps = {key: np.array([step[key] for step in result.steps]) for key in ("force_N", "contact_nodes")}
    position = np.stack(wall.faces(result.last.u)) - np.stack(wall.faces(np.zeros_like(result.last.u)))
    return {**steps, "pressure": wall.spread(result.last.pressure), "displacement": position}


def assert_same(part: Result, full: Result) -> None:
    own, all_of_it = fields(part), fields(full)
    for name, value in all_of_it.items():
        assert np.max(np.abs(own[name] - value)) <= EXACT * np.max(np.abs(value)), name
    for name, value in full.quantities.items():
        assert part.quantities[name] == pytest.approx(value, rel=EXACT), name
    assert part.model.n_unknowns < 0.55 * full.model.n_unknowns


@pytest.mark.parametrize(
    "settings",
    [
        {},
        pytest.param({"load": "follower", "section": "nonsymmetric", "pressure_area": "face"}, marks=pytest.mark.slow),
        pytest.param({"element": "paper", "coupling": "consistent"}, marks=pytest.mark.slow),
        pytest.param({"gamma_deg": "30", "epsilon": "1e4", "interpolation": "isoparametric"}, marks=pytest.mark.slow),
        *(pytest.param({"foundation": f}, marks=pytest.mark.slow) for f in PARAMETERS if f != "plane"),
    ],
    ids=str,
)
def test_a_turned_half_is_the_whole(settings: dict[str, str]) -> None:
    given = {"delta_mm": "4,12", **settings}
    assert_same(run("half", given), run("full", given))


@pytest.mark.slow
@pytest.mark.parametrize(
    ("settings", "model"),
    [
        ({"gamma_deg": "90"}, "half"),
        ({"gamma_deg": "90"}, "quarter"),
        ({**ISOTROPIC, "foundation": "sphere"}, "mirror"),
        ({**ISOTROPIC, "foundation": "sphere"}, "quarter"),
    ],
    ids=str,
)
def test_parts_of_a_tyre_without_angle_plies(settings: dict[str, str], model: str) -> None:
    given = {"delta_mm": "4,10", **settings}
    assert_same(run(model, given), run("full", given))


@pytest.mark.parametrize("measure", ["linear", "donnell"])
def test_every_kind_of_measure_has_the_symmetry(measure: str) -> None:
    given = {"delta_mm": "5"}
    assert_same(run("half", given, measure=measure), run("full", given, measure=measure))


def test_another_algorithm_solves_parts_alike() -> None:
    given = {"delta_mm": "10", "epsilon": "inf"}
    assert_same(run("half", given, contact="lcp"), run("full", given))


def test_inflation_of_a_column_is_that_of_the_whole() -> None:
    """With the paper's element the lifted column is the answer: nothing is left to iterate."""
    solution = run("half", {"delta_mm": "2", "element": "paper"})
    lifted = [row for row in solution.history if row["stage"] == "inflation"]
    assert len(lifted) == 1
    assert lifted[0]["residual"] <= EXACT
    angle = np.linalg.norm(fields(solution)["displacement"][0].reshape(17, 18, 3)[:, 9], axis=1)  # opposite the plane
    assert angle.max() > 1.0


@pytest.mark.parametrize(
    "settings",
    [
        {"load": "follower", "pressure_area": "face", "interpolation": "isoparametric", "grading": "uniform"},
        {"element": "paper", "gamma_deg": "30", "section": "nonsymmetric"},
        {**ISOTROPIC, "element": "paper"},
        pytest.param({"element": "paper"}, marks=pytest.mark.slow),
        pytest.param({"element": "paper", "load": "follower", "pressure_area": "face"}, marks=pytest.mark.slow),
        pytest.param({"grading": "uniform"}, marks=pytest.mark.slow),
    ],
    ids=str,
)
def test_a_column_turned_around_is_the_inflated_whole(settings: dict[str, str]) -> None:
    """Twist included; other elements than the paper's look at the shape of each, so there all columns are alike."""
    column, whole = (run(model, {"delta_mm": "0", **settings}) for model in ("axisymmetric", "full"))
    states = [np.stack(actual.model.wall.faces(actual.last.u)) for actual in (column, whole)]
    moved = states[1] - np.stack(whole.model.wall.faces(np.zeros_like(whole.last.u)))
    assert np.max(np.abs(states[0] - states[1])) <= EXACT * np.max(np.abs(moved))
    for name, value in column.quantities.items():
        assert whole.quantities[name] == pytest.approx(value, rel=EXACT), name
    for key in ("force_N", "contact_nodes", "centre_pressure_MPa", "half_length_mm", "half_width_mm"):
        assert column.steps[0][key] == whole.steps[0][key] == 0, key
    assert column.steps[0]["patch_to_clamp_mm"] == pytest.approx(whole.steps[0]["patch_to_clamp_mm"], rel=EXACT)
    assert column.model.n_unknowns < whole.model.n_unknowns / 15
    if "E_MPa" not in settings:  # angle plies twist
        assert np.max(np.abs(moved[0].reshape(17, 18, 3)[:, 9, 1])) > 1e-3


def test_contact_is_not_the_same_all_around() -> None:
    for given in ({}, {"delta_mm": "0,5"}):
        with pytest.raises(UsageError, match="needs delta_mm = 0"):
            resolve("tyre", given, model="axisymmetric")


@pytest.mark.parametrize(
    ("settings", "model", "reason"),
    [
        ({"delta_mm": "0"}, "axisymmetric", "inflation alone, which is axisymmetric"),
        ({"delta_mm": "0,5"}, "half", "plies at +-52 deg"),
        ({}, "half", "plies at +-52 deg"),
        ({"gamma_deg": "0"}, "quarter", "cords at 0 deg"),
        (ISOTROPIC, "quarter", "isotropic plies"),
    ],
)
def test_the_smallest_valid_model_is_chosen_and_told(settings: dict[str, str], model: str, reason: str) -> None:
    _, request = resolve("tyre", settings)
    assert request.model == model
    assert reason in request.model_reason


@pytest.mark.parametrize("model", ["mirror", "quarter"])
def test_angle_plies_have_no_mirror(model: str) -> None:
    with pytest.raises(UsageError, match="no mirror plane") as caught:
        resolve("tyre", {}, model=model)
    assert "\n" not in str(caught.value)
    with pytest.raises(UsageError, match="one of auto, full, half, mirror, quarter, sector, axisymmetric"):
        resolve("tyre", {}, model="eighth")


def test_a_wrong_sign_of_an_image_is_seen(monkeypatch: pytest.MonkeyPatch) -> None:
    """Must fail beside must pass: a seam that mirrors instead of turning gives another force."""
    right = run("half", {"delta_mm": "5"}).steps[-1]["force_N"]
    monkeypatch.setattr("studies.scenes.tyre.parts.TURN_OF_FRAME", np.array([-1.0, 1.0, 1.0]))
    wrong = solve(*resolve("tyre", {"delta_mm": "5"}, MESH, model="half"))
    assert not wrong.outcome.converged or abs(wrong.steps[-1]["force_N"] / right - 1) > 1e-4


def test_images_in_the_map(rng: np.random.Generator) -> None:
    """Node 2 follows node 0 with signs, node 1 is its own image, and is held where that changes the sign."""
    fixed = np.zeros((4, 6), bool)
    fixed[0, 5] = True
    images = Images(np.array([2, 1]), np.array([0, 1]), np.array([[-1, 1, 1], [1, -1, -1]]))
    actual = DofMap.build(fixed, images=images)
    assert actual.n == 5 + 2 + 6
    u = rng.uniform(1, 2, actual.n)
    v = actual.expand(u)
    np.testing.assert_array_equal(v[2], v[0] * [-1, -1, 1, 1, 1, 1])
    np.testing.assert_array_equal(v[1] == 0, [False, False, True, True, True, True])
    np.testing.assert_array_equal(actual.restrict(v), u)
    assert not actual.hinged.any()
    with pytest.raises(ValueError, match="follows an image"):
        DofMap.build(fixed, images=Images(np.array([2, 3]), np.array([0, 2]), np.ones((2, 3))))
