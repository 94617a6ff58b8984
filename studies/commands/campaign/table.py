"""``footprint table``: the cells of a campaign, what was asked and what became of them."""

from __future__ import annotations

import argparse
from pathlib import Path

from studies.ask.scene import UsageError
from studies.commands import OK
from studies.commands.options import add_store, reading
from studies.output.atomic import write_table
from studies.run.collect import collect


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """The campaign and which of its rows."""
    parser.add_argument("campaign")
    add_store(parser)
    parser.add_argument("--where", action="append", default=[], metavar="COLUMN=VALUE", help="only these rows")
    parser.add_argument("--csv", type=Path, metavar="FILE", help="write all columns as CSV")


def run(options: argparse.Namespace) -> int:
    """Print outcome, label and reason of each cell, and how many of each outcome there are."""
    with reading(options.store):
        table = collect(options.store, options.campaign)
    for pair in options.where:
        column, separator, value = pair.partition("=")
        if not separator or column not in table:
            raise UsageError(f"--where {pair!r} must be COLUMN=VALUE with one of {', '.join(map(str, table.columns))}")
        numbers = table[column].dtype.kind == "f"
        table = table[table[column] == (_number(pair, value) if numbers else value)]
    if options.csv is not None:
        write_table(options.csv, table)
    print(f"{'outcome':15s}{'cell':60s}reason")
    for outcome, label, reason in zip(table["outcome"], table["label"], table["reason"], strict=True):
        print(f"{outcome:15s}{label:60s}{'' if outcome == 'converged' else reason}".rstrip())
    print(f"{len(table)} cells: " + ", ".join(f"{n} {name}" for name, n in table["outcome"].value_counts().items()))
    return OK


def _number(pair: str, value: str) -> float:
    try:
        return float(value)
    except ValueError:
        raise UsageError(f"--where {pair!r}: this column has numbers") from None
