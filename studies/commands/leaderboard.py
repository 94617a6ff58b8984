"""``footprint leaderboard``: results of the arena, one JSON an entry and machine, as a page, the ranking first."""

from __future__ import annotations

import argparse
from pathlib import Path

from studies.commands import OK
from studies.commands.options import check_directory


def add_leaderboard(parser: argparse.ArgumentParser) -> None:
    """The folder and where the page goes."""
    parser.add_argument("results", type=Path, metavar="RESULTS", help="a folder of what bench solvers has written")
    parser.add_argument("--out", type=Path, required=True, metavar="DIR", help="where leaderboard.md and .html go")


def run_leaderboard(options: argparse.Namespace) -> int:
    """Read all, rank, and write the page whole or not at all."""
    from reports.files import write_texts
    from reports.leaderboard import leaderboard
    from studies.arena.collected.dataset import identity
    from studies.arena.ranking import board
    from studies.arena.result_files import read_all
    from studies.arena.results import harness

    check_directory(options.out)
    found = board(read_all(options.results))
    counts = found.stale, found.secrets, (identity(), harness())
    written = write_texts(options.out, leaderboard(found.tolerance, found.ranked, found.runs, found.machines, *counts))
    for row in found.ranked:
        print(f"{row['rank']}. {row['entry']}: {row['ok']} of {row['asked']} ok, {row['anomalous']} anomalous")
    counted = f"{len(found.ranked)} entries, {len(found.runs)} results, {found.stale} stale"
    print(f"{counted}: {', '.join(map(str, written))}")
    return OK
