"""Section of the page of convergence: the default element against the one of the paper, over all scenes."""

from __future__ import annotations

import pandas as pd

from reports.markdown import NOTHING, Part, commands, fixed, percent, prose, table
from reports.tables import Store

SHOWN = 3  # meshes


def element_choice_part(store: Store) -> Part:
    """The table, and what it says."""
    found, rule = store.analysis("element_choice"), store.rules()
    counts = found["verdict"].value_counts()
    errors = {
        name: found[name].map(lambda text: [float(each) for each in text.split()]) for name in ("paper", "default")
    }
    pairs = [list(zip(*both, strict=True)) for both in zip(errors["paper"], errors["default"], strict=True)]
    rows, worse = [], []
    for row, pair in zip(found.to_dict("records"), pairs, strict=True):
        meshes = row["meshes"].split()[:SHOWN]
        shown = [f"{percent(paper)} / {percent(default)}" for paper, default in pair[:SHOWN]]
        line = [row["ladder"], f"`{row['quantity']}`", row["verdict"], ", ".join(meshes)]
        line += [*shown, *[NOTHING] * (SHOWN - len(shown))]
        line += [" / ".join(fixed(row[f"{who}_{what}"], 0) for who in errors) for what in ("elements", "iterations")]
        rows.append(line)
        if row["verdict"] == "worse":
            paper, default = pair[0]
            worse.append(f"{row['ladder']} `{row['quantity']}` ({percent(paper)} by the paper's, {percent(default)})")
    nearer = sum(abs(pair[0][1]) < abs(pair[0][0]) for pair in pairs)
    farther = sum(abs(pair[0][1]) > abs(pair[0][0]) for pair in pairs)
    enough = percent(rule["enough"], 0, sign=False)
    text = prose(f"""## Which element

The element of the paper (`element=paper`) against the default (`element=refined`), which samples the thickness strain
at the nodes and relaxes the linear membrane modes of curved elements. Both have the same unknowns and the same limit;
errors are relative to that limit, which is taken from the sequence whose limit is the more certain. On the coarsest
mesh the default is better for {counts.get("better", 0)} quantities, equal within
{percent(rule["equal"], 1, sign=False)} or within the uncertainty of the limit for {counts.get("equal", 0)}, and worse
for {counts.get("worse", 0)}{": " + "; ".join(worse) if worse else ""}. By the bare numbers, however close, it is nearer
for {nearer} and farther for {farther}. *Elements for {enough}*: from which the error stays below, interpolated; a dash
where it is so on every mesh or on none. *Iterations*: of Newton's method over the whole path on the second mesh.""")
    header = ["scene", "quantity", "default is", "meshes", "coarsest: paper / default", "second", "third"]
    header += [f"elements for {enough}", "iterations"]
    return Part("\n\n".join([text, table("Errors of both elements", header, rows, words=4), _commands(store, found)]))


def _commands(store: Store, found: pd.DataFrame) -> str:
    """Of the default element, on the meshes that both have."""
    meshes = found.assign(mesh=found["meshes"].str.split()).explode("mesh")[["ladder", "quantity", "mesh"]]
    data = store.analysis("convergence")
    return commands(meshes.merge(data[data["element"] == "refined"], on=["ladder", "quantity", "mesh"])["command"])
