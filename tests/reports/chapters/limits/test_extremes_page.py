"""The page of extremes: counts, causes in words, commands, and what the pictures show, of made-up maps."""

from __future__ import annotations

from pathlib import Path

import pandas as pd
import pytest

from reports.chapters.limits.extremes import LOOKS, cause, extremes_page, faults, outcome_map
from reports.store.tables import load_store
from studies.experiments.extremes.maps import CLASSES
from studies.store.atomic import write_table


def test_counts_causes_and_commands(store: Path) -> None:
    loaded = load_store(store)
    text = extremes_page(loaded).text
    points = loaded.table("extremes")
    asked = points[points["asked"]]
    share = f"{100 * len(asked) / len(points):.0f} %"
    assert f"2 maps of {len(points)} points in all" in text
    assert f"{len(asked)} points were solved, {share} of them" in text
    assert faults(loaded) == {
        "not converged": int((asked["class"] == "not converged").sum()),
        "refused": int((asked["class"] == "refused").sum()),
    }
    count = int(((asked["map"] == "two") & (asked["class"] == "not converged")).sum())
    told = "the iteration limit was reached, the tangent gives no reason"
    assert f"- *not converged* at {count} solved points: {told} ({count}, as at " in text
    assert "qp does not apply: it is made up" in text
    assert "footprint extremes each --at " in text
    assert "takes 5 of their 289 points for another class: " in text
    assert "The first grid has blocks of 8 cells each way; what is smaller may have been passed by." in text
    assert "The first grid has blocks of 8 cells on a line;" in text
    assert "| [Each algorithm](#each-algorithm) |" in text


def test_limits_stand_with_their_errors_and_causes(store: Path) -> None:
    text = extremes_page(load_store(store)).text
    for name in ("Thinnest shell", "Largest rotation in one step", "Smallest travel", "Stiffest ε"):
        assert f"### {name}\n" in text
    assert "| measure | `exact` | 0.001 | 0.50 % | 0.50 % | 0.001 |" in text
    assert "| algorithm | `augmented-lagrangian` | – | – | – | – | 1e+04 |" in text
    assert "| measure | `exact` | 1e-14 (bound) | 0.50 % | 0.50 % | 1e-14 | – |" in text
    assert "- *refused* where `augmented-lagrangian` fails: augmented-lagrangian does not apply: it is made up." in text
    lost = "`exact`, `linear`, `lcp`, `augmented-lagrangian`"
    assert f"- *not converged* where {lost} fails: rounding alone, the tangent gives no reason." in text
    assert "though right at first: " not in text


def test_a_certified_result_that_is_far_off_is_told(own_store: Path) -> None:
    path = own_store / "tables" / "extremes_limits.csv"
    limits = pd.read_csv(path)
    limits.loc[limits["limit"] == "smallest travel", "error"] = 1.0
    write_table(path, limits)
    text = extremes_page(load_store(own_store)).text
    assert "though right at first: smallest travel (`exact`, `linear`, `lcp`, `augmented-lagrangian`)." in text


def test_a_boundary_that_was_missed_is_told(own_store: Path) -> None:
    path = own_store / "tables" / "extremes_check.csv"
    check = pd.read_csv(path)
    write_table(path, pd.concat([check, check.assign(map="each", distance=float("inf"), unlike=3)]))
    text = extremes_page(load_store(own_store)).text
    assert "takes 8 of their 578 points for another class: " in text
    assert "in *Two settings*, *Each algorithm*." in text
    assert "| 3 | missed |" in text


def test_a_map_of_all_points_has_passed_nothing_by(own_store: Path) -> None:
    path = own_store / "tables" / "extremes_maps.csv"
    write_table(path, pd.read_csv(path).assign(stride=1))
    text = extremes_page(load_store(own_store)).text
    assert text.count("Nothing was passed by.") == 2
    assert "The first grid has" not in text


def test_causes_are_counted_without_their_numbers() -> None:
    reason = (
        "a state beyond the path, 2 more eigenvalues; the load step was cut; bifurcation near 0.4: 13 % of that at 0"
    )
    assert cause(reason) == "a state beyond the path, the tangent shows a bifurcation"
    assert cause("the judge finds tension beyond its bounds") == "the judge finds tension beyond its bounds"
    assert cause("cut; too few converged steps to tell why") == "cut, too few steps converged to tell why"


def test_every_class_has_a_look_of_its_own() -> None:
    assert set(LOOKS) == set(CLASSES)
    colours, hatches, markers = zip(*LOOKS.values(), strict=True)
    assert len(set(colours)) == len(LOOKS)
    assert len({*zip(hatches, markers, strict=True)}) >= len(LOOKS) - 1  # both kinds of convergence differ by hatch


@pytest.mark.slow
def test_a_map_is_drawn_the_same_twice(store: Path) -> None:
    loaded = load_store(store)
    points, maps = loaded.table("extremes"), loaded.table("extremes_maps")
    for _, labels in maps.iterrows():
        own = points[points["map"] == labels["map"]]
        first, second = outcome_map(own, labels), outcome_map(own, labels)
        assert first() == second()
        assert first().startswith("<?xml")
