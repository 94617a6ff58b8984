"""``footprint run``: the missing cells of a campaign into its store."""

from __future__ import annotations

import argparse
import sys

from studies.campaigns.file import find
from studies.campaigns.run import run as run_campaign
from studies.commands import OK
from studies.commands.options import add_store, positive, progress_bar
from studies.pool.task import Limits


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """The campaign, its store, the engine and the limits of a cell."""
    parser.add_argument("campaign", help="a name of its own, or a .toml file")
    add_store(parser)
    parser.add_argument("--engine", default="serial", help="serial, local:N or dask:ADDRESS; default serial")
    parser.add_argument("--resume", action="store_true", help="only go on with a campaign that the store knows")
    parser.add_argument("--time-limit", type=float, default=900.0, metavar="S", help="of one cell, default 900")
    parser.add_argument("--memory-limit", type=float, default=8192.0, metavar="MB", help="of one cell, default 8192")


def run(options: argparse.Namespace) -> int:
    """Solve what is missing and print a line of what became of it."""
    limits = Limits(positive("time-limit", options.time_limit), positive("memory-limit", options.memory_limit))
    campaign = find(options.campaign)
    with progress_bar(campaign.name) as advance:
        summary = run_campaign(
            campaign,
            options.store,
            options.engine,
            limits,
            advance,
            lambda line: print(f"footprint: {line}", file=sys.stderr),
            resume=options.resume,
        )
    print(f"{campaign.name}: {summary.line}")
    return OK
