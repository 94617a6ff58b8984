"""A deck pressed on a foundation, against the scene of the same panel on its lines of curvature.

Decks with several sections, and with a thickness at each node, against beams in closed form.

What shell decks of CalculiX's own tests say, in decks of our own; the answers are closed forms.
"""

from pathlib import Path

import numpy as np
import pytest

from contact.catalogue import ALGORITHMS
from formulations.geometry.surfaces import cylinder, normal
from studies.output.vtu import read_vtu
from studies.scenes.complete import complete
from studies.scenes.contact.pressed_panel import E_L, E_T, HALF_ANGLE, HALF_LENGTH, NU, PLY, RADIUS, G
from studies.solving.solve import solve
from support.decks import ISOTROPIC, answered, mesh_lines, plate, refused, swapped

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
        (["foundation=sphere", "over_node=99", "delta_mm=1"], "over_node = 99 is not a node of panel.inp"),
        (["foundation=plane", "cleat_top_mm=3", "delta_mm=1"], "a foundation 'plane' has no cleat_top_mm"),
        (["foundation=wall"], "wall"),
        (["delta_mm=1"], "has no setting 'delta_mm'"),
        ([], "no load: *CLOAD, *DLOAD, or --set foundation=plane"),
    ],
)
def test_what_cannot_be_pressed_is_refused(tmp_path, capsys, given, words) -> None:
    options = [word for each in given for word in ("--set", each)]
    assert words in refused(tmp_path, capsys, panel(4), *options)


ROOT = ["*NSET, NSET=ROOT", "1, 2", "*NSET, NSET=TIP", "33, 34", "*BOUNDARY", "ROOT, 1, 6"]
BENT = ["*STEP", "*STATIC", "*CLOAD", "TIP, 3, 5e-4", "*NODE PRINT, NSET=TIP", "U", "*END STEP"]
MATERIAL = ["*MATERIAL, NAME=M", "*ELASTIC", "1000., 0."]
MESH = mesh_lines(*plate(16, 1, 20.0, 2.0))
HALVES = ["*ELSET, ELSET=IN, GENERATE", "1, 8", "*ELSET, ELSET=OUT, GENERATE", "9, 16"]
STEPPED = [
    *MESH,
    *HALVES,
    *MATERIAL,
    *("*SHELL SECTION, ELSET=IN, MATERIAL=M", "0.6", "*SHELL SECTION, ELSET=OUT, MATERIAL=M", "0.3", *ROOT, *BENT),
]
OUTER = "*SHELL SECTION, ELSET=OUT, MATERIAL=M"
NODAL = ["*SHELL SECTION, ELSET=ALL, MATERIAL=M, NODAL THICKNESS", "9."]


def test_a_step_in_thickness_and_material(tmp_path, capsys) -> None:
    """P (int s^2/(E I) + int 1/(G A)) piece by piece; the thin half of plies about its middle, E 4000 in 0.1 mm."""
    stiffer = ["*MATERIAL, NAME=N", "*ELASTIC", "4000., 0.", "*SHELL SECTION, ELSET=OUT, COMPOSITE"]
    lines = swapped(STEPPED, OUTER, *stiffer)
    lines = swapped(lines, "0.3", "0.1,, M", "0.1,, N", "0.1,, M")
    seen = answered(tmp_path, lines, "--mesh", "2x2", "--no-error")["quantities"]
    bending = [1000 * 2 * 0.6**3 / 12, 2 * (1000 * (0.3**3 - 0.1**3) + 4000 * 0.1**3) / 12]
    moments = [(20.0**3 - 10.0**3) / 3, 10.0**3 / 3]
    deflection = 1e-3 * sum(moment / each for moment, each in zip(moments, bending, strict=True))
    assert seen["u3_TIP_mm"] == pytest.approx(deflection, rel=5e-3)  # shear of the wall, 32 elements
    said = capsys.readouterr().out
    assert "thickness 0.6 mm on 8 elements" in said
    assert "N 0.1 at 0" in said


