"""``footprint show``: what a scene, a measure or an algorithm is."""

from __future__ import annotations

import argparse

from studies.catalogue.descriptions import describe
from studies.commands import OK


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """The name."""
    parser.add_argument("name", metavar="SCENE|MEASURE|ALGORITHM")


def run(options: argparse.Namespace) -> int:
    """Print its description."""
    print(describe(options.name).text)
    return OK
