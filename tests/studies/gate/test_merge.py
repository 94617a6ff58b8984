"""The rules of a merge: what is here stays, a stopped merge is gone on with, counters are held against a solve."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from studies.ask.request import UsageError
from studies.cli import main
from studies.gate.merge import ALREADY, NOT_SOLVED, VERIFIED, merge
from studies.run.archive import Archive
from support.stores.elsewhere import BEAM, Elsewhere


def halve(told: dict[str, Any]) -> None:
    told["counters"]["newton_iterations"] //= 2


def without_field(told: dict[str, Any]) -> None:
    told["files"] = []


def test_a_second_merge_has_nothing_to_do(elsewhere: Elsewhere, tmp_path: Path) -> None:
    merge(elsewhere.root, tmp_path / "here")
    path = Archive(tmp_path / "here").record_path(elsewhere.ids[BEAM])
    before = path.read_bytes()
    assert merge(elsewhere.root, tmp_path / "here").counts == {ALREADY: 6}
    assert path.read_bytes() == before


def test_a_cell_that_is_here_with_other_values_stays_and_is_named(elsewhere: Elsewhere, tmp_path: Path) -> None:
    merge(elsewhere.root, tmp_path / "here")
    path = Archive(tmp_path / "here").record_path(elsewhere.ids[BEAM])
    before = path.read_bytes()
    elsewhere.falsify(BEAM, lambda stated: stated["quantities"].update(tip_deflection_mm=7.0))
    actual = merge(elsewhere.root, tmp_path / "here")
    (line,) = actual.refused
    assert "tip_deflection_mm: claimed 7.0, the cell here has" in line
    assert line.endswith("and stays")
    assert path.read_bytes() == before


def test_a_stopped_merge_is_gone_on_with(elsewhere: Elsewhere, tmp_path: Path) -> None:
    def stop(done: int, planned: int, label: str) -> None:
        if done == 3:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        merge(elsewhere.root, tmp_path / "here", progress=stop)
    assert merge(elsewhere.root, tmp_path / "here").counts == {ALREADY: 3, VERIFIED: 3}


def test_what_was_not_solved_there_is_no_lie(elsewhere: Elsewhere, tmp_path: Path) -> None:
    elsewhere.archive.record_path(elsewhere.ids[BEAM]).unlink()
    actual = merge(elsewhere.root, tmp_path / "here")
    assert (actual.counts, actual.refused) == ({NOT_SOLVED: 1, VERIFIED: 5}, [])


def test_the_plan_that_is_here_stays(elsewhere: Elsewhere, tmp_path: Path) -> None:
    merge(elsewhere.root, tmp_path / "here")
    index = Archive(tmp_path / "here").index_path("beams")
    index.write_text(index.read_text().replace("another store", "ours"))
    before = index.read_bytes()
    merge(elsewhere.root, tmp_path / "here")
    assert index.read_bytes() == before


def test_counters_are_claims(elsewhere: Elsewhere, tmp_path: Path) -> None:
    elsewhere.falsify(BEAM, halve)
    assert merge(elsewhere.root, tmp_path / "believed").refused == []
    ours = Archive(tmp_path / "believed").record(elsewhere.ids[BEAM])
    assert ours is not None
    assert "counters" in ours["merged"]["claimed"]


def test_a_store_is_not_merged_into_itself_nor_what_is_none(elsewhere: Elsewhere, tmp_path: Path) -> None:
    with pytest.raises(UsageError, match="cannot be merged into itself"):
        merge(elsewhere.root, elsewhere.root)
    with pytest.raises(UsageError, match="is not a store: it has no campaign"):
        merge(tmp_path / "nothing", tmp_path / "here")
    assert not (tmp_path / "here").exists()


def test_the_command_ends_with_one_where_a_claim_is_refused(
    elsewhere: Elsewhere, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    elsewhere.falsify(BEAM, without_field)
    words = ["merge", str(elsewhere.root), "--store", str(tmp_path / "here")]
    assert main(words) == 1
    printed = capsys.readouterr()
    assert printed.err.startswith(f"refused: {BEAM} ({elsewhere.ids[BEAM]}): field: none is kept")
    assert printed.out == "merge: 5 verified, 1 refused\n"
