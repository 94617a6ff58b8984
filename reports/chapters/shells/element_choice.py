"""Section of the page of convergence: the default element against the one of the paper, over all scenes."""

from __future__ import annotations

import pandas as pd

from reports.chapters.shells.figures_convergence import both_elements
from reports.formats import NOTHING, fixed, percent, quantity, share
from reports.markdown import Part, commands, folded, joined, picture, prose, table
from reports.store.tables import Store

SHOWN, COUNTS = 2, ("elements", "iterations")  # meshes; what is counted of both elements


def element_choice_part(store: Store) -> Part:
    """The table, and what it says."""
    found, rule = store.analysis("element_choice"), store.rules()
    counts = found["verdict"].value_counts()
    rows, worse, pairs = [], [], []
    for row in found.to_dict("records"):
        pair = [
            (float(paper), float(own)) for paper, own in zip(row["paper"].split(), row["default"].split(), strict=True)
        ]
        shown = [f"{percent(paper)} / {percent(default)}" for paper, default in pair[:SHOWN]]
        named = [row["ladder"], quantity(row["quantity"]), row["verdict"], ", ".join(row["meshes"].split()[:SHOWN])]
        both = (" / ".join(fixed(row[f"{who}_{what}"]) for who in ("paper", "default")) for what in COUNTS)
        rows.append([*named, *shown, *[NOTHING] * (SHOWN - len(shown)), *both])
        pairs.append(pair[0])
        if row["verdict"] == "worse":
            paper, default = map(percent, pair[0])
            worse.append(f"{row['ladder']}, {quantity(row['quantity'])} ({paper} by the paper's, {default})")
    nearer = sum(abs(default) < abs(paper) for paper, default in pairs)
    farther = sum(abs(default) > abs(paper) for paper, default in pairs)
    enough = share(rule["enough"], 0)
    text = prose(f"""## Which element

The element of the paper (`element=paper`) against the default (`element=refined`), which takes half of the thickness
strain from the nodes, so that an element has no error of the third order in the angle its directors turn by, and
relaxes the linear membrane modes of curved elements. Both have the same unknowns and the same limit;
errors are relative to that limit, which is taken from the sequence whose limit is the more certain. On the coarsest
mesh the default is better for {counts.get("better", 0)} quantities, equal within
{share(rule["equal"], 1)} or within the uncertainty of the limit for {counts.get("equal", 0)}, and worse
for {counts.get("worse", 0)}{": " + "; ".join(worse) if worse else ""}. By the bare numbers, however close, it is nearer
for {nearer} and farther for {farther}. *Elements for {enough}*: from which the error stays below, interpolated; a dash
where it is so on every mesh or on none. *Iterations*: of Newton's method over the whole path on the second mesh.""")
    header = ["scene", "quantity", "default is", "meshes", "coarsest: paper / default", "second"]
    header += [f"elements for {enough}", "iterations"]
    coarsest = found.assign(**{who: [float(row.split()[0]) for row in found[who]] for who in ("paper", "default")})
    unlike = coarsest[coarsest["verdict"] != "equal"]
    words = "Error on the coarsest mesh by both elements, a row a quantity in which they are not equal"
    drawn = picture("convergence-elements.svg", words, both_elements(unlike)) if len(unlike) else ""
    listed = folded("Both elements on two meshes", table("Errors of both elements", header, rows, words=4))
    return joined(text, drawn, listed, _commands(store, found))


def _commands(store: Store, found: pd.DataFrame) -> str:
    """Of the default element, on the meshes that both have."""
    meshes = found.assign(mesh=found["meshes"].str.split()).explode("mesh")[["ladder", "quantity", "mesh"]]
    data = store.analysis("convergence")
    return commands(meshes.merge(data[data["element"] == "refined"], on=["ladder", "quantity", "mesh"])["command"])
