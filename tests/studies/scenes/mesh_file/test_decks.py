"""Shells from decks: against scenes on the same mesh, and what is refused with which words."""

import json
from collections.abc import Sequence

import meshio
import numpy as np
import pytest

from formulations.geometry.surfaces import cylinder, normal
from formulations.section.laminate import Ply
from studies.cli import OK, WRONG_USE, main
from studies.scenes import SCENES
from studies.scenes.benchmarks.obstacle_course import ScordelisLo
from studies.scenes.complete import complete
from studies.scenes.element import centred_laminate, patch
from studies.scenes.mesh_file.scene import entered
from studies.scenes.statics import StaticModel, area_load
from studies.solving.refinement.records import growth
from studies.solving.solve import solve
from support.decks import ISOTROPIC, STRIP, answered, mesh_lines, plate, refused, swapped, written


def test_a_cantilever_is_that_of_the_scene(tmp_path, capsys) -> None:
    result = answered(tmp_path, STRIP, "--no-error", "--set", "load_fraction=0.25,0.5,0.75,1")
    scene = solve(*complete("cantilever", {"element": "quads"}))
    for ours, step in zip(scene.steps, result["steps"], strict=True):
        assert step["u3_TIP_mm"] == pytest.approx(ours["tip_deflection_mm"], rel=1e-10)
        assert step["u1_TIP_mm"] == pytest.approx(-ours["tip_shortening_mm"], rel=1e-10)
        assert step["reaction_3_N"] == pytest.approx(-4.0 * step["load_fraction"], rel=1e-9)
    last = result["steps"][-1]
    assert last["largest_at_node"] in (33, 34)
    assert last["along_forces_mm"] == pytest.approx(last["u3_TIP_mm"], rel=1e-12)
    assert result["measure"] == "exact"
    assert result["mesh"] == "1x1"
    said = capsys.readouterr().out
    assert "34 nodes, 16 quadrilaterals" in said
    assert "without effect: *HEADING, *NODE FILE" in said
    assert not any(name.endswith(".inp") for name in SCENES)  # entered for that call alone


def test_without_nlgeom_the_measure_is_linear(tmp_path) -> None:
    lines = swapped(STRIP, "*STEP, NLGEOM", "*STEP")
    result = answered(tmp_path, lines, "--no-error")
    assert result["measure"] == "linear"
    tip = result["quantities"]["u3_TIP_mm"]
    assert tip == pytest.approx(4.0 * 10.0**3 / (3 * 1.2e6 * 0.1**3 / 12), rel=2e-3)  # P L^3/(3 E I), and shear
    assert answered(tmp_path, lines, "--no-error", "--measure", "exact")["quantities"]["u3_TIP_mm"] < 0.6 * tip


def test_a_moment_at_the_end_bends_a_strip_to_a_circle(tmp_path, capsys) -> None:
    """w = M L^2/(2 E I), of half a moment on both nodes; in axes of the nodes, too."""
    lines = swapped(swapped(STRIP, "*STEP, NLGEOM", "*STEP"), "TIP, 3, 2.", "TIP, 5, -1.")
    deflection = 2.0 * 10.0**2 / (2 * 1.2e6 * 0.1**3 / 12)
    assert answered(tmp_path, lines, "--no-error")["quantities"]["u3_TIP_mm"] == pytest.approx(deflection, rel=1e-7)
    assert "moments on 2 nodes, in all 0 -2 0 N mm" in capsys.readouterr().out
    turned = swapped(lines, "TIP, 5, -1.", "TIP, 4, -1.")
    turned = swapped(turned, "*NSET, NSET=ROOT", "*TRANSFORM, NSET=TIP", "0, 1, 0, -1, 0, 0", "*NSET, NSET=ROOT")
    turned = [line for line in turned if line not in ("*NSET, NSET=TIP", "33, 34")]
    turned = swapped(turned, "*TRANSFORM, NSET=TIP", "*NSET, NSET=TIP", "33, 34", "*TRANSFORM, NSET=TIP")
    actual = answered(tmp_path, turned, "--no-error")["quantities"]["u3_TIP_mm"]
    assert actual == pytest.approx(deflection, rel=1e-7)
    assert "moments are supported with the measure linear only" in refused(
        tmp_path, capsys, swapped(STRIP, "TIP, 3, 2.", "TIP, 5, -1.")
    )


