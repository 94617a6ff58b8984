"""``footprint fuzz``: one random case, examined again."""

from __future__ import annotations

import argparse

from studies.ask.scene import UsageError
from studies.commands import FAILED, OK
from studies.fuzz.cases import KINDS
from studies.fuzz.examine import BROKEN, examine


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """The number of the case."""
    parser.add_argument("--seed", type=int, required=True, metavar="N", help="number of the case, from 0")
    parser.add_argument("--kind", choices=list(KINDS), default="", help="of the case, by default drawn from N")
    parser.add_argument("--smaller", action="store_true", help="give settings back while the same law is broken")


def run(options: argparse.Namespace) -> int:
    """Print what was asked, what came of it, and which law it breaks."""
    if options.seed < 0:
        raise UsageError(f"seed = {options.seed} must be a whole number, 0 or more")
    report = examine(options.seed, options.kind, smaller=options.smaller)
    print(f"{report.kind}: {report.about}")
    for name, text in (("came to", report.word), ("law", report.law), (report.verdict, report.said)):
        if text:
            print(f"{name}: {text}")
    return FAILED if report.verdict == BROKEN else OK
