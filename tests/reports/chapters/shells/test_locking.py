"""The section of locking: its table, the law of what is left over, and the yardsticks, from tables with known laws."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from reports.chapters.locking import excess, locking_part, rates
from reports.store import load_store
from studies.experiments.locking import MESHES, THINNESS
from studies.output.atomic import write_table


def rows(text: str, kind: str) -> list[list[str]]:
    lines = (line for line in text.splitlines() if line.startswith(f"| {kind} |"))
    return [[word.strip() for word in line.split("|")[2:-1]] for line in lines]


def test_every_kind_of_locking_has_its_lines(store: Path) -> None:
    text = locking_part(load_store(store)).text
    stiff, remedy = rows(text, "Poisson thickness")
    assert stiff[2:] == ["ν = 0", "1.000", "ν = 0.45", "3.025"]
    assert remedy[2:] == ["ν = 0", "1.000", "ν = 0.45", "1.000"]
    (shear,) = rows(text, "shear")
    assert shear[3] == shear[5] == "0.996"
    assert len(rows(text, "curved beam")) == len(MESHES)
    membrane = rows(text, "membrane")
    assert len(membrane) == 4 * len(MESHES)
    free = [row for row in membrane if row[0] == "hyperboloid, free ends: energy"]
    assert [row[4] for row in free] == [f"h/R = {min(THINNESS):g}"] * len(MESHES)
    assert float(free[0][5]) < 0.5 < float(free[0][3])
    clamped = [row for row in membrane if row[0] == "hyperboloid, clamped ends: energy"]
    assert all(row[3] == row[5] for row in clamped)


def test_left_over_locking_has_the_rates_it_was_made_with(store: Path) -> None:
    data = load_store(store).table("membrane_locking")
    found = excess(data, "relaxed")
    assert list(found.columns) == list(MESHES)
    np.testing.assert_allclose(found.loc[1e-5] / found.loc[1e-4], 101, rtol=0.02)  # less what is there at 1e-3
    np.testing.assert_allclose(found[8] / found[16], 64, rtol=1e-6)
    assert rates(data) == ("101", "64")


def test_an_excess_of_rounding_has_no_rate(store: Path) -> None:
    data = load_store(store).table("membrane_locking")
    assert rates(data[data["elements"] > min(MESHES)])[1] == "–"


def test_yardsticks_are_counted(own_store: Path) -> None:
    data = load_store(own_store).table("membrane_locking")
    known = data["yardstick_reduced"].notna()
    text = " ".join(locking_part(load_store(own_store)).text.split())
    assert f"below those of the reduced one in {known.sum()} of {known.sum()} cases" in text
    data.loc[data.index[known][0], "energy_norm_error"] = 0.6
    write_table(own_store / "tables" / "membrane_locking.csv", data)
    text = " ".join(locking_part(load_store(own_store)).text.split())
    assert f"below those of the reduced one in {known.sum() - 1} of {known.sum()} cases" in text
