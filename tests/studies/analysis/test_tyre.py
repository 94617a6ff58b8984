"""The tyre's force: parts that were put in come out with their intervals; the printed patch beside a computed one."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from studies.analysis.printed_pressures import HALF, LITERAL, asymmetries, compare, core, force, printed_map, words
from studies.analysis.tyre import tyre_budget
from studies.output.atomic import SCHEMA, write_json
from studies.run.answers import Answers
from studies.run.lists import BUDGET, READINGS, ROBUSTNESS
from studies.run.plan import Row
from studies.scenes.complete import complete as resolve
from studies.scenes.tyre.readings import central_asymmetry, mirror_asymmetry

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
        rows.append(Row(cell, str(i), request).as_json())
    stated = {"schema": SCHEMA, "campaign": "made", "title": "made up", "pages": ""}
    write_json(root / "campaigns" / "made.json", {**stated, "cells": rows})
    return Answers.of(root, "made")


def budget(root: Path, wobble: float = 0.0) -> pd.DataFrame:
    tables = {"work_precision": pd.DataFrame({"reference_N": [LIMIT], "known": [1e-3]})}
    solid = pd.DataFrame({"quantity": ["force_N"], "at": ["20"], "model_part": [3e-4], "known_to": [4e-3]})
    return tyre_budget(store_of(root, wobble), tables.get, solid).set_index("changed")


def test_parts_are_those_that_were_put_in(tmp_path: Path) -> None:
    actual = budget(tmp_path)
    assert actual.loc["42x40, element of the paper", "change"] == pytest.approx(40 / 42**2)
    assert actual.loc["limit of grids", "within"] == 1e-3
    for name, change in CHANGED.items():
        assert actual.loc[name, "change"] == pytest.approx(change, abs=1e-12)
        assert actual.loc[name, "within"] == pytest.approx(0.0, abs=1e-12)
    assert not actual.loc["shell instead of a solid", "settled"]
    assert actual.loc["follower", "settled"]
    wide = budget(tmp_path / "wide", wobble=0.01)  # meshes that do not agree widen the interval
    assert wide.loc["follower", "within"] > 0.01
    assert not wide.loc["nonsymmetric", "settled"]


def test_every_reading_has_words() -> None:
    messages = [words(cell.label) for cell in READINGS]
    assert len({reading for reading, _ in messages}) == len(READINGS)
    assert words("reading gamma_deg 51.5") == ("cord angle 51.5 deg", "data")


TYRE_SETTINGS = {"R1_mm": 50.0, "R0_mm": 250.0, "plies": 4, "ply_thickness_mm": 1.2}


def hand_made() -> tuple[pd.DataFrame, pd.DataFrame]:
    """Printed: 7 x 7 of 1 MPa without a corner; ours: 1.1 MPa without a core node and without row 15."""
    angles = np.arange(-15.0, 16.0, 5.0)
    printed = pd.DataFrame(1.0, index=pd.Index(angles), columns=pd.Index(angles))
    ours = 1.1 * printed
    printed.iloc[0, 0] = np.nan
    ours.iloc[2, 2] = np.nan
    ours.iloc[6] = np.nan
    return ours, printed


def test_comparison_of_two_patches_by_hand() -> None:
    ours, printed = hand_made()
    c = compare(ours, printed)
    assert (c["printed_nodes"], c["in_one_only"], c["outside"]) == (48, 9, 8)  # ours has 41, 40 of them in both
    assert c["core_rms"] == pytest.approx(0.1, rel=1e-12)
    assert (c["centre_MPa"], c["printed_centre_MPa"]) == (1.1, 1.0)


def test_core_keeps_its_distance_along_both_directions() -> None:
    patch = np.ones((7, 7), bool)
    assert core(patch).sum() == 9
    patch[3, 0] = False
    assert core(patch).sum() == 8
    assert not core(patch)[3, 2]
    assert core(patch)[2, 2]
    assert core(np.ones((4, 9), bool)).sum() == 0


def test_force_is_pressure_times_mid_surface_area() -> None:
    _, printed = hand_made()
    psi = np.deg2rad(np.asarray(printed.columns, dtype=float))
    r = 200.0 + 52.4 * np.cos(psi)  # mid-surface, 2.4 mm outside the inner face
    areas = np.deg2rad(5.0) * np.deg2rad(2.5) * 52.4 * r
    expected = 7 * areas.sum() - areas[0]  # one corner is blank
    assert force(printed, HALF, TYRE_SETTINGS) == pytest.approx(expected, rel=1e-12)


def test_symmetries_of_the_printed_table() -> None:
    printed = printed_map()
    central, *mirrors = (row[1:] for row in asymmetries(printed))
    assert central == (0.0,)
    for mirror in mirrors:
        assert mirror == pytest.approx((0.039,), abs=1e-12)
    patch = printed.notna().to_numpy()
    assert patch.sum() == 277
    assert np.array_equal(patch, patch[::-1, ::-1])
    assert force(printed, LITERAL, TYRE_SETTINGS) == pytest.approx(2 * force(printed, HALF, TYRE_SETTINGS))


def test_asymmetry_leaves_blanks_out() -> None:
    p = pd.DataFrame([[np.nan, 2.0, 3.0], [1.0, 2.0, 1.5]], index=[-1.0, 1.0], columns=[-1.0, 0.0, 1.0])
    assert dict(asymmetries(p))["mirror: p(psi, phi) - p(-psi, phi)"] == 0.5


def test_images_of_a_periodic_map() -> None:
    """psi odd, phi odd, and their product, which only the half turn keeps."""
    psi, phi = np.meshgrid([-1.0, 0.0, 1.0], [-2.0, -1.0, 0.0, 1.0], indexing="ij")
    touching = np.ones_like(psi, bool)
    touching[0, 1] = False
    p = 5 + np.sin(np.pi * phi / 2) * psi
    assert central_asymmetry(p) == pytest.approx(0, abs=1e-14)
    assert mirror_asymmetry(p) == mirror_asymmetry(p, touching) == pytest.approx(2)
    lone = np.zeros_like(psi)
    lone[0, 1] = 3.0
    assert (mirror_asymmetry(lone), mirror_asymmetry(lone, touching), central_asymmetry(lone)) == (3.0, 0.0, 3.0)
