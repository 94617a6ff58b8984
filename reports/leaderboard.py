"""The leaderboard of the arena as a page, from rows; texts in them are of others, and mean themselves here."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

from reports.formats import NOTHING
from reports.html import report_html
from reports.markdown import Template
from reports.reading import as_words

PAGE, HTML = "leaderboard.md", "leaderboard.html"
TITLE = "Leaderboard of the arena"
TEXT = Template("leaderboard")


def leaderboard(
    tolerance: float,
    ranked: Iterable[Mapping[str, Any]],
    runs: Iterable[Mapping[str, Any]],
    machines: Iterable[Mapping[str, Any]],
    stale: int,
    secrets: int,
    checksums: tuple[str, str],
) -> dict[str, str]:
    """The page by the names of its files, in Markdown and as HTML that needs no network.

    ranked, runs, machines: the rows of the tables.  stale: how many results are.  secrets: how many different ones the
    held-out problems are of.  checksums: of the collection and of the harness.
    """
    rows, every = [_worded(_drawn(row)) for row in ranked], [_worded(row) for row in runs]
    held = "" if not secrets else f" {TEXT('held-out')}" + (f" {TEXT('secrets', secrets=secrets)}" * (secrets > 1))
    ranking = (
        TEXT("ranking", tolerance=tolerance, rows=rows, held_out=held) if rows else TEXT("nothing-fresh", stale=stale)
    )
    outdated = TEXT("stale", stale=stale, results=len(every)) if stale else ""
    below = TEXT("machines", stale=f"\n{outdated}", runs=every, machines=[_worded(row) for row in machines])
    collection, harness = checksums
    page = f"{TEXT('page', ranking=ranking, machines=below, collection=collection, harness=harness)}\n"
    return {PAGE: page, HTML: report_html({PAGE: page}, {PAGE: TITLE}, {})}


def _drawn(row: Mapping[str, Any]) -> dict[str, Any]:
    """The held-out problems that are solved, of how many."""
    return {**row, "drawn": None if row["drawn"] is None else f"{row['drawn_ok']}/{row['drawn']}"}


def _worded(row: Mapping[str, Any]) -> dict[str, Any]:
    """The row as text of Markdown, a dash for what is not there."""
    worded = {key: as_words(value) if isinstance(value, str) else value for key, value in row.items()}
    return {key: NOTHING if value is None else value for key, value in worded.items()}
