"""Times of two machines are never ranked against each other: only one machine's are in a table, which says whose."""

from __future__ import annotations

import json
import re
import shutil
from pathlib import Path

import pandas as pd
import pytest

from reports.chapters.index import appendix
from reports.origin import machines as section
from reports.store import load_store
from studies.analysis.everything import analyse
from studies.ask.scene import UsageError
from studies.gate.merge import merge
from studies.output.provenance import UNKNOWN, machine_of
from studies.run import times
from studies.run.archive import Archive
from studies.run.campaign import find
from studies.run.collect import collect, of_one_machine
from studies.run.running import run
from studies.run.times import times_path
from support.stores.campaigns import small
from support.stores.elsewhere import BEAM, BEAMS, FINE, STRIP, Elsewhere, solved

FAST, CELLS = "Other CPU", 6


def of_another_machine(told: dict) -> None:
    """A thousand times as fast, as it claims."""
    told["provenance"]["machine"]["cpu"] = FAST
    told["timing_s"] = {name: value / 1000 for name, value in told["timing_s"].items()}


@pytest.fixture(scope="module")
def beams(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return solved(tmp_path_factory.mktemp("beams"), "beams", BEAMS)


@pytest.fixture
def mixed(beams: Path, tmp_path: Path) -> Path:
    """Two cells that were solved here, four that were merged from a faster machine."""
    there = Elsewhere(Path(shutil.copytree(beams, tmp_path / "elsewhere")))
    for label in there.ids:
        there.falsify(label, of_another_machine)
    (tmp_path / "beams.toml").write_text(BEAMS)
    here = Elsewhere(Path(shutil.copytree(beams, tmp_path / "here")))
    for label in set(here.ids) - {FINE, STRIP}:
        here.archive.record_path(here.ids[label]).unlink()
        shutil.rmtree(here.archive.files(here.ids[label]))
    for label in (FINE, STRIP):
        there.archive.record_path(there.ids[label]).unlink()
    assert merge(there.root, here.root).refused == []
    return here.root


def test_only_seconds_of_one_machine_are_in_the_table(mixed: Path) -> None:
    table = collect(mixed, "beams").set_index("label")
    merged = table["merged"] == "verified"
    assert merged.sum() == 4
    assert table.loc[merged, "machine"].str.startswith(FAST).all()
    assert not table.loc[~merged, "machine"].str.startswith(FAST).any()
    assert table.loc[merged, "t.seconds"].isna().all()
    assert (table.loc[~merged, "t.seconds"] > 0).all()
    assert (table.loc[merged, "seconds_there"] > 0).all()
    assert table.loc[~merged, "seconds_there"].isna().all()
    assert (table["c.operations"] > 0).all()


def test_seconds_of_the_minority_of_a_cluster_do_not_count_either() -> None:
    table = pd.DataFrame({"machine": ["a", "a", "b", ""], "merged": "", "t.seconds": 1.0, "t.cpu": 1.0})
    assert of_one_machine(table, "a")[["t.seconds", "t.cpu"]].notna().all(axis=1).tolist() == [True, True, False, False]


def test_where_the_campaign_was_timed_its_machine_is_the_home(mixed: Path) -> None:
    """The lane times cells here, merged ones too; what was solved elsewhere brings nothing beside it."""
    here = Elsewhere(mixed)
    lane = {"schema": 2, "provenance": {"machine": {"cpu": "Quiet CPU"}}, "canaries": [], "rounds": 1}
    cells = [{"label": BEAM, "id": here.ids[BEAM], "warm": [2.0] * 8, "cold": [], "discarded": []}]
    times_path(mixed, "beams").parent.mkdir()
    times_path(mixed, "beams").write_text(json.dumps({**lane, "cells": cells}))
    table = collect(mixed, "beams").set_index("label")
    assert table["t.seconds"].dropna().to_dict() == {BEAM: 2.0}


@pytest.mark.slow
def test_the_page_says_whose_the_cells_are(mixed: Path) -> None:
    analyse(mixed, "beams")
    store = load_store(mixed)
    text = appendix(store).text
    assert "## Machines" in text
    (row,) = [line for line in text.splitlines() if line.startswith(f"| {FAST}") and line.count("|") == 7]
    assert [word.strip() for word in row.split("|")[2:-1]] == ["4", "4", "0", "0", "0"]
    cells = pd.read_csv(mixed / "tables" / "data_cells.csv")
    assert (cells["machine"].str.startswith(FAST) == (cells["merged"] == "verified")).all()


@pytest.mark.slow
def test_a_store_of_one_machine_says_no_more_than_before(beams: Path, tmp_path: Path) -> None:
    own = Path(shutil.copytree(beams, tmp_path / "own"))
    analyse(own, "beams")
    assert section(load_store(own)).text.strip() == ""
    assert collect(own, "beams")["t.seconds"].notna().all()


@pytest.mark.slow
def test_a_store_that_is_all_merged_has_no_seconds_and_is_analysed(beams: Path, tmp_path: Path) -> None:
    merge(beams, tmp_path / "here")
    analyse(tmp_path / "here", "beams")
    assert collect(tmp_path / "here", "beams")["t.seconds"].isna().all()
    assert "## Machines" in appendix(load_store(tmp_path / "here")).text


def test_a_run_goes_on_beside_merged_cells(mixed: Path, tmp_path: Path) -> None:
    assert run(find(str(tmp_path / "beams.toml")), mixed).solved == 0
    assert Archive(mixed).campaigns() == ["beams"]


def test_machines_differ_by_what_decides_a_time() -> None:
    record = {"machine": {"cpu": "A", "cores": 2, "memory_GiB": 23.5, "python": "3.11"}, "blas": {"threads": "1"}}
    assert machine_of(record) == machine_of({**record, "machine": {**record["machine"], "memory_GiB": 23.4}})
    assert machine_of(record) != machine_of({**record, "blas": {"threads": "2"}})
    assert machine_of({}) == UNKNOWN


class Steady:
    """In the place of the process: every solve takes ``seconds``, the canary none that moves."""

    seconds = 1.0

    def ask(self, *_: object) -> dict[str, str]:
        return {"class": "", "text": json.dumps({"seconds": 1.0, "timing_s": {"cpu": self.seconds}})}

    def end(self) -> None:
        pass


def test_to_time_some_cells_keeps_the_samples_of_the_others(
    own: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(times, "Child", Steady)
    campaign, fine = find(str(small(tmp_path))), re.compile("8x1").search
    assert len(times.time_campaign(campaign, own)) == CELLS
    before = times.read_times(own, "small")
    monkeypatch.setattr(Steady, "seconds", 2.0)
    table = times.time_campaign(campaign, own, fine)
    assert all(map(fine, table["label"]))
    after = times.read_times(own, "small")
    for cell in before["cells"]:
        (now,) = (each for each in after["cells"] if each["label"] == cell["label"])
        assert now == cell if not fine(cell["label"]) else set(now["warm"]) == {2.0}
    assert len(after["cells"]) == CELLS
    assert after["canaries"][: len(before["canaries"])] == before["canaries"]
    monkeypatch.setattr(times, "provenance", lambda: {"machine": {"cpu": FAST}})
    with pytest.raises(UsageError, match="has times of another machine"):
        times.time_campaign(campaign, own, fine)
    assert times.read_times(own, "small") == after
    times.time_campaign(campaign, own)
    assert times.read_times(own, "small")["provenance"] == {"machine": {"cpu": FAST}}
