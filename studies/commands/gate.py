"""``footprint check``: a fresh campaign against the committed baseline, or times against times."""

from __future__ import annotations

import argparse
import sys
import tempfile
from pathlib import Path

import pandas as pd

from studies.ask.request import UsageError
from studies.commands import FAILED, OK
from studies.gate.baseline import HERE, Update, read_baseline
from studies.gate.compare import NothingComparedError, check, failures, lines, update
from studies.gate.times import compare_times, samples_of_both, time_lines
from studies.run.campaign import find
from studies.run.collect import collect


def add_check(parser: argparse.ArgumentParser) -> None:
    """What is compared, and the update of the baseline."""
    parser.add_argument("--store", type=Path, metavar="DIR", help="one that has the campaign; default: solve it now")
    parser.add_argument("--campaign", default="quick", help="which")
    parser.add_argument("--engine", default="serial", help="as of run, where it is solved now")
    parser.add_argument("--baseline", type=Path, metavar="FILE", help="to compare with; default the committed one")
    parser.add_argument("--update", action="store_true", help="replace the baseline; with --owner and --reason")
    parser.add_argument("--owner", default="", metavar="NAME", help="who answers for an update")
    parser.add_argument("--reason", default="", metavar="TEXT", help="why the baseline is replaced")
    parser.add_argument(
        "--time", nargs=2, type=Path, metavar=("BEFORE", "NOW"), help="two stores with times of the timing lane"
    )


def run_check(options: argparse.Namespace) -> int:
    """Compare, or update; 1 where something is worse."""
    if options.time is not None and (options.update or options.store is not None or options.baseline is not None):
        raise UsageError("--time compares two stores and no baseline")
    if not options.update and (options.owner or options.reason):
        raise UsageError("--owner and --reason go with --update")
    if options.baseline is None:
        options.baseline = HERE / f"{_name(options.campaign)}.csv"
    try:
        if options.time is not None:
            return _check_times(options.time[0], options.time[1], options.campaign)
        return _update(options) if options.update else _check(options)
    except NothingComparedError as error:
        print(f"footprint: check failed: {error}", file=sys.stderr)
        return FAILED


def _check(options: argparse.Namespace) -> int:
    """Print what is worse than the baseline."""
    read_baseline(options.baseline)  # what is wrong with it is said before minutes of solving
    table = _collected(options)
    found = check(table, options.baseline)
    wrong = failures(found)
    print("\n".join(lines(wrong)), end="\n" if wrong else "")
    better = f", {len(found) - len(wrong)} better" if len(found) > len(wrong) else ""
    verdict = f"{len(wrong)} values are not what they were" if wrong else "nothing is worse"
    print(f"check: {len(table)} cells of {options.campaign} against {options.baseline}: {verdict}{better}")
    if wrong:
        print("what is meant to be so: footprint check --update --owner NAME --reason TEXT")
    return FAILED if wrong else OK


def _update(options: argparse.Namespace) -> int:
    """Replace the baseline, print what changed; the request is checked before anything is solved."""
    signed = Update(options.owner, options.reason, options.campaign)
    table = _collected(options)
    found = update(table, options.baseline, signed)
    print("\n".join(lines(found)), end="\n" if found else "")
    print(f"{options.baseline}: {len(table)} cells, {len(found)} values beyond the bounds of before")
    return OK


def _name(campaign: str) -> str:
    """The name under which a store knows a campaign that was given by its name or its file."""
    return Path(campaign).stem if campaign.endswith(".toml") else campaign


def _collected(options: argparse.Namespace) -> pd.DataFrame:
    """The collected campaign of a store, or, without one, solved now and thrown away."""
    from studies.run.running import run as run_campaign

    if options.store is not None:
        return collect(options.store, _name(options.campaign))
    found = find(options.campaign)
    with tempfile.TemporaryDirectory(prefix="footprint-") as directory:
        print(run_campaign(found, Path(directory), options.engine).line, file=sys.stderr)
        return collect(Path(directory), found.name)


def _check_times(before: Path, now: Path, campaign: str) -> int:
    """Print what is slower than before beyond the noise."""
    times = compare_times(*samples_of_both(before, now, _name(campaign)))
    slower = int((times["verdict"] == "slower").sum())
    print("\n".join(time_lines(times)), end="\n" if (times["verdict"] != "same").any() else "")
    print(f"check: times of {len(times)} cells of {campaign}: {slower} are slower")
    return FAILED if slower else OK
