"""The budget of the tyre's force: what was put into grids, choices and solids comes out with its interval."""

from __future__ import annotations

from pathlib import Path

import pandas as pd
import pytest

from studies.analysis.comparisons.tyre.budget import tyre_budget
from studies.analysis.comparisons.tyre.printed_pressures import words
from studies.output.atomic import SCHEMA, plain, write_json
from studies.run.campaigns.plan import Row
from studies.run.campaigns.report_cells import BUDGET, READINGS, ROBUSTNESS
from studies.run.cells.answers import Answers
from studies.solving.solve import resolve

LIMIT = 2000.0
CHANGED = {"follower": 0.15, "full-3d": 0.1, "nonsymmetric": 0.0}


def store_of(root: Path, wobble: float = 0.0) -> Answers:
    """Second order towards the limit, and towards the change of each load and section; a wobble on the last mesh."""
    rows = []
    for i, cell in enumerate((*BUDGET, *(c for c in ROBUSTNESS if "settle" not in c.label and c.label != "far"))):
        *_, name, mesh = cell.label.split()
        n = int(mesh.split("x")[0])
        change = CHANGED.get(name, 0.0) * (1 + 30 / n**2)
        change += wobble * (n == 84 and name in CHANGED)
        force = LIMIT * (1 + 40 / n**2) * (1 + change)
        _, request = resolve(cell.scene, cell.settings, **cell.options)
        named = {key: getattr(request, key) for key in ("scene", "measure", "contact", "newton", "model")}
        record = {"schema": SCHEMA, "id": str(i), **named, "mesh": mesh, "settings": {}, "reason": "", "cuts": []}
        record |= {"outcome": "converged", "class": "converged", "quantities": {}, "counters": {}, "timing_s": {}}
        record |= {"steps": [{"delta_mm": 20.0, "force_N": force}], "provenance": {}, "files": []}
        write_json(root / "cells" / f"{i}.json", record)
        rows.append(Row(cell, str(i), plain(request.data)).as_json())
    told = {"schema": SCHEMA, "campaign": "made", "title": "made up", "pages": ""}
    write_json(root / "campaigns" / "made.json", {**told, "cells": rows})
    return Answers.of(root, "made")


def budget(root: Path, wobble: float = 0.0) -> pd.DataFrame:
    tables = {"work_precision": pd.DataFrame({"reference_N": [LIMIT], "known": [1e-3]})}
    solid = pd.DataFrame({"quantity": ["force_N"], "at": ["20"], "model_part": [3e-4], "known_to": [4e-3]})
    return tyre_budget(store_of(root, wobble), tables.get, solid).set_index("changed")


def test_parts_are_those_that_were_put_in(tmp_path: Path) -> None:
    found = budget(tmp_path)
    assert found.loc["42x40, element of the paper", "change"] == pytest.approx(40 / 42**2)
    assert found.loc["limit of grids", "within"] == 1e-3
    for name, change in CHANGED.items():
        assert found.loc[name, "change"] == pytest.approx(change, abs=1e-12)
        assert found.loc[name, "within"] == pytest.approx(0.0, abs=1e-12)
    assert not found.loc["shell instead of a solid", "settled"]
    assert found.loc["follower", "settled"]


def test_meshes_that_do_not_agree_widen_the_interval(tmp_path: Path) -> None:
    found = budget(tmp_path, wobble=0.01)
    assert found.loc["follower", "within"] > 0.01
    assert not found.loc["nonsymmetric", "settled"]


def test_every_reading_has_words() -> None:
    told = [words(cell.label) for cell in READINGS]
    assert len({reading for reading, _ in told}) == len(READINGS)
    assert words("reading gamma_deg 51.5") == ("cord angle 51.5 deg", "data")
