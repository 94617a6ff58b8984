"""``footprint time``: the converged cells of a campaign on a quiet machine, one at a time."""

from __future__ import annotations

import argparse
import math
import re
import sys

from studies.ask.scene import UsageError
from studies.commands import FAILED, OK
from studies.commands.options import add_store, add_trust, count, progress_bar
from studies.run.campaign import find
from studies.run.timing_lane import time_campaign


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """The campaign, which cells and how often."""
    parser.add_argument("campaign")
    add_store(parser)
    add_trust(parser)
    parser.add_argument("--only", default="", metavar="REGEX", help="the labels that are timed")
    parser.add_argument("--longest", type=float, default=math.inf, metavar="S", help="only solves within S seconds")
    parser.add_argument("--blocks", type=int, default=2, help="fresh processes, default 2")
    parser.add_argument("--rounds", type=int, default=4, help="interleaved rounds of a block, default 4")


def run(options: argparse.Namespace) -> int:
    """Time and print the table; 1 where the machine was too busy."""
    blocks, rounds = count("blocks", options.blocks), count("rounds", options.rounds)
    try:
        only = re.compile(options.only)
    except re.error as error:
        raise UsageError(f"--only {options.only!r} must be a regular expression: {error}") from None
    campaign = find(options.campaign, trust=options.trust)
    with progress_bar(campaign.name) as advance:
        table = time_campaign(campaign, options.store, only.search, blocks, rounds, advance, options.longest)
    print(table.to_string(index=False, float_format=lambda x: f"{x:.4g}"))
    if (table["samples"] == 0).any():
        print("footprint: the machine was too busy: the canary moved in every block", file=sys.stderr)
        return FAILED
    return OK
