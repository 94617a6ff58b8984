"""Text of the pages, from the files of the folder ``templates``: prose and tables with fields to be filled in.

A file has blocks, each under a line ``%% name``. Paragraphs stand apart by an empty line, and lines within one are
joined, for how long a number is must not move words. Fields are filled in as by ``formats.Line``. A line with
``for rows:`` before it stands once for each record of the value ``rows``; an indented line goes on with the one above.
A table without rows, a fold or block of the machine with nothing in it and an empty paragraph leave no trace.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from types import MappingProxyType
from typing import Any

from reports.formats import Line
from reports.markdown import END_FOLD, END_MACHINE, FENCE, FOLD, MACHINE, Form, Part, filled

FOLDER = Path(__file__).parent / "templates"
BLOCK = re.compile(r"^%% ([\w-]+)\n", re.MULTILINE)
FOR = re.compile(r"for (\w+): (.*)")
STARTS = re.compile(r"\n(?=- |\| |for \w+: )")  # lines of a paragraph that are not joined to the one before
SPACES = re.compile(r" {2,}")  # where a sentence is left out
TITLE = re.compile(r"\*\*.*\*\*")
NONE: Mapping[str, Callable[[], str]] = MappingProxyType({})


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
