"""Words for a terminal: aligned columns, and text of others with its control characters written out.

All that is printed passes :class:`Escaping`. What is said does not enter here, nor what a page would take for its own.

A notebook shows an answer as a line of text, or as that line with a table and remarks as HTML, all text escaped.
"""

from __future__ import annotations

import re
from abc import ABC, abstractmethod
from collections.abc import Iterator, Sequence
from html import escape
from typing import TYPE_CHECKING, Any, TextIO

# all control characters but the ends of lines and tabs; marks that turn the direction of text or are not seen; halves
CONTROL = re.compile("[\x00-\x08\x0b-\x1f\x7f-\x9f\u061c\u200b-\u200f\u2028-\u202e\u2060-\u206f\ufeff\ud800-\udfff]")


def columns(rows: Sequence[Sequence[str]], indent: str = "", *, right: range = range(0)) -> Iterator[str]:
    """Each column as wide as its longest word, those in ``right`` flush right; the last one takes what it needs."""
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    for row in rows:
        padded = (
            f"{word:{'>' if i in right else '<'}{width}s}"
            for i, (word, width) in enumerate(zip(row, widths, strict=True))
        )
        yield (indent + "  ".join(padded)).rstrip()


def printable(text: str) -> str:
    """A text without control characters: each as it is written in Python."""
    return CONTROL.sub(lambda match: _escaped(match[0]), text)


def _escaped(letter: str) -> str:
    code = ord(letter)
    return f"\\x{code:02x}" if code < 256 else f"\\u{code:04x}"


class Escaping:
    """A stream that shows control characters instead of sending them, and writes what its encoding has no letter for.

    ``stream``: the one behind it, for what draws on a terminal by control characters of its own.
    """

    def __init__(self, stream: TextIO) -> None:
        self.stream = stream

    def write(self, text: str) -> int:
        """Write; returns the length of the text."""
        encoding = self.stream.encoding or "utf-8"
        self.stream.write(printable(text).encode(encoding, "backslashreplace").decode(encoding))
        return len(text)

    def __getattr__(self, name: str) -> Any:
        return getattr(self.stream, name)


def behind(stream: Any) -> TextIO:
    """The stream that draws, behind the one that escapes."""
    underlying: TextIO = getattr(stream, "stream", stream)
    return underlying


if TYPE_CHECKING:
    import pandas as pd

MOST = 20  # rows of the table


class Shown(ABC):
    """An answer that shows itself."""

    @property
    @abstractmethod
    def line(self) -> str:
        """What it is, in one line."""

    @abstractmethod
    def shown(self) -> tuple[pd.DataFrame, list[str]]:
        """Its table, and remarks below it."""

    def __repr__(self) -> str:
        return f"<{type(self).__name__} {self.line}>"

    def _repr_html_(self) -> str:
        table, remarks = self.shown()
        from pandas import option_context

        with option_context("display.max_colwidth", None):  # meanings are whole sentences
            rows = table.to_html(max_rows=MOST, index=False, float_format=lambda x: f"{x:.6g}", border=0)
        paragraphs = "".join(f"<p>{escape(each)}</p>" for each in remarks)
        return f"<p><strong>{escape(self.line)}</strong></p>{rows}{paragraphs}"
