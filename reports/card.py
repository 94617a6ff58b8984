"""The card of a part as a page: what it solved, its laws, claims and cost; every number is given to it."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import pandas as pd

from reports.formats import code
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
    alike = {"same": same.sum(), "compared": len(compared), "alike": record["alike"]}
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
