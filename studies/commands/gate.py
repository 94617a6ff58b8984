"""``footprint check``: a fresh campaign against the committed baseline, or times against times.

``footprint compare``: two stores of a campaign side by side, as a short comment for a review in Markdown.
"""

from __future__ import annotations

import argparse
import datetime
import sys
import tempfile
from collections.abc import Sequence
from pathlib import Path

import pandas as pd

from studies.ask.request import UsageError
from studies.commands import FAILED, OK
from studies.commands.options import reading
from studies.gate.baseline import HERE, OUTCOME, TOLERANCES, Bound, Update, read_baseline, read_bounds
from studies.gate.compare import (
    UNFINISHED,
    NothingComparedError,
    check,
    compared,
    failures,
    lines,
    measured,
    shortened,
    update,
)
from studies.gate.times import compare_times, samples_of_both, time_lines
from studies.run.campaign import find
from studies.run.collect import collect
from studies.solving.result import CONVERGED


def add_check(parser: argparse.ArgumentParser) -> None:
    """What is compared, and the update of the baseline."""
    parser.add_argument("--store", type=Path, metavar="DIR", help="one that has the campaign; default: solve it now")
    parser.add_argument("--campaign", default="quick", help="which")
    parser.add_argument("--engine", default="serial", help="as of run, where it is solved now")
    parser.add_argument("--baseline", type=Path, metavar="FILE", help="to compare with; default the committed one")
    parser.add_argument("--update", action="store_true", help="replace the baseline; with --owner and --reason")
    parser.add_argument("--owner", default="", metavar="NAME", help="who answers for an update")
    parser.add_argument("--reason", default="", metavar="TEXT", help="why the baseline is replaced")
    parser.add_argument("--date", metavar="YYYY-MM-DD", help="of an update, default today")
    parser.add_argument(
        "--time", nargs=2, type=Path, metavar=("BEFORE", "NOW"), help="two stores with times of the timing lane"
    )


def run_check(options: argparse.Namespace) -> int:
    """Compare, or update; 1 where something is worse."""
    if options.time is not None and (options.update or options.store is not None or options.baseline is not None):
        raise UsageError("--time compares two stores and no baseline")
    if not options.update and (options.owner or options.reason or options.date):
        raise UsageError("--owner, --reason and --date go with --update")
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
    try:
        date = datetime.date.fromisoformat(options.date) if options.date else datetime.date.today()
    except ValueError:
        raise UsageError(f"date = {options.date!r} must be YYYY-MM-DD") from None
    signed = Update(options.owner, options.reason, date, options.campaign)
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


MOST = 20  # rows a table: a comment is read, an archive is not
TITLES = {"worse": "Worse", "changed": "Changed", "better": "Better", "missing": "Missing", "new": "New"}
VALUES = ("cell", "value", "A", "B", "allowed")
TIMES = ("cell", "A [s]", "B [s]", "change", "floor", "adjusted p")


def add_compare(parser: argparse.ArgumentParser) -> None:
    """Two stores and the campaign."""
    parser.add_argument("before", type=Path, metavar="A", help="the store before")
    parser.add_argument("now", type=Path, metavar="B", help="the store of now")
    parser.add_argument("--campaign", default="quick", help="which")


def run_compare(options: argparse.Namespace) -> int:
    """Print the comparison, with times where both stores have samples; 1 where there is nothing to compare."""
    before, now, campaign = options.before, options.now, options.campaign
    with reading(now):
        bounds, times = read_bounds(HERE / TOLERANCES), _of_times(before, now, campaign)
        try:
            print(comment(campaign, collect(before, campaign), collect(now, campaign), bounds, times), end="")
        except NothingComparedError as error:
            print(f"footprint: {error}", file=sys.stderr)
            return FAILED
    return OK


def _of_times(before: Path, now: Path, campaign: str) -> pd.DataFrame | str:
    """Slower and faster cells, each a test of its own, or why there is no comparison."""
    try:
        sides = samples_of_both(before, now, campaign)
        slower, faster = (compare_times(*sides, worse) for worse in ("slower", "faster"))
    except (UsageError, NothingComparedError) as error:
        return str(error)
    return slower.where(slower["verdict"] != "same", faster)


def comment(
    campaign: str, before: pd.DataFrame, now: pd.DataFrame, bounds: tuple[Bound, ...], times: pd.DataFrame | str
) -> str:
    """What changed beyond the bounds, what is new, what is missing, how much ran; tables as of ``collect``.

    times: of compare_times, slower and faster ones, or why there are none.
    Raises NothingComparedError when the two have no cell in common.
    """
    findings = compared(measured(before), measured(now), bounds)
    parts = [f"### Campaign {campaign}, A → B", f"A: {_ran(before)}. B: {_ran(now)}."]
    if not findings:
        parts.append("Nothing changed beyond the bounds.")
    for what, title in TITLES.items():
        rows = [
            (f.label, f.column or "the cell", shortened(f.before), shortened(f.now), f.allowed)
            for f in findings
            if f.what == what
        ]
        if rows:
            parts.append(_titled(f"{title} ({len(rows)})", VALUES, rows, words=2))
    parts.append(f"Wall time: not compared, {times}." if isinstance(times, str) else _changes(times))
    return "\n\n".join(parts) + "\n"


def _ran(cells: pd.DataFrame) -> str:
    """How much of a campaign has an answer, and how the rest ended."""
    from reports.reading import as_words

    counts = cells[OUTCOME].value_counts()
    done = int((~cells[OUTCOME].isin(UNFINISHED)).sum())
    others = "".join(f", {n} {as_words(str(outcome))}" for outcome, n in counts.items() if outcome != CONVERGED)
    return f"{done} of {len(cells)} cells ran, {counts.get(CONVERGED, 0)} {CONVERGED}{others}"


def _titled(title: str, header: Sequence[str], rows: Sequence[Sequence[str]], words: int) -> str:
    """The first rows; what is in them are texts of others."""
    from reports.markdown import table
    from reports.reading import as_words

    rest = f"\n\nand {len(rows) - MOST} more" if len(rows) > MOST else ""
    return table(title, header, (list(map(as_words, row)) for row in rows[:MOST]), words) + rest


def _changes(times: pd.DataFrame) -> str:
    """The cells that became slower or faster."""
    moved = times[times["verdict"].isin(("slower", "faster"))]
    cells = int((times["verdict"] != "too few samples").sum())
    if moved.empty:
        return f"Wall time: no significant change in {cells} cells."
    rows = [
        (
            row["label"],
            f"{row['before_s']:.4g}",
            f"{row['now_s']:.4g}",
            f"{100 * row['change']:+.1f} %",
            f"{100 * row['floor']:.1f} %",
            f"{row['p']:.1e}",
        )
        for row in moved.to_dict("records")
    ]
    return _titled(f"Wall time: {len(moved)} of {cells} cells", TIMES, rows, words=1)
