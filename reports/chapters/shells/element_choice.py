"""Section of the page of verification: which option of the element, over all scenes, as advice."""

from __future__ import annotations

from typing import Any

import pandas as pd

from reports.markdown import Part
from reports.store.tables import Store
from reports.template import Template

TEXT = Template("convergence")
SHARES = ("projected", "balanced", "nodal")  # of the thickness strain that is taken from the nodes: none, half, all


def elements_part(store: Store) -> Part:
    """The whole section."""
    found, shares = store.analysis("element_choice"), store.analysis("thickness_share")
    errors = {f"{name}_error": found[name].str.split().str[0].astype(float) for name in ("paper", "default")}
    nearer = int((errors["default_error"].abs() < errors["paper_error"].abs()).sum())
    counts = found["verdict"].value_counts()
    better, equal, larger = (counts.get(verdict, 0) for verdict in ("better", "equal", "worse"))
    told = {"count": len(found), "better": better, "equal": equal, "larger": larger, "nearer": nearer}
    rows = {
        "worse": found.assign(**errors)[found["verdict"] == "worse"],
        "shares": [counted(shares, n) for n in SHARES],
    }
    return TEXT("elements", rules=store.rules(), scenes=shares["ladder"].nunique(), **told, **rows)


def counted(found: pd.DataFrame, name: str) -> dict[str, Any]:
    """Of a share: on the coarser and on the default mesh, in how many scenes it is best and alone best; early ends."""
    counts: dict[str, Any] = {"share": name}
    for mesh, coarse in (("coarse", True), ("fine", False)):
        own = found[(found["coarse"].astype(bool) == coarse) & found["nearest"].astype(bool)]
        best = own.groupby("ladder")["share"].agg(set)
        counts |= {mesh: sum(name in names for names in best), f"{mesh}_alone": sum(names == {name} for names in best)}
    wrong = found[found["confirmed"].eq(False) & (found["share"] == name)]["ladder"]
    return {**counts, "wrong": len(wrong), "wrong_in": ", ".join(wrong) or "none"}
