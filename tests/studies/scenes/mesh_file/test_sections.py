"""Decks with several sections, and with a thickness at each node, against beams in closed form."""

import numpy as np
import pytest

from support.decks import answered, mesh_lines, plate, refused, swapped

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
