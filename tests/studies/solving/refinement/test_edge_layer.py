"""The layer at free edges of decks: Reissner's strip under torsion, and intervals beside grids that are finer."""

from pathlib import Path

import numpy as np
import pytest

from studies.scenes.complete import complete
from studies.scenes.mesh_file.scene import entered
from studies.solving.refinement.cascade import answer
from studies.solving.refinement.edge_layer import EdgeLayer
from studies.solving.refinement.mesh_error import solve_with_error
from studies.solving.result import Result
from studies.solving.solve import solve
from support.decks import mesh_lines, plate, written

WIDTH, LONG, H = 20.0, 60.0, 1.0
B = H / np.sqrt(12.0)
WALL = ["*MATERIAL, NAME=M", "*ELASTIC", "1e5, 0.3", "*SHELL SECTION, ELSET=ALL, MATERIAL=M", f"{H}"]


def strip(tmp_path: Path, *loads: str) -> str:
    """Six elements of ten thicknesses in a row, two across, on its first end."""
    x, elements = plate(6, 2, LONG, WIDTH)
    lines = [*mesh_lines(x, elements), *WALL, "*NSET, NSET=ROOT", "1, 2, 3", "*BOUNDARY", "ROOT, 1, 6"]
    return written(tmp_path, [*lines, "*STEP", "*STATIC", "*CLOAD", *loads, "*END STEP"])


TWISTED, BENT = ("19, 3, 1.", "21, 3, -1."), ("19, 3, 1.", "20, 3, 2.", "21, 3, 1.")


def on(deck: str, n: int) -> Result:
    with entered(deck):
        return solve_with_error(*complete(deck, {}, (n, n)))


def test_a_strip_under_torsion_gives_way_as_reissner_has_it(tmp_path) -> None:
    """Two edges of the width b each, of all but the clamped end; on elements of 34 b all of it is still to come."""
    layer = EdgeLayer.of(on(strip(tmp_path, *TWISTED), 4), 4.0)
    assert layer is not None
    assert layer.width == pytest.approx(B, rel=1e-12)
    assert layer.length == pytest.approx(2.5, rel=1e-12)
    assert layer.before == pytest.approx(2 * B / WIDTH, rel=0.05)


@pytest.mark.slow
def test_the_interval_of_a_twisted_strip_has_what_finer_grids_find(tmp_path) -> None:
    """That of three grids ended 0.4 % below the value on 16x16, which the layer moves on upwards."""
    deck = strip(tmp_path, *TWISTED)
    coarse = on(deck, 4)
    with entered(deck):
        fine = solve(*complete(deck, {}, (16, 16))).quantities
    for name in ("along_forces_mm", "largest_mm"):
        assert coarse.errors[name]["low"] <= 1.005 * fine[name] <= coarse.errors[name]["high"] < 1.05 * fine[name]
    (said,) = (note for note in coarse.notes if "free director" in note)
    assert said.startswith("edges with a free director have a boundary layer of 0.29 mm, elements there are 2.5 mm")


@pytest.mark.slow
def test_an_error_that_is_asked_for_allows_for_it(tmp_path) -> None:
    """On grids that are finer and finer, from the mesh of the deck on."""
    deck = strip(tmp_path, *TWISTED)
    with entered(deck):
        result, known = answer(*complete(deck, {}, (1, 1)), 0.03, "along_forces_mm")
        fine = solve(*complete(deck, {}, (16, 16))).quantities["along_forces_mm"]
    assert known
    width = result.quantities["uncertainty"]
    assert result.quantities["extrapolated_along_forces_mm"] * (1 + width) >= 1.005 * fine


def test_bending_has_no_such_layer_and_a_sum_of_forces_no_wider_interval(tmp_path) -> None:
    bent, twisted = on(strip(tmp_path, *BENT), 4), on(strip(tmp_path, *TWISTED), 4)
    assert not any("director" in note for note in bent.notes)
    limit = bent.errors["along_forces_mm"]
    assert limit["high"] < 1.006 * limit["low"]
    sums = on(strip(tmp_path, "19, 3, 1.", "21, 3, -0.5"), 4).errors["reaction_3_N"]
    assert sums["high"] - sums["low"] < 1e-6
    assert "reaction_3_N" not in twisted.errors


def test_an_edge_that_holds_its_director_has_none(tmp_path) -> None:
    """All edges clamped."""
    x, elements = plate(4, 4, 40.0, 40.0)
    rim = np.flatnonzero(np.any((x[:, :2] == 0) | (x[:, :2] == 40), axis=1)) + 1
    lines = [*mesh_lines(x, elements), *WALL, "*BOUNDARY", *(f"{node}, 1, 6" for node in rim.tolist())]
    deck = written(tmp_path, [*lines, "*STEP", "*STATIC", "*DLOAD", "ALL, P, 1e-3", "*END STEP"])
    assert EdgeLayer.of(on(deck, 2), 2.0) is None
