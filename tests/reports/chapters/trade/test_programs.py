"""The page of other programs from a made-up table: the opening sentences, the table, and what stands without."""

from __future__ import annotations

from pathlib import Path

import pandas as pd
import pytest

from reports.chapters.programs import agreements, programs_page
from reports.figures.drawing import drawn
from reports.store import load_store
from studies.analysis.programs import agreement
from studies.output.atomic import write_table
from support.pages.rows import row
from support.stores.made_up import analysed_again
from support.stores.programs import made_up_programs


def test_the_opening_counts_and_gives_reasons() -> None:
    said = agreements(agreement(made_up_programs()))
    assert said == [
        "CalculiX (ccx 2.20) runs 4 scenes from our decks; on the finest mesh of each, 1 of 4 values (scenes: 1) are"
        " within 1 % of ours.",
        "inward [mm] of hemisphere differs by -2.00 %, which falls with the mesh at the rate 2.0.",
        "inflated equator outer [mm] of tyre, angle plies, inflated differs by +20.00 %: a deck has one direction of"
        " plies a brick, and our own solid under that rule is +1.00 % from it on the same mesh.",
        "force [N] of ring differs by +3.00 %, for a reason that is not known.",
    ]


def test_the_finest_meshes_are_there(store: Path) -> None:
    text = programs_page(load_store(store)).text
    assert "CalculiX (ccx 2.20) runs 4 scenes" in text
    (best,) = (line for line in text.splitlines() if line.startswith("| tyre, isotropic | CalculiX"))
    assert best == "| tyre, isotropic | CalculiX | 16x16 | force_N | 1 | 522.6 | 520 | +0.5 % | – |"


def test_without_its_tables_nothing_is_said(own_store: Path) -> None:
    (own_store / "tables" / "programs.csv").unlink()
    assert "CalculiX" not in programs_page(load_store(own_store)).text


@pytest.mark.slow
def test_peers_are_shown_where_they_were_measured(own_store: Path) -> None:
    shell = ("hemisphere", "footprint", "default", "16x16", 1665, 8.1, 8, 0.2, 0.02, 0.1, 0.04, 3, 1.0)
    peer = ("hemisphere", "kratos", "thick", "20x20", 2646, 8.15, 50, 8.0, 0.1, 5.0, 2.0, 3, 40.0)
    columns = ["problem", "program", "family", "mesh", "unknowns", "value", "iterations", "seconds"]
    columns += ["start", "assembly", "factorisation", "runs", "units"]
    never = ("hemisphere", "kratos", "thin", "8x8", 486, 7.0, 50, 1.0, 0.1, 0.5, 0.2, 3, 5.0)
    measured = pd.DataFrame([shell, peer, never], columns=columns)
    judged = measured.assign(within=0.01, bar=50.0, uncertainty=0.002, error=measured["value"] / 8.178 - 1)
    write_table(own_store / "tables" / "peers.csv", judged)
    assert "Time to an equal error" not in programs_page(load_store(own_store)).text  # not analysed yet
    analysed_again(own_store)
    page = programs_page(load_store(own_store))
    assert (
        "`kratos` (thick, 20x20) takes 40.0 times the time of `footprint` (default, 16x16); the bar of 50 is"
        in page.text
    )
    found = row(page.text, "| hemisphere | `kratos` | thick | 1 % |")
    assert found[4:] == ["20x20", "2646", "-0.34 %", "8.00", "40.0", "40.0", "+0.62 %"]
    assert row(page.text, "| hemisphere | `kratos` | thin | 1 % |")[4:10] == ["–"] * 6
    with drawn() as figures:
        page.pictures["cost-peers.svg"]()
    (figure,) = figures
    assert [axes.get_title() for axes in figure.axes if axes.get_visible()] == ["hemisphere"]
