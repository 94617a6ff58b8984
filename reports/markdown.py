"""Words and numbers as Markdown: number formats without negative zeros, tables under a title, fenced commands.

What the numbers mean is not known here.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field

MACHINE, END_MACHINE = "<!-- machine -->", "<!-- /machine -->"
NOTHING = "–"  # for a number that does not exist: None or NaN


@dataclass(frozen=True)
class Part:
    """A piece of a page: its text and the pictures it shows, SVG by file name."""

    text: str
    pictures: Mapping[str, str] = field(default_factory=dict)


def joined(parts: Iterable[Part]) -> Part:
    """Parts below one another."""
    parts = list(parts)
    pictures = {name: svg for part in parts for name, svg in part.pictures.items()}
    return Part("\n\n".join(part.text.strip("\n") for part in parts) + "\n", pictures)


def fixed(value: float | None, decimals: int, sign: bool = False) -> str:
    """``decimals`` places; a value that rounds to zero has no sign."""
    if value is None or math.isnan(value):
        return NOTHING
    text = f"{value:+.{decimals}f}" if sign else f"{value:.{decimals}f}"
    return text.lstrip("+-") if float(text) == 0.0 else text


def percent(fraction: float | None, decimals: int = 2, sign: bool = True) -> str:
    """A fraction in per cent: a change with its sign, a size without."""
    return NOTHING if fraction is None or math.isnan(fraction) else fixed(100 * fraction, decimals, sign) + " %"


def digits(value: float, count: int) -> str:
    """``count`` significant digits, trailing zeros kept."""
    return NOTHING if math.isnan(value) else f"{value + 0.0:#.{count}g}"


def number(value: float) -> str:
    """Six significant digits at most."""
    return NOTHING if math.isnan(value) else f"{value:.6g}"


def scientific(value: float | None, decimals: int = 1) -> str:
    """Mantissa and exponent; exact zero is 0."""
    if value is None or math.isnan(value):
        return NOTHING
    return "0" if value == 0.0 else f"{value:.{decimals}e}"


def table(title: str, header: Sequence[str], rows: Iterable[Sequence[object]], words: int = 1) -> str:
    """A table under its title line; the first columns are words, the others are numbers."""
    lines = [f"**{title}**", "", _line(header), _line([*[":--"] * words, *["--:"] * (len(header) - words)])]
    return "\n".join([*lines, *(_line(row) for row in rows)])


def _line(entries: Sequence[object]) -> str:
    return "| " + " | ".join(str(entry) for entry in entries) + " |"


def prose(text: str) -> str:
    """Text with its line ends inside paragraphs and list items taken out: how long a number is must not move words."""
    paragraphs = [re.sub(r"\n(?!- )\s*", " ", paragraph.strip()) for paragraph in text.strip().split("\n\n")]
    return "\n\n".join(paragraphs)


def picture(name: str, words: str) -> str:
    """A picture of the folder ``figures`` with the words that replace it where it cannot be shown."""
    return f"![{words}](figures/{name})"


def folded(summary: str, text: str) -> str:
    """Text that opens on a click."""
    return f"<details><summary>{summary}</summary>\n\n{text}\n\n</details>"


def commands(lines: Iterable[str]) -> str:
    """Shell commands in a fold."""
    unique = dict.fromkeys(lines)
    block = "\n".join(["```sh", *unique, "```"])
    return folded("Commands that reproduce these numbers", block)


def machine(text: str) -> str:
    """Text that depends on the machine, so that a comparison of pages skips it."""
    return f"{MACHINE}\n\n{text}\n\n{END_MACHINE}"
