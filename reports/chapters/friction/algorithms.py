"""Parts of the page of friction: whether the algorithms agree, what they cost, and what they are checked by."""

from __future__ import annotations

import re
from collections.abc import Hashable
from typing import Any

import pandas as pd

from reports.formats import NOTHING, code, scientific, share
from reports.markdown import Part, fold, joined, listing, machine, prose, table
from reports.store.tables import Store

FIRST, SOLVED = "semismooth", ("converged", "unstable")


def algorithms_part(store: Store) -> Part:
    """Whether they agree, and what they cost."""
    data, summary = store.table("friction_agreement"), store.analysis("friction_algorithms")
    names = [name for name in summary["algorithm"] if name != FIRST]
    text = prose(f"""## Which algorithm

{data["case"].nunique()} scenes with friction by every algorithm from the same start. Costs are over those of
`{FIRST}`, in the median of the scenes that both solve in the same load steps (*both*); what an unsolved scene cost is
in no median. *Same*: every node is in the same state as by `{FIRST}` and nodal forces agree within the tolerance;
else the largest difference over the largest force, with the nodes in another *state*, and the load steps where they
differ, which is another path. `regularised` solves another law, so its difference is that of the law.""")
    heads = "algorithm | scenes | solved | refused | failed | agrees | other steps | both | iterations"
    heads += " | operations | seconds"
    line = "{algorithm:code} | {cases} | {solved} | {refused} | {failed} | {agrees} | {other_steps} | {both}"
    line += " | {iterations_ratio:.2f} | {operations_ratio:.2f} | {seconds_ratio:.2f}"
    first = data[data["algorithm"] == FIRST].set_index("case")["substeps"]
    rows = []
    for case, own in data.groupby("case", sort=False):
        by_name = {row["algorithm"]: row for row in own.to_dict("records")}
        rows.append([case, first[case], *(_cell(by_name.get(name), first[case]) for name in names)])
    heads_of_cases = ["scene", "load steps", *map(code, names)]
    cases = table(f"Against `{FIRST}`, at all loads", heads_of_cases, rows, words=len(heads_of_cases))
    odd = data[~data["outcome"].isin(SOLVED)].assign(reason=lambda rows: rows["reason"].map(_short))
    why = listing("Not solved, why", odd, "scene | algorithm | reason", "{case} | {algorithm:code} | {reason}", words=3)
    return joined(
        text,
        machine(listing("Solved, agreed, and costs", summary, heads, line)),
        machine(cases),
        fold(f"The {len(odd)} not solved", machine(why)) if len(odd) else "",
    )


def _short(reason: object) -> str:
    """The first clause of a reason."""
    return re.split(r"; | \(", str(reason))[0]


def _cell(row: dict[Hashable, Any] | None, steps: int) -> str:
    """What became of a scene."""
    if row is None:
        return NOTHING
    if row["outcome"] not in SOLVED:
        return str(row["outcome"])
    if row["agrees"]:
        return "same"
    parts = [scientific(row["force_error"]), f"{row['states']} states" if row["states"] else ""]
    parts.append(f"{row['substeps']} steps" if row["substeps"] != steps else "")
    return ", ".join(filter(None, parts))


def checks_part(store: Store) -> Part:
    """Closed forms and orders, and problems that separate the algorithms."""
    data = store.analysis("friction_orders").assign(size=lambda rows: rows["error"].abs())
    families = data.groupby(["family", "theory"], sort=False).agg(
        errors=("error", "size"), worst=("size", "max"), low=("order", "min"), high=("order", "max")
    )
    text = prose("""## What the algorithms are checked by

Closed forms, solved by `semismooth`: a bar dragged over a plane under uniform pressure (*strip*), a strip pulled over a
*drum* in partial slip and in gross slip (*capstan*), a disc turned on the spot (*parking*), a block whose plane is
dragged along a quarter circle (*path*). Errors are relative, on the finest mesh or in the finest steps; an error of
rounding has no order.""")
    heads, line = "reference | theory | errors | largest | orders", "{family} | {theory} | {errors} | {worst:.1e} | "
    made = listing("Errors and orders", families.reset_index(), heads, line + "{low:.2f} to {high:.2f}")
    return joined(text, made, *_separating(store))


def _separating(store: Store) -> tuple[str, str]:
    """A row an algorithm: a plate, springs with none, one or several answers, and public problems."""
    greco, springs = store.table("friction_greco"), store.table("friction_klarbring")
    bound, public = store.rules()["friction_greco"], store.has_table("friction_public")
    files = store.table("friction_public").dropna(subset=["algorithm"]) if public else pd.DataFrame()
    finest = greco[greco["elements"] == greco["elements"].max()]
    names = list(dict.fromkeys([*finest["algorithm"], *springs["algorithm"], *(files["algorithm"] if public else [])]))
    rows = [
        [code(name), _plate(finest, name, bound), *_found(springs, name), *(_public(files, name) if public else ())]
        for name in names
    ]
    heads = ["algorithm", "GRECO plate", "one answer: found", "several: one found", "none: claimed", "claims wrong"]
    heads += ["public: certified", "public: refused by the judge"] if public else []
    words = prose(f"""The GRECO plate (Code_Aster, SSNV128) sticks, slips and is open on one side; within {share(bound)}
of the slips of fine graded meshes counts as correct. Klarbring's two coupled springs (Ingenieur-Archiv 60, 1990) have
one, several or no answers, all written down; where there is none, none may be claimed.""")
    if public:
        words += " " + prose(f"""The {files["problem"].nunique()} public problems are Siconos' rigid bodies with
friction, with {files["contacts"].min():g} to {files["contacts"].max():g} contacts and a few seconds of the processor
each; the claims of `regularised` obey another law and are not judged.""")
    shown = table("Problems that separate the algorithms", heads, rows)
    return words, machine(shown) if public else shown


def _plate(finest: pd.DataFrame, name: str, bound: float) -> str:
    own = finest[finest["algorithm"] == name]
    if own.empty:
        return NOTHING
    row = own.iloc[0]
    if row["outcome"] not in SOLVED:
        return str(row["outcome"])
    return f"{'within' if row['error'] <= bound else 'failed'}, {share(row['error'], 3)}"


def _found(springs: pd.DataFrame, name: str) -> list[str]:
    own = springs[springs["algorithm"] == name]
    if own.empty:
        return [NOTHING] * 4
    claimed, wrong = own["outcome"].isin(SOLVED), own["found"] == "wrong"
    right = claimed & own["found"].notna() & ~wrong
    kinds = (own["answers"] == 1, own["answers"] > 1)
    none = own["answers"] == 0
    counts = [f"{int(right[kind].sum())} of {int(kind.sum())}" for kind in kinds]
    return [*counts, f"{int(claimed[none].sum())} of {int(none.sum())}", str(int(wrong.sum()))]


def _public(files: pd.DataFrame, name: str) -> list[str]:
    own = files[files["algorithm"] == name]
    if own.empty:
        return [NOTHING] * 2
    judged = own["certified"].map({True: 1.0, False: 0.0}).astype(float)
    claimed = own["outcome"].isin(SOLVED)
    taken, refused = claimed & (judged == 1), claimed & (judged == 0)
    if claimed.any() and not (taken | refused).any():
        return [f"not judged, {int(claimed.sum())} claimed", NOTHING]
    return [f"{int(taken.sum())} of {len(own)}", str(int(refused.sum()))]
