"""Section of the page of verification: which option of the element, over all scenes, as advice."""

from __future__ import annotations

import pandas as pd

from reports.formats import percent, quantity, share
from reports.markdown import Part, folded, joined, prose, table
from reports.store.tables import Store

SHARES = ("projected", "balanced", "nodal")  # of the thickness strain that is taken from the nodes: none, half, all


def elements_part(store: Store) -> Part:
    """The whole section."""
    found, shares, rule = store.analysis("element_choice"), store.analysis("thickness_share"), store.rules()
    counts = found["verdict"].value_counts()
    pairs = [(float(row["paper"].split()[0]), float(row["default"].split()[0])) for row in found.to_dict("records")]
    nearer = sum(abs(default) < abs(paper) for paper, default in pairs)
    text = prose(f"""## Which element

**Keep the default** (`element=refined`): it takes half of the thickness strain from the nodes (`balanced`) and relaxes
the linear membrane modes of curved elements. Against the element of the paper (`element=paper`: `projected`,
`compatible`), with the same unknowns and the same limit, its error on the coarsest mesh is smaller for
{counts.get("better", 0)} of {len(found)} quantities, equal within {share(rule["equal"], 1)} or the uncertainty of the
limit for {counts.get("equal", 0)}, larger for {counts.get("worse", 0)}; by the bare numbers it is nearer for {nearer}.

**Take `thickness_strain=nodal` only on coarse meshes of moderate bending**, and confirm it on a finer mesh. What is
taken from the nodes makes an element softer, and on a mesh that is too stiff for other reasons softness looks like
accuracy; but a strip that turns by φ in one element bends like φ - φ³/6, so that folds end early, at limit points of
the element.""")
    worse = [
        f"- {row['ladder']}, {quantity(row['quantity'])}: {percent(paper)} by the paper's element, {percent(default)}"
        for row, (paper, default) in zip(found.to_dict("records"), pairs, strict=True)
        if row["verdict"] == "worse"
    ]
    listed = folded("Where the default element is worse on the coarsest mesh", "\n".join(worse)) if worse else ""
    return joined(text, listed, _shares(shares, rule["equal"]))


def _shares(found: pd.DataFrame, equal: float) -> str:
    """How often each share is best, and where its path ends early."""
    rows = [[f"`{name}`", *counted(found, name)] for name in SHARES]
    scenes = found["ladder"].nunique()
    heads = ["thickness strain", "best on half of the default mesh", "alone", "best on the default mesh", "alone"]
    heads += ["limit points not confirmed", "in"]
    title = f"Share of the thickness strain taken from the nodes, {scenes} scenes; best: within {share(equal, 1)}"
    return table(title, heads, rows)


def counted(found: pd.DataFrame, name: str) -> list[object]:
    """Of a share: on the coarser and on the default mesh, in how many scenes it is best and alone best; early ends."""
    entries: list[object] = []
    for coarse in (True, False):
        own = found[found["coarse"].astype(bool) == coarse]
        near = own["nearest"].astype(bool)
        best = [set(each.loc[near, "share"]) for _, each in own.groupby("ladder")]
        entries += [sum(name in names for names in best), sum(names == {name} for names in best)]
    wrong = found[found["confirmed"].eq(False) & (found["share"] == name)]["ladder"]
    return [*entries, len(wrong), ", ".join(wrong) or "none"]
