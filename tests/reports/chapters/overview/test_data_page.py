"""The appendix and the data beside the pages: complete, described, readable as it says, and small enough to be kept."""

from __future__ import annotations

import gzip
import io
import re
from pathlib import Path

import pandas as pd

from reports.files import as_bytes, write_texts
from reports.store import load_store

ROOT = Path(__file__).parents[4]
LARGEST = 2_000_000  # bytes of all that is committed


def table(files: dict[str, str], name: str) -> pd.DataFrame:
    return pd.read_csv(io.StringIO(files[f"data/{name}"]))


def test_every_planned_cell_is_in_the_data(files: dict[str, str], store: Path) -> None:
    """As many as every foot says, and of each class."""
    cells, planned = table(files, "cells.csv.gz"), load_store(store).planned
    assert list(cells["label"].sort_values()) == sorted(each.label for each in planned)
    counts = cells["outcome"].value_counts().to_dict()
    told = re.search(r"\*report: (\d+) cells planned: (.*?);", files["tyre.md"])
    assert int(told[1]) == len(cells)
    assert {name: int(n) for n, name in (part.split(" ", 1) for part in told[2].split(", "))} == counts


def test_columns_are_those_of_the_files(files: dict[str, str]) -> None:
    columns = table(files, "columns.csv")
    for name in ("cells", "answers"):
        own = list(table(files, f"{name}.csv.gz"))
        assert own == list(columns.loc[columns["table"] == name, "column"])
    assert columns["description"].notna().all()


def test_the_example_of_the_page_runs(files: dict[str, str], tmp_path: Path, monkeypatch, capsys) -> None:
    write_texts(tmp_path, {name: text for name, text in files.items() if name.startswith("data/")})
    monkeypatch.chdir(tmp_path)
    (code,) = re.findall(r"```python\n(.*?)```", files["data.md"], re.DOTALL)
    exec(code, {})
    assert "exact" in capsys.readouterr().out


def test_compressed_files_are_the_same_bytes_every_time() -> None:
    assert as_bytes("a.csv.gz", "text") == as_bytes("a.csv.gz", "text")
    assert gzip.decompress(as_bytes("a.csv.gz", "tëxt")).decode() == "tëxt"
    assert as_bytes("a.csv", "tëxt") == "tëxt".encode()


def test_what_is_committed_stays_small() -> None:
    assert sum(path.stat().st_size for path in (ROOT / "reports" / "pages").rglob("data/*")) < LARGEST


def test_the_citation_names_the_version_of_the_project() -> None:
    project = (ROOT / "pyproject.toml").read_text(encoding="utf-8")
    cited = (ROOT / ".github" / "CITATION.cff").read_text(encoding="utf-8")
    version = re.search(r'^version = "(.*)"$', project, re.MULTILINE)[1]
    assert f"\nversion: {version}\n" in cited
    assert "\nlicense: MIT\n" in cited
