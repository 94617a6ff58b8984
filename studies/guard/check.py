"""``footprint check`` and ``compare``: campaigns out of stores, handed to the gate, and what it prints."""

from __future__ import annotations

import argparse
import datetime
import sys
import tempfile
from pathlib import Path
from statistics import median

import pandas as pd

from studies.analysis.cells.collect import collect
from studies.campaigns.file import find
from studies.campaigns.run import run
from studies.guard.baseline import HERE, TOLERANCES, read_baseline, read_bounds
from studies.guard.compare import NothingComparedError, check, failures, lines, update
from studies.guard.review import Shown, comment
from studies.guard.times import compare_times, time_lines
from studies.scene import UsageError
from studies.store.times import DRIFT, read_times


def check_baseline(campaign: str, store: Path | None, baseline: Path | None, engine: str) -> bool:
    """Print what is worse than the baseline; returns whether anything is."""
    path = baseline or committed(campaign)
    read_baseline(path)  # what is wrong with it is said before minutes of solving
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
    """Print what is slower than before beyond the noise; returns whether anything is.

    Raises UsageError without times, or when the canary says that the machine is another one.
    """
    times = compare_times(*_sides(before, now, campaign))
    slower = times[times["verdict"] == "slower"]
    print("\n".join(time_lines(times)), end="\n" if (times["verdict"] != "same").any() else "")
    print(f"check: times of {len(times)} cells of {campaign}: {len(slower)} are slower")
    return bool(len(slower))


def _sides(before: Path, now: Path, campaign: str) -> tuple[pd.DataFrame, pd.DataFrame]:
    """The samples of both; raises UsageError when the canary of one store runs at another speed than the other's."""
    sides = samples_of(before, campaign), samples_of(now, campaign)
    told = [read_times(store, name_of(campaign)) for store in (before, now)]
    quiet = [median(pair[0] for pair in each["canaries"] if pair[2]) for each in told]
    if not abs(quiet[1] / quiet[0] - 1) <= DRIFT:
        raise UsageError(
            f"the canary takes {quiet[1] / quiet[0]:.2f} times what it took: another machine, or another state of it"
        )
    return sides


def samples_of(store: Path, campaign: str) -> pd.DataFrame:
    """Raw warm times of the timing lane, a row a sample: label, seconds, block; raises UsageError without any."""
    found = read_times(store, name_of(campaign))
    rows = [
        (cell["label"], seconds, i // found["rounds"])
        for cell in found["cells"]
        for i, seconds in enumerate(cell["warm"])
    ]
    if not rows:
        raise UsageError(f"{store}: every block of times was discarded, the machine was not quiet")
    return pd.DataFrame(rows, columns=["label", "seconds", "block"])


def compare_stores(before: Path, now: Path, campaign: str, shown: Shown) -> str:
    """The comment of a review; with times where both stores have samples.  shown: as for :func:`comment`."""
    bounds, times = read_bounds(HERE / TOLERANCES), _times(before, now, campaign)
    return comment(campaign, collect(before, campaign), collect(now, campaign), bounds, shown, times)


def _times(before: Path, now: Path, campaign: str) -> pd.DataFrame | str:
    """Slower and faster cells, each a test of its own, or why there is no comparison."""
    try:
        sides = _sides(before, now, campaign)
        slower, faster = (compare_times(*sides, worse) for worse in ("slower", "faster"))
    except (UsageError, NothingComparedError) as error:
        return str(error)
    return slower.where(slower["verdict"] != "same", faster)
