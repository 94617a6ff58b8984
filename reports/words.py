"""Text of others as text in Markdown: what a page would take for its own is given by its number.

All that a page shows of a store passes here once, where it is read. What is said does not enter here.
"""

from __future__ import annotations

import re

HTML = r"<(?=[A-Za-z/!?])|!(?=\[)|\](?=[(\[])"  # with links and pictures
PLACES = r"(?m:^[\s>*+\-\d.)]*\[)(?=[^\]]*\]:)"  # of links, by name
LINKED = r"(?<=[a-z]):(?=//)|(?<=www)\.|(?<=\w)@(?=\w)|(?<!\w)@(?=\w)"  # what GitHub makes links of by itself
NAMED = r"&(?=#?\w+;)"  # characters by their names
LIVE = re.compile(
    rf"{HTML}|{PLACES}|{LINKED}|{NAMED}"
    r"|[|`$~\\*]|(?<![^\W_])_|_(?![^\W_])"  # columns, code, formulas, fences, escapes, emphasis
    r"|^\s*[#>]"  # headings, quotes
)
LIVE_IN_PROSE = re.compile(rf"{HTML}|{PLACES}|{LINKED}|{NAMED}|[$~]")


def as_words(text: str) -> str:
    """A text on one line that means itself in Markdown: characters that would do something are given by their numbers.

    Numbers, units and names of ours stay as they are.
    """
    return LIVE.sub(_numbered, text if text.isprintable() else _printable(" ".join(text.split())))


def as_prose(text: str) -> str:
    """A text whose code, emphasis and paragraphs stay; links, pictures, formulas and HTML are written out."""
    return LIVE_IN_PROSE.sub(_numbered, "\n".join(map(_printable, text.split("\n"))))


def _printable(line: str) -> str:
    """A line whose other characters are as Python writes them."""
    return "".join(letter if letter.isprintable() else letter.encode("unicode_escape").decode() for letter in line)


def _numbered(found: re.Match[str]) -> str:
    return "".join(f"&#{ord(letter)};" for letter in found[0])
