"""Other programs beside ours: what they take at equal error, and what they find for our decks on their finest meshes.

From the tables of ``footprint bench peers`` and ``footprint bench programs``.
"""

from __future__ import annotations

import math

import numpy as np
import pandas as pd

from studies.bench.problems import problems
from studies.solving.refinement.richardson import holds_from

OURS = "footprint"
PARTS = ("start", "assembly", "factorisation")
GIVEN = ("within", "bar", "uncertainty")
NEEDED = ("mesh", "unknowns", "error", "seconds", "units")
OTHERS = ("ngsolve", "kratos")  # columns, nan where one has not solved the scene


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
    meshes = own.sort_values("unknowns")
    enough = meshes.iloc[holds_from(meshes["error"].abs() <= meshes["within"]) :]
    nothing = pd.Series({"mesh": "", **dict.fromkeys((*NEEDED[1:], *PARTS), math.nan)})
    first, last = enough.iloc[0] if len(enough) else nothing, meshes.iloc[-1]
    shares = {f"share_{part}": first[part] / first["seconds"] for part in PARTS}
    needed, given = ({name: row[name] for name in names} for row, names in ((first, NEEDED), (last, GIVEN)))
    return {**given, **needed, **shares, "finest": last["mesh"], "finest_error": last["error"], "value": last["value"]}


def agreement(programs: pd.DataFrame, peers: pd.DataFrame | None = None) -> pd.DataFrame:
    """The rows of the finest mesh of each case and program, with a column for each of OTHERS.

    It is the value of its finest mesh over that of our finest in the same table, less one, beside the last load of
    a case: peers stand at full load, and on meshes of their own.
    """
    most = programs.groupby(["case", "program"])["bricks"].transform("max")
    found = programs[programs["bricks"] == most].reset_index(drop=True)
    last = found["step"] == found.groupby(["case", "program"])["step"].transform("max")
    for name in OTHERS:
        apart = [_apart(peers, str(case), str(each), name) for case, each in found[["case", "quantity"]].to_numpy()]
        found[name] = np.where(last, apart, np.nan)
    return found


def _apart(peers: pd.DataFrame | None, case: str, quantity: str, program: str) -> float:
    known = problems().get(case)
    if peers is None or known is None or known.quantity != quantity:
        return np.nan
    reached = peers[(peers["problem"] == case) & peers["value"].notna()]
    ours, theirs = (_finest(reached[reached["program"] == name]) for name in (OURS, program))
    return theirs / ours - 1


def _finest(own: pd.DataFrame) -> float:
    return float(own["value"].iloc[int(own["unknowns"].argmax())]) if len(own) else np.nan
