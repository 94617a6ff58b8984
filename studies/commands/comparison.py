"""``footprint check``: a fresh campaign against the committed baseline; ``footprint compare``: two stores."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from pathlib import Path

import pandas as pd

from studies.ask.request import UsageError
from studies.commands import FAILED, OK
from studies.commands.options import add_store, check_file, reading
from studies.gate.baseline import COMMAND, HERE, OUTCOME, TOLERANCES, UPDATE, Bound, read_bounds
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
from studies.gate.times import compare_times, samples_of_both
from studies.run.answers import ERROR
from studies.run.archive import Archive
from studies.run.campaign import find
from studies.run.collect import collect
from studies.run.plan import plan
from studies.solving.result import CONVERGED, SOLVED

SPENT = ("newton_iterations", "factorisations", "operations")
QUICK = "quick"
MOST = 20  # rows a table: a comment is read, an archive is not
TITLES = {"worse": "Worse", "changed": "Changed", "better": "Better", "missing": "Missing", "new": "New"}
VALUES = ("cell", "value", "A", "B", "allowed")
TIMES = ("cell", "A [s]", "B [s]", "change", "floor", "adjusted p")


def add_compare(parser: argparse.ArgumentParser) -> None:
    """Two stores and the campaign."""
    parser.add_argument("before", type=Path, metavar="A", help="store before the change")
    parser.add_argument("now", type=Path, metavar="B", help="store after the change")
    parser.add_argument("--campaign", metavar="NAME", help="campaign, if the stores have several; default quick")
    parser.add_argument("--out", type=Path, metavar="FILE", help="write the comparison as one HTML page with pictures")


def run_compare(options: argparse.Namespace) -> int:
    """Print the comparison, with times where both stores have samples; 1 where there is nothing to compare."""
    before, now = options.before, options.now
    campaign = options.campaign or _campaign_of(before, now)
    if options.out is not None:
        check_file(options.out, "--out")
    with reading(now):
        bounds, times = read_bounds(HERE / TOLERANCES), _of_times(before, now, campaign)
        try:
            sides = collect(before, campaign), collect(now, campaign)
            text = comment(campaign, *sides, bounds, times, stale(campaign, *sides))
        except NothingComparedError as error:
            print(f"footprint: {error}", file=sys.stderr)
            return FAILED
        if options.out is not None:
            values = values_of_both(*map(measured, sides))
            from reports.change import change_html  # with matplotlib, which a comment does without
            from reports.files import write_texts

            page = change_html(text, values, before, now, campaign)
            write_texts(options.out.parent, {options.out.name: page})
    print(text, end="")
    return OK


def _campaign_of(*stores: Path) -> str:
    """The one that all stores have, or quick."""
    shared = set.intersection(*(set(Archive(store).campaigns()) for store in stores))
    return shared.pop() if len(shared) == 1 else QUICK


def values_of_both(before: pd.DataFrame, now: pd.DataFrame) -> dict[str, pd.DataFrame]:
    """Errors and operations of the cells that both have measured, with columns A and B."""
    both = before.merge(now, on=["label", "column"], suffixes=(" A", " B"))
    values = {}
    for name, start in {"relative error": ERROR, "operations": "c.operations"}.items():
        own = both[both["column"].str.startswith(start)]
        values[name] = pd.DataFrame({side: own[f"value {side}"].astype(float) for side in "AB"})
    return values


def _of_times(before: Path, now: Path, campaign: str) -> pd.DataFrame | str:
    """Slower and faster cells, each a test of its own, or why there is no comparison."""
    try:
        sides = samples_of_both(before, now, campaign)
        slower, faster = (compare_times(*sides, worse) for worse in ("slower", "faster"))
    except (UsageError, NothingComparedError) as error:
        return str(error)
    return slower.where(slower["verdict"] != "same", faster)


def stale(campaign: str, *sides: pd.DataFrame) -> str:
    """How many cells of both sides other sources have solved than those at work, which would solve them again."""
    try:
        ids = {row.cell.label: row.id for row in plan(find(campaign))}
    except UsageError:  # a campaign of somebody else's, which is nowhere but in the stores
        return ""
    counts = [int(((cells["id"] != "") & (cells["id"] != cells["label"].map(ids))).sum()) for cells in sides]
    return " ".join(
        f"{count} cells of {side} are stale: they were solved with other sources."
        for count, side in zip(counts, "AB", strict=True)
        if count
    )


def comment(
    campaign: str,
    before: pd.DataFrame,
    now: pd.DataFrame,
    bounds: tuple[Bound, ...],
    times: pd.DataFrame | str,
    stale: str = "",
) -> str:
    """What changed beyond the bounds, what is new, what is missing, how much ran; tables as of ``collect``.

    times: of compare_times, slower and faster ones, or why there are none.  stale: what is said of :func:`stale` cells.
    Raises NothingComparedError when the two have no cell in common.
    """
    findings = compared(measured(before), measured(now), bounds)
    parts = [f"### Campaign {campaign}, A → B", f"A: {_ran(before)}. B: {_ran(now)}.", _spent(before, now)]
    parts += [stale] if stale else []
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
    from reports.files import as_words

    counts = cells[OUTCOME].value_counts()
    done = int((~cells[OUTCOME].isin(UNFINISHED)).sum())
    others = "".join(f", {n} {as_words(str(outcome))}" for outcome, n in counts.items() if outcome != CONVERGED)
    return f"{done} of {len(cells)} cells ran, {counts.get(CONVERGED, 0)} {CONVERGED}{others}"


def _spent(before: pd.DataFrame, now: pd.DataFrame) -> str:
    """What the cells cost that both have solved, in counts, which are no machine's."""
    both = before.merge(now, on=["label", COMMAND], suffixes=(" A", " B"))
    both = both[both[f"{OUTCOME} A"].isin(SOLVED) & both[f"{OUTCOME} B"].isin(SOLVED)]
    ratios = []
    for name in SPENT:
        if f"c.{name} A" in both and f"c.{name} B" in both and (a := both[f"c.{name} A"].sum()) > 0:
            b = both[f"c.{name} B"].sum()
            ratios.append(f"{name.replace('_', ' ')} {a:.4g} → {b:.4g} ({b / a:.3f})")
    return f"{len(both)} cells solved in both{': ' if ratios else ''}{', '.join(ratios)}."


