"""The card of a part and the leaderboard of the arena as pages: every number is given to them.

Texts in the rows of the leaderboard are of others, and mean themselves here.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import Any

import pandas as pd

from reports.files import as_words
from reports.formats import NOTHING, code
from reports.html import report_html
from reports.markdown import Part, Template, joined, table

TEXT = Template("card", cell=lambda words: str(words).replace("|", "\\|"))
ENDS = {"false": ["false claim"], "lost": ["not solved", "raised", "over the limit"], "refused": ["refused"]}
SAME = "agrees"


def card_page(cards: Sequence[Mapping[str, Any]], command: str, version: str, picture: str = "") -> str:
    """Of one part or several; picture: the name of the file beside it, if there is one."""
    return (
        f"{TEXT('page', cards=joined(*(_card(each, picture) for each in cards)), command=command, version=version)}\n"
    )


def _card(record: Mapping[str, Any], picture: str) -> Part:
    own, reference = record["own"], record["reference"]
    ended = {name: own[own["ended"].isin(words)] for name, words in ENDS.items()}
    nothing = {f"none_{name}": "" if len(rows) else TEXT(f"none-{name}") for name, rows in ended.items()}
    compared = own[own["agreement"] != ""]
    same, away = compared["agreement"] == SAME, own.dropna(subset=["away"])
    alike = {
        "same": same.sum(),
        "compared": len(compared),
        "alike": record["alike"],
        "held_against": record["held_against"],
    }
    parts = {
        "agreement": TEXT("agreement", **alike) if len(compared) else TEXT("nothing-compared"),
        "beside": TEXT("beside", reference=reference) if len(away) else "",
        "left_out": TEXT(str(record["kind"]).replace(" ", "-")),
        "picture": TEXT("picture", reference=reference, file=picture) if picture else "",
        "hard": _hard(record["hard"], str(record["name"])) if len(record["hard"]) else "",
    }
    rows = {"unlike": compared[~same], "away": away, "costs": list(_costs(own, reference))}
    asked = len(own) - len(ended["refused"])
    return TEXT("card", **{**record, **ended, **nothing, **parts, **rows, "asked": asked})


def _costs(own: pd.DataFrame, reference: str) -> Iterator[dict[str, str]]:
    for cost in ("operations", "seconds"):
        both = own.dropna(subset=[f"{cost}_ratio"])
        if both.empty:
            yield {"sentence": f"{cost}: none were counted on problems that both solve"}
            continue
        ratios, whole = both[f"{cost}_ratio"], both[cost].sum() / both[f"{cost}_of_reference"].sum()
        span = f"median **{ratios.median():.2f}**, from {ratios.min():.2f} to {ratios.max():.2f}, in all {whole:.2f}"
        lost = f"on the {len(both)} problems that both solve; {len(own) - len(both)} are not in it"
        yield {"sentence": f"{cost} over those of `{reference}`, {span}, {lost}"}


def _hard(problems: pd.DataFrame, name: str) -> Part:
    names = [name, *(other for other in problems if other != name)]
    rows = ([point, *own] for point, own in zip(problems.index, problems[names].to_numpy(), strict=True))
    return TEXT("hard", table=table("How each ends", ["point", *map(code, names)], rows, words=1 + len(names)))


PAGE, HTML = "leaderboard.md", "leaderboard.html"
TITLE = "Leaderboard of the arena"
LEADERBOARD = Template("leaderboard")


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
    held = (
        ""
        if not secrets
        else f" {LEADERBOARD('held-out')}" + (f" {LEADERBOARD('secrets', secrets=secrets)}" * (secrets > 1))
    )
    ranking = (
        LEADERBOARD("ranking", tolerance=tolerance, rows=rows, held_out=held)
        if rows
        else LEADERBOARD("nothing-fresh", stale=stale)
    )
    outdated = LEADERBOARD("stale", stale=stale, results=len(every)) if stale else ""
    below = LEADERBOARD("machines", stale=f"\n{outdated}", runs=every, machines=[_worded(row) for row in machines])
    collection, harness = checksums
    page = f"{LEADERBOARD('page', ranking=ranking, machines=below, collection=collection, harness=harness)}\n"
    return {PAGE: page, HTML: report_html({PAGE: page}, {PAGE: TITLE}, {})}


def _drawn(row: Mapping[str, Any]) -> dict[str, Any]:
    """The held-out problems that are solved, of how many."""
    return {**row, "drawn": None if row["drawn"] is None else f"{row['drawn_ok']}/{row['drawn']}"}


def _worded(row: Mapping[str, Any]) -> dict[str, Any]:
    """The row as text of Markdown, a dash for what is not there."""
    worded = {key: as_words(value) if isinstance(value, str) else value for key, value in row.items()}
    return {key: NOTHING if value is None else value for key, value in worded.items()}