def roof_of(m: int) -> tuple[StaticModel, np.ndarray, list[str]]:
    """Scordelis-Lo with the supports that a deck can tell: u_x = u_y = 0 on the diaphragm, the director free.

    The model, the number of the node in the middle of the free edge, and the deck, in which it is the set EDGE.
    """
    _, request = complete("scordelis-lo", {"element": "quads"}, (m, m), measure="linear")
    laminate = centred_laminate(request, Ply.isotropic(4.32e8, 0.0, 0.25))
    edges = ("diaphragm", "symmetric", "symmetric", "free")
    roof = patch(
        request, cylinder(ScordelisLo.RADIUS), (0, ScordelisLo.LENGTH / 2), (0, ScordelisLo.HALF_ANGLE), laminate, edges
    )
    nodal = area_load(roof, lambda a1, a2: ScordelisLo.WEIGHT * np.array([-1.0, 0.0, 0.0]))
    corner = roof.grid.node_at(ScordelisLo.LENGTH / 2, ScordelisLo.HALF_ANGLE)
    a1, a2 = roof.grid.nodes.T
    frame = roof.surface.frame(a1, a2)
    forces = np.einsum("nif,nij->nj", nodal.reshape(-1, 3, 2), frame)
    mesh = mesh_lines(roof.surface.position(a1, a2), roof.grid.elements[:, ::-1], normal(roof.surface, a1, a2))
    material = ["*MATERIAL, NAME=M", "*ELASTIC", "4.32e8, 0.", "*SHELL SECTION, ELSET=ALL, MATERIAL=M", "0.25"]
    lines = [*mesh, *material, "*BOUNDARY"]
    for value, axis, support in ((0.0, 0, "1, 2"), (ScordelisLo.LENGTH / 2, 0, "ZSYMM"), (0.0, 1, "YSYMM")):
        lines += [f"{node + 1}, {support}" for node in roof.grid.on_line(axis, value)]
    lines += ["*STEP", "*STATIC", "*CLOAD"]
    lines += [f"{n + 1}, {i + 1}, {forces[n, i]:.17g}" for n, i in np.argwhere(forces)]
    lines += ["*NSET, NSET=EDGE", str(corner + 1), "*NODE PRINT, NSET=EDGE", "U", "*END STEP"]
    return StaticModel.of(request, roof, lambda shell, u: {}, forces=nodal), corner, lines


def without_normals(lines: Sequence[str]) -> list[str]:
    until = lines.index("*ELEMENT, TYPE=S4, ELSET=ALL")
    return [",".join(line.split(",")[:4]) if 0 < at < until else line for at, line in enumerate(lines)]


def test_a_roof_on_soft_diaphragms(tmp_path) -> None:
    model, corner, lines = roof_of(8)
    step = model.problem_at(1.0).linearise(np.zeros(model.n_unknowns), None)
    u = np.linalg.solve(step.tangent.toarray(), -step.residual)
    ours = np.mean(model.shell.discretisation.cartesian(u), axis=0)[corner]
    seen = answered(tmp_path, lines, "--no-error")["quantities"]
    values = [seen[f"u{i}_EDGE_mm"] for i in (1, 2, 3)]
    assert np.allclose(values, ours, rtol=0, atol=1e-9 * np.abs(ours).max())
    bare = answered(tmp_path, without_normals(lines), "--no-error")["quantities"]
    assert bare["u1_EDGE_mm"] == pytest.approx(seen["u1_EDGE_mm"], rel=1e-9)  # normals of a cylinder are exact


