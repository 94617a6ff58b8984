"""The rows of the tables of a page, as words."""

from __future__ import annotations


def row(text: str, *words: str) -> list[str]:
    """The cells of the first line that has all of these words; raises StopIteration where there is none."""
    found = next(line for line in text.splitlines() if all(word in line for word in words))
    return [word.strip() for word in found.split("|")[1:-1]]
