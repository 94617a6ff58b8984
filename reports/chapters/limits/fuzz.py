"""The page of random cases: what they came to, what explains two answers that differ, what broke a law, and faults."""

from __future__ import annotations

import re

import pandas as pd

from reports.chapter import Chapter
from reports.formats import number
from reports.markdown import Part, commands, joined, listing, machine, prose, table
from reports.store.tables import Store

VERDICTS = ("agrees", "explained", "not compared", "broken")
KINDS = {
    "scene": "requests of all scenes",
    "friction": "requests with friction",
    "posed": "panels posed in two ways",
    "matrices": "matrices with an answer",
}
INTRODUCTION = prose("""# Random cases

Requests that nobody has written down: scene, measure, algorithm, grid and settings are drawn from a number, near
their defaults, far from them and on the bounds of their ranges. Each case must end within a number of
linearisations and without a traceback, converged, refused in one line, or ended with a cause. What is called
converged is judged; its derivatives are compared with differences, its negative eigenvalues with those of dense
algebra; and one law more is drawn. *Requests of all scenes* are solved once more by another algorithm, Newton
iteration or solver, in more load steps, as a part of a tyre and as the whole, or in other units. *Requests with
friction* are dragged and turned back and forth, too; friction may not drive, exceed its bound or miss the direction
against the slip that places alone tell, and next to none must do what none does. A quarter of all requests are hard
ones of earlier runs with one thing changed. *Panels posed in two ways* have their axes exchanged, are measured in
other units, moved and turned together with all that holds and presses them, renumbered, or loaded in steps.
*Matrices with an answer* are small contact problems made from it. Two answers *agree* to 1e-6 of displacements and
of contact forces; a difference is *explained* only by what is computed of each state: the error that one more step
of Newton's iteration shows, a negative eigenvalue, or two stable equilibria each of which is confirmed by the way
of solving that has found the other. Everything else is *broken*, a finding.""")


def fuzz_page(store: Store) -> Part:
    """The whole page."""
    cases, faults = store.table("fuzz"), store.table("fuzz_faults").fillna("")
    cases = cases.fillna(dict.fromkeys(("kind", "word", "law", "said", "about"), ""))
    return joined(INTRODUCTION, _overview(cases), _laws(cases), _explained(cases), _broken(cases), _faults(faults))


def _overview(cases: pd.DataFrame) -> Part:
    """Kind by outcome."""
    words = [word for word in cases["word"].value_counts().index if word]
    of_kind = cases.groupby("kind", sort=False)
    kinds = {KINDS.get(str(kind), str(kind) or "the process died"): own for kind, own in of_kind}
    rows = [["all", *(len(own) for own in kinds.values())]]
    rows += [[word, *(_counts(own, "word", words)[i] for own in kinds.values())] for i, word in enumerate(words)]
    broken = int((cases["verdict"] == "broken").sum())
    text = prose(f"""## What became of them

{len(cases)} cases, of which {broken} break a law. An outcome in the table is that of the first solve: what breaks
a law has none.""")
    return joined(text, table("Cases by outcome", ["outcome", *kinds], rows))


def _laws(cases: pd.DataFrame) -> Part:
    """Law by verdict."""
    rows = [
        [law, len(own), *_counts(own, "verdict", VERDICTS)] for law, own in cases[cases["law"] != ""].groupby("law")
    ]
    text = prose("""## By law

A law is not compared where the other way of solving is refused or ends before its last load; the reason is
then recorded.""")
    return joined(text, table("Cases by the law that was drawn, or broken", ["law", "cases", *VERDICTS], rows))


def _explained(cases: pd.DataFrame) -> Part:
    """Why two answers differ, counted."""
    own = cases[cases["verdict"] == "explained"]
    if own.empty:
        return joined(prose("## Explained differences\n\nThere are none."))
    why = own["said"].map(lambda text: re.split(r"[:,]", text)[0])
    found = own.assign(why=why).groupby("why", sort=False).agg(cases=("seed", "size"), first=("command", "first"))
    made = listing("Differences by their explanation", found.reset_index(), "explanation | cases", "{why} | {cases}")
    return joined(prose("## Explained differences"), made, machine(commands(own["command"])))


def _broken(cases: pd.DataFrame) -> Part:
    """Every finding with the command that replays it."""
    own = cases[cases["verdict"] == "broken"]
    if own.empty:
        return joined(prose("## Findings\n\nNo case breaks a law."))
    shown = own.assign(said=own["said"].str.slice(0, 200).str.replace("|", "/"))
    made = listing("Cases that break a law", shown, "case | law | what is said", "{seed} | {law} | {said}", words=3)
    return joined(prose("## Findings"), machine(made, commands(own["command"])))


def _faults(faults: pd.DataFrame) -> Part:
    """Planted faults."""
    lost = int((faults["cases"] == 0).sum())
    latest = faults["cases"].max()
    text = prose(f"""## Planted faults

How much of what is wrong would be found: {len(faults)} faults were planted one at a time, in an algorithm or in a
model, and the cases examined from the first one on; {lost} were not found, and the others by case
{number(float(latest))} at the latest. A case that breaks a law without the fault does not count.""")
    line = "{fault} | {law} | {cases}"
    return joined(text, listing("Planted faults", faults, "fault | found by | cases until found", line, words=2))


def _counts(own: pd.DataFrame, column: str, names: list[str] | tuple[str, ...]) -> list[int]:
    counts = own[column].value_counts()
    return [int(counts.get(name, 0)) for name in names]


CHAPTER = Chapter(
    "fuzz",
    "Random cases",
    "requests drawn at random, the laws that each must keep, and how soon planted faults are found.",
    fuzz_page,
    needs=("fuzz", "fuzz_faults"),
)
