"""Part of the page of algorithms: do all of them give the same contact set and force, whatever the case?"""

from __future__ import annotations

import pandas as pd

from reports.formats import code
from reports.markdown import Part, Template, commands
from reports.store import Store

TEXT = Template("algorithms")
REFUSAL = " does not apply: "  # before its reason
REFUSED = "unsupported"


def agreement_part(store: Store) -> Part:
    """The pressed tyre by every algorithm, a line each, and problems of the campaign with several answers."""
    agreement = store.table("algorithm_agreement")
    plain = agreement["algorithm"].map(code)
    agreement = agreement.assign(named=plain.where(agreement["way"] == "", plain + ", " + agreement["way"]))
    put = agreement[agreement["exact"] & ~agreement["reference"]]
    solved, refused = put[put["outcome"] != REFUSED], put[put["outcome"] == REFUSED]
    first = agreement.iloc[0]
    alike = (agreement["way"] == "") & (agreement["load"] == first["load"]) & (agreement["section"] == first["section"])
    values = {
        "first": first,
        "cases": len(agreement.drop_duplicates(["load", "section"])),
        "agree": int(solved["agrees"].sum()),
        "solved": len(solved),
        "refused": len(refused),
        "commands": commands(agreement[alike]["command"]),
    }
    rows = {
        "ways": [_row(way, own) for way, own in put.groupby("named", sort=False)],
        "odd": solved[~solved["agrees"].astype(bool)],
    }
    finite = _finite(agreement[~agreement["exact"] & (agreement["outcome"] != REFUSED)])
    parts = {"finite": finite, "refusals": _refused(refused), "answers": _answers(store)}
    return TEXT("agreement", rules=store.rules(), **values, **rows, **parts)


def _row(way: object, own: pd.DataFrame) -> dict[str, object]:
    solved = own[own["outcome"] != REFUSED]
    agree = f"{int(solved['agrees'].sum())} of {len(solved)}" if len(solved) else ""
    counts = {"cases": len(own), "refused": len(own) - len(solved)}
    return {"way": way, "agree": agree, "off": solved["off"].max(), "nodes": solved["nodes"].max(), **counts}


def _refused(refused: pd.DataFrame) -> Part:
    """Who refuses what, the first reason of each."""
    rows = []
    for name, own in refused.groupby("algorithm", sort=False):
        reason = str(own["reason"].iloc[0])
        rows.append({"name": name, "count": len(own), "reason": reason.partition(REFUSAL)[2] or reason})
    return TEXT("refusals", rows=rows) if rows else Part("No request is refused.")


def _finite(soft: pd.DataFrame) -> Part:
    """What a finite epsilon, the default of some algorithms, changes."""
    if soft.empty:
        return Part()
    stiffness = ", ".join(f"{epsilon:g}" for epsilon in soft["epsilon"].unique())
    most = {"off": soft["off"].max(), "depth": soft["penetration_mm"].max()}
    return TEXT("finite", stiffness=stiffness, count=len(soft), **most)


def _answers(store: Store) -> Part:
    """Problems of the whole campaign to which it has more than one certified answer."""
    if not store.has("disagreements"):
        return Part()
    disagreements = store.table("disagreements")
    rows = [
        {"why": why, "answers": len(own), "scenes": dict.fromkeys(own["scene"]), "difference": own["difference"].max()}
        for why, own in disagreements.groupby("why", sort=False)
    ]
    return TEXT("answers", count=len(disagreements), rows=rows)
