"""The page of friction: numbers of made-up tables, failures that are named, what is left out without its table."""

from __future__ import annotations

from pathlib import Path

import pandas as pd
import pytest

from reports.chapter import of_page
from reports.chapters.friction import CHAPTER, friction_page
from reports.figures.friction import _cell, _title, filmstrip, shown_stops
from reports.markdown import Part
from reports.store import load_store
from support.pages.changed import set_values
from support.stores.friction import patch


@pytest.fixture
def page(store: Path) -> Part:
    return friction_page(load_store(store))


def test_ends_of_drag_and_turn(page: Part) -> None:
    assert "| 0.5 | 1000.0 | 1000.0 | 500.00 | 8 | 8 | 8 | 500.00 | rounding | 0.03 |" in page.text
    assert "| 0.5 | 9.962 | 12 | 12 | 2 | 9.962 | 10.000 | rounding | 0.03 |" in page.text
    assert "All 16 loads of these paths converged and are certified by the judge." in page.text
    assert "footprint solve tyre --model full --mesh 42x40 --set delta_mm=10 --set mu=0.25 --set turn_deg=" in page.text


def test_beside_dissipation_stands_that_it_converges_with_the_load_step(page: Part) -> None:
    tables, _, after = page.text.partition("**Do not rely on the dissipation of these tables.**")
    assert tables.count("dissipated [N m] |") == 2
    told = "dragged by 1 mm in one step each the dissipation has an error of +100 %, the force one of -4.0 %"
    assert told in after.partition("\n\n")[0]


def test_a_load_that_is_refused_is_named(own_store: Path) -> None:
    set_values(own_store, "friction_dragged", 2, failures="friction_cone")
    text = friction_page(load_store(own_store)).text
    assert "| 0.25 | 2 | – | converged | friction_cone |" in text
    assert "loads of these paths converged" not in text


def test_load_steps(page: Part) -> None:
    assert "| 8 | 99.500 | -0.50 % | 0.0563 | +12.5 % | 8.00 |" in page.text
    assert "1.00 for the force and 1.00 for the dissipation; theory says 1." in page.text


def test_the_page_opens_with_its_statements(store: Path) -> None:
    opening = of_page(load_store(store), "friction")
    assert "pulled by μ F_n with" in opening
    assert "`semismooth` converges on 3 of 3 scenes" in opening


def test_agreement_names_failures_and_other_steps(page: Part) -> None:
    assert "| scene | load steps | `trial-and-error` | `regularised` | `qp` |" in page.text
    assert "| tyre dragged | 2 | cap-hit | 1.0e-04 | same |" in page.text
    assert "| ring | 2 | 2.5e-01, 3 states, 8 steps | 1.0e-04 | same |" in page.text
    assert "| `trial-and-error` | 3 | 2 | 0 | 1 | 1 | 1 | 1 |" in page.text
    assert "The 1 not solved" in page.text
    assert "| tyre dragged | `trial-and-error` | the states repeat themselves |" in page.text
    assert "| `qp` | 3 | 3 | 0 | 0 | 3 | 0 | 3 | 1.00 | 1.50 | 1.00 |" in page.text


def test_closed_forms_by_family(page: Part) -> None:
    assert "| strip | 2 | 4 | 1.6e-05 | 2.00 to 2.00 |" in page.text
    assert "| path | 1 | 2 | 1.3e-03 | 1.00 to 1.00 |" in page.text


def test_problems_that_separate_the_algorithms(page: Part) -> None:
    assert "| `trial-and-error` | cycling | 0 of 1 | 1 of 1 | 0 of 1 | 0 | – | – |" in page.text
    assert "| `qp` | within, 0.010 % | 1 of 1 | 1 of 1 | 0 of 1 | 0 | 1 of 2 | 1 |" in page.text
    assert "| `semismooth` | within, 0.010 % | 1 of 1 | 1 of 1 | 0 of 1 | 0 | 1 of 2 | 0 |" in page.text
    assert "The 2 public problems are Siconos' rigid bodies with friction, with 1 to 40 contacts" in page.text


def test_a_wrong_claim_on_springs_is_counted(own_store: Path) -> None:
    springs = load_store(own_store).table("friction_klarbring")
    (row,) = springs.index[(springs["case"] == "nothing") & (springs["algorithm"] == "qp")]
    set_values(own_store, "friction_klarbring", row, outcome="converged", found="wrong")
    text = friction_page(load_store(own_store)).text
    assert "| `qp` | within, 0.010 % | 1 of 1 | 1 of 1 | 1 of 1 | 1 | 1 of 2 | 1 |" in text


def test_columns_without_their_table_are_left_out(own_store: Path) -> None:
    (own_store / "tables" / "friction_public.csv").unlink()
    assert "public problems" not in friction_page(load_store(own_store)).text
    (own_store / "tables" / "friction_greco.csv").unlink()
    assert not CHAPTER.applies(load_store(own_store))


def test_a_cell_of_the_patch_has_the_area_of_its_candidate() -> None:
    """Neighbours are 5 mm apart across, and an area of 50 mm² is 10 mm wide; the same with both axes exchanged."""
    data = patch()[lambda t: t["stop"] == 0]
    assert _cell(data) == (10.0, 5.0)
    changed = data.rename(columns={"y_mm": "z_mm", "z_mm": "y_mm"})
    assert _cell(changed) == (5.0, 10.0)


def test_three_stops_are_shown_of_any_number() -> None:
    """The first of the drag, the farthest, the last; what comes after the farthest is on its way back."""
    stops = pd.DataFrame({"stop": range(6), "drag_mm": [0.0, 0.5, 1.0, 4.0, 2.0, 0.0]})
    shown = shown_stops(stops)
    assert shown["stop"].tolist() == [1, 3, 5]
    told = [_title(own, stops, 4.0) for _, own in shown.groupby("stop")]
    assert told == ["plane at 0.5 mm", "plane at 4 mm", "plane back at 0 mm"]
    assert shown_stops(stops[:1])["stop"].tolist() == [0]


@pytest.mark.slow
def test_pictures_are_drawn(page: Part) -> None:
    for name in ("friction-dragged.svg", "friction-turned.svg", "friction-steps.svg", "friction-patch.svg"):
        assert page.pictures[name]().count("<svg") == 1
    assert filmstrip(patch().assign(friction_z_N=0.0))().startswith("<?xml")
