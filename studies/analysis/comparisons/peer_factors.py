"""What peers take over what shells take, at equal error: from the table of ``footprint bench peers``."""

from __future__ import annotations

import math
from typing import Any

import pandas as pd

OURS = "footprint"
PARTS = ("start", "assembly", "factorisation")
NOTHING = {"mesh": "", "unknowns": math.nan, "error": math.nan, "seconds": math.nan, "units": math.nan}


def peer_factors(table: pd.DataFrame) -> pd.DataFrame:
    """A row a line: problem, program, family, within, bar, and the mesh of it that is sufficient, with its cost.

    Sufficient is the coarsest mesh from which on the error of every finer one is at most ``within``, for a coarse one
    may be by luck; none leaves mesh empty and numbers nan.  share_*: of its seconds.  cheapest: whether it is the line
    of its program that takes least.  factor: its seconds over those of our cheapest line.  bare: the same if ours took
    nothing but its factorisations.  finest, finest_error: of its finest mesh; apart: its value there over ours, less
    one.
    """
    rows = [
        {**dict(zip(("problem", "program", "family"), key, strict=True)), **_line(own)}
        for key, own in table.groupby(["problem", "program", "family"], sort=False)
    ]
    found = pd.DataFrame(rows)
    cheapest = found.groupby(["problem", "program"])["seconds"].transform("min")
    found["cheapest"] = found["seconds"] == cheapest
    for problem, lines in found.groupby("problem"):
        ours = lines[(lines["program"] == OURS) & lines["cheapest"]]
        seconds, share, limit = (
            float(ours[name].iloc[0]) if len(ours) else math.nan for name in ("seconds", "share_factorisation", "value")
        )
        here = found["problem"] == problem
        found.loc[here, "factor"] = lines["seconds"] / seconds
        found.loc[here, "bare"] = lines["seconds"] / (seconds * share)
        found.loc[here, "apart"] = lines["value"] / limit - 1
    return found.drop(columns="value")


def _line(own: pd.DataFrame) -> dict[str, object]:
    """What one line needs, and where it ends."""
    finer = own.sort_values("unknowns", ascending=False).to_dict("records")
    first: dict[str, Any] | None = None
    for row in finer:
        if not abs(row["error"]) <= row["within"]:
            break
        first = {str(name): value for name, value in row.items()}
    shares = {f"share_{part}": first[part] / first["seconds"] if first else math.nan for part in PARTS}
    needed = {name: (first or NOTHING)[name] for name in NOTHING}
    last = finer[0]
    given = {name: last[name] for name in ("within", "bar", "uncertainty")}
    return {**given, **needed, **shares, "finest": last["mesh"], "finest_error": last["error"], "value": last["value"]}
