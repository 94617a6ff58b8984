"""The pieces of a page as Markdown: prose, tables under a title, pictures, folds, fenced commands.

What they mean is not known here.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import pandas as pd

from reports.formats import NOTHING, Line

Form = Callable[[Any], str]
MACHINE, END_MACHINE = "<!-- machine -->", "<!-- /machine -->"
FOLD, END_FOLD = re.compile(r"<details><summary>(.+)</summary>"), "</details>"
FENCE = re.compile(r"^(```.*?^```)$", re.MULTILINE | re.DOTALL)


@dataclass(frozen=True)
class Part:
    """A piece of a page: its text and the pictures it shows, by file name, which draw themselves when asked for."""

    text: str = ""
    pictures: Mapping[str, Callable[[], str]] = field(default_factory=dict)

    def __str__(self) -> str:
        return self.text.strip("\n")


def joined(*blocks: Part | str) -> Part:
    """Pieces below one another; one without text leaves no trace."""
    pictures = {name: svg for part in blocks if isinstance(part, Part) for name, svg in part.pictures.items()}
    return Part("\n\n".join(filter(None, (str(block).strip("\n") for block in blocks))) + "\n", pictures)


def table(title: str, header: Sequence[str], rows: Iterable[Sequence[object]], words: int = 1) -> str:
    """A table under its title line; the first columns are words, the others are numbers."""
    lines = [f"**{title}**", "", _line(header), _line([*[":--"] * words, *["--:"] * (len(header) - words)])]
    return "\n".join([*lines, *map(_line, rows)])


def by_name(
    groups: Iterable[tuple[Sequence[object], pd.DataFrame]],
    names: Iterable[object],
    entry: Callable[[dict[Any, Any]], object],
    column: str = "name",
) -> Iterator[list[object]]:
    """A line of a table for each group: its words, then an entry for each name, a dash where the group has none."""
    columns = list(names)
    for words, own in groups:
        by = {row[column]: row for row in own.to_dict("records")}
        yield [*words, *(entry(by[name]) if name in by else NOTHING for name in columns)]


def filled(line: str, records: pd.DataFrame | Iterable[Any], **named: Form) -> list[str]:
    """A line for each record, its fields filled in as by ``Line``."""
    filler, each = Line(named), records.to_dict("records") if isinstance(records, pd.DataFrame) else records
    return [filler.filled(line, record) for record in each]


def _line(entries: Sequence[object]) -> str:
    return "| " + " | ".join(map(str, entries)) + " |"


def prose(text: str) -> str:
    """Text with its line ends inside paragraphs and list items taken out."""
    return "\n\n".join(re.sub(r"\n(?!- )\s*", " ", each.strip()) for each in text.strip().split("\n\n"))


def picture(name: str, words: str, svg: Callable[[], str]) -> Part:
    """A picture of the folder ``figures`` with the words that replace it where it cannot be shown."""
    return Part(f"![{words}](figures/{name})", {name: svg})


def commands(lines: Iterable[str]) -> str:
    """Shell commands in a fold; nothing where there is none."""
    block = "\n".join(["```sh", *dict.fromkeys(lines), "```"])
    summary = "Commands that reproduce these numbers"
    return f"<details><summary>{summary}</summary>\n\n{block}\n\n{END_FOLD}" if block.count("\n") > 1 else ""


def machine(*blocks: str) -> str:
    """Text that depends on the machine, so that a comparison of pages skips it."""
    return "\n\n".join([MACHINE, *blocks, END_MACHINE])
