"""Other programs beside ours: what they take at equal error, and what they find for our decks on their finest meshes.

From the tables of ``footprint bench peers`` and ``footprint bench programs``.
"""

from __future__ import annotations

import math

import pandas as pd

from studies.solving.refinement.richardson import holds_from

OURS = "footprint"
GIVEN = ("within", "bar", "value")
NEEDED = ("mesh", "unknowns", "error", "seconds", "units")


def peer_factors(table: pd.DataFrame) -> pd.DataFrame:
    """A row a line: problem, program, family, within, bar, and the mesh of it that is sufficient, with its cost.

    Sufficient is the coarsest mesh from which on the error of every finer one is at most ``within``, for a coarse one
    may be by luck; none leaves mesh empty and numbers nan.  factor: its seconds over those of our cheapest line.
    bare: the same if ours took nothing but its factorisations.  apart: the value of its finest mesh over that of this
    line of ours, less one.
    """
    rows = [
        {**dict(zip(("problem", "program", "family"), key, strict=True)), **_line(own)}
        for key, own in table.groupby(["problem", "program", "family"], sort=False)
    ]
    peers = pd.DataFrame(rows)
    ours = peers[peers["program"] == OURS].sort_values("seconds", kind="stable").drop_duplicates("problem")
    cheapest = ours.dropna(subset="seconds").set_index("problem").reindex(peers["problem"]).set_axis(peers.index)
    factors = {"factor": peers["seconds"] / cheapest["seconds"], "bare": peers["seconds"] / cheapest["factorisation"]}
    factored = peers.assign(**factors, apart=peers["value"] / cheapest["value"] - 1)
    return factored.drop(columns=["value", "factorisation"])


def _line(own: pd.DataFrame) -> dict[str, object]:
    """What one line needs, and where it ends."""
    meshes = own.sort_values("unknowns")
    enough = meshes.iloc[holds_from(meshes["error"].abs() <= meshes["within"]) :]
    nothing = pd.Series({"mesh": "", **dict.fromkeys((*NEEDED[1:], "factorisation"), math.nan)})
    first, last = enough.iloc[0] if len(enough) else nothing, meshes.iloc[-1]
    return {name: last[name] for name in GIVEN} | {name: first[name] for name in (*NEEDED, "factorisation")}


def agreement(programs: pd.DataFrame) -> pd.DataFrame:
    """The rows of the finest mesh of each case and program."""
    most = programs.groupby(["case", "program"])["bricks"].transform("max")
    return programs[programs["bricks"] == most].reset_index(drop=True)
