"""A deck pressed on a foundation, against the scene of the same panel on its lines of curvature."""

from pathlib import Path

import numpy as np
import pytest

from contact.catalogue import ALGORITHMS
from formulations.geometry.surfaces import cylinder, normal
from studies.output.vtu import read_vtu
from studies.scenes.complete import complete
from studies.scenes.contact.pressed_panel import E_L, E_T, HALF_ANGLE, HALF_LENGTH, NU, PLY, RADIUS, G
from studies.solving.solve import solve
from support.decks import answered, mesh_lines, plate, refused

ALONG_X = ["--set", "towards_1=1", "--set", "towards_3=0"]
ON_PLANE = [*ALONG_X, "--set", "foundation=plane", "--set", "delta_mm=1,2"]
FAST = ("semismooth", "lcp")


def panel(m: int, *loads: str) -> list[str]:
    """The pressed panel of m x m elements with its own normals; clamped along its generators."""
    x, elements = plate(m, m, 2 * HALF_LENGTH, 2 * HALF_ANGLE)
    a, b = x[:, 0] - HALF_LENGTH, x[:, 1] - HALF_ANGLE
    surface = cylinder(RADIUS)
    clamped = np.flatnonzero(np.isclose(np.abs(b), HALF_ANGLE)) + 1
    return [
        *mesh_lines(surface.position(a, b), elements[:, ::-1], normal(surface, a, b)),
        *("*MATERIAL, NAME=F", "*ELASTIC, TYPE=ENGINEERING CONSTANTS"),
        *(f"{E_L}, {E_T}, {E_T}, {NU}, {NU}, {NU}, {G}, {G}", f"{G}"),
        *("*ORIENTATION, NAME=O", "0., 0., 1., 0., 1., 0.", "3, 0."),
        "*SHELL SECTION, ELSET=ALL, COMPOSITE, ORIENTATION=O",
        *(f"{PLY}, 3, F, {45 * (-1) ** k}." for k in range(4)),
        *("*BOUNDARY", *(f"{node}, 1, 6" for node in clamped.tolist())),
        *("*STEP, NLGEOM", "*STATIC", *loads, "*END STEP"),
    ]


@pytest.mark.parametrize(
    "contact", [pytest.param(name, marks=[] if name in FAST else [pytest.mark.slow]) for name in ALGORITHMS]
)
def test_every_algorithm_has_the_force_of_the_scene(tmp_path, contact: str) -> None:
    ours = solve(*complete("pressed-panel", {"element": "quads"}, "4x4", contact=contact)).steps
    result = answered(tmp_path, panel(4), *ON_PLANE, "--no-error", "--contact", contact)
    for step, row in zip(result["steps"], ours, strict=True):
        assert step["force_N"] == pytest.approx(row["force_N"], rel=1e-8)
        assert step["reaction_1_N"] == pytest.approx(step["force_N"], rel=1e-8)
        assert step["contact_nodes"] == row["contact_nodes"]


def test_a_panel_that_is_cut_is_the_finer_panel(tmp_path) -> None:
    ours = solve(*complete("pressed-panel", {"element": "quads"}, "8x8")).quantities["force_N"]
    result = answered(tmp_path, panel(4), *ON_PLANE, "--no-error", "--mesh", "2x2")
    assert result["quantities"]["force_N"] == pytest.approx(ours, rel=1e-6)


def test_loads_come_first_and_a_foundation_may_come_from_inside(tmp_path) -> None:
    loads = ["*DLOAD", "ALL, P, 0.05"]
    seen = answered(tmp_path, panel(4, *loads), *ON_PLANE, "--no-error")["quantities"]
    width = 2 * RADIUS * np.sin(HALF_ANGLE)
    assert seen["force_N"] - seen["reaction_1_N"] == pytest.approx(0.05 * width * 2 * HALF_LENGTH, rel=0.02)
    still = answered(tmp_path, panel(4, *loads), *ON_PLANE[:-2], "--no-error", "--set", "load_fraction=0.5,1")
    assert [step["load_fraction"] for step in still["steps"]] == [0.5, 1.0]
    assert 0 < still["quantities"]["force_N"] < seen["force_N"]

    ball = ["--set", "foundation=sphere", "--set", "foundation_radius_mm=20", "--set", "over_node=13"]
    inside = ["--set", "towards_1=-1", "--set", "towards_3=0", "--set", "delta_mm=0.5", "--no-error"]
    pushed = answered(tmp_path, panel(4), *inside, *ball)["quantities"]
    assert pushed["reaction_1_N"] == pytest.approx(-pushed["force_N"], rel=1e-8)
    assert pushed["force_N"] > 0
    fields = read_vtu(Path(tmp_path / "out" / "fields.vtu")).data
    assert fields["pressure"][fields["face"] == 0].max() == pytest.approx(pushed["peak_MPa"], rel=1e-12)
    assert not fields["pressure"][fields["face"] == 1].any()


def test_it_is_dragged_with_friction(tmp_path) -> None:
    friction = ["--set", "mu=0.3", "--set", "drag_mm=0.5", "--no-step-error"]
    seen = answered(tmp_path, panel(4), *ON_PLANE, "--no-error", *friction)["quantities"]
    assert 0.5 * seen["bound_N"] < seen["friction_N"] <= seen["bound_N"] * (1 + 1e-9)


@pytest.mark.parametrize(
    ("given", "words"),
    [
        (["foundation=plane"], "a foundation without delta_mm presses a shell without loads nowhere"),
        (["foundation=plane", "towards_3=0", "delta_mm=1"], "towards_1, towards_2 and towards_3 are all 0"),
        (["foundation=sphere", "over_node=99", "delta_mm=1"], "over_node = 99 is no node of panel.inp"),
        (["foundation=plane", "cleat_top_mm=3", "delta_mm=1"], "a foundation 'plane' has no cleat_top_mm"),
        (["foundation=wall"], "wall"),
        (["delta_mm=1"], "has no setting 'delta_mm'"),
        ([], "no load: *CLOAD, *DLOAD, or --set foundation=plane"),
    ],
)
def test_what_cannot_be_pressed_is_refused(tmp_path, capsys, given, words) -> None:
    options = [word for each in given for word in ("--set", each)]
    assert words in refused(tmp_path, capsys, panel(4), *options)
