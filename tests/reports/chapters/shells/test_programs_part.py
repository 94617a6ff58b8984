"""The section of other programs from a made-up table: the opening sentence, both tables, and what stands without."""

from __future__ import annotations

from pathlib import Path

from reports.chapters.shells.programs import programs_part, sentences
from reports.store.tables import load_store
from studies.analysis.comparisons.program_agreement import agreement
from support.stores.programs import made_up_programs


def test_the_opening_counts_and_gives_reasons() -> None:
    said = sentences(agreement(made_up_programs()))
    assert said == [
        "CalculiX (ccx 2.20) runs 4 scenes from our decks; on the finest mesh of each, 1 of 4 values (scenes: 1) are"
        " within 1 % of ours.",
        "inward_mm of hemisphere is -2.00 % off, and falls with the mesh at the rate 2.0.",
        "inflated_equator_outer_mm of tyre, angle plies, inflated is -20.00 % off: a deck has one direction of plies a"
        " brick, and our own solid under that rule is +1.00 % from it on the same mesh.",
        "force_N of ring is +3.00 % off, without a reason found.",
    ]


def test_both_tables_are_there(store: Path) -> None:
    text = programs_part(load_store(store)).text
    assert "CalculiX (ccx 2.20) runs 4 scenes" in text
    (best,) = (line for line in text.splitlines() if line.startswith("| tyre, isotropic | CalculiX"))
    assert best == "| tyre, isotropic | CalculiX | 16x16 | force_N | 1 | 522.6 | 520 | +0.50 % | – |"
    (coarse,) = (line for line in text.splitlines() if line.startswith("| hemisphere | C3D20R | 8x8 | 64 |"))
    assert coarse.split(" | ")[6:] == ["-8.00 %", "–", "–", "12.5 |"]


def test_without_the_tables_the_command_is_named(own_store: Path) -> None:
    (own_store / "tables" / "programs.csv").unlink()
    text = programs_part(load_store(own_store)).text
    assert "Not run here; `footprint bench programs" in text