@pytest.mark.slow
def test_the_interval_of_a_roof_has_the_value_of_others(tmp_path) -> None:
    """0.30202: Krysl and Chen's, of flat facets.

    On 64x64 elements the layer at its free edges, resolved, adds 0.16 %: intervals allow for that.
    """
    result = answered(tmp_path, without_normals(roof_of(16)[2]))
    limit = result["errors"]["u1_EDGE_mm"]
    assert result["mesh"] == "4x4"
    assert limit["low"] <= -0.30202 <= limit["high"]
    assert limit["high"] - limit["low"] < (0.004 + 0.0016) * 0.302


def test_the_interval_of_a_cantilever_has_the_printed_deflection(tmp_path, capsys) -> None:
    """Sze, Liu, Lo (2004), table 1: 6.698 at 4 N."""
    result = answered(tmp_path, STRIP)
    limit = result["errors"]["u3_TIP_mm"]
    assert result["mesh"] == "4x4"
    assert limit["low"] <= 6.698 <= limit["high"] < 1.001 * limit["low"]
    said = capsys.readouterr().out
    assert "values of mesh 4x4, 256 elements" in said
    assert "on its own mesh, 1x1: largest_mm 7.45" in said


def test_a_ring_of_four_elements_is_cut_on_its_circle(tmp_path) -> None:
    """A quarter of a ring under inner pressure, normals from its positions: Lame's mean of both faces for nu = 0.

    Each of its ends is held in the plane of symmetry, new nodes between held ones, too.
    """
    x, elements = plate(4, 1, np.pi / 2, 4.0)
    x = np.stack([10 * np.cos(x[:, 0]), 10 * np.sin(x[:, 0]), x[:, 1]], axis=-1)
    lines = [
        *mesh_lines(x, elements),
        *("*MATERIAL, NAME=M", "*ELASTIC", "1000., 0.", "*SHELL SECTION, ELSET=ALL, MATERIAL=M", "0.1"),
        *("*BOUNDARY", "1, YSYMM", "2, YSYMM", "9, XSYMM", "10, XSYMM", "1, 3, 3"),
        *("*STEP", "*STATIC", "*DLOAD", "ALL, P, 0.01", "*END STEP"),
    ]
    inner, outer = 9.95, 10.05
    p = 0.01 * 10 / inner  # a dead pressure is on the area of the middle
    faces = [p * inner**2 / (1000 * (outer**2 - inner**2)) * (r + outer**2 / r) for r in (inner, outer)]
    result = answered(tmp_path, lines, "--set", "fold_deg=25")
    limit = result["errors"]["largest_mm"]
    assert limit["low"] <= np.mean(faces) <= limit["high"] < 1.01 * limit["low"]


def test_plies_and_pressure(tmp_path, capsys) -> None:
    """A cross-ply strip, one end clamped, under pressure: the beam of its plies, p b L^4/(8 D), nu = 0."""
    lines = [
        *mesh_lines(*plate(32, 1, 100.0, 5.0)),
        *("*MATERIAL, NAME=FIBRES", "*ELASTIC, TYPE=LAMINA", "100000., 4000., 0., 2000., 2000., 2000."),
        *("*MATERIAL, NAME=SAME", "*ELASTIC, TYPE=ENGINEERING CONSTANTS"),
        *("100000., 4000., 4000., 0., 0., 0., 2000., 2000.", "2000."),
        *("*ORIENTATION, NAME=O", "0., 1., 0., -1., 0., 0.", "3, -90."),
        "*SHELL SECTION, ELSET=ALL, COMPOSITE, ORIENTATION=O",
        *("0.5, 3, FIBRES, 0.", "1.0, 3, SAME, 90.", "0.5, 3, FIBRES, 0."),
        *("*NSET, NSET=ROOT", "1, 2", "*NSET, NSET=TIP, GENERATE", "65, 66, 1", "*BOUNDARY", "ROOT, ENCASTRE"),
        *("*STEP", "*STATIC", "*DLOAD", "ALL, P, 0.0001", "*NODE PRINT, NSET=TIP", "U", "*END STEP"),
    ]
    seen = answered(tmp_path, lines, "--no-error")["quantities"]
    bending = (100000.0 * (2.0**3 - 1.0**3) + 4000.0 * 1.0**3) / 12
    deflection = 1e-4 * 100.0**4 / (8 * bending)
    assert seen["u3_TIP_mm"] == pytest.approx(deflection, rel=6e-3)  # shear of the wall and 32 elements
    assert seen["reaction_3_N"] == pytest.approx(-1e-4 * 500.0, rel=1e-9)
    assert "plies from inside" in capsys.readouterr().out
    half = answered(
        tmp_path, swapped(lines, "ALL, P, 0.0001", *(f"{i}, P, 0.0001" for i in range(1, 17))), "--mesh", "2x2"
    )
    assert half["quantities"]["reaction_3_N"] == pytest.approx(-1e-4 * 250.0, rel=1e-9)


