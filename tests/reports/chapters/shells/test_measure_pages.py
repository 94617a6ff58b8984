"""The pages of rigid motions and locking: rates, laws and what is left over, from tables with known laws."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from reports.chapters.shells.locking import excess, locking_page, worst_energy
from reports.chapters.shells.rigid_body import rigid_body_page, shared_curves
from reports.store.tables import Store, load_store
from studies.experiments.locking import MESHES, THINNESS
from studies.store.atomic import write_table


@pytest.fixture
def loaded(store: Path) -> Store:
    return load_store(store)


def line(text: str, start: str) -> list[str]:
    """The first row of a table that starts with these words."""
    found = next(line for line in text.splitlines() if line.startswith(start))
    return [word.strip() for word in found.split("|")[1:-1]]


# --- rigid motions ----------------------------------------------------------------------------------------------


def test_rates_of_the_famous_failures(loaded: Store) -> None:
    text = rigid_body_page(loaded).text
    assert line(text, "| von-karman | out of plane |")[2:] == ["-0.1250 a^4.00"] * 4
    assert line(text, "| linear | drilling |")[2:] == ["-0.5000 a^2.00"] * 4
    assert line(text, "| donnell | translation |")[2] == "0"
    assert line(text, "| donnell | translation |")[3].endswith("a^2.00")
    assert "| exact | drilling | -" not in text
    found = loaded.analysis("rigid_body_powers")
    shear = found.query("measure == 'donnell' and surface == 'cylinder' and motion == 'translation'").iloc[0]
    assert shear["largest_rate"] == pytest.approx(1, abs=0.01)


def test_every_case_has_its_row_with_law_and_difference(loaded: Store) -> None:
    text = rigid_body_page(loaded).text
    data = loaded.table("rigid_body")
    everything = text[text.index("## All cases") :]
    assert everything.count("\n| ") == len(data) + 2 * 4  # and a header with its line for each surface
    quartic = f"{-((1 - math.cos(0.5)) ** 2) / 2:.6e}"
    assert line(everything, "| out of plane | von-karman |")[3:5] == [quartic, quartic]


def test_a_measure_off_its_law_is_seen(own_store: Path) -> None:
    path = own_store / "tables" / "rigid_body.csv"
    data = pd.read_csv(path)
    case = (data["measure"] == "sanders") & (data["motion"] == "drilling")
    data.loc[case, "strain"] += 1e-3
    write_table(path, data)
    overview = line(rigid_body_page(load_store(own_store)).text, "| sanders |")
    assert overview[-1] == "1.0e-03"


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


# --- locking ----------------------------------------------------------------------------------------------------


def test_thickness_locking_is_shown_beside_its_law(loaded: Store) -> None:
    text = locking_page(loaded).text
    assert "1.225 at ν = 0.3, 3.025 at ν = 0.45" in text
    assert line(text, "| moment | `full-3d` |")[2:] == ["1.0000", "1.0000", "1.2250", "1.2250", "3.0250", "3.0250"]
    assert line(text, "| pressure | `constant-s33` |")[2:] == ["1.0000"] * 6


def test_left_over_locking_has_the_rates_it_was_made_with(loaded: Store) -> None:
    found = excess(loaded.table("membrane_locking"), "relaxed")
    assert list(found.columns) == list(MESHES)
    np.testing.assert_allclose(found.loc[1e-5] / found.loc[1e-4], 101, rtol=0.02)  # less what is there at 1e-3
    np.testing.assert_allclose(found[8] / found[16], 64, rtol=1e-6)
    row = line(locking_page(loaded).text, "| relaxed | 16 | ")
    assert row[-2:] == ["–", "64"]


def test_the_worst_shell_is_named(loaded: Store) -> None:
    surface, thinness, n, ratio = worst_energy(loaded)
    assert (surface, thinness, n) == ("hyperboloid", min(THINNESS), min(MESHES))
    assert 0 < ratio < 0.5


def test_yardsticks_are_counted(own_store: Path) -> None:
    path = own_store / "tables" / "membrane_locking.csv"
    data = pd.read_csv(path)
    known = data["yardstick_reduced"].notna()
    assert f"below the reduced one in {known.sum()} of {known.sum()} cases" in locking_page(load_store(own_store)).text
    data.loc[data.index[known][0], "energy_norm_error"] = 0.6
    write_table(path, data)
    text = locking_page(load_store(own_store)).text
    assert f"below the reduced one in {known.sum() - 1} of {known.sum()} cases" in text
