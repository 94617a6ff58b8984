"""The tyre as a 3D solid: what it refuses, its symmetry, and its forces against two other programs and the shell."""

from pathlib import Path

import meshio
import numpy as np
import pandas as pd
import pytest

from formulations.geometry.surfaces import Plate, Surface, annulus
from formulations.section.laminate import Laminate, Ply
from formulations.solid import SolidDiscretisation
from formulations.solid_mesh import SolidMesh
from studies.ask.layers import write_solid_fields
from studies.ask.scene import UsageError
from studies.scenes.complete import complete as resolve
from studies.scenes.data import read_reference
from studies.solving.result import Result
from support.problems.solved import read, solved

ONE_PERCENT = 0.01
TO_10 = {"delta_mm": "10"}
GROWTH = {"inner": 4.6256, "outer": 4.3463}  # of the equator by inflation [mm], NGSolve
SHELL = {
    "element": "paper",
    **{"E_MPa": "20", "nu": "0.45", "plies": "1", "ply_thickness_mm": "4.8"},
    **{"load": "follower", "pressure_area": "face"},
}


def run(settings: dict[str, str], mesh: str, scene: str = "tyre-solid", **options: object) -> Result:
    return solved(scene, mesh, **settings, **options)


def forces(result: Result) -> np.ndarray:
    return read(result, "force_N")


def solids() -> np.ndarray:
    return read_reference("isotropic_tyre_3d_solid.csv")["force_N_ngsolve"].to_numpy()


@pytest.fixture(scope="module")
def small() -> Result:
    return run({**TO_10, "plies": "2", "ply_thickness_mm": "2.4"}, "8x10")


@pytest.fixture(scope="module")
def isotropic() -> Result:
    return run({}, "20x20")


@pytest.mark.parametrize(
    ("settings", "options", "says"),
    [
        ({}, {"measure": "linear"}, "measure 'linear' does not apply"),
        ({"E_L_MPa": "510.45"}, {"model": "quarter"}, "model 'quarter' needs isotropic"),
        ({}, {"model": "half"}, "one of auto, full, quarter"),
        ({"pressure_area": "mid"}, {}, "one of face"),
        ({"section": "full-3d"}, {}, "no setting 'section'"),
        ({"membrane": "relaxed"}, {}, "no setting 'membrane'"),
        ({"E_MPa": "20"}, {}, "needs both E_MPa and nu, and takes no E_L_MPa"),
    ],
)
def test_what_does_not_apply_to_a_solid_is_refused(
    settings: dict[str, str], options: dict[str, str], says: str
) -> None:
    with pytest.raises(UsageError, match=says) as caught:
        resolve("tyre-solid", settings, **options)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    ("settings", "model"),
    [
        ({}, "quarter"),
        ({"E_L_MPa": "510.45"}, "full"),
        ({"E_L_MPa": "510.45", "gamma_deg": "0"}, "quarter"),
        ({"E_L_MPa": "510.45", "gamma_deg": "-90"}, "quarter"),
    ],
)
def test_the_model_is_a_quarter_where_two_planes_mirror(settings: dict[str, str], model: str) -> None:
    _, request = resolve("tyre-solid", settings)
    assert request.model == model
    assert request.newton == "plain"


@pytest.mark.slow
def test_a_quarter_is_the_whole_tyre(small: Result) -> None:
    settings = {**TO_10, "plies": "2", "ply_thickness_mm": "2.4"}
    whole = run(settings, "8x10", model="full")
    assert small.counters["dofs"] < 0.3 * whole.counters["dofs"]
    a, b = small.steps[-1], whole.steps[-1]
    for quantity in ("force_N", "centre_pressure_MPa", "contact_nodes", "half_length_mm", "half_width_mm"):
        assert a[quantity] == pytest.approx(b[quantity], rel=1e-8), quantity
    assert b["mirror_asymmetry"] <= 1e-9
    for name in ("contact", "profile"):
        tables = [actual.table(name).frame() for actual in (small, whole)]
        pd.testing.assert_frame_equal(*tables, rtol=1e-7, atol=1e-7)
    assert small.quantities == pytest.approx(whole.quantities, rel=1e-8)


@pytest.mark.slow
def test_every_step_passes_the_judge_and_touching_nodes_lie_in_the_plane(isotropic: Result) -> None:
    for step in isotropic.steps:
        assert step["kkt"]["equilibrium"] <= 1e-8
        assert step["kkt"]["penetration"] <= 1e-9
        assert step["kkt"]["tension"] == 0.0
    pressed = isotropic.table("contact").frame()
    last = pressed[pressed["delta_mm"] == 20.0]
    assert last["active"].sum() == isotropic.steps[-1]["contact_nodes"]
    plane = last.loc[last["active"] == 1, "x_mm"]
    assert np.ptp(plane) <= 1e-9
    assert (last["x_mm"] <= plane.max() + 1e-9).all()


def test_fields_hold_plies_displacement_and_pressure(small: Result, tmp_path: Path) -> None:
    small.write(tmp_path)
    mesh = meshio.read(tmp_path / "fields.vtu")
    (block,) = mesh.cells
    assert len(block.data) == 4 * 5 * 2
    assert set(mesh.cell_data["ply"][0]) == {0.0, 1.0}
    assert mesh.point_data["displacement"].shape == mesh.points.shape
    assert np.linalg.norm(mesh.point_data["displacement"], axis=1).max() > 5.0  # the plane, less the growth
    assert mesh.point_data["pressure"].max() == pytest.approx(small.last.pressure.max())


