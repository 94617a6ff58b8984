"""The section "Shell against solid" on a store made up here: what is put into it comes out as mesh and model parts."""

from __future__ import annotations

import shutil
from collections.abc import Callable
from dataclasses import asdict, replace
from pathlib import Path
from typing import Any

import pytest

from reports.chapters.tyre import solid_part
from reports.figures.result_figures import draw_result
from reports.files import StoreError
from reports.store import TYRE_STEP_KEYS, load_cell, load_store
from studies.analysis.tyre import cancellation
from studies.output.atomic import SCHEMA, write_json, write_text
from studies.run.lists import LISTS
from studies.run.plan import Row
from studies.scenes import SCENES
from studies.scenes.complete import Cell
from studies.scenes.complete import complete as resolve
from studies.scenes.data import DATA
from support.pages import edit_json, place
from support.stores.campaigns import analysed_again

FORCE = {5.0: 200.0, 10.0: 500.0, 15.0: 900.0, 20.0: 1300.0}  # limits of the solid [N]
GROWTH = {"inner": 4.6, "outer": 4.3}  # mm
MODEL, EQUATOR = 1.01, 0.98  # limit of the shell over that of the solid
SOFT = 0.999
FORCES = "Force of shell and solid [N]"
KKT = {"equilibrium": 1e-12, "penetration": 0.0, "tension": 0.0, "complementarity": 0.0}


def write_cell(cell: Cell, directory: Path) -> Row:
    """Values that approach their limits with second order: the solid from above, the shell from below."""
    _, request = resolve(cell.scene, cell.settings, **cell.options)
    solid = cell.scene == "tyre-solid"
    error = (1.0 if solid else -1.0) * 10.0 / request.mesh[0] ** 2
    body = (1.0 if solid else MODEL) * (SOFT if cell.label == "solid penalty" else 1.0)
    known = dict.fromkeys(TYRE_STEP_KEYS, 0.0) | {"kkt": KKT, "failures": []}
    equator = (1.0 if solid else EQUATOR) * (1 + error)
    result = {
        **{name: getattr(request, name) for name in ("scene", "measure", "contact", "newton", "model")},
        "mesh": f"{request.mesh[0]}x{request.mesh[1]}",
        "settings": {**request.settings, "steps": request.steps},
        **dict.fromkeys(("outcome", "class", "reason"), "converged"),
        "quantities": {f"inflated_equator_{face}_mm": growth * equator for face, growth in GROWTH.items()},
        "steps": [{**known, "delta_mm": d, "force_N": F * body * (1 + error)} for d, F in FORCE.items()],
        **{"cuts": [], "counters": {}, "timing_s": {}, "provenance": {}, "files": []},
    }
    write_json(directory.with_suffix(".json"), {"schema": SCHEMA, "id": directory.name, **result})
    return Row(cell, directory.name, request)


@pytest.fixture(scope="module")
def solid(tmp_path_factory: pytest.TempPathFactory) -> Path:
    root = tmp_path_factory.mktemp("solid")
    rows = [write_cell(cell, root / "cells" / str(i)).as_json() for i, cell in enumerate(LISTS["solid"].cells())]
    references = [{"scene": name, **asdict(r)} for name in ("tyre", "tyre-solid") for r in SCENES[name].references]
    write_json(root / "references.json", {"schema": SCHEMA, "references": references})
    record = {"schema": SCHEMA, "campaign": "solid", "title": "made up", "pages": ""}
    write_json(root / "campaigns" / "solid.json", {**record, "cells": rows})
    name = "isotropic_tyre_3d_solid.csv"
    write_text(root / "references" / name, (DATA / name).read_text(encoding="utf-8"))
    analysed_again(root, "solid")
    return root


@pytest.fixture
def store(solid: Path, tmp_path: Path) -> Path:
    """A copy, to be changed."""
    return Path(shutil.copytree(solid, tmp_path / "store"))


def edit(store: Path, label: str, change: Callable[[dict[str, Any]], object]) -> None:
    edit_json(place(store, label, "solid").with_suffix(".json"), change)
    analysed_again(store, "solid")


def rows(text: str, title: str) -> dict[str, list[str]]:
    """The rows of a table by their first entry."""
    lines = text.split(f"**{title}**\n\n")[1].split("\n\n")[0].splitlines()[2:]
    cells = [[entry.strip() for entry in line.strip("|").split("|")] for line in lines]
    return {first: rest for first, *rest in cells}


def test_parts_of_the_difference_are_those_that_were_put_in(solid: Path) -> None:
    text = solid_part(load_store(solid)).text
    forces = rows(text, FORCES)
    assert list(forces) == ["5", "10", "15", "20"]
    solid, solid_part_, shell, shell_part, model, known, other = forces["10"]
    assert (solid, shell) == ("500.00", "505.00")
    assert (solid_part_, shell_part) == (f"{1000 / 56**2:+.2f} %", f"{-1000 / 84**2:+.2f} %")
    assert (model, known) == ("+1.00 %", "0.00 %")
    assert other == f"{100 * (500 / 523.76 - 1):+.2f} %"
    growth = rows(text, "Growth of the equator by inflation [mm]")
    assert {face: row[4] for face, row in growth.items()} == {"inner": "-2.00 %", "outer": "-2.00 %"}
    assert "-0.10 % at 20 mm" in text
    assert text.count("footprint solve tyre-solid") == 3 + 1


def test_an_irregular_sequence_says_how_far_its_limit_is_known(store: Path) -> None:
    edit(store, "solid 28x36", lambda result: result["steps"][1].update(force_N=499.0))
    forces = rows(solid_part(load_store(store)).text, FORCES)
    assert float(forces["10"][5].split()[0]) > 0.5
    assert forces["15"][5] == "0.00 %"


def test_a_travel_that_was_not_reached_is_a_dash(store: Path) -> None:
    edit(store, "isotropic fine", lambda result: result["steps"].pop())
    forces = rows(solid_part(load_store(store)).text, FORCES)["20"]
    assert forces[2:6] == ["–"] * 4


def test_a_missing_cell_is_one_line(solid: Path) -> None:
    loaded = load_store(solid)
    few = replace(loaded, planned=tuple(cell for cell in loaded.planned if cell.label != "solid penalty"))
    with pytest.raises(StoreError, match="no cell 'solid penalty', which the pages need"):
        solid_part(few)


def test_cancellation_at_the_equator_by_hand() -> None:
    settings = {"R1_mm": 50.0, "R0_mm": 250.0, "plies": 1, "ply_thickness_mm": 4.8, "nu": 0.45}
    assert cancellation(settings) == pytest.approx(26.2 / (26.2 - 0.45 * 46.961), rel=1e-3)
    assert cancellation(settings | {"nu": 0.0}) == 1.0


@pytest.mark.slow
def test_a_solved_solid_is_drawn_as_a_tyre(tmp_path: Path) -> None:
    from studies.solving.solve import solve

    solve(*resolve("tyre-solid", {"delta_mm": "10"}, "8x10")).write(tmp_path)
    assert load_cell(tmp_path).converged
    assert len(draw_result(tmp_path)) == 4
