"""What pages are looked at with: rows of tables, what a median must say, widths; and stores that are changed for it.

The rows of the tables of a page, as words.

A store that is changed: records of cells by their labels, and tables by their names.

Medians and rankings of a page that say too little of what they rest on.

How wide a table of a page is at least, in the type of the HTML: estimated letter by letter.
"""

from __future__ import annotations

import json
import re
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pandas as pd

from studies.output.atomic import write_json, write_table


def row(text: str, *words: str) -> list[str]:
    """The cells of the first line that has all of these words; raises StopIteration where there is none."""
    actual = next(line for line in text.splitlines() if all(word in line for word in words))
    return [word.strip() for word in actual.split("|")[1:-1]]


def place(root: Path, label: str, campaign: str = "report") -> Path:
    """The directory of the cell with this label."""
    index = json.loads((root / "campaigns" / f"{campaign}.json").read_text(encoding="utf-8"))
    return root / "cells" / next(row["id"] for row in index["cells"] if row["label"] == label)


def edit_json(path: Path, change: Callable[[dict[str, Any]], object]) -> None:
    data = json.loads(path.read_text(encoding="utf-8"))
    change(data)
    write_json(path, data)


def edit_table(root: Path, name: str, change: Callable[[pd.DataFrame], pd.DataFrame]) -> None:
    path = root / "tables" / f"{name}.csv"
    write_table(path, change(pd.read_csv(path)))


def set_values(root: Path, name: str, row: int, **columns: object) -> None:
    """Give a row of a table other values."""
    edit_table(root, name, lambda data: data.astype(dict.fromkeys(columns, object)).pipe(_set, row, columns))


def _set(data: pd.DataFrame, row: int, columns: dict[str, object]) -> pd.DataFrame:
    data.loc[row, list(columns)] = list(columns.values())
    return data


MEDIAN = re.compile(r"^\d+\.\d+ \[(\d|–)")  # with its interval: over several problems
RANKING = re.compile(r"(\d+) problems: \S+ > ")
BOTH, SOLVES = re.compile(r"\bboth\b"), re.compile(r"\b(solve[sd]?|reaches|share)\b")
FEWEST = 5
OF_MEDIANS = re.compile(r"^(\w+_)?ratio$")  # a declared column, where its low and high ends are declared, too


def unfounded(text: str) -> list[str]:
    """Tables with a median that lack the number of problems, or the share that is solved, and rankings of too few."""
    return [*_tables(text), *(f"ranked: {actual[0]}" for actual in RANKING.finditer(text) if int(actual[1]) < FEWEST)]


def _tables(text: str) -> Iterator[str]:
    for block in text.split("\n\n"):
        lines = [line for line in block.splitlines() if line.startswith("|")]
        if len(lines) < 3:
            continue
        heads, _, *rows = ([cell.strip() for cell in line.strip("|").split(" | ")] for line in lines)
        medians = [row for row in rows if any(MEDIAN.match(cell) for cell in row)]
        both = next((i for i, head in enumerate(heads) if BOTH.search(head)), None)
        if medians and (both is None or not any(SOLVES.search(head) for head in heads)):
            yield f"{' | '.join(heads)}: a median without both-count or solved share"
        for row in medians if both is not None else []:
            if int(row[both].split()[0]) < FEWEST:
                yield f"{' | '.join(row)}: a median of {row[both]}"


def bare_columns(columns: tuple[str, ...]) -> list[str]:
    """Declared medians of a table that declares no both-count, or no solved share, beside them."""
    names = [name for name in columns if OF_MEDIANS.match(name)]
    spread = [n for n in names if {n.removesuffix("ratio") + "low", n + "_low"} & set(columns)]
    founded = "both" in columns and bool({"solved", "solved_share", "a_solved"} & set(columns))
    return [] if founded else spread


LETTER, CODE = 7.4, 6.5  # px, mean of a letter of a table and of one of code; Chromium's widths are within 5 % of it
PADDING, SORT = 17.6, 12.0  # px of a cell, and of the arrow at a head
PAGE = 968.0  # px of a page


def widths(text: str) -> Iterator[tuple[str, float]]:
    """Title and least width [px] of each table: columns of numbers do not wrap, words do at blanks and hyphens."""
    lines = text.splitlines()
    for i, line in enumerate(lines):
        if re.fullmatch(r"\|( :?--:? \|)+", line):
            rows = [lines[i - 1]]
            j = i + 1
            while j < len(lines) and lines[j].startswith("| "):
                rows.append(lines[j])
                j += 1
            numbers = [cell.strip() == "--:" for cell in line.strip("|").split("|")]
            yield lines[i - 3].strip("*"), _least([_cells(row) for row in rows], numbers)


def _cells(row: str) -> list[str]:
    return [re.sub(r"\]\([^)]*\)", "", cell.strip()).replace("[", "") for cell in row.strip("|").split(" | ")]


def _least(rows: list[list[str]], numbers: list[bool]) -> float:
    head, *body = rows
    total = 0.0
    for k, number in enumerate(numbers):
        words = max(map(_size, re.split(r"[ \-]", head[k])))
        cells = [_size(row[k]) if number else max(map(_size, re.split(r"[ \-]", row[k]))) for row in body]
        total += PADDING + max(words + SORT, *cells, 0.0)
    return total


def _size(words: str) -> float:
    code = "`" in words
    return (CODE if code else LETTER) * len(words.replace("`", "").replace("*", ""))
