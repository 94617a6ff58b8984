"""What shell decks of CalculiX's own tests say, in decks of our own; the answers are closed forms."""

import numpy as np
import pytest

from support.decks import ISOTROPIC, answered, mesh_lines, plate, refused, swapped

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
    told = swapped(means, "*BOUNDARY", "*NORMAL", *sides, "*BOUNDARY")
    found = [answered(tmp_path, lines, *ONCE)["quantities"]["largest_mm"] for lines in (means, told)]
    assert found[1] == pytest.approx(found[0], rel=1e-12)
    said = capsys.readouterr().out
    assert "2 from the deck" in said
    assert "several normals at 2 nodes" in said
    assert "normal of node 17 is zero" in refused(tmp_path, capsys, swapped(told, sides[0], "8, 17, 0., 0., 0."))


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("*ELEMENT, TYPE=S4, ELSET=ALL", ["*ELEMENT,TYPE=S8,ELSET=ALL"], "S8 is of second order"),
        ("*STATIC", ["*STATIC", "*TEMPERATURE", "ALL,373.,1000."], "*TEMPERATURE is not understood"),
        ("*STATIC", ["*DYNAMIC"], "*DYNAMIC is not understood"),
        ("*STATIC", ["*STATIC", "*BOUNDARY", "Ntip,4,4,.01"], "a prescribed rotation of .01"),
        ("Ehalf,P,-.1", ["Ehalf,EDNOR1,-.1"], "a load EDNOR1 is not understood: P is"),
        ("*END STEP", ["*END STEP", "*STEP"], "one step is understood"),
    ],
)
def test_what_the_suite_has_and_a_director_for_each_node_has_not(tmp_path, capsys, old, new, words) -> None:
    lines = [*mesh_lines(*plate(16, 1, 1.0, 0.1)), *ISOTROPIC, *ENDS, *HALF]
    assert words in refused(tmp_path, capsys, swapped(lines, old, *new))
