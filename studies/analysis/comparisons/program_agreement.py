"""What other programs find for our decks on their finest meshes, with those that solve the same scene in their own way.

From the tables of ``footprint bench programs`` and, where it is there, of ``footprint bench peers``.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pandas as pd

from studies.analysis.comparisons.peer_factors import OURS
from studies.bench.peers.problems import problems

PROGRAMS, PEERS = "programs", "peers"
TABLE = "program_agreement"
OTHERS = ("ngsolve", "kratos")  # columns, nan where one has not solved the scene


def program_tables(tables: Path) -> dict[str, pd.DataFrame]:
    """The table of the agreement by name; nothing where no program was run."""
    path = tables / f"{PROGRAMS}.csv"
    if not path.exists():
        return {}
    beside = tables / f"{PEERS}.csv"
    peers = pd.read_csv(beside) if beside.exists() else None
    return {TABLE: agreement(pd.read_csv(path), peers)}


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
