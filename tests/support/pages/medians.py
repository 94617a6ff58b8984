"""Medians and rankings of a page that say too little of what they rest on."""

from __future__ import annotations

import re
from collections.abc import Iterator

MEDIAN = re.compile(r"^\d+\.\d+ \[(\d|–)")  # with its interval: over several problems
RANKING = re.compile(r"(\d+) problems: \S+ > ")
BOTH, SOLVES = re.compile(r"\bboth\b"), re.compile(r"\b(solve[sd]?|reaches|share)\b")
FEWEST = 5
OF_MEDIANS = re.compile(r"^(\w+_)?ratio$")  # a declared column, where its low and high ends are declared, too


def unfounded(text: str) -> list[str]:
    """Tables with a median that lack the number of problems, or the share that is solved, and rankings of too few."""
    return [*_tables(text), *(f"ranked: {found[0]}" for found in RANKING.finditer(text) if int(found[1]) < FEWEST)]


def _tables(text: str) -> Iterator[str]:
    for block in text.split("\n\n"):
        lines = [line for line in block.splitlines() if line.startswith("|")]
        if len(lines) < 3:
            continue
        heads, _, *rows = ([cell.strip() for cell in line.strip("|").split(" | ")] for line in lines)
        medians = [row for row in rows if any(MEDIAN.match(cell) for cell in row)]
        both = next((i for i, head in enumerate(heads) if BOTH.search(head)), None)
        if medians and (both is None or not any(SOLVES.search(head) for head in heads)):
            yield f"{' | '.join(heads)}: a median without both-count or solved share"
        for row in medians if both is not None else []:
            if int(row[both].split()[0]) < FEWEST:
                yield f"{' | '.join(row)}: a median of {row[both]}"


def bare_columns(columns: tuple[str, ...]) -> list[str]:
    """Declared medians of a table that declares no both-count, or no solved share, beside them."""
    names = [name for name in columns if OF_MEDIANS.match(name)]
    spread = [n for n in names if {n.removesuffix("ratio") + "low", n + "_low"} & set(columns)]
    founded = "both" in columns and bool({"solved", "solved_share", "a_solved"} & set(columns))
    return [] if founded else spread
