"""``footprint compare``: two stores of a campaign side by side, as a short comment for a review in Markdown."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from pathlib import Path

import pandas as pd

from reports.markdown import table
from reports.reading import as_words
from studies.ask.scene import UsageError
from studies.commands import FAILED, OK
from studies.commands.options import reading
from studies.gate.baseline import HERE, OUTCOME, TOLERANCES, Bound, read_bounds
from studies.gate.compare import UNFINISHED, NothingComparedError, compared, measured, shortened
from studies.gate.times import compare_times, samples_of_both
from studies.run.collect import collect
from studies.solving.result import CONVERGED

MOST = 20  # rows a table: a comment is read, an archive is not
TITLES = {"worse": "Worse", "changed": "Changed", "better": "Better", "missing": "Missing", "new": "New"}
VALUES = ("cell", "value", "A", "B", "allowed")
TIMES = ("cell", "A [s]", "B [s]", "change", "floor", "adjusted p")


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Two stores and the campaign."""
    parser.add_argument("before", type=Path, metavar="A")
    parser.add_argument("now", type=Path, metavar="B")
    parser.add_argument("--campaign", default="quick", help="default quick")


def run(options: argparse.Namespace) -> int:
    """Print the comparison, with times where both stores have samples; 1 where there is nothing to compare."""
    before, now, campaign = options.before, options.now, options.campaign
    with reading(now):
        bounds, times = read_bounds(HERE / TOLERANCES), _times(before, now, campaign)
        try:
            print(comment(campaign, collect(before, campaign), collect(now, campaign), bounds, times), end="")
        except NothingComparedError as error:
            print(f"footprint: {error}", file=sys.stderr)
            return FAILED
    return OK


def _times(before: Path, now: Path, campaign: str) -> pd.DataFrame | str:
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
            parts.append(_table(f"{title} ({len(rows)})", VALUES, rows, words=2))
    parts.append(f"Wall time: not compared, {times}." if isinstance(times, str) else _changes(times))
    return "\n\n".join(parts) + "\n"


def _ran(cells: pd.DataFrame) -> str:
    """How much of a campaign has an answer, and how the rest ended."""
    counts = cells[OUTCOME].value_counts()
    done = int((~cells[OUTCOME].isin(UNFINISHED)).sum())
    others = "".join(f", {n} {as_words(str(outcome))}" for outcome, n in counts.items() if outcome != CONVERGED)
    return f"{done} of {len(cells)} cells ran, {counts.get(CONVERGED, 0)} {CONVERGED}{others}"


def _table(title: str, header: Sequence[str], rows: Sequence[Sequence[str]], words: int) -> str:
    """The first rows; what is in them are texts of others."""
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
    return _table(f"Wall time: {len(moved)} of {cells} cells", TIMES, rows, words=1)