def test_a_deck_has_surfaces_inside_its_wall(tmp_path) -> None:
    """As thin as that they change nothing; a law at points is asked for like anywhere."""
    two = answered(tmp_path, STRIP, "--no-error")["quantities"]["u3_TIP_mm"]
    asked = ("--no-error", "--set", "surfaces=3", "--set", "law=neo-hooke")
    assert answered(tmp_path, STRIP, *asked)["quantities"]["u3_TIP_mm"] == pytest.approx(two, rel=2e-3)


def test_nine_constants_of_a_deck_are_those_of_its_ply(tmp_path) -> None:
    elastic = ["*ELASTIC, TYPE=ENGINEERING CONSTANTS", "1000., 400., 100., 0.1, 0.2, 0.3, 50., 60.", "70."]
    material = ["*MATERIAL, NAME=M", *elastic, "*SHELL SECTION, ELSET=ALL, MATERIAL=M", "0.1"]
    lines = [*mesh_lines(*plate(2, 1, 1.0, 1.0)), *material, "*BOUNDARY", "1, 1, 6", "2, 1, 6", *LOADED]
    with entered(written(tmp_path, lines)) as scene:
        ((ply,),) = scene.plies
    assert (ply.moduli, ply.poisson, ply.shears) == ((1000, 400, 100), (0.1, 0.2, 0.3), (50, 60, 70))


def test_pressure_follows_with_nlgeom(tmp_path) -> None:
    """A quarter of a ring under inner pressure, symmetric at both ends: it turns nowhere, R grows by p R^2/(E h)."""
    a = np.linspace(0, np.pi / 2, 17)
    x, elements = plate(16, 1, np.pi / 2, 1.0)
    x = np.stack([10 * np.cos(x[:, 0]), 10 * np.sin(x[:, 0]), x[:, 1]], axis=-1)
    assert len(a) * 2 == len(x)
    lines = [
        *mesh_lines(x, elements),
        *("*MATERIAL, NAME=M", "*ELASTIC", "1000., 0.", "*SHELL SECTION, ELSET=ALL, MATERIAL=M", "0.1"),
        *("*BOUNDARY", "1, YSYMM", "2, YSYMM", "33, XSYMM", "34, XSYMM", "1, 3, 3"),
        *("*STEP, NLGEOM", "*STATIC", "*DLOAD", "ALL, P, 0.01", "*END STEP"),
    ]
    result = answered(tmp_path, lines, "--no-error")
    assert result["settings"]["pressure"] == "follower"
    assert result["quantities"]["largest_mm"] == pytest.approx(0.01 * 10.0**2 / (1000.0 * 0.1), rel=0.03)
    dead = answered(tmp_path, lines, "--no-error", "--set", "pressure=dead")
    assert dead["quantities"]["largest_mm"] == pytest.approx(0.01, rel=0.03)