@pytest.mark.parametrize("mesh", ["1x1", "2x2"])
def test_a_taper_by_nodes(tmp_path, capsys, mesh) -> None:
    """w = 12 P/(E b) int s^2/h^3 ds with h = a + c s from the tip."""
    a, c = 0.2, 0.02
    h1 = a + 20 * c
    thickness = [f"{2 * i + j}, {a + c * (20 - 20 * i / 16):.12g}" for i in range(17) for j in (1, 2)]
    lines = [*MESH, *MATERIAL, *NODAL, "*NODAL THICKNESS", *thickness, *ROOT, *BENT]
    seen = answered(tmp_path, lines, "--mesh", mesh, "--no-error")["quantities"]
    bending = (np.log(h1 / a) + 2 * a / h1 - a**2 / (2 * h1**2) - 1.5) / c**3
    shear = 2e-3 / 2000 * np.log(h1 / a) / c
    assert seen["u3_TIP_mm"] == pytest.approx(1e-3 * 12 / 2000 * bending + shear, rel=8e-3 / int(mesh[0]) ** 2)
    assert "thickness of the nodes 0.2 to 0.6 mm, M" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        (OUTER, ["*SHELL SECTION, ELSET=ALL, MATERIAL=M"], "second one of the elements 1, 2"),
        ("0.3", ["-0.3"], "thickness = -0.3 must be a positive number"),
        ("0.6", ["0.6", *NODAL[:1], "0."], "no *NODAL THICKNESS of the nodes 1, 2, 3, 4 and"),
        ("0.6", ["0.6", "*NODAL THICKNESS", "1, 0."], "a thickness of 0 must be a positive number"),
        ("0.6", ["0.6", "*NODAL THICKNESS", "1, 0.1", "1, 0.2"], "a second thickness of node 1"),
        (OUTER, ["*SHELL SECTION, ELSET=OUT, COMPOSITE, NODAL THICKNESS"], "NODAL THICKNESS of a COMPOSITE"),
    ],
)
def test_sections_that_say_too_much_or_too_little(tmp_path, capsys, old, new, words) -> None:
    lines = swapped(STEPPED, old, *new)
    if "no *NODAL" in words:
        lines = lines[: lines.index("*SHELL SECTION, ELSET=IN, MATERIAL=M")] + new[1:] + [*ROOT, *BENT]
    assert words in refused(tmp_path, capsys, lines)


def test_walls_that_differ_have_no_surfaces_inside(tmp_path, capsys) -> None:
    assert "need the same wall everywhere" in refused(tmp_path, capsys, STEPPED, "--set", "surfaces=3")


def test_plies_that_count_from_two_axes(tmp_path, capsys) -> None:
    fibres = ["*MATERIAL, NAME=F", "*ELASTIC, TYPE=LAMINA", "100000., 4000., 0., 2000., 2000., 2000."]
    axes = ["*ORIENTATION, NAME=O", "0., 1., 0., -1., 0., 0.", "3, 0."]
    walls = ["*SHELL SECTION, ELSET=IN, MATERIAL=F", "0.6", OUTER.replace("=M", "=F, ORIENTATION=O"), "0.3"]
    lines = [*MESH, *HALVES, *fibres, *axes, *walls, *ROOT, *BENT]
    assert "plies count from 2 axes" in refused(tmp_path, capsys, lines)


ONCE = ["--mesh", "1x1", "--no-error"]
ENDS = ["*NSET,NSET=Nfix ", "1,", "2,", "*NSET,NSET=Ntip", "33,", "34,", "*BOUNDARY", "Nfix,1,6", "Nfix,3,6", "1,2,2"]
PRINTS = ["*NODE PRINT,NSET=Ntip", "U,RF", "*EL PRINT,ELSET=ALL,GLOBAL=YES", "S", "*NODE FILE,OUTPUT=3D", "U"]
HALF = ["*ELSET,ELSET=Ehalf,GENERATE", "9,16", "*STEP", "*STATIC", "*DLOAD", "Ehalf,P,-.1", *PRINTS, "*END STEP"]


