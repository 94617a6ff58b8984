"""Supports and forces in axes of *TRANSFORM: a deck turned in space moves as it did, and wedges are symmetric."""

import numpy as np
import pytest

from support.decks import STRIP, answered, mesh_lines, numbers, plate, refused, swapped

ROUND = np.array([[0.36, 0.48, -0.8], [-0.8, 0.6, 0.0], [0.48, 0.64, 0.6]])  # a rotation, no axis of which stays


def panel(turn: np.ndarray, axes: bool) -> list[str]:
    """A quarter of a cylindrical panel: planes of symmetry x = 0 and y = 0, soft hinges, a force and a pressure."""
    x, elements = plate(4, 3, 0.5, 8.0)
    x = np.stack([10 * np.sin(x[:, 0]), x[:, 1], 10 * np.cos(x[:, 0])], axis=-1)
    number = np.arange(1, len(x) + 1).reshape(5, 4)
    sets = {
        "XS": number[0, 1:],
        "YS": number[1:, 0],
        "XY": number[:1, 0],
        "HINGE": number[-1, 1:],
        "TOP": number[:1, 0],
    }
    lines = mesh_lines(x @ turn, elements)
    for name, nodes in {**sets, "ALL": number.ravel()}.items():
        lines += [f"*NSET, NSET={name}", *map(str, nodes)]
    if axes:
        lines += ["*TRANSFORM, NSET=ALL, TYPE=R", numbers([*(3 * turn[0]), *(turn[1] + 2 * turn[0])])]
    return [
        *lines,
        *("*MATERIAL, NAME=M", "*ELASTIC", "1000., 0.3", "*SHELL SECTION, ELSET=ALL, MATERIAL=M", "0.2"),
        *("*BOUNDARY", "XS, XSYMM", "YS, YSYMM", "TOP, 1, 2", "TOP, 4, 6", "HINGE, 1, 1", "HINGE, 3, 3, 0.02"),
        *("*STEP, NLGEOM", "*STATIC", "*CLOAD", "TOP, 3, -0.2", "TOP, 1, 0.1", "*DLOAD", "ALL, P, 0.002"),
        *("*NODE PRINT, NSET=ALL", "U", "*END STEP"),
    ]


@pytest.mark.parametrize("mesh", ["1x1", "2x2"])
def test_a_panel_turned_in_space_moves_as_it_did(tmp_path, capsys, mesh) -> None:
    as_it_is, turned = (
        answered(tmp_path, panel(turn, axes), "--mesh", mesh, "--no-error")["quantities"]
        for turn, axes in ((np.eye(3), False), (ROUND, True))
    )
    size = as_it_is["largest_mm"]
    assert size > 0.02
    for word in ("largest_mm", "along_forces_mm"):
        assert turned[word] == pytest.approx(as_it_is[word], rel=0, abs=1e-9 * size)
    for kind in ("reaction_{}_N", "u{}_ALL_mm"):
        before, behind = (np.array([each[kind.format(i)] for i in (1, 2, 3)]) for each in (as_it_is, turned))
        assert np.allclose(behind, before @ ROUND, rtol=0, atol=1e-9 * np.abs(before).max())
    assert abs(as_it_is["reaction_3_N"]) > 0.02
    assert "or those of a plane of symmetry in which the normal lies" in refused(tmp_path, capsys, panel(ROUND, False))


FIRST = 10 * np.array([np.cos(0.3), np.sin(0.3)])


@pytest.mark.parametrize("mesh", ["1x1", "2x2"])
def test_a_support_that_moves_bends_a_strip(tmp_path, mesh) -> None:
    """In the middle 5/16 of what the tip is moved by, but for the shear of the wall; at half the load half of it."""
    lines = swapped(STRIP, "*STEP, NLGEOM", "*STEP")
    loaded = lines.index("*STEP")
    lines = [*lines[:loaded], "*NSET, NSET=MID", "17, 18", "*STEP", "*STATIC", "*BOUNDARY", "TIP, 3, 3, 0.2"]
    lines += ["*NODE PRINT, NSET=MID", "U", "*NODE PRINT, NSET=TIP", "U", "*END STEP"]
    result = answered(tmp_path, lines, "--mesh", mesh, "--no-error", "--set", "load_fraction=0.5,1")
    for step in result["steps"]:
        assert step["u3_TIP_mm"] == pytest.approx(0.2 * step["load_fraction"], rel=1e-12)
        assert step["u3_MID_mm"] == pytest.approx(5 / 16 * step["u3_TIP_mm"], rel=2e-3)
        assert abs(step["reaction_3_N"]) < 1e-9


def wedge() -> list[str]:
    x, elements = plate(6, 1, 0.6, 1.0)
    x = np.stack([10 * np.cos(x[:, 0] + 0.3), 10 * np.sin(x[:, 0] + 0.3), x[:, 1]], axis=-1)
    return [
        *mesh_lines(x, elements),
        *("*MATERIAL, NAME=M", "*ELASTIC", "1000., 0.", "*SHELL SECTION, ELSET=ALL, MATERIAL=M", "0.1"),
        *("*NSET, NSET=ENDS", "1, 2, 13, 14", "*TRANSFORM, NSET=ENDS, TYPE=C", "0., 0., 5., 0., 0., 7."),
        *("*BOUNDARY", "ENDS, YSYMM", "1, 3, 3", "*STEP", "*STATIC", "*DLOAD", "ALL, P, 0.01", "*END STEP"),
    ]


def test_a_wedge_of_a_ring_under_pressure_grows(tmp_path) -> None:
    """Symmetric about two planes that no axis is normal to: u_r = p R^2/(E h)."""
    seen = answered(tmp_path, wedge(), "--mesh", "2x2", "--no-error")["quantities"]
    assert seen["largest_mm"] == pytest.approx(0.01 * 10.0**2 / (1000.0 * 0.1), rel=0.01)
    spread = np.array([np.cos(0.9) - np.cos(0.3), np.sin(0.9) - np.sin(0.3)])  # of the radii, a force p R b each
    actual = np.array([seen["reaction_1_N"], seen["reaction_2_N"]])
    assert np.allclose(actual, 0.1 * np.array([-spread[1], spread[0]]), rtol=2e-3)


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("*TRANSFORM, NSET=ENDS, TYPE=C", ["*TRANSFORM, NSET=ENDS, TYPE=S"], "TYPE=S is not supported"),
        ("0., 0., 5., 0., 0., 7.", ["0., 0., 5., 0., 0., 5."], "these two points make no axes"),
        ("0., 0., 5., 0., 0., 7.", ["9., 0., 5., 9., 0., 1e999"], "1e999 is not a finite number"),
        ("0., 0., 5., 0., 0., 7.", [numbers([*FIRST, 0.0, *FIRST, 1.0])], "node 1 lies on the axis"),
        ("*BOUNDARY", ["*TRANSFORM, NSET=ENDS", "1., 0., 0., 0., 1., 0.", "*BOUNDARY"], "is the second one of node 1"),
    ],
)
def test_axes_that_are_none(tmp_path, capsys, old, new, words) -> None:
    assert words in refused(tmp_path, capsys, swapped(wedge(), old, *new))
