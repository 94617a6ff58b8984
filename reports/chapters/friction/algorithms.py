"""The page of algorithms with friction: whether they agree, what they cost, and the answers that check them."""

from __future__ import annotations

from collections.abc import Hashable
from typing import Any

import pandas as pd

from reports.chapter import Chapter
from reports.chapters.friction.references import references_part
from reports.formats import NOTHING, code, fixed, scientific, share
from reports.markdown import Part, fold, joined, listing, machine, prose, table
from reports.store.tables import Store

NEEDS = ("friction_agreement", "friction_greco", "friction_klarbring", "friction_algorithms", "friction_orders")
FIRST, SOLVED = "semismooth", ("converged", "unstable")


def algorithms_page(store: Store) -> Part:
    """The whole page."""
    return joined(
        _introduction(),
        *(section(store) for section in (_agreement, _costs, _greco, _klarbring)),
        references_part(store),
        _public(store),
    )


def _introduction() -> str:
    return prose(f"""# {CHAPTER.title}

Each algorithm finds who is open, sticks and slips in a load step, by its own way: `semismooth` by Newton's method on a
non-smooth function (Alart, Curnier 1991), `trial-and-error` by equilibrium on fixed states and a swap after it, the
*naive set*, `regularised` by springs with radial return, `augmented-lagrangian` by such springs beside known forces,
`qp` by friction bounds that are repeated until they fit, `lcp` by pivots on a polygon (Stewart, Trinkle;
Anitescu, Potra), both ended on the exact law. The problem is one and the same, so the answer must be, but where there
is more than one ([springs](#none-one-or-several-answers)) or the load steps differ.""")


def _agreement(store: Store) -> Part:
    """Every case by every algorithm."""
    data, summary = store.table("friction_agreement"), store.analysis("friction_algorithms")
    names = [name for name in summary["algorithm"] if name != FIRST]
    text = prose("""## The same answer?

*same*: every candidate is in the same state as by `semismooth` and the largest difference of a nodal force, over the
largest force, is below the bound of agreement; else that difference stands there, with *states* that differ, and with
the number of load steps where it is another one: a path that was cut otherwise is another path. `regularised` has no
exact law to ask for, and is shown for its error. What does not end is named by its outcome and counts as failed.""")
    first = data[data["algorithm"] == FIRST].set_index("case")["substeps"]
    rows = []
    for case, own in data.groupby("case", sort=False):
        by_name = {row["algorithm"]: row for row in own.to_dict("records")}
        rows.append([case, first[case], *(_cell(by_name.get(name), first[case]) for name in names)])
    odd = data[~data["outcome"].isin(SOLVED)]
    why = listing("Not solved, why", odd, "case | algorithm | reason", "{case} | {algorithm:code} | {reason}", words=3)
    heads = "algorithm | cases | solved | share | refused | failed | agrees | in other steps | off in the same steps"
    line = "{algorithm:code} | {cases} | {solved} | {share:.0%} | {refused} | {failed} | {agrees} | {other_steps}"
    line += " | {off:.1e}"
    shares = summary.assign(share=summary["solved"] / summary["cases"])
    return joined(
        text,
        machine(
            table(
                "Against `semismooth`, at all loads",
                ["case", "load steps", *map(code, names)],
                rows,
                words=len(names) + 2,
            )
        ),
        machine(listing("Solved, and agreed", shares, heads, line)),
        fold(f"{len(odd)} solves that do not end", machine(why)) if len(odd) else "Every solve ends.",
    )


def _cell(row: dict[Hashable, Any] | None, steps: int) -> str:
    """What became of a case."""
    if row is None:
        return NOTHING
    if row["outcome"] not in SOLVED:
        return str(row["outcome"])
    if row["agrees"]:
        return "same"
    parts = [scientific(row["force_error"]), f"{row['states']} states" if row["states"] else ""]
    parts.append(f"{row['substeps']} steps" if row["substeps"] != steps else "")
    return ", ".join(filter(None, parts))


def _costs(store: Store) -> Part:
    """What each algorithm takes."""
    data, summary = store.table("friction_agreement"), store.analysis("friction_algorithms")
    text = prose("""## What they cost

In the median over cases that an algorithm and `semismooth` both solve in the same load steps (*both*), over those of
`semismooth`. What fails is not in a median: its cost is in the table of all solves, and was in vain.""")
    heads = "algorithm | both | iterations | factorisations | operations"
    line = "{algorithm:code} | {both} | {iterations_ratio:.2f} | {factorisations_ratio:.2f} | {operations_ratio:.2f}"
    seconds = listing(
        "Processor time over that of `semismooth`",
        summary,
        "algorithm | both | seconds",
        "{algorithm:code} | {both} | {seconds_ratio:.2f}",
    )
    every = listing(
        "All solves",
        data,
        "case | algorithm | outcome | loads | certified | steps | iterations | factorisations | operations [10⁶]"
        " | seconds",
        "{case} | {algorithm:code} | {outcome} | {loads} | {judged} | {substeps} | {iterations} | {factorisations}"
        " | {operations:.0f} | {cpu_s:.2f}",
        words=3,
    )
    return joined(
        text,
        listing("Costs over those of `semismooth`", summary, heads, line),
        machine(seconds),
        fold(f"All {len(data)} solves", machine(every)),
    )


