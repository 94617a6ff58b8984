"""``footprint check``: a fresh campaign against the committed baseline."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

import pandas as pd

from studies.ask.request import UsageError
from studies.commands import FAILED, OK
from studies.commands.options import add_store
from studies.gate.baseline import HERE
from studies.gate.compare import NothingComparedError, check, failures, lines, update
from studies.run.collect import collect


def add_check(parser: argparse.ArgumentParser) -> None:
    """What is compared, and the update of the baseline."""
    add_store(parser)
    parser.add_argument("--campaign", default="quick", help="which")
    parser.add_argument("--update", action="store_true", help="replace the baseline; with --owner and --reason")
    parser.add_argument("--owner", default="", metavar="NAME", help="who answers for an update")
    parser.add_argument("--reason", default="", metavar="TEXT", help="why the baseline is replaced")


def run_check(options: argparse.Namespace) -> int:
    """Compare, or update; 1 where something is worse."""
    baseline = HERE / f"{options.campaign}.csv"
    if not options.update and (options.owner or options.reason):
        raise UsageError("--owner and --reason go with --update")
    if options.update and not (options.owner.strip() and options.reason.strip()):
        raise UsageError("a baseline is updated with --owner NAME and --reason TEXT only")
    table = collect(options.store, options.campaign)
    try:
        return _update(options, table, baseline) if options.update else _check(options, table, baseline)
    except NothingComparedError as error:
        print(f"footprint: check failed: {error}", file=sys.stderr)
        return FAILED


def _check(options: argparse.Namespace, table: pd.DataFrame, baseline: Path) -> int:
    """Print what is worse than the baseline."""
    findings = check(table, baseline)
    wrong = failures(findings)
    print("\n".join(lines(wrong)), end="\n" if wrong else "")
    better = f", {len(findings) - len(wrong)} better" if len(findings) > len(wrong) else ""
    verdict = f"{len(wrong)} values are not what they were" if wrong else "nothing is worse"
    print(f"check: {len(table)} cells of {options.campaign} against {baseline}: {verdict}{better}")
    if wrong:
        print("what is meant to be so: footprint check --update --owner NAME --reason TEXT")
    return FAILED if wrong else OK


def _update(options: argparse.Namespace, table: pd.DataFrame, baseline: Path) -> int:
    """Replace the baseline, print what changed."""
    findings = update(table, baseline, options.owner, options.reason)
    print("\n".join(lines(findings)), end="\n" if findings else "")
    print(f"{baseline}: {len(table)} cells, {len(findings)} values beyond the bounds of before")
    return OK