@pytest.mark.slow
def test_a_mesh_that_is_enough_is_chosen(tmp_path, capsys) -> None:
    deck, out = written(tmp_path, STRIP), str(tmp_path / "out")
    assert main(["choose", deck, "--error", "5%", "--of", "u3_TIP_mm", "--budget", "4s", "--out", out]) == OK
    said = capsys.readouterr().out
    assert f"footprint solve {deck} --mesh 1x1 --measure exact --out DIR" in said


TWO = ["*NODE", "1, 0, 0, 0", "2, 1, 0, 0", "3, 1, 1, 0", "4, 0, 1, 0", "5, 2, 0, 0", "6, 2, 1, 0"]
REST = [*ISOTROPIC, "*NSET, NSET=ROOT", "1, 4", "*BOUNDARY", "ROOT, 1, 6"]
LOADED = ["*STEP", "*STATIC", "*CLOAD", "5, 3, 1.", "*END STEP"]
PAIR = [*TWO, "*ELEMENT, TYPE=S4, ELSET=ALL", "1, 1, 2, 3, 4", "2, 2, 5, 6, 3", *REST, *LOADED]


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("*ELEMENT, TYPE=S4, ELSET=ALL", ["*ELEMENT, TYPE=S3, ELSET=ALL"], "line 8: *ELEMENT, TYPE=S3 is a triangle"),
        ("*ELEMENT, TYPE=S4, ELSET=ALL", ["*ELEMENT, TYPE=S8R, ELSET=ALL"], "Mesh.ElementOrder = 1"),
        ("*ELEMENT, TYPE=S4, ELSET=ALL", ["*ELEMENT, TYPE=C3D8, ELSET=ALL"], "C3D8 is not a quadrilateral shell"),
        ("1, 1, 2, 3, 4", ["1, 1, 2, 3, 3"], "element 1 has a node twice"),
        ("1, 1, 2, 3, 4", ["1, 1, 2, 3, 7"], "element 1 names node 7"),
        ("1, 1, 2, 3, 4", ["2, 1, 2, 3, 4"], "element 2 twice"),
        ("1, 1, 2, 3, 4", ["1, 1, 3, 2, 4"], "angle of 180 degrees or more, or without an area: 1"),
        (
            "2, 2, 5, 6, 3",
            ["2, 3, 6, 5, 2"],
            "elements 1 and 2 go round against each other at the edge of nodes 2 and 3",
        ),
        ("2, 1, 0, 0", ["2, nan, 0, 0"], "line 3: nan is not a finite number"),
        ("2, 1, 0, 0", ["2, 1e999, 0, 0"], "line 3: 1e999 is not a finite number"),
        ("1.2e6, 0.", ["1e200, 0."], "1e200 must lie in [-1e+60, 1e+60]"),
        ("2, 1, 0, 0", ["99999999999, 1, 0, 0"], "99999999999 is not a whole number in [1, 2147483647]"),
        ("2, 1, 0, 0", ["1, 1, 0, 0"], "node 1 twice"),
        ("1, 4", ["1, 4, LOST"], "there is no set of nodes LOST"),
        ("ROOT, 1, 6", ["LOST, 1, 6"], "there is no set of nodes LOST"),
        ("ROOT, 1, 6", ["ROOT, 1, 11"], "degrees of freedom 1 to 11 must lie in 1 to 6"),
        ("ROOT, 1, 6", ["ROOT, 1, 6, 0.5"], "a prescribed rotation of 0.5 is not supported"),
        ("ROOT, 1, 6", ["ROOT, 4, 6"], "degrees 4, 5, 6 at node 1, whose normal is (0, 0, 1)"),
        ("ROOT, 1, 6", ["ROOT, ZSYMM"], "or those of a plane of symmetry in which the normal lies"),
        ("*NSET, NSET=ROOT", ["*NSET, NSET=ROOT, GENERATE"], "there is no node"),
        ("0.1", ["-0.1"], "line 15: thickness = -0.1 must be a positive number"),
        ("1.2e6, 0.", ["1.2e6, 0.5"], "nu = 0.5 must lie in (-1, 0.5)"),
        ("5, 3, 1.", ["5, 7, 1."], "degree of freedom 7 must be 1 to 6"),
        ("5, 3, 1.", ["5, 6, 1."], "the moment on node 5 turns about the normal (0, 0, 1)"),
        ("5, 3, 1.", ["5, 3, 1.", "5, 3, 1."], "a second load on node 5, degree 3"),
        ("*CLOAD", ["*CLOAD, AMPLITUDE=A"], "*CLOAD has a parameter AMPLITUDE that is not supported"),
        ("*STATIC", ["*STATIC, RIKS"], "*STATIC has a parameter RIKS"),
        ("*STATIC", ["*FREQUENCY"], "*FREQUENCY is not supported"),
        ("*END STEP", ["*END STEP", "*STEP"], "only one step is supported"),
        ("*NODE", ["*INCLUDE, INPUT=other.inp", "*NODE"], "line 1: *INCLUDE is not supported"),
        ("*NODE", ["*PART, NAME=P", "*NODE"], "line 1: *PART is not supported"),
    ],
)
def test_what_is_not_understood_is_refused_by_name(tmp_path, capsys, old, new, words) -> None:
    if "GENERATE" in new[0]:
        lines = swapped(swapped(PAIR, old, *new), "1, 4", "1, 2000000000, 1")
        words = "2000000000 nodes, of 6 that there are"
    else:
        lines = swapped(PAIR, old, *new)
    assert words in refused(tmp_path, capsys, lines)


