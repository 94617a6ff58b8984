"""The tables to be taken away: every cell, every answer, and what each of their columns is.

Rounded: seconds to 4 digits, all else to 10. Cells are numbered in the order of the table, and answers name theirs.
What a column is stands in ``columns.csv``, by its kind: of what was asked and what became of it, the letter of a
collected column, or of answers.
"""

from __future__ import annotations

from pathlib import Path

import pandas as pd

from studies.run.cells.rows import answers, reference_rows

DIGITS, OF_SECONDS = 10, 4
CLOCK = "s"  # unit of what is rounded as seconds
FILE = Path(__file__).with_name("columns.csv")
DESCRIBED: dict[tuple[str, str], tuple[str, str]] = {  # unit and description by kind and name
    (kind, name): (unit, words)
    for kind, name, unit, words in pd.read_csv(FILE, keep_default_na=False).to_numpy().tolist()
}
ASKED, ANSWERS = ([name for kind, name in DESCRIBED if kind == each] for each in ("asked", "answers"))
PREFIXES = {"asked": "", "c": "", "w": "operations_", "t": "time_", "k": "residual_"}  # of published columns, by kind


def published(table: pd.DataFrame) -> dict[str, pd.DataFrame]:
    """The tables data_cells, data_answers and data_columns of a collected table."""
    numbered = table.assign(cell=range(len(table)))
    collected = {name: ("asked", name) for name in ASKED}
    collected |= {name: (name[0], name[2:]) for name in map(str, numbered) if name[1:2] == "." and name[0] in PREFIXES}
    kept = {name: _renamed(*of) for name, of in collected.items()}
    rows = [("cells", kept[name], *_described(*of)) for name, of in collected.items()]
    rows += [("answers", name, *_described("answers", name)) for name in ANSWERS]
    columns = pd.DataFrame(rows, columns=["table", "column", "unit", "description"])
    cells, values = numbered[list(kept)].rename(columns=kept), _answers(table, numbered)
    return {"data_cells": _rounded(cells, columns), "data_answers": _rounded(values, columns), "data_columns": columns}


def _answers(table: pd.DataFrame, numbered: pd.DataFrame) -> pd.DataFrame:
    own = answers(table)[["label", "quantity", "value"]]
    known = reference_rows(table).rename(columns={"value": "reference"})
    found = own.merge(known, how="left", on=["label", "quantity"]).merge(numbered[["label", "cell"]], on="label")
    found["error"] = found["value"] / found["reference"] - 1
    return found.sort_values("cell", kind="stable")[ANSWERS]


def _renamed(kind: str, name: str) -> str:
    """The name that a collected column is published under: seconds and counters have no prefix."""
    return name if name.startswith("seconds") else PREFIXES[kind] + name


def _described(kind: str, name: str) -> tuple[str, str]:
    """Unit and description of a column; a counter that a part from outside keeps has its name alone."""
    return DESCRIBED.get((kind, name), ("", name.replace("_", " ")))


def _rounded(table: pd.DataFrame, columns: pd.DataFrame) -> pd.DataFrame:
    units = columns.set_index("column")["unit"].to_dict()
    return table.assign(
        **{
            str(name): _significant(table[name], OF_SECONDS if units[name] == CLOCK else DIGITS)
            for name in table.select_dtypes("float")
        }
    )


def _significant(values: pd.Series, digits: int) -> pd.Series:
    return values.map(lambda value: float(f"{value:.{digits}g}"))
