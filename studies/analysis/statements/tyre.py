"""How far the force of the tyre is known: by its grids, and by what its model leaves out."""

from __future__ import annotations

from collections.abc import Iterator

import pandas as pd

from studies.analysis.statements.record import Statement

CHANGES = {  # what of the model changes the force, by its name in the budget
    "follower": "a pressure that follows the inner face",
    "full-3d": "the full three-dimensional law",
    "shell instead of a solid": "a solid (of an isotropic tyre)",
}


def force_known(work_precision: pd.DataFrame, tyre_budget: pd.DataFrame) -> Iterator[Statement]:
    """How far the force is known: by its grids, and by what its model leaves out."""
    row, changes = work_precision.iloc[0], tyre_budget.set_index("changed")
    values = {"force": row["reference_N"], "known": row["known"]}
    text = "The force of the paper's tyre at 20 mm is {force:.1f} N in the limit of its grids, known to {known:.2%}"
    said = []
    for name, words in CHANGES.items():
        if name in changes.index:
            own = changes.loc[[name]].iloc[-1]
            key = name.split()[0].replace("-", "_")
            values |= {key: float(own["change"]), f"{key}_known": float(own["within"])}
            said.append(f"{words} changes it by {{{key}:+.1%}} ± {{{key}_known:.1%}}")
    values |= {
        "total": sum(float(values[name.split()[0].replace("-", "_")]) for name in CHANGES if name in changes.index)
    }
    text += f"; that is the error of the mesh alone: {', '.join(said)}" if said else ""
    text += ", {total:+.0%} if all are added: the model decides, not the mesh" if len(said) > 1 else ""
    text += ". Beyond 14.5 mm short waves beside the patch cost no energy: finer grids may leave this path."
    scope = "dead load, mid-surface area, exact measure; a follower load or a solid has another force"
    yield Statement("force-known", "cost", text, values, len(work_precision), scope)
