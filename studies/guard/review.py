"""Two stores of a campaign side by side, as a short comment for a review in Markdown."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import pandas as pd

from studies.guard.baseline import OUTCOME, Bound
from studies.guard.compare import UNFINISHED, Finding, compared, measured, shortened
from studies.result import CONVERGED

MOST = 20  # rows a table: a comment is read, an archive is not
VALUES = ("cell", "value", "A", "B", "allowed")
TIMES = {
    **{"cell": ("label", "{}"), "A [s]": ("before_s", "{:.4g}"), "B [s]": ("now_s", "{:.4g}")},
    **{"change": ("change", "{:+.1f} %"), "floor": ("floor", "{:.1f} %"), "adjusted p": ("p", "{:.1e}")},
}
Shown = Callable[[str], str]
TITLES = {"worse": "Worse", "changed": "Changed", "better": "Better", "missing": "Missing", "new": "New"}


def comment(
    campaign: str,
    before: pd.DataFrame,
    now: pd.DataFrame,
    bounds: tuple[Bound, ...],
    shown: Shown,
    times: pd.DataFrame | str = "not asked for",
) -> str:
    """What changed beyond the bounds, what is new, what is missing, how much ran; tables as of ``collect``.

    times: of compare_times, slower and faster ones, or why there are none.  shown: text of others as it stands in
    Markdown.
    Raises NothingComparedError when the two have no cell in common.
    """
    findings = compared(measured(before), measured(now), bounds)
    parts = [f"### Campaign {campaign}, A → B", f"A: {ran(before, shown)}. B: {ran(now, shown)}."]
    if not findings:
        parts.append("Nothing changed beyond the bounds.")
    for what, title in TITLES.items():
        own = [finding for finding in findings if finding.what == what]
        if own:
            parts.append(_table(f"{title} ({len(own)})", VALUES, [_words(finding) for finding in own], shown, left=2))
    parts.append(f"Wall time: not compared, {times}." if isinstance(times, str) else _times(times, shown))
    return "\n\n".join(parts) + "\n"


def ran(table: pd.DataFrame, shown: Shown) -> str:
    """How much of a campaign has an answer, and how the rest ended."""
    outcomes = table[OUTCOME]
    rest = outcomes[~outcomes.isin((CONVERGED,))].value_counts()
    done = int((~outcomes.isin(UNFINISHED)).sum())
    others = "".join(f", {n} {shown(str(outcome))}" for outcome, n in rest.items())
    return f"{done} of {len(table)} cells ran, {int((outcomes == CONVERGED).sum())} {CONVERGED}{others}"


def _table(title: str, head: Sequence[str], rows: Sequence[Sequence[str]], shown: Shown, left: int) -> str:
    """The first rows under a bold title; so many columns are aligned to the left, the others to the right."""
    align = [":--"] * left + ["--:"] * (len(head) - left)
    words = (" | ".join(map(shown, row)) for row in (head, align, *rows[:MOST]))
    rest = f"\n\nand {len(rows) - MOST} more" if len(rows) > MOST else ""
    return f"**{title}**\n\n" + "\n".join(f"| {line} |" for line in words) + rest


def _words(f: Finding) -> tuple[str, ...]:
    return f.label, f.column or "the cell", shortened(f.before), shortened(f.now), f.allowed


def _times(times: pd.DataFrame, shown: Shown) -> str:
    moved = times[times["verdict"].isin(("slower", "faster"))]
    compared_cells = int((times["verdict"] != "too few samples").sum())
    if moved.empty:
        return f"Wall time: no significant change in {compared_cells} cells."
    percent = moved.assign(change=100 * moved["change"], floor=100 * moved["floor"])
    rows = [[form.format(row[name]) for name, form in TIMES.values()] for row in percent.to_dict("records")]
    return _table(f"Wall time: {len(moved)} of {compared_cells} cells", list(TIMES), rows, shown, left=1)
