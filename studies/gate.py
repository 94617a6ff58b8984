"""``footprint check`` and ``compare``: campaigns out of stores, handed to the gate, and what it prints."""

from __future__ import annotations

import argparse
import datetime
import json
import sys
import tempfile
from pathlib import Path

import pandas as pd

from studies.archive import Archive
from studies.baseline_files import HERE, TOLERANCES, read_bounds
from studies.campaign import run
from studies.definition import find
from studies.regression import NothingComparedError, check, failures, lines, update
from studies.regression_statistics import compare_times, time_lines
from studies.review import comment
from studies.scene import UsageError
from studies.table import collect


def check_baseline(campaign: str, store: Path | None, baseline: Path | None, engine: str) -> bool:
    """Print what is worse than the baseline; returns whether anything is."""
    path = baseline or committed(campaign)
    if not path.exists():  # before minutes of solving
        raise UsageError(f"{path}: no baseline; footprint check --update --owner NAME --reason TEXT makes one")
    table = table_of(campaign, store, engine)
    found = check(table, path)
    wrong = failures(found)
    print("\n".join(lines(wrong)), end="\n" if wrong else "")
    better = f", {len(found) - len(wrong)} better" if len(found) > len(wrong) else ""
    verdict = f"{len(wrong)} values are not what they were" if wrong else "nothing is worse"
    print(f"check: {len(table)} cells of {campaign} against {path}: {verdict}{better}")
    if wrong:
        print("what is meant to be so: footprint check --update --owner NAME --reason TEXT")
    return bool(wrong)


def update_baseline(options: argparse.Namespace) -> None:
    """Replace the baseline, print what changed; the request is checked before anything is solved."""
    if not options.owner.strip() or not options.reason.strip():
        raise UsageError("a baseline is updated with --owner NAME and --reason TEXT only")
    try:
        date = datetime.date.fromisoformat(options.date) if options.date else datetime.date.today()
    except ValueError:
        raise UsageError(f"date = {options.date!r} must be YYYY-MM-DD") from None
    path = options.baseline or committed(options.campaign)
    table = table_of(options.campaign, options.store, options.engine)
    found = update(table, path, options.owner, options.reason, date, options.campaign)
    print("\n".join(lines(found)), end="\n" if found else "")
    print(f"{path}: {len(table)} cells, {len(found)} values beyond the bounds of before")


def committed(campaign: str) -> Path:
    """The baseline file of a campaign, there or not."""
    return HERE / f"{name_of(campaign)}.csv"


def name_of(campaign: str) -> str:
    """The name under which a store knows a campaign that was given by its name or its file."""
    return Path(campaign).stem if campaign.endswith(".toml") else campaign


def table_of(campaign: str, store: Path | None, engine: str) -> pd.DataFrame:
    """The collected campaign of a store, or, without one, solved now and thrown away."""
    if store is not None:
        return collect(store, name_of(campaign))
    found = find(campaign)
    with tempfile.TemporaryDirectory(prefix="footprint-") as directory:
        print(run(found, Path(directory), engine).line, file=sys.stderr)
        return collect(Path(directory), found.name)


def check_times(before: Path, now: Path, campaign: str) -> bool:
    """Print what is slower than before beyond the noise; returns whether anything is."""
    times = compare_times(samples_of(before, campaign), samples_of(now, campaign))
    slower = times[times["verdict"] == "slower"]
    print("\n".join(time_lines(times)), end="\n" if (times["verdict"] != "same").any() else "")
    print(f"check: times of {len(times)} cells of {campaign}: {len(slower)} are slower")
    return bool(len(slower))


def samples_of(store: Path, campaign: str) -> pd.DataFrame:
    """Raw times of the timing lane, a row a sample: label, seconds, block; raises UsageError when there are none."""
    path = Archive(store).root / "timing" / f"{name_of(campaign)}.json"
    try:
        found = json.loads(path.read_text(encoding="utf-8"))["samples"]
    except FileNotFoundError:
        raise UsageError(f"{store} has no times of campaign {name_of(campaign)!r}") from None
    except (OSError, ValueError, KeyError, TypeError) as error:
        raise UsageError(f"{path} cannot be read: {' '.join(str(error).split())}") from None
    return pd.DataFrame(found, columns=["label", "seconds", "block"])


def compare_stores(before: Path, now: Path, campaign: str) -> str:
    """The comment of a review; with times where both stores have samples."""
    bounds = read_bounds(HERE / TOLERANCES)
    return comment(campaign, collect(before, campaign), collect(now, campaign), bounds, _times(before, now, campaign))


def _times(before: Path, now: Path, campaign: str) -> pd.DataFrame | None:
    """Slower and faster cells, where both stores have times; each side is a test of its own."""
    try:
        sides = samples_of(before, campaign), samples_of(now, campaign)
        slower, faster = (compare_times(*sides, worse) for worse in ("slower", "faster"))
    except (UsageError, NothingComparedError):
        return None
    return slower.where(slower["verdict"] != "same", faster)
