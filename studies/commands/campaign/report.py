"""``footprint report``: the pages of a store, written or compared."""

from __future__ import annotations

import argparse
from pathlib import Path

from reports.reading import StoreError
from reports.site import check_pages, place_of, write_pages
from studies.ask.scene import UsageError
from studies.commands import FAILED, OK
from studies.commands.options import add_store
from studies.run.archive import check_store

PAGES = Path("reports/pages")


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """The store, which campaign of it, and where the pages lie."""
    add_store(parser)
    parser.add_argument("--campaign", metavar="NAME", help="which, where the store has several")
    parser.add_argument("--out", type=Path, metavar="DIR", help=f"default {PAGES}, or the campaign's folder there")
    parser.add_argument("--check", action="store_true", help="compare with the pages in --out instead of writing them")


def run(options: argparse.Namespace) -> int:
    """Write the pages and print their paths, or print how they differ."""
    check_store(options.store, options.campaign)
    try:
        folder, line = place_of(options.store, options.campaign)
        out = options.out or PAGES / folder
        print(line)
        if not options.check:
            for path in write_pages(options.store, out, options.campaign):
                print(path)
            return OK
        differences = check_pages(options.store, out, options.campaign)
    except StoreError as error:
        raise UsageError(str(error)) from None
    print("\n".join(differences) or f"{out} agrees with {options.store}")
    return FAILED if differences else OK