def test_a_fold_is_refused_with_its_edge(tmp_path, capsys) -> None:
    folded = swapped(swapped(PAIR, "5, 2, 0, 0", "5, 1, 0, 1"), "6, 2, 1, 0", "6, 1, 1, 1")
    assert "a fold of 90 degrees at the edge of nodes 2 and 3" in refused(tmp_path, capsys, folded)
    third = swapped(PAIR, "2, 2, 5, 6, 3", "2, 2, 5, 6, 3", "3, 3, 2, 7, 8")
    third = swapped(third, "6, 2, 1, 0", "6, 2, 1, 0", "7, 1, 0, 1", "8, 1, 1, 1")
    assert "more than two elements meet at the edge of nodes 2 and 3" in refused(tmp_path, capsys, third)


def test_options_that_a_deck_does_not_have(tmp_path, capsys) -> None:
    own = "must be 1x1, the mesh of panel.inp, or NxN, each of its elements in N x N, N up to 353"
    for mesh in ("4x2", "354x354"):
        assert f"--mesh {mesh} {own}" in refused(tmp_path, capsys, PAIR, "--mesh", mesh)
    assert "has no setting 'distort'" in refused(tmp_path, capsys, PAIR, "--set", "distort=0.2")
    assert "no keywords" in refused(tmp_path, capsys, [])
    assert "data before the first keyword" in refused(tmp_path, capsys, ["\x00\x01\x02"])
    assert main(["solve", str(tmp_path / "none.inp"), "--out", str(tmp_path / "out")]) == WRONG_USE


def test_a_deck_of_bricks_is_refused(tmp_path, capsys) -> None:
    deck = tmp_path / "bricks.inp"
    assert main(["export", "cantilever", "--mesh", "4x1", "--format", "inp", "--out", str(deck)]) == OK
    assert main(["solve", str(deck), "--out", str(tmp_path / "out")]) == WRONG_USE
    assert "C3D20" in capsys.readouterr().err


