"""``footprint merge``: the cells of another machine's store, recomputed from their fields before they are taken."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from studies.ask.request import UsageError
from studies.commands import FAILED, OK
from studies.commands.options import add_store, progress_bar
from studies.gate.merge import ALL, merge


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """The foreign store, ours, and how many cells are solved again."""
    parser.add_argument("source", type=Path, metavar="FROM", help="the store of another machine")
    add_store(parser)
    told = "solve so many cells again, drawn by lot, and compare their counters; all: every one"
    parser.add_argument("--again", default="0", metavar="N|all", help=told)


def run(options: argparse.Namespace) -> int:
    """Take what holds; a line on each cell that is refused, and 1 if there is one."""
    again = _number(options.again)
    with progress_bar("merge") as advance:
        summary = merge(
            options.source,
            options.store,
            again,
            advance,
            lambda line: print(f"refused: {line}", file=sys.stderr),
        )
    print(f"merge: {summary.line}")
    return FAILED if summary.refused else OK


def _number(text: str) -> int:
    if text == ALL:
        return sys.maxsize
    if not (text.isascii() and text.isdigit()):
        raise UsageError(f"--again {text!r} must be a whole number of at least 0, or {ALL}")
    return int(text)
