"""``footprint analyse``: the tables that the pages are made of."""

from __future__ import annotations

import argparse

from studies.analysis.everything import analyse
from studies.commands import OK
from studies.commands.options import add_store, reading


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """The campaign and its store."""
    parser.add_argument("campaign")
    add_store(parser)


def run(options: argparse.Namespace) -> int:
    """Write the tables and print their paths."""
    with reading(options.store):
        paths = analyse(options.store, options.campaign)
    for path in paths:
        print(path)
    return OK
