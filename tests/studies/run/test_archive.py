"""What is looked at in a store before pages are made of it."""

from __future__ import annotations

import json
import os
from pathlib import Path

import pytest

from studies.ask.scene import UsageError
from studies.run import archive
from studies.run.archive import KEYS, check_store

ROW = {
    **{"label": "a", "id": "a", "scene": "panel", "command": "solve", "options": {}, "settings": {}, "files": False},
    **{"request": None, "reason": ""},
}
PLAN = {"schema": 2, "campaign": "one", "cells": [ROW]}
RECORD = {**{key: {} for key in KEYS}, "schema": 2, "id": "a", "class": "converged", "reason": "", "scene": "panel"}
RECORD |= {"steps": [], "files": []}


@pytest.fixture
def store(tmp_path: Path) -> Path:
    """A plan of one cell, a record of no plan that is none, and a table."""
    for path, text in (
        ("campaigns/one.json", json.dumps(PLAN)),
        ("cells/a.json", json.dumps(RECORD)),
        ("cells/b.json", "{"),
        ("tables/t.csv", "a,b\n1,2\n"),
    ):
        (tmp_path / path).parent.mkdir(exist_ok=True)
        (tmp_path / path).write_text(text)
    return tmp_path


def test_what_is_missing_or_asked_for_by_no_plan_is_passed_over(store: Path) -> None:
    check_store(store)
    check_store(store, "one")
    check_store(store / "nowhere")


@pytest.mark.parametrize(
    ("path", "text", "says"),
    [
        ("cells/a.json", json.dumps(RECORD | {"reason": 1}), "reason = 1 must be a text"),
        ("cells/a.json", "[]", "is not a record"),
        ("failures/a.json", "[" * 100_000, "nests deeper"),
        ("campaigns/one.json", json.dumps(PLAN | {"cells": [ROW | {"id": "../x"}]}), "must be a name"),
        ("references.json", '{"schema": 2, "references": 1}', "must be a list"),
    ],
)
def test_values_are_of_their_types(store: Path, path: str, text: str, says: str) -> None:
    (store / path).parent.mkdir(exist_ok=True)
    (store / path).write_text(text)
    with pytest.raises(UsageError, match=says) as caught:
        check_store(store)
    assert str(store / path) in str(caught.value)


def test_tables_are_files_within_bounds(store: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(archive, "MOST", 3)
    with pytest.raises(UsageError, match="more than 3 values"):
        check_store(store)
    (store / "tables" / "t.csv").unlink()
    os.mkfifo(store / "tables" / "u.csv")
    with pytest.raises(UsageError, match="not a regular file"):
        check_store(store)


def test_a_damaged_record_is_set_aside_over_no_other(tmp_path: Path) -> None:
    """The first one was looked at and removed: the next two take the names that are free."""
    kept, held = archive.Archive(tmp_path), tmp_path / "aside" / "a.1.json"
    for path in (held, kept.record_path("a")):
        path.parent.mkdir()
        path.write_text(path.name)
    assert kept.set_aside("a").name == "a.json"
    kept.record_path("a").write_text("third")
    assert kept.set_aside("a").name == "a.2.json"
    assert held.read_text() == "a.1.json"