def _titled(title: str, header: Sequence[str], rows: Sequence[Sequence[str]], words: int) -> str:
    """The first rows; what is in them are texts of others."""
    from reports.files import as_words
    from reports.markdown import table

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


def add_check(parser: argparse.ArgumentParser) -> None:
    """What is compared, and the update of the baseline."""
    add_store(parser)
    parser.add_argument("--campaign", default="quick", help="campaign")
    parser.add_argument("--update", action="store_true", help="replace the baseline; with --owner and --reason")
    parser.add_argument("--owner", default="", metavar="NAME", help="who is responsible for the update")
    parser.add_argument("--reason", default="", metavar="TEXT", help="why the baseline is replaced")


def run_check(options: argparse.Namespace) -> int:
    """Compare, or update; 1 where something is worse."""
    baseline = HERE / f"{options.campaign}.csv"
    if not options.update and (options.owner or options.reason):
        raise UsageError("--owner and --reason need --update")
    if options.update and not (options.owner.strip() and options.reason.strip()):
        raise UsageError("--update needs --owner NAME and --reason TEXT")
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
    verdict = f"{len(wrong)} values are worse or different" if wrong else "nothing is worse"
    print(f"check: {len(table)} cells of {options.campaign} against {baseline}: {verdict}{better}")
    if wrong:
        print(f"if the change is intended: {UPDATE.format(options.campaign)}")
    return FAILED if wrong else OK


def _update(options: argparse.Namespace, table: pd.DataFrame, baseline: Path) -> int:
    """Replace the baseline, print what changed."""
    findings = update(table, baseline, options.owner, options.reason)
    print("\n".join(lines(findings)), end="\n" if findings else "")
    print(f"{baseline}: {len(table)} cells, {len(findings)} values beyond the bounds of before")
    return OK
