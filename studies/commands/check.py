"""``footprint check``: a fresh campaign against the committed baseline, or times against times."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from studies.commands import FAILED, OK
from studies.guard.check import check_baseline, check_times, update_baseline
from studies.guard.compare import NothingComparedError
from studies.scene import UsageError


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """What is compared, and the update of the baseline."""
    parser.add_argument("--store", type=Path, metavar="DIR", help="one that has the campaign; default: solve it now")
    parser.add_argument("--campaign", default="quick", help="default quick")
    parser.add_argument("--engine", default="serial", help="as of run, where it is solved now")
    parser.add_argument("--baseline", type=Path, metavar="FILE", help="default: the committed one")
    parser.add_argument("--update", action="store_true", help="replace the baseline; with --owner and --reason")
    parser.add_argument("--owner", default="", metavar="NAME", help="who answers for an update")
    parser.add_argument("--reason", default="", metavar="TEXT", help="why the baseline is replaced")
    parser.add_argument("--date", metavar="YYYY-MM-DD", help="of an update, default today")
    parser.add_argument(
        "--time", nargs=2, type=Path, metavar=("BEFORE", "NOW"), help="two stores with times of the timing lane"
    )


def run(options: argparse.Namespace) -> int:
    """Compare, or update; 1 where something is worse."""
    if options.time is not None and (options.update or options.store is not None or options.baseline is not None):
        raise UsageError("--time compares two stores and no baseline")
    if not options.update and (options.owner or options.reason or options.date):
        raise UsageError("--owner, --reason and --date go with --update")
    try:
        if options.time is not None:
            worse = check_times(options.time[0], options.time[1], options.campaign)
        elif options.update:
            update_baseline(options)
            return OK
        else:
            worse = check_baseline(options.campaign, options.store, options.baseline, options.engine)
    except NothingComparedError as error:
        print(f"footprint: check failed: {error}", file=sys.stderr)
        return FAILED
    return FAILED if worse else OK
