"""The pieces of a page as Markdown: prose, tables under a title, pictures, folds, fenced commands.

What they mean is not known here.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import pandas as pd

from reports.formats import Line

Form = Callable[[Any], str]
MACHINE, END_MACHINE = "<!-- machine -->", "<!-- /machine -->"


@dataclass(frozen=True)
class Part:
    """A piece of a page: its text and the pictures it shows, by file name, which draw themselves when asked for."""

    text: str
    pictures: Mapping[str, Callable[[], str]] = field(default_factory=dict)


def joined(*blocks: Part | str) -> Part:
    """Pieces below one another; one without text leaves no trace."""
    parts = [block if isinstance(block, Part) else Part(block) for block in blocks]
    pictures = {name: svg for part in parts for name, svg in part.pictures.items()}
    return Part("\n\n".join(part.text.strip("\n") for part in parts if part.text) + "\n", pictures)


def table(title: str, header: Sequence[str], rows: Iterable[Sequence[object]], words: int = 1) -> str:
    """A table under its title line; the first columns are words, the others are numbers."""
    lines = [f"**{title}**", "", _line(header), _line([*[":--"] * words, *["--:"] * (len(header) - words)])]
    return "\n".join([*lines, *(_line(row) for row in rows)])


def listing(
    title: str, records: pd.DataFrame | Iterable[Any], heads: str, line: str, words: int = 1, **named: Form
) -> str:
    """A table with a line a record: its heads as "a | b", and its line of what stands below them as "{x:.1f} | {y}".

    The fields of the line are filled in as by ``Line``. Raises ValueError when there are not as many of one as of the
    other.
    """
    names, columns = heads.split(" | "), line.split(" | ")
    if len(names) != len(columns):
        raise ValueError(f"{title}: {len(names)} heads over {len(columns)} columns")
    each = records.to_dict("records") if isinstance(records, pd.DataFrame) else list(records)
    return table(title, names, zip(*(filled(column, each, **named) for column in columns), strict=True), words)


def filled(line: str, records: pd.DataFrame | Iterable[Any], **named: Form) -> list[str]:
    """A line for each record, its fields filled in as by ``Line``."""
    filler, each = Line(named), records.to_dict("records") if isinstance(records, pd.DataFrame) else records
    return [filler.filled(line, record) for record in each]


def _line(entries: Sequence[object]) -> str:
    return "| " + " | ".join(str(entry) for entry in entries) + " |"


def prose(text: str) -> str:
    """Text with its line ends inside paragraphs and list items taken out: how long a number is must not move words."""
    paragraphs = [re.sub(r"\n(?!- )\s*", " ", paragraph.strip()) for paragraph in text.strip().split("\n\n")]
    return "\n\n".join(paragraphs)


def picture(name: str, words: str, svg: Callable[[], str]) -> Part:
    """A picture of the folder ``figures`` with the words that replace it where it cannot be shown."""
    return Part(f"![{words}](figures/{name})", {name: svg})


def folded(summary: str, text: str) -> str:
    """Text that opens on a click."""
    return f"<details><summary>{summary}</summary>\n\n{text}\n\n</details>"


def fold(summary: str, *blocks: Part | str) -> Part:
    """Pieces with their pictures that open on a click."""
    inside = joined(*blocks)
    return Part(folded(summary, inside.text.strip("\n")), inside.pictures)


def commands(lines: Iterable[str]) -> str:
    """Shell commands in a fold."""
    block = "\n".join(["```sh", *dict.fromkeys(lines), "```"])
    return folded("Commands that reproduce these numbers", block)


def machine(*blocks: str) -> str:
    """Text that depends on the machine, so that a comparison of pages skips it."""
    return "\n\n".join([MACHINE, *blocks, END_MACHINE])
