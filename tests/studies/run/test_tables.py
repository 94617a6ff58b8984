"""Tables of one result beside pandas, which writes and reads the same."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from studies.output.atomic import Table


def test_files_are_those_of_pandas_to_the_byte(rng: np.random.Generator, tmp_path: Path) -> None:
    columns = {
        "wide": rng.normal(size=40) * 10.0 ** rng.integers(-300, 300, size=40),
        "count": np.arange(40),
        "rare": np.where(np.arange(40) % 3, math.nan, 0.1),
        "edge": np.resize([math.inf, -math.inf, -0.0, 1e16, 1e-5, 123456789.0], 40),
        "state": "unloaded",
        "said": np.resize(['limit point, "cut"', "two\nlines", ""], 40),
    }
    Table.of(columns).write(tmp_path / "ours.csv")
    pd.DataFrame(columns).to_csv(tmp_path / "theirs.csv", index=False)
    assert (tmp_path / "ours.csv").read_bytes() == (tmp_path / "theirs.csv").read_bytes()


def test_what_a_row_lacks_is_blank_and_a_whole_number_stays_one(tmp_path: Path) -> None:
    rows = [{"stage": "press", "added": 3}, {"stage": "press", "event": "cut"}]
    Table.of_rows(rows).write(tmp_path / "history.csv")
    assert (tmp_path / "history.csv").read_text() == "stage,added,event\npress,3,\npress,,cut\n"
    pd.testing.assert_frame_equal(pd.read_csv(tmp_path / "history.csv"), pd.DataFrame(rows))


def test_without_rows_the_named_columns_are_there(tmp_path: Path) -> None:
    Table.of_rows([], ["stage", "residual"]).write(tmp_path / "history.csv")
    assert (tmp_path / "history.csv").read_text() == "stage,residual\n"
    assert len(Table({})) == len(Table.of_rows([], ["stage"])) == 0


def test_stacked_and_framed_as_pandas_does() -> None:
    parts = [{"state": "a", "x": np.array([1.0, 2.0])}, {"state": "b", "x": np.array([3.0]), "y": np.array([4.0])}]
    ours = Table.stacked([Table.of(part) for part in parts])
    theirs = pd.concat([pd.DataFrame(part) for part in parts], ignore_index=True)
    pd.testing.assert_frame_equal(ours.frame(), theirs)
    assert len(ours) == 3


def test_columns_of_different_length_are_no_table() -> None:
    with pytest.raises(ValueError, match="broadcast"):
        Table.of({"x": np.zeros(3), "y": np.zeros(4)})
    with pytest.raises(ValueError, match="shorter"):
        list(Table({"x": [1, 2], "y": [1]}).rows())