def test_a_plate_with_an_inner_corner_is_flat(tmp_path, capsys) -> None:
    """Three elements share a node of the rim, which has no tangent there, and two edges to nodes inside."""
    x, elements = plate(6, 6, 6.0, 6.0)
    arms = x[elements].mean(axis=1)[:, :2].min(axis=1) < 3.0
    lines = [*mesh_lines(x, elements[arms]), *ISOTROPIC, "*BOUNDARY", "7, 1, 6", "14, 1, 6", "21, 1, 6", *LOADED[:3]]
    assert (
        main(
            [
                "solve",
                written(tmp_path, [*lines, "45, 3, 1.", "*END STEP"]),
                "--no-error",
                "--out",
                str(tmp_path / "out"),
            ]
        )
        == OK
    )
    assert "converged" in capsys.readouterr().out


def test_elements_that_meet_back_to_back_in_a_node_have_no_normal_there(tmp_path, capsys) -> None:
    lines = swapped(PAIR, "2, 2, 5, 6, 3", "2, 3, 7, 8, 9")
    lines = swapped(lines, "6, 2, 1, 0", "6, 2, 1, 0", "7, 1, 2, 0", "8, 2, 2, 0", "9, 2, 1, 0")
    lines = swapped(lines, "5, 3, 1.", "8, 3, 1.")
    assert "no normal in common: 3" in refused(tmp_path, capsys, lines)


def test_a_part_that_hangs_on_nothing_is_refused_with_its_elements(tmp_path, capsys) -> None:
    seam = swapped(PAIR, "2, 2, 5, 6, 3", "2, 7, 5, 6, 8")
    seam = swapped(seam, "6, 2, 1, 0", "6, 2, 1, 0", "7, 1, 0, 0", "8, 1, 1, 0")
    assert "no support on the part of the elements 2, which have no node" in refused(tmp_path, capsys, seam)
    held = swapped(seam, "ROOT, 1, 6", "ROOT, 1, 6", "7, 1, 6", "8, 1, 6")
    assert main(["solve", written(tmp_path, held), "--no-error", "--out", str(tmp_path / "held")]) == OK


def test_a_shell_that_is_free_to_move_is_no_answer(tmp_path) -> None:
    lines = swapped(PAIR, "ROOT, 1, 6", "ROOT, 3, 3")
    assert main(["solve", written(tmp_path, lines), "--out", str(tmp_path / "out")]) not in (OK, WRONG_USE)


@pytest.mark.parametrize(("node", "within"), [(25, 0.02), pytest.param(46, 0.15, marks=pytest.mark.slow)])
def test_what_a_force_along_the_wall_makes_grow_is_foreseen(tmp_path, node: int, within: float) -> None:
    """In the middle of a sheet Kelvin's, (3 - nu)(1 + nu)/(4 pi E h) ln 2; at its rim Flamant's, 2/(pi E h) ln 2."""
    lines = [
        *mesh_lines(*plate(6, 6, 1.0, 1.0)),
        *("*MATERIAL, NAME=M", "*ELASTIC", "1000., 0.3", "*SHELL SECTION, ELSET=ALL, MATERIAL=M", "0.02"),
        *("*BOUNDARY", *(f"{i}, 1, 6" for i in range(1, 8)), "*STEP", "*STATIC"),
        *("*CLOAD", f"{node}, 1, 1.", "*END STEP"),
    ]
    deck = written(tmp_path, lines)
    with entered(deck):
        runs = [solve(*complete(deck, {}, (n, n), measure="linear")) for n in (2, 4)]
    grown = np.diff([run.quantities["along_forces_mm"] for run in runs])[0]
    exact = {25: 2.7 * 1.3 / (4 * np.pi * 20), 46: 2 / (np.pi * 20)}[node] * np.log(2)
    assert grown == pytest.approx(exact, rel=0.03)
    assert growth(runs[-1], "along_forces_mm") == pytest.approx(exact, rel=within)
    assert growth(runs[-1], "reaction_1_N") == 0.0


