"""The pages of friction: numbers of made-up tables, failures that are named, sections without their tables."""

from __future__ import annotations

from pathlib import Path

import pandas as pd
import pytest

from reports.chapters.friction.algorithms import CHAPTER, algorithms_page
from reports.chapters.friction.filmstrip import _cell, filmstrip
from reports.chapters.friction.tyre import friction_page
from reports.markdown import Part
from reports.store.statements import of_page
from reports.store.tables import load_store
from studies.store.atomic import write_table
from support.stores.friction import patch


@pytest.fixture
def tyre(store: Path) -> Part:
    return friction_page(load_store(store))


@pytest.fixture
def algorithms(store: Path) -> Part:
    return algorithms_page(load_store(store))


def test_ends_of_drag_and_turn(tyre: Part) -> None:
    assert "| 0.5 | 1000.0 | 1000.0 | 500.00 | 8 | 8 | 8 | 8 | 500.00 | rounding |" in tyre.text
    assert "| 0.5 | 9.962 | 12 | 12 | 2 | 12 | 9.962 | 10.000 | 0.99619 | rounding |" in tyre.text
    assert "No load of these paths is refused by the judge" in tyre.text
    assert "footprint solve tyre --model full --mesh 42x40 --set delta_mm=10 --set mu=0.25 --set turn_deg=" in tyre.text


def test_a_load_that_is_refused_is_named(own_store: Path) -> None:
    path = own_store / "tables" / "friction_dragged.csv"
    table = pd.read_csv(path)
    table["failures"] = table["failures"].astype(object)
    table.loc[2, "failures"] = "friction_cone"
    write_table(path, table)
    text = friction_page(load_store(own_store)).text
    assert "| 0.25 | 2 | – | converged | friction_cone |" in text
    assert "No load of these paths" not in text


def test_stops_of_the_patch_load_steps_and_symmetry(tyre: Part) -> None:
    assert "| 1 | 9 | 3 | 90.0 | 0.00 | -18.00 | 0.200 | 0.100 |" in tyre.text
    assert "| 8 | 99.500 | -0.50 % | 0.0563 | +12.5 % | 2 of 10 | 8.00 | converged |" in tyre.text
    assert "| dissipation | 1.00 | 1 |" in tyre.text
    assert "| dragged | 9 | 1e-15 | 2e-01 | 5e-01 |" in tyre.text


def test_steps_above_a_bar_are_marked(tyre: Part) -> None:
    assert "| press to 10 mm | 5 | 1.20 | 200 | 2.00 | – |" in tyre.text
    assert "| drag to 0.5 mm | 5 | 1.50 | 300 | 3.00 | operations, factorisations |" in tyre.text


def test_pages_open_with_their_statements(store: Path) -> None:
    loaded = load_store(store)
    assert "pulled by μ F_n to" in of_page(loaded, "friction")
    assert "`semismooth` ends on 3 of 3 scenes" in of_page(loaded, "friction-algorithms")


def test_agreement_names_failures_and_other_steps(algorithms: Part) -> None:
    assert "| case | load steps | `trial-and-error` | `regularised` | `qp` |" in algorithms.text
    assert "| tyre dragged | 2 | cap-hit | 1.0e-04 | same |" in algorithms.text
    assert "| ring | 2 | 2.5e-01, 3 states, 8 steps | 1.0e-04 | same |" in algorithms.text
    assert "| `trial-and-error` | 3 | 2 | 67 % | 0 | 1 | 1 | 1 | 1.0e-12 |" in algorithms.text
    assert "1 solves that do not end" in algorithms.text
    assert "| tyre dragged | `trial-and-error` | the states repeat themselves |" in algorithms.text
    assert "| `qp` | 3 | 1.00 | 2.00 | 1.50 |" in algorithms.text


def test_plate_and_springs(algorithms: Part) -> None:
    assert "| 16 | `trial-and-error` | cycling | 3 | 4 | 50 | – | – | – | not solved |" in algorithms.text
    assert "| 16 | `qp` | converged | 3 | 4 | 50 | 2.8600 | -1405.0 | 0.010 % | yes |" in algorithms.text
    assert "2 of 3 algorithms end within the bound on the finest mesh." in algorithms.text
    assert "| one | 0.50 | stick | (cycling) | stick | stick |" in algorithms.text
    assert "| nothing | 2.00 | none | (cycling) | (cycling) | (cycling) |" in algorithms.text


def test_closed_forms_and_public_problems(algorithms: Part) -> None:
    assert "| strip | steps 1 | end | 80 elements | +1.6e-05 | 2.00 | 2 |" in algorithms.text
    assert "| strip | steps 1 | front | 80 elements | < 1e-08 | – | 2 |" in algorithms.text
    assert "| pushed | alone | 0.0001 | 0.001 | 13.5 | 2e-03 | 2e-03 | 1e-06 |" in algorithms.text
    assert "| 0.1 | 1 | 1e-14 | 2e-14 | 4 | 1.0e-01 | 49.8000 | 1e-06 |" in algorithms.text
    assert "| Q1 | 4 | lifting | 4 | 0 | cycling | – | – | – |" in algorithms.text
    assert "| `qp` | 2 | 2 | 1 | 1 | – |" in algorithms.text
    assert "2 problems with friction of Siconos, rigid bodies with 1 to 40 contacts" in algorithms.text
    assert "1 more files are no such problems." in algorithms.text
    assert "| `crushed-ring` | 30 | 24.000 | 25.200 | +5.00 % | – | – |" in algorithms.text
    assert "| `semismooth` | 2 | 1 | 1 | 0 | cycling 1 |" in algorithms.text


def test_sections_without_their_table_are_left_out(own_store: Path) -> None:
    for name in ("friction_public", "friction_rolling", "friction_cost"):
        (own_store / "tables" / f"{name}.csv").unlink()
    loaded = load_store(own_store)
    text = algorithms_page(loaded).text
    assert "## Public problems" not in text
    assert "### A rolling wheel" not in text
    assert "### Tied where it touches" in text
    assert "## What friction costs\n\nNot measured here." in friction_page(loaded).text
    (own_store / "tables" / "friction_greco.csv").unlink()
    assert not CHAPTER.applies(load_store(own_store))


def test_a_cell_of_the_patch_has_the_area_of_its_candidate() -> None:
    """Neighbours are 5 mm apart across, and an area of 50 mm² is 10 mm wide; the same with both axes exchanged."""
    table = patch()[lambda t: t["stop"] == 0]
    assert _cell(table) == (10.0, 5.0)
    turned = table.rename(columns={"y_mm": "z_mm", "z_mm": "y_mm"})
    assert _cell(turned) == (5.0, 10.0)


@pytest.mark.slow
def test_pictures_are_drawn_of_any_number_of_stops(tyre: Part) -> None:
    for name in ("friction-dragged.svg", "friction-turned.svg", "friction-steps.svg", "friction-patch.svg"):
        assert tyre.pictures[name]().count("<svg") == 1
    four = pd.concat([patch(), patch()[lambda t: t["stop"] == 0].assign(stop=3)])
    assert filmstrip(four)().startswith("<?xml")
    assert filmstrip(patch().assign(friction_z_N=0.0))().startswith("<?xml")
