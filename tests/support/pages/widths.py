"""How wide a table of a page is at least, in the type of the HTML: estimated letter by letter."""

from __future__ import annotations

import re
from collections.abc import Iterator

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
