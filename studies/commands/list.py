"""``footprint list``: the names of the catalogues, each with its meaning."""

from __future__ import annotations

import argparse
from collections.abc import Iterable

from contact.catalogue import ALGORITHMS
from formulations.strains.catalogue import MEASURES
from studies.catalogue.descriptions import meaning_of
from studies.commands import OK
from studies.output.terminal import columns
from studies.run.campaign import find, names
from studies.scenes import SCENES


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Which catalogue."""
    parser.add_argument("what", nargs="?", choices=("scenes", "measures", "algorithms", "campaigns"))


def run(options: argparse.Namespace) -> int:
    """Print one catalogue, or all."""
    catalogues: dict[str, Iterable[str]] = {"scenes": SCENES, "measures": MEASURES, "algorithms": ALGORITHMS}
    lists = {what: [(name, meaning_of(name)) for name in catalogue] for what, catalogue in catalogues.items()}
    lists["campaigns"] = [(name, find(name).title) for name in names()]
    for what in [options.what] if options.what else lists:
        if not options.what:
            print(f"{what}:")
        print("\n".join(columns(lists[what], "" if options.what else "  ")))
    return OK