@pytest.mark.parametrize(("step", "tolerance"), [("*STEP", "1e-9"), ("*STEP, NLGEOM", "1e-2")])
def test_supports_in_balance_with_each_other_have_no_reaction_and_no_limit_of_one(tmp_path, step, tolerance) -> None:
    """A tip moved by a support: what both ends bear has the sum 0, of which the grids know no limit."""
    moved = [line for line in STRIP if line not in ("*CLOAD", "TIP, 3, 2.", "*NSET, NSET=TIP", "33, 34")]
    moved = swapped(moved, "ROOT, 1, 6", "ROOT, 1, 6", "33, 3, 3, 0.1", "34, 3, 3, 0.1")
    moved = swapped(moved, "*STEP, NLGEOM", step)
    out = tmp_path / "out"
    assert main(["solve", written(tmp_path, moved), "--set", f"tolerance={tolerance}", "--out", str(out)]) == OK
    record = json.loads((out / "result.json").read_text())
    assert [record["quantities"][f"reaction_{i}_N"] for i in (1, 2, 3)] == [0.0, 0.0, 0.0]
    assert not any("reaction" in name for name in record["errors"])


@pytest.mark.parametrize("mesh", ["1x1", "4x4"])
def test_supports_that_have_names_have_a_resultant_each(tmp_path, mesh) -> None:
    """A strip on three sets, loaded as a lever: P a/L on one end; the third bears none, and is named like another."""
    x, elements = plate(8, 2, 8.0, 1.0)
    lines = [
        *mesh_lines(x, elements),
        *ISOTROPIC,
        *("*NSET, NSET=LEFT", "1, 2, 3", "*NSET, NSET=RIGHT-END", "25, 26, 27", "*NSET, NSET=RIGHT_END", "14"),
        *("*BOUNDARY", "LEFT, 1, 3", "RIGHT-END, 2, 3", "RIGHT_END, 2, 2", "*STEP", "*STATIC"),
        *("*CLOAD", "7, 3, 1.", "8, 3, 2.", "9, 3, 1.", "*END STEP"),
    ]
    seen = answered(tmp_path, lines, "--no-error", "--mesh", mesh)["quantities"]
    assert seen["reaction_3_N"] == pytest.approx(-4.0, rel=1e-9)
    assert seen["reaction_3_LEFT_N"] == pytest.approx(-3.0, rel=1e-9)
    assert seen["reaction_3_RIGHT_END_N"] == pytest.approx(-1.0, rel=1e-9)
    assert seen["reaction_3_RIGHT_END_2_N"] == 0.0


def test_readings_have_no_smallest_displacement(tmp_path) -> None:
    """Of a linear deck under 1e-200 of its forces; the squares of its displacements are 0."""
    linear = swapped(STRIP, "*STEP, NLGEOM", "*STEP")
    whole, faint = (
        answered(tmp_path, swapped(linear, "TIP, 3, 2.", f"TIP, 3, {force}"), "--no-error")["quantities"]
        for force in ("2.", "2e-200")
    )
    assert faint["largest_at_node"] in (33, 34)
    for name in ("largest_mm", "along_forces_mm", "u3_TIP_mm"):
        assert faint[name] == pytest.approx(1e-200 * whole[name], rel=1e-6, abs=0.0)


def test_fields_have_the_stresses_of_the_plies(tmp_path) -> None:
    """A strip of 1 x 0.1 mm under 4 N at its end, 10 mm away: 6 F x/(b h^2) at the middle of an element, nu = 0."""
    out = tmp_path / "out"
    lines = [line.replace("*STEP, NLGEOM", "*STEP") for line in STRIP]
    assert main(["solve", written(tmp_path, lines), "--no-error", "--out", str(out)]) == OK
    cells = meshio.read(out / "fields.vtu").cell_data
    arm = 10.0 - 0.625 * (np.arange(16) + 0.5)
    for name, sign in (("S_LL1-", 1.0), ("S_LL1+", -1.0)):
        np.testing.assert_allclose(cells[name][0], sign * 6 * 4 * arm / 0.1**2, rtol=1e-7)
    assert max(np.abs(cells[name][0]).max() for name in ("S_TT1-", "S_LT1+")) < 1e-9 * cells["S_LL1-"][0].max()