@pytest.mark.parametrize("surface", [Plate(), annulus()], ids=["right-handed", "left-handed"])
def test_fields_are_hexahedra_in_the_order_of_vtk(surface: Surface, tmp_path: Path) -> None:
    laminate = Laminate.single(Ply.isotropic(1.0, 0.3, 1e-3))
    lines = 1.0 + 1e-3 * np.arange(3)  # so small that the annulus is flat and straight
    mesh = SolidMesh.build(surface, lines, lines, laminate)
    solid = SolidDiscretisation.build(mesh, laminate, np.zeros((len(mesh.x), 3), bool))
    write_solid_fields(tmp_path / "f.vtu", solid, np.zeros(solid.n_free), np.zeros(len(mesh.x)))
    read = meshio.read(tmp_path / "f.vtu")
    (block,) = read.cells
    assert block.type == "hexahedron27"
    node = 1e3 * read.points[block.data]
    edges = [node[:, i] - node[:, 0] for i in (1, 3, 4)]
    volume = np.einsum("...i,...i->...", np.cross(edges[0], edges[1]), edges[2])
    assert volume == pytest.approx(np.ones(4), rel=0.01)
    ends = [(0, 1), (1, 2), (2, 3), (3, 0), (4, 5), (5, 6), (6, 7), (7, 4), (0, 4), (1, 5), (2, 6), (3, 7)]
    faces = [(0, 3, 7, 4), (1, 2, 6, 5), (0, 1, 5, 4), (3, 2, 6, 7), (0, 1, 2, 3), (4, 5, 6, 7)]
    for i, corners in enumerate([*ends, *faces, range(8)], start=8):
        assert np.max(np.abs(node[:, i] - node[:, list(corners)].mean(axis=1))) <= 0.01, i


@pytest.mark.slow
def test_cords_at_an_angle_turn_the_patch() -> None:
    solution = run({**TO_10, "E_L_MPa": "510.45", "plies": "2", "ply_thickness_mm": "2.4"}, "8x10")
    assert solution.request.model == "full"
    assert solution.steps[-1]["central_asymmetry"] <= 1e-9
    assert solution.steps[-1]["mirror_asymmetry"] > 0.01


@pytest.mark.slow
def test_more_elements_through_the_wall_change_little(isotropic: Result) -> None:
    two = run({**TO_10, "per_ply": "2"}, "20x20")
    assert two.counters["dofs"] > 1.5 * isotropic.counters["dofs"]
    change = two.steps[-1]["force_N"] / forces(isotropic)[1] - 1
    assert 1e-6 < abs(change) < 0.002  # Q2 holds the linear S33 of one layer


@pytest.mark.slow
def test_isotropic_force_is_that_of_two_other_programs(isotropic: Result) -> None:
    coarse = 0.015  # 20x20: at 15 and 20 mm the mesh is worth more than 1 %
    bounds = np.array([ONE_PERCENT, ONE_PERCENT, coarse, coarse])
    assert np.all(np.abs(forces(isotropic) / solids() - 1) <= bounds)


@pytest.mark.slow
def test_isotropic_inflation_is_that_of_another_program(isotropic: Result) -> None:
    half_percent = 0.005
    for face, growth in GROWTH.items():
        assert isotropic.quantities[f"inflated_equator_{face}_mm"] == pytest.approx(growth, rel=half_percent)
    profile = isotropic.table("profile").frame()
    reference = read_reference("isotropic_tyre_3d_inflation.csv")
    for axis in ("radial", "axial"):
        middle = 0.5 * (profile[f"inner_{axis}_mm"] + profile[f"outer_{axis}_mm"])
        unloaded, inflated = (middle[profile["state"] == state].to_numpy() for state in ("unloaded", "inflated"))
        psi = profile.loc[profile["state"] == "inflated", "psi_deg"]
        ours = np.interp(reference["psi_deg"], psi, inflated - unloaded)
        off = np.max(np.abs(ours - reference[f"{axis}_mm"]))
        assert off <= 2 * half_percent * reference["radial_mm"].max()  # ours is interpolated between nodes


@pytest.mark.slow
def test_consistent_coupling_changes_the_force_little(isotropic: Result) -> None:
    solution = run({**TO_10, "coupling": "consistent"}, "20x20")
    change = solution.steps[-1]["force_N"] / forces(isotropic)[1] - 1
    assert 1e-6 < abs(change) < ONE_PERCENT


def limit(coarse: np.ndarray, fine: np.ndarray) -> np.ndarray:
    """Of meshes halved once, for the order 2 that the rim of a patch allows."""
    return fine + (fine - coarse) / 3


@pytest.mark.slow
def test_limits_of_solid_and_shell_at_ten_millimetres_agree_with_another_program() -> None:
    solid = limit(*(forces(run(TO_10, mesh)) for mesh in ("28x36", "56x72")))
    shell = limit(*(forces(run({**SHELL, **TO_10}, mesh, "tyre")) for mesh in ("42x40", "84x80")))
    assert solid == pytest.approx(solids()[1], rel=0.002)
    assert shell == pytest.approx(solid, rel=0.004)
