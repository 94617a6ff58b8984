"""``footprint list``: the names of the catalogues."""

from __future__ import annotations

import argparse

from contact.catalogue import ALGORITHMS
from formulations.strains.catalogue import MEASURES
from studies.campaigns.file import find, names
from studies.commands import OK
from studies.scenes import SCENES


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Which catalogue."""
    parser.add_argument("what", nargs="?", choices=("scenes", "measures", "algorithms", "campaigns"))


def run(options: argparse.Namespace) -> int:
    """Print one catalogue, or all."""
    lists = {
        "scenes": [f"{name:18s}{scene.title}" for name, scene in SCENES.items()],
        "measures": list(MEASURES),
        "algorithms": list(ALGORITHMS),
        "campaigns": [f"{name:18s}{find(name).title}" for name in names()],
    }
    for what in [options.what] if options.what else lists:
        if not options.what:
            print(f"{what}:")
        print("\n".join(("" if options.what else "  ") + line for line in lists[what]))
    return OK
