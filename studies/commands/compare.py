"""``footprint compare``: two stores side by side."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from reports.words import as_words
from studies.commands import FAILED, OK
from studies.commands.options import reading
from studies.guard.check import compare_stores
from studies.guard.compare import NothingComparedError


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Two stores and the campaign."""
    parser.add_argument("before", type=Path, metavar="A")
    parser.add_argument("now", type=Path, metavar="B")
    parser.add_argument("--campaign", default="quick", help="default quick")


def run(options: argparse.Namespace) -> int:
    """Print the comparison; 1 where there is nothing to compare."""
    with reading(options.now):
        try:
            print(compare_stores(options.before, options.now, options.campaign, as_words), end="")
        except NothingComparedError as error:
            print(f"footprint: {error}", file=sys.stderr)
            return FAILED
    return OK