def _greco(store: Store) -> Part:
    """The plate that separates methods."""
    data, bound = store.table("friction_greco"), store.rules()["friction_greco"]
    slips = [name for name in data.columns if name.startswith("slip_")]
    text = prose(f"""## The GRECO plate

An elastic square in plane strain, pressed on a plane with μ = 1 and pushed from the left (Code_Aster, SSNV128): the
left corner is off the plane, then it slips, then it sticks. Slips at {len(slips)} places are compared with those of
fine graded meshes of 9-node quadrilaterals; the bound is {share(bound)} of a slip, on the finest mesh here.""")
    ended, finest = data["outcome"].isin(SOLVED), data["elements"] == data["elements"].max()
    within = data["error"] <= bound
    said = ["yes" if near else "no" for near in within]
    named = data.assign(
        kept=["not solved" if not end else word for end, word in zip(ended, said, strict=True)],
        worst=data["error"].where(ended),
        first=data[slips[0]].where(ended) * 100,
        pull=data["friction_N"].where(ended),
    )
    heads = "elements | algorithm | outcome | iterations | factorisations | operations [10⁶] | corner [10⁻² mm]"
    heads += " | friction [N/mm] | largest error | within"
    line = "{elements} | {algorithm:code} | {outcome} | {newton_iterations} | {factorisations} | {operations:.0f}"
    line += " | {first:.4f} | {pull:.1f} | {worst:.3%} | {kept}"
    count = int((ended & finest & within).sum())
    told = f"{count} of {int(finest.sum())} algorithms end within the bound on the finest mesh."
    return joined(text, listing("The plate from rest", named, heads, line, words=3), told)


def _klarbring(store: Store) -> Part:
    """None, one or several answers."""
    data = store.table("friction_klarbring")
    names = list(dict.fromkeys(data["algorithm"]))
    text = prose("""## None, one or several answers

One candidate on two springs that are coupled (Klarbring, Ingenieur-Archiv 60 (1990) 529-541): all answers can be
written down. Where μ K_nt is below K_tt and the springs are definite there is one; beyond, slip may press the candidate
on by itself, and there are up to three; springs that are not definite may leave none. That is a property of the law
and no failure of an algorithm: which of several is found depends on the start, here from rest, and where there is none
the right end is not to claim one. Not to find the only one is a failure.""")
    rows = []
    for case, own in data.groupby("case", sort=False):
        row = own.iloc[0]
        found = {each["algorithm"]: _found(each) for each in own.to_dict("records")}
        there = row["which"] if isinstance(row["which"], str) else "none"
        rows.append([case, fixed(row["mu_Knt_over_Ktt"], 2), there, *(found.get(name, NOTHING) for name in names)])
    heads = ["springs", "μ K_nt/K_tt", "answers", *map(code, names)]
    return joined(text, table("What is found, from rest", heads, rows, words=len(heads)))


def _found(row: dict[Hashable, Any]) -> str:
    found = row["found"]
    return found if isinstance(found, str) else f"({row['outcome']})"


def _public(store: Store) -> Part:
    """Public problems of another program; nothing where they were not run."""
    if not store.has_table("friction_public"):
        return Part("")
    files = store.table("friction_public")
    data = files.dropna(subset=["algorithm"])
    taken = data["certified"].map({True: 1.0, False: 0.0}).astype(float)
    claimed = data["outcome"].isin(SOLVED)
    kinds = data.assign(taken=claimed & (taken == 1), refused=claimed & (taken == 0), claimed=claimed)
    summed = kinds.groupby("algorithm", sort=False).agg(
        problems=("problem", "nunique"),
        claimed=("claimed", "sum"),
        taken=("taken", "sum"),
        refused=("refused", "sum"),
    )
    ends = kinds[~claimed].groupby("algorithm")["outcome"].agg(_counted)
    named = summed.assign(other=ends.reindex(summed.index).fillna("")).reset_index()
    text = prose(f"""## Public problems

{data["problem"].nunique()} problems with friction of Siconos, rigid bodies with {data["contacts"].min():g} to
{data["contacts"].max():g} contacts, before our algorithms and the oracle, a few seconds of the processor each. *Taken*:
called solved and certified by the judge; *refused*: called solved and not. What is regularised is judged by its own law
and left out of both. {files["problem"].nunique() - data["problem"].nunique()} more files are no such problems.""")
    heads = "algorithm | problems | called solved | taken | refused by the judge | others end by"
    line = "{algorithm:code} | {problems} | {claimed} | {taken} | {refused} | {other:said}"
    return joined(text, machine(listing("Public problems", named, heads, line)))


def _counted(outcomes: pd.Series) -> str:
    counts = outcomes.value_counts().sort_index()
    return ", ".join(f"{name} {count}" for name, count in counts.items())


CHAPTER = Chapter(
    "friction-algorithms",
    "Algorithms with friction, and what they are checked by",
    "agreement and cost on every scene, problems with several answers or none, closed forms and their orders.",
    algorithms_page,
    needs=NEEDS,
)
