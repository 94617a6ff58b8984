"""The page of what must not matter: laws of rigid motions, counts of made-up checks and cases, and what is broken."""

from __future__ import annotations

import math
from pathlib import Path

import pandas as pd
import pytest

from reports.chapters.invariance import accidents, invariance_page, shared_curves
from reports.store import Store, load_store
from support.pages.changed import edit_table, set_values
from support.pages.rows import row


@pytest.fixture
def loaded(store: Path) -> Store:
    return load_store(store)


def test_rates_of_the_famous_failures(loaded: Store) -> None:
    text = invariance_page(loaded).text
    assert row(text, "| `von-karman` |")[5:7] == ["-0.125 a^4.00", "-0.500 a^2.00"]
    assert row(text, "| `linear` |")[5:7] == ["-0.500 a^2.00", "-0.500 a^2.00"]
    assert row(text, "| `exact` |")[1:7] == ["0"] * 6
    assert float(row(text, "| `donnell` |")[1]) > 0.1  # a translated cylinder strains
    assert row(text, "| `linear` |")[1] == "0"
    found = loaded.table("rigid_body_powers")
    shear = found.query("measure == 'donnell' and surface == 'cylinder' and motion == 'translation'").iloc[0]
    assert shear["largest_rate"] == pytest.approx(1, abs=0.01)


def test_a_measure_off_its_law_is_seen(own_store: Path) -> None:
    def off(data: pd.DataFrame) -> pd.DataFrame:
        case = (data["measure"] == "sanders") & (data["motion"] == "drilling")
        return data.assign(strain=data["strain"].where(~case, data["strain"] + 1e-3))

    edit_table(own_store, "rigid_body", off)
    assert row(invariance_page(load_store(own_store)).text, "| `sanders` |")[-1] == "1.0e-03"


def test_measures_with_the_same_strain_share_a_curve() -> None:
    rows = pd.DataFrame(
        [
            (name, t, strain(t))
            for name, strain in (("a", math.sin), ("b", math.cos), ("c", math.sin))
            for t in (0.1, 1)
        ],
        columns=["measure", "theta_rad", "strain"],
    )
    assert [names for names, _ in shared_curves(rows)] == ["a, c", "b"]


def test_nothing_is_broken_by_accident(loaded: Store) -> None:
    text = invariance_page(loaded).text
    assert accidents(loaded) == (0, 12)
    assert "12 checks, 0 broken by accident" in text
    assert "| axes exchanged | 4 | 4 | 0 | 0 | 0 | 1.0e-15 | – |" in text
    assert row(text, "| plate moved and turned |")[-1] == "`donnell` 0.20"
    assert "Broken by accident**" not in text


def test_an_accident_is_shown_with_its_reason(own_store: Path) -> None:
    set_values(
        own_store, "symmetry", 0, **{"class": "broken by accident", "deviation": 0.25, "reason": "nothing explains it"}
    )
    loaded = load_store(own_store)
    text = invariance_page(loaded).text
    assert accidents(loaded) == (1, 12)
    assert "12 checks, 1 broken by accident" in text
    assert "| axes exchanged | 4 | 3 | 0 | 1 | 0 | 2.5e-01 | – |" in text
    assert "| axes exchanged | exact | semismooth | 2.5e-01 | nothing explains it |" in text


def test_counts_findings_and_faults(loaded: Store) -> None:
    text = invariance_page(loaded).text
    assert "6 cases 3 satisfy their law to 1e-6, 1 differ for a computed reason (1 not both are stable)" in text
    assert (
        "and in 1 a law is violated. 1 give nothing to compare: 0 are refused and 0 do not converge, with their" in text
    )
    assert (
        "and 1 converge where the other way does not. 2 faults were planted one at a time; 1 were not detected" in text
    )
    assert "the others by case 12 at the latest" in text
    assert "| 5 | derivatives | off by 1 |" in text
    assert "footprint fuzz --seed 5" in text
    assert "| wrong area | certified | 12 |" in text
    assert "| not detected |" in text


def test_without_random_cases_their_section_is_left_out(own_store: Path) -> None:
    (own_store / "tables" / "fuzz.csv").unlink()
    assert "## Random cases" not in invariance_page(load_store(own_store)).text
