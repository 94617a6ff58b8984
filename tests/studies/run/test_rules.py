"""Small rules of campaigns: what is kept, what counts as a finer mesh, and what is made anew."""

from __future__ import annotations

from pathlib import Path
from types import SimpleNamespace

import pandas as pd
import pytest

from studies.output import atomic
from studies.run import plan
from studies.run.answers import _apart
from studies.run.plan import Row, solved_rows
from studies.scenes.complete import complete


def test_files_of_a_cell_are_kept_where_any_of_its_rows_wants_them() -> None:
    for wants in ((False, True), (True, False), (False, False)):
        rows = [Row(SimpleNamespace(artefacts=each), "one", None) for each in wants]
        assert [(name, row.cell.artefacts) for name, row in solved_rows(rows)] == [("one", any(wants))]


def test_a_mesh_is_finer_than_the_last_that_stays() -> None:
    assert _apart([1.0, 0.8, 0.64, 0.512]) == [False, True, False, True]


def test_a_table_whose_writing_was_stopped_is_made_anew(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Even by who asks for the one that was there before."""
    path, table = tmp_path / "table.csv", pd.DataFrame({"x": [1]})
    assert atomic.write_table_once(path, "old", lambda: table)
    assert not atomic.write_table_once(path, "old", lambda: table)

    def stopped(path: Path, text: str) -> None:
        raise KeyboardInterrupt

    with monkeypatch.context() as context:
        context.setattr(atomic, "write_text", stopped)
        with pytest.raises(KeyboardInterrupt):
            atomic.write_table_once(path, "new", lambda: table)
    assert atomic.write_table_once(path, "old", lambda: table)


def test_json_knows_no_negative_zero() -> None:
    assert atomic.as_text({"x": -0.0, "y": [-0.0]}).count("-") == 0


def test_another_schema_is_another_cell(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(plan, "sources_hash", lambda *_, **__: "sources")
    _, request = complete("ring", {})
    before = plan.identity(request)
    monkeypatch.setattr(plan, "SCHEMA", 0)
    assert plan.identity(request) != before
