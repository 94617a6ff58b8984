"""A card as one page of Markdown: the verdict, then all that failed or was refused, then cost, hard points and place.

Numbers come from the card; nothing is worked out here but medians that stand beside their range.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence

import numpy as np
import pandas as pd

from studies.arena.card.card import TWICE, Card
from studies.arena.card.problems import GROUPS
from studies.arena.card.runs import ALGORITHM, ELEMENT, MEASURE, SOLVER
from studies.arena.card.trials import AGREES, ALIKE, FAILED, FALSE, LATE, RAISED, REFUSED, SOLVED
from studies.experiments.conformance import Check
from studies.output.provenance import provenance

LEFT_OUT = {
    ALGORITHM: "Operations are those that the suite counts where it does them: assembly, factorisations, triangular "
    "solutions, condensed columns, pivots. What a plug-in works out by itself is in the seconds alone.",
    MEASURE: "Every scene is solved by `semismooth`; the answer is held against that of `lcp` with the same measure.",
    ELEMENT: "Every scene is solved by `semismooth`; the answer is held against that of `lcp` with the same option.",
    SOLVER: "Each problem is asked for to an accuracy of 1e-6 and of 1e-8, judged from the file alone; operations of "
    "programs from elsewhere are not counted.",
}


def page(cards: Sequence[Card], command: str, picture: str = "") -> str:
    """The Markdown of the parts of one file; command: that makes it again.  picture: the file beside it, if any."""
    lines: list[str] = []
    for card in cards:
        lines += _of(card, picture)
    made = provenance()
    versions = f"{made['version']} at {str(made['commit'])[:12]}" if made.get("commit") else str(made["version"])
    lines += ["---", "", f"Made by `{command}`, footprint {versions}.", ""]
    return "\n".join(lines)


def _of(card: Card, picture: str) -> list[str]:
    subject = card.subject
    origin = f"`{subject.file}`" if subject.file else "the suite"
    lines = [f"# Card of the {subject.kind} `{subject.name}`", "", f"**{card.verdict}**", "", f"Of {origin}.", ""]
    sections = {
        "Problems": _problems(card),
        "False claims": _ends(card, (FALSE,), "No claim is false."),
        "Not solved": _ends(card, (FAILED, RAISED, LATE), "Every problem that is not refused is solved."),
        "Refused": _ends(card, (REFUSED,), "Nothing is refused."),
        "Laws": _laws(card.laws),
        "Agreement": _agreement(card),
        "Cost": _cost(card, picture),
        "Hard points": [] if subject.kind == SOLVER else _hard(card),
        "Place": _place(card),
    }
    for title, section in sections.items():
        lines += [f"## {title}", "", *section] if section else []
    return lines


def _problems(card: Card) -> list[str]:
    words = [SOLVED, FALSE, FAILED, RAISED, LATE, REFUSED]
    own = card.own
    counts = pd.crosstab(own["group"], own["ended"]).reindex(index=own["group"].unique(), columns=words, fill_value=0)
    rows = [[GROUPS[str(group)], count.sum(), *count] for group, count in counts.iterrows()]
    return _table(["problems", "tried", *words], rows)


def _ends(card: Card, words: Sequence[str], nothing: str) -> list[str]:
    own = card.ended(*words)
    if own.empty:
        return [nothing, ""]
    heads = {"problem": "problem", "ended": "ended", "reason": "why"}
    if len(words) == 1:
        del heads["ended"]
    return _table(list(heads.values()), own[list(heads)].to_numpy().tolist())


def _laws(laws: Iterable[Check]) -> list[str]:
    ordered = sorted(laws, key=lambda law: (law.passed, bool(law.refused)))
    rows = []
    for law in ordered:
        word = "refused" if law.refused else "kept" if law.passed else "**broken**"
        within = f"[{_number(law.low)}, {_number(law.high)}]"
        rows.append([law.law, _number(law.found), within, word, law.refused or law.said])
    return _table(["law", "found", "must be in", "", "worst"], rows)


def _agreement(card: Card) -> list[str]:
    compared = card.compared
    if compared.empty:
        return ["Nothing to compare: no answer, or the law of another ε.", ""]
    alike = int((compared["agreement"] == AGREES).sum())
    lines = [
        f"{alike} of {len(compared)} answers have the same set, displacements and forces to {ALIKE:g} as the exact "
        "ones.",
        "",
    ]
    rest = compared[compared["agreement"] != AGREES]
    rows = [[row.problem, _number(row.apart), row.agreement] for row in rest.itertuples()]
    lines += _table(["problem", "apart", "why"], rows) if rows else []
    away = card.own.dropna(subset=["away"])
    if len(away):
        told = [[row.problem, _number(row.away)] for row in away.itertuples()]
        lines += [f"Its answers beside those of `{card.reference}`, which may differ as the laws do:", ""]
        lines += _table(["problem", "apart"], told)
    return lines


def _cost(card: Card, picture: str) -> list[str]:
    ratios = card.ratios()
    own, reference = ratios[ratios["who"] == card.subject.name], card.reference
    lines = []
    for cost in ("operations", "seconds"):
        found = own[f"{cost}_ratio"].dropna()
        if len(found):
            total, of = (float(own.loc[found.index, column].sum()) for column in (cost, f"{cost}_of_reference"))
            lines.append(
                f"- {cost} over those of `{reference}`, median **{np.median(found):.2f}**, from {found.min():.2f} to "
                f"{found.max():.2f}, in all {total / of:.2f}, on the {len(found)} problems that both solve; "
                f"{len(own) - len(found)} are not in it"
            )
        else:
            lines.append(f"- {cost}: none were counted on problems that both solve")
    lines += ["", LEFT_OUT[card.subject.kind], ""]
    lines += [f"![Cost over that of {reference}, problem by problem]({picture})", ""] if picture else []
    head = ["problem", "ended", "iterations", "factorisations", "operations", "ratio", "seconds", "ratio"]
    told = ["iterations", "factorisations", "operations", "operations_ratio", "seconds", "seconds_ratio"]
    rows = [
        [row["problem"], row["ended"], *(_number(row[name], ".2f" if "ratio" in name else ".3g") for name in told)]
        for row in own.to_dict("records")
    ]
    return [*lines, *_table(head, rows)]


def _hard(card: Card) -> list[str]:
    table = card.hard()
    names = [card.subject.name, *(name for name in table if name != card.subject.name)]
    rows = [[point, *(told[name] for name in names)] for point, told in table.to_dict("index").items()]
    return _table(["point", *(f"`{name}`" for name in names)], rows)


def _place(card: Card) -> list[str]:
    meaning = {
        "solved share": "share solved of the problems not refused",
        "operations": f"share solved with at most {TWICE:g} times the fewest operations",
        "seconds": f"share solved in at most {TWICE:g} times the least processor time",
    }
    rows = [
        [meaning[str(row.figure)], f"{row.rank} of {row.of}", f"{row.value:.0%}", f"{row.best:.0%} (`{row.who}`)"]
        for row in card.place().itertuples()
    ]
    asked = len(card.own) - len(card.ended(REFUSED))
    return [
        f"On the {asked} problems that it does not refuse; a failure lowers every share.",
        "",
        *_table(["figure", "rank", "value", "best"], rows),
    ]


def _table(head: Sequence[str], rows: Iterable[Sequence[object]]) -> list[str]:
    def line(cells: Sequence[object]) -> str:
        return f"| {' | '.join(str(cell).replace('|', chr(92) + '|') for cell in cells)} |"

    return [line(head), line(["---"] * len(head)), *map(line, rows), ""]


def _number(value: object, form: str = ".3g") -> str:
    """Nothing for NaN."""
    number = float(str(value))
    return "" if math.isnan(number) else f"{number + 0.0:{form}}"


def drawn(card: Card) -> pd.DataFrame:
    """What the picture shows: who, problem, ended and ratio, of operations where they are counted, else of seconds."""
    ratios = card.ratios()
    own = ratios[ratios["who"] == card.subject.name]
    cost = "operations" if own["operations_ratio"].notna().any() else "seconds"
    table = ratios[["who", "problem", "ended"]].assign(ratio=ratios[f"{cost}_ratio"], cost=cost)
    return table[table["who"] != card.reference]
