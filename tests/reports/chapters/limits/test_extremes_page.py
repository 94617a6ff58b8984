"""The page of extremes: limits by setting, counts and causes of made-up maps, and labels that can be told apart."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from reports.chapters.extremes import LOOKS, cause, extremes_page, faults, outcome_maps, plain_ticks
from reports.store import load_store
from studies.experiments.extremes import CLASSES
from support.pages.changed import edit_table


def test_counts_causes_and_commands(store: Path) -> None:
    loaded = load_store(store)
    page = extremes_page(loaded)
    points = loaded.table("extremes")
    asked = points[points["asked"]]
    share = f"{100 * len(asked) / len(points):.0f} %"
    assert "2 maps of small solves" in page.text
    assert f"{len(asked)} of {len(points)} points are solved ({share})" in page.text
    assert faults(loaded) == {
        "not converged": int((asked["class"] == "not converged").sum()),
        "refused": int((asked["class"] == "refused").sum()),
    }
    own = asked[asked["map"] == "two"]
    count, good = int((own["class"] == "not converged").sum()), int((own["class"] == "converged").sum())
    told = f"the iteration limit was reached, the tangent gives no reason ({count} of {count})"
    assert f"| Two settings | {good} of {len(own)} | {count} | 0 | {told} |" in page.text
    assert "footprint extremes each --at " in page.text
    assert "On 1 maps solved at all points the search takes 5 of 289 points for another class." in page.text
    assert "the budget was spent" not in page.text
    assert list(page.pictures) == ["extremes.svg"]


def test_limits_stand_in_one_table_with_their_causes(store: Path) -> None:
    text = extremes_page(load_store(store)).text
    for name in ("thinnest shell", "largest rotation in one step", "smallest travel", "stiffest ε"):
        assert sum(line.startswith(f"| {name}, ") for line in text.splitlines()) == 2
    thin = next(line for line in text.splitlines() if line.startswith("| thinnest shell") and "| measures |" in line)
    assert "| 0.001 (all 2) | 0.001 (all 2) | rounding alone, the tangent gives no reason (all 2) |" in thin
    soft = next(line for line in text.splitlines() if line.startswith("| stiffest ε") and "| algorithms |" in line)
    assert "the bound: `lcp`; –: `augmented-lagrangian`" in soft
    assert "augmented-lagrangian does not apply: it is made up" in soft
    assert "wrong by half" not in text


def test_a_certified_result_that_is_far_off_is_told(own_store: Path) -> None:
    edit_table(
        own_store, "extremes_limits", lambda t: t.assign(error=t["error"].mask(t["limit"] == "smallest travel", 1.0))
    )
    text = extremes_page(load_store(own_store)).text
    assert "half of the result or more: smallest travel (`exact`, `linear`, `lcp`, `augmented-lagrangian`)." in text


def test_boundaries_that_were_missed_and_budgets_that_were_spent_are_told(own_store: Path) -> None:
    lost = {"map": "each", "distance": float("inf"), "unlike": 3}
    edit_table(own_store, "extremes_check", lambda check: pd.concat([check, check.assign(**lost)]))
    edit_table(own_store, "extremes", lambda points: points.assign(complete=False))
    text = extremes_page(load_store(own_store)).text
    assert "takes 8 of 578 points for another class, with whole boundaries on 1 maps." in text
    assert "On 2 maps the budget was spent" in text


def test_causes_are_counted_without_their_numbers() -> None:
    reason = (
        "a state beyond the path, 2 more eigenvalues; the load step was cut; bifurcation near 0.4: 13 % of that at 0"
    )
    assert cause(reason) == "a state beyond the path, the tangent shows a bifurcation"
    assert cause("the judge finds tension beyond its bounds") == "the judge finds tension beyond its bounds"
    assert cause("cut; too few converged steps to tell why") == "cut, too few steps converged to tell why"
    assert cause("limit point of the path at 2.93: it turns back") == "the tangent shows a limit point"


def test_every_class_has_a_look_of_its_own() -> None:
    assert set(LOOKS) == set(CLASSES)
    colours, hatches = zip(*LOOKS.values(), strict=True)
    assert len(set(colours)) == len(LOOKS)
    assert len({(colour, hatch) for colour, hatch in zip(colours, hatches, strict=True)}) == len(LOOKS)


@pytest.mark.parametrize(
    "values",
    [
        np.round(0.5 - 10.0 ** np.linspace(-1, -4, 17), 6),  # up to incompressible
        np.round(1 - 10.0 ** np.linspace(0, -4, 17), 6),  # up to elements without a width
        10.0 ** np.linspace(-6, -1, 17),
        np.linspace(-0.05, 0.35, 17),
    ],
    ids=["near a half", "near one", "powers", "even"],
)
def test_ticks_are_several_and_different(values: np.ndarray) -> None:
    places, labels = plain_ticks(values)
    assert 3 <= len(places) == len(labels) <= 9
    assert len(set(labels)) == len(labels)
    assert places == sorted(places)
    numbers = [float(label) for label in labels if "$" not in label]
    assert all(values.min() * (1 - 1e-9) <= number <= values.max() for number in numbers if number > 0)


@pytest.mark.slow
def test_a_map_is_drawn_the_same_twice(store: Path) -> None:
    loaded = load_store(store)
    points, maps = loaded.table("extremes"), loaded.table("extremes_maps")
    pairs = maps[~maps["y_named"].astype(bool)]
    first, second = outcome_maps(points, pairs), outcome_maps(points, pairs)
    assert first() == second()
    assert first().startswith("<?xml")
