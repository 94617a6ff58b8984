"""Two stores of a campaign side by side, as a short comment for a review in Markdown."""

from __future__ import annotations

from collections.abc import Iterator

import pandas as pd

from studies.guard.baseline import OUTCOME, Bound
from studies.guard.compare import SOLVED, UNFINISHED, Finding, compared, measured, shortened

MOST = 20  # rows a table: a comment is read, an archive is not
TITLES = {"worse": "Worse", "changed": "Changed", "better": "Better", "missing": "Missing", "new": "New"}


def comment(
    campaign: str,
    before: pd.DataFrame,
    now: pd.DataFrame,
    bounds: tuple[Bound, ...],
    times: pd.DataFrame | str = "not asked for",
) -> str:
    """What changed beyond the bounds, what is new, what is missing, how much ran; tables as of ``collect``.

    times: of compare_times, slower and faster ones, or why there are none.
    Raises NothingComparedError when the two have no cell in common.
    """
    findings = compared(measured(before), measured(now), bounds)
    parts = [f"### Campaign {campaign}, A → B", f"A: {ran(before)}. B: {ran(now)}."]
    if not findings:
        parts.append("Nothing changed beyond the bounds.")
    for what, title in TITLES.items():
        own = [finding for finding in findings if finding.what == what]
        if own:
            parts.append("\n".join(_table(f"{title} ({len(own)})", own)))
    if isinstance(times, str):
        parts.append(f"Wall time: not compared, {times}.")
    else:
        parts.append("\n".join(_times(times)))
    return "\n\n".join(parts) + "\n"


def ran(table: pd.DataFrame) -> str:
    """How much of a campaign has an answer, and how the rest ended."""
    outcomes = table[OUTCOME]
    rest = outcomes[~outcomes.isin((SOLVED,))].value_counts()
    done = int((~outcomes.isin(UNFINISHED)).sum())
    others = "".join(f", {n} {outcome}" for outcome, n in rest.items())
    return f"{done} of {len(table)} cells ran, {int((outcomes == SOLVED).sum())} {SOLVED}{others}"


def _table(title: str, findings: list[Finding]) -> Iterator[str]:
    yield f"**{title}**"
    yield ""
    yield "| cell | value | A | B | allowed |"
    yield "| :-- | :-- | --: | --: | --: |"
    for f in findings[:MOST]:
        words = (f.label, f.column or "the cell", shortened(f.before), shortened(f.now), f.allowed)
        yield "| " + " | ".join(word.replace("|", "\\|") for word in words) + " |"
    if len(findings) > MOST:
        yield ""
        yield f"and {len(findings) - MOST} more"


def _times(times: pd.DataFrame) -> Iterator[str]:
    moved = times[times["verdict"].isin(("slower", "faster"))]
    compared_cells = int((times["verdict"] != "too few samples").sum())
    if moved.empty:
        yield f"Wall time: no significant change in {compared_cells} cells."
        return
    yield f"**Wall time: {len(moved)} of {compared_cells} cells**"
    yield ""
    yield "| cell | A [s] | B [s] | change | floor | adjusted p |"
    yield "| :-- | --: | --: | --: | --: | --: |"
    for row in moved.head(MOST).to_dict("records"):
        numbers = f"{row['before_s']:.4g} | {row['now_s']:.4g} | {100 * row['change']:+.1f} %"
        yield f"| {row['label']} | {numbers} | {100 * row['floor']:.1f} % | {row['p']:.1e} |"
    if len(moved) > MOST:
        yield ""
        yield f"and {len(moved) - MOST} more"
