"""The section "Shell against solid" on a store made up here: what is put into it comes out as mesh and model parts."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import asdict
from pathlib import Path
from typing import Any

import pytest

from reports.cells import load_cell
from reports.chapters.tyre import solid_part
from reports.figures.result_figures import draw_result
from reports.reading import StoreError
from reports.store import load_store
from studies.analysis.tyre import cancellation
from studies.output.atomic import SCHEMA, plain, write_json, write_text
from studies.run.campaigns.plan import Row
from studies.run.campaigns.report_cells import LISTS
from studies.scenes import SCENES
from studies.scenes.complete import Cell
from studies.scenes.complete import complete as resolve
from studies.scenes.data import DATA
from support.stores.made_up import analysed_again

FORCE = {5.0: 200.0, 10.0: 500.0, 15.0: 900.0, 20.0: 1300.0}  # limits of the solid [N]
GROWTH = {"inner": 4.6, "outer": 4.3}  # mm
MODEL, EQUATOR = 1.01, 0.98  # limit of the shell over that of the solid
SOFT = 0.999
FORCES = "Force of shell and solid [N]"
KKT = {"equilibrium": 1e-12, "penetration": 0.0, "tension": 0.0, "complementarity": 0.0}


def write_cell(cell: Cell, directory: Path) -> None:
    """Values that approach their limits with second order: the solid from above, the shell from below."""
    _, request = resolve(cell.scene, cell.settings, **cell.options)
    solid = cell.scene == "tyre-solid"
    error = (1.0 if solid else -1.0) * 10.0 / request.mesh[0] ** 2
    body = (1.0 if solid else MODEL) * (SOFT if cell.label == "solid penalty" else 1.0)
    step = {"centre_pressure_MPa": 0.15, "contact_nodes": 30, "half_length_mm": 40.0, "half_width_mm": 20.0}
    step |= {
        "kkt": KKT,
        "failures": [],
        "rounding": 1e-13,
        "central_asymmetry": 0.0,
        "mirror_asymmetry": 0.0,
        "newton_iterations": 5,
        "substeps": 1,
    }
    quantities = {
        f"inflated_equator_{face}_mm": growth * (1.0 if solid else EQUATOR) * (1 + error)
        for face, growth in GROWTH.items()
    }
    result = {
        **{name: getattr(request, name) for name in ("scene", "measure", "contact", "newton", "model")},
        "mesh": f"{request.mesh[0]}x{request.mesh[1]}",
        "settings": {**request.settings, "steps": request.steps},
        **{"outcome": "converged", "class": "converged", "cuts": [], "reason": "converged", "quantities": quantities},
        "steps": [{"delta_mm": d, "force_N": F * body * (1 + error), **step} for d, F in FORCE.items()],
        **{"counters": {}, "timing_s": {}, "provenance": {}, "files": []},
    }
    write_json(directory.with_suffix(".json"), {"schema": SCHEMA, "id": directory.name, **result})


@pytest.fixture
def store(tmp_path: Path) -> Path:
    rows = []
    for i, cell in enumerate(LISTS["solid"].cells()):
        write_cell(cell, tmp_path / "cells" / str(i))
        _, request = resolve(cell.scene, cell.settings, **cell.options)
        rows.append(Row(cell, str(i), plain(request.data)).as_json())
    references = [{"scene": name, **asdict(r)} for name in ("tyre", "tyre-solid") for r in SCENES[name].references]
    write_json(tmp_path / "references.json", {"schema": SCHEMA, "references": references})
    told = {"schema": SCHEMA, "campaign": "solid", "title": "made up", "pages": ""}
    write_json(tmp_path / "campaigns" / "solid.json", {**told, "cells": rows})
    name = "isotropic_tyre_3d_solid.csv"
    write_text(tmp_path / "references" / name, (DATA / name).read_text(encoding="utf-8"))
    analysed_again(tmp_path, "solid")
    return tmp_path


def edit(store: Path, label: str, change: Callable[[dict[str, Any]], object]) -> None:
    path = next(cell for cell in load_store(store).cells if cell.label == label).directory.with_suffix(".json")
    data = json.loads(path.read_text(encoding="utf-8"))
    change(data)
    write_json(path, data)
    analysed_again(store, "solid")


def rows(text: str, title: str) -> dict[str, list[str]]:
    """The rows of a table by their first entry."""
    lines = text.split(f"**{title}**\n\n")[1].split("\n\n")[0].splitlines()[2:]
    cells = [[entry.strip() for entry in line.strip("|").split("|")] for line in lines]
    return {first: rest for first, *rest in cells}


def test_parts_of_the_difference_are_those_that_were_put_in(store: Path) -> None:
    text = solid_part(load_store(store)).text
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


def test_a_missing_cell_is_one_line(store: Path) -> None:
    index = json.loads((store / "campaigns" / "solid.json").read_text())
    index["cells"] = [row for row in index["cells"] if row["label"] != "solid penalty"]
    write_json(store / "campaigns" / "solid.json", index)
    with pytest.raises(StoreError, match=r"no cell with scene tyre-solid, epsilon 20\.0; the pages need one"):
        solid_part(load_store(store))


def test_steps_of_a_solid_are_checked_as_those_of_a_tyre(store: Path) -> None:
    edit(store, "solid 14x18", lambda result: result["steps"][0].pop("force_N"))
    with pytest.raises(StoreError, match="lacks force_N"):
        load_store(store)


def test_cancellation_at_the_equator_by_hand() -> None:
    settings = {"R1_mm": 50.0, "R0_mm": 250.0, "plies": 1, "ply_thickness_mm": 4.8, "nu": 0.45}
    assert cancellation(settings) == pytest.approx(26.2 / (26.2 - 0.45 * 46.961), rel=1e-3)
    assert cancellation(settings | {"nu": 0.0}) == 1.0


@pytest.mark.slow
def test_a_solved_solid_is_drawn_as_a_tyre(tmp_path: Path) -> None:
    from studies.solving.solve import solve

    solve(*resolve("tyre-solid", {"delta_mm": "10"}, "8x10")).write(tmp_path)
    assert load_cell(tmp_path, "solid").converged
    assert len(draw_result(tmp_path)) == 4
