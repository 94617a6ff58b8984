"""The one writer of Markdown: prose, tables, pictures, folds, commands, and templates with fields to be filled in.

Templates are the files of the folder ``templates``. A file has blocks, each under a line ``%% name``. Paragraphs stand
apart by an empty line, and lines within one are joined, for how long a number is must not move words. Fields are filled
in as by ``formats.Line``. A line with ``for rows:`` before it stands once for each record of the value ``rows``; an
indented line goes on with the one above. A table without rows, a fold or block of the machine with nothing in it and
an empty paragraph leave no trace. What the pieces mean is not known here.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from types import MappingProxyType
from typing import Any

import pandas as pd

from reports.formats import NOTHING, Line

Form = Callable[[Any], str]
MACHINE, END_MACHINE = "<!-- machine -->", "<!-- /machine -->"
FOLD, END_FOLD = re.compile(r"<details><summary>(.+)</summary>"), "</details>"
FENCE = re.compile(r"^(```.*?^```)$", re.MULTILINE | re.DOTALL)
FOLDER = Path(__file__).parent / "templates"
BLOCK = re.compile(r"^%% ([\w-]+)\n", re.MULTILINE)
FOR = re.compile(r"for (\w+): (.*)")
STARTS = re.compile(r"\n(?=- |\| |for \w+: )")  # lines of a paragraph that are not joined to the one before
SPACES = re.compile(r" {2,}")  # where a sentence is left out
TITLE = re.compile(r"\*\*.*\*\*")
NONE: Mapping[str, Callable[[], str]] = MappingProxyType({})


@dataclass(frozen=True)
class Part:
    """A piece of a page: its text and the pictures it shows, by file name, which draw themselves when asked for.

    Raises TypeError for a picture that is not a function.
    """

    text: str = ""
    pictures: Mapping[str, Callable[[], str]] = field(default_factory=dict)

    def __post_init__(self) -> None:
        for name, svg in self.pictures.items():
            if not callable(svg):
                raise TypeError(f"picture {name} is of type {type(svg).__name__}, not a function that returns an SVG")

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


class Template:
    """The blocks of one file; ``named``: formats of its fields beside those of every file."""

    def __init__(self, name: str, **named: Form) -> None:
        _, *pieces = BLOCK.split((FOLDER / f"{name}.md").read_text(encoding="utf-8"))
        self.name = name
        self.blocks = {block: list(_paragraphs(text)) for block, text in zip(pieces[::2], pieces[1::2], strict=True)}
        self.named = named

    def __call__(self, block: str, pictures: Mapping[str, Callable[[], str]] = NONE, /, **values: Any) -> Part:
        """A block with these values; pictures: those that it shows. Pictures of parts among the values come with it."""
        made: list[str] = []
        for lines in self.blocks[block]:
            text = "\n".join(each for line in lines for each in self._lines(line, values)).strip()
            if len(lines) == 3 and FOR.match(lines[2]) and text.count("\n") == 1:  # the heads of a table without rows
                if made and TITLE.fullmatch(made[-1]):
                    made.pop()
            elif made and _nothing_between(made[-1], text):
                made.pop()
            elif text:
                made.append(text)
        drawn = {name: svg for part in values.values() if isinstance(part, Part) for name, svg in part.pictures.items()}
        return Part("\n\n".join(made), {**drawn, **pictures})

    def _lines(self, line: str, values: Mapping[str, Any]) -> list[str]:
        repeated = FOR.match(line)
        if repeated is not None:
            return filled(repeated[2], values[repeated[1]], **self.named)
        text = Line(self.named).filled(line, values)
        return [text if text.startswith("|") or "\n" in text else SPACES.sub(" ", text)]


def _paragraphs(text: str) -> Iterator[list[str]]:
    """The lines of each; code keeps its own, empty ones included."""
    for at, piece in enumerate(FENCE.split(text)):
        if at % 2:
            yield [piece]
            continue
        for paragraph in piece.strip().split("\n\n"):
            yield [" ".join(map(str.strip, line.split("\n"))) for line in STARTS.split(paragraph)]


def _nothing_between(begin: str, end: str) -> bool:
    return (begin, end) == (MACHINE, END_MACHINE) or (end == END_FOLD and FOLD.fullmatch(begin) is not None)
