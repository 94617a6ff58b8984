"""Rows of words as aligned lines for a terminal; what the words mean does not enter here."""

from __future__ import annotations

from collections.abc import Iterator, Sequence


def columns(rows: Sequence[Sequence[str]], indent: str = "", *, right: range = range(0)) -> Iterator[str]:
    """Each column as wide as its longest word, those in ``right`` flush right; the last one takes what it needs."""
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    for row in rows:
        words = (
            f"{word:{'>' if i in right else '<'}{width}s}"
            for i, (word, width) in enumerate(zip(row, widths, strict=True))
        )
        yield (indent + "  ".join(words)).rstrip()