def test_two_materials_under_pressure_on_half(tmp_path, capsys) -> None:
    """nu = 0, so a beam: q (3 L^4 - 4 a^3 L + a^4)/(24 E I) with E I about the neutral axis; plies from inside."""
    wall = [
        *("*MATERIAL,NAME=EL1", "*ELASTIC", "210000,.0", "*EXPANSION", "12.E-6", "*MATERIAL,NAME=EL2", "*ELASTIC"),
        *("420000.,.0", "*SHELL SECTION,ELSET=ALL,COMPOSITE", "0.01,,EL2", "0.01,,EL1"),
    ]
    mesh = [f"{line}, ,0.00000e+00" if line.startswith("34,") else line for line in mesh_lines(*plate(16, 1, 1.0, 0.1))]
    seen = answered(tmp_path, [*mesh, *wall, *ENDS, *HALF], *ONCE)["quantities"]
    E, z = np.array([420000.0, 210000.0]), np.array([-0.005, 0.005])
    z = z - E @ z / E.sum()
    bending = 0.1 * np.sum(E * (0.01**3 / 12 + 0.01 * z**2))
    assert seen["u3_NTIP_mm"] == pytest.approx(-0.1 * 0.1 * (3 - 0.5 + 0.0625) / (24 * bending), rel=4e-3)
    assert seen["reaction_3_N"] == pytest.approx(0.1 * 0.1 * 0.5, rel=1e-9)
    assert "*EXPANSION" in capsys.readouterr().out


def test_a_ridge_that_tells_the_normals_of_both_sides_has_their_mean(tmp_path, capsys) -> None:
    x, elements = plate(16, 1, 2.0, 1.0)
    x[:, 2] = 0.05 * (1 - np.abs(x[:, 0] - 1))
    ends = ["*BOUNDARY", *(f"{node}, 1, 6" for node in (1, 2, 33, 34))]
    loaded = ["*STEP", "*STATIC", "*CLOAD", "17, 3, 0.5", "18, 3, 0.5", "*END STEP"]
    means = [*mesh_lines(x, elements), *ISOTROPIC, *ends, *loaded]
    sides = [f"{8 + (way > 0)}, {node}, {0.1 * way}, 0., 2." for way in (-1, 1) for node in (17, 18)]
    stated = swapped(means, "*BOUNDARY", "*NORMAL", *sides, "*BOUNDARY")
    values = [answered(tmp_path, lines, *ONCE)["quantities"]["largest_mm"] for lines in (means, stated)]
    assert values[1] == pytest.approx(values[0], rel=1e-12)
    said = capsys.readouterr().out
    assert "2 from the deck" in said
    assert "several normals at 2 nodes" in said
    assert "normal of node 17 is zero" in refused(tmp_path, capsys, swapped(stated, sides[0], "8, 17, 0., 0., 0."))


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("*ELEMENT, TYPE=S4, ELSET=ALL", ["*ELEMENT,TYPE=S8,ELSET=ALL"], "S8 is of second order"),
        ("*STATIC", ["*STATIC", "*TEMPERATURE", "ALL,373.,1000."], "*TEMPERATURE is not supported"),
        ("*STATIC", ["*DYNAMIC"], "*DYNAMIC is not supported"),
        ("*STATIC", ["*STATIC", "*BOUNDARY", "Ntip,4,4,.01"], "a prescribed rotation of .01"),
        ("Ehalf,P,-.1", ["Ehalf,EDNOR1,-.1"], "a load EDNOR1 is not supported: P is"),
        ("*END STEP", ["*END STEP", "*STEP"], "only one step is supported"),
    ],
)
def test_what_the_suite_has_and_a_director_for_each_node_has_not(tmp_path, capsys, old, new, words) -> None:
    lines = [*mesh_lines(*plate(16, 1, 1.0, 0.1)), *ISOTROPIC, *ENDS, *HALF]
    assert words in refused(tmp_path, capsys, swapped(lines, old, *new))
