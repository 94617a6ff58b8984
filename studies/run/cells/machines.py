"""Whose machine a cell was solved on, and whose seconds count: seconds of two machines are never in one table.

The seconds of a table are those of one machine, its home: that of the timing lane where the campaign was timed, else
the one that solved most of the cells here. A merged cell brings no seconds that count: nobody can verify a time. What
it claims stands by itself, beside its machine.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping
from typing import Any

import numpy as np
import pandas as pd

UNKNOWN = "not told"
STATUSES = ("verified", "solved again", "unverified failure")  # of merged cells
COUNTED = ("machine", "cells", *STATUSES, "seconds")


def machine_of(origin: Mapping[str, Any]) -> str:
    """What decides a time, of a record's provenance: processor, cores, system, BLAS and its threads."""
    told, blas = origin.get("machine") or {}, origin.get("blas") or {}
    cores = f"{told['cores']} cores" if told.get("cores") else ""
    brought = ", ".join(dict.fromkeys(str(version) for name, version in blas.items() if name != "threads"))
    threads = f"threads {blas['threads']}" if "threads" in blas else ""
    names = (told.get("cpu"), cores, told.get("system"), told.get("processor"), brought, threads)
    return ", ".join(str(name) for name in names if name) or UNKNOWN


def of_record(record: Mapping[str, Any]) -> dict[str, Any]:
    """machine; merged: how far the cell was verified, nothing where it was solved here; seconds_there: as claimed."""
    mark = record.get("merged") or {}
    found = {"machine": machine_of(record.get("provenance") or {}), "merged": mark.get("status", "")}
    return {**found, "seconds_there": mark.get("timing_s", {}).get("cpu", np.nan)} if mark else found


def home_of(table: pd.DataFrame, timed_on: str = "") -> str:
    """The machine whose seconds count; nothing where no cell was solved here.  timed_on: that of the timing lane."""
    if timed_on:
        return timed_on
    here = table.loc[(table["machine"] != "") & (table["merged"] == ""), "machine"]
    return Counter(here).most_common(1)[0][0] if len(here) else ""


def of_one_machine(table: pd.DataFrame, home: str) -> pd.DataFrame:
    """The table without the seconds of any machine but its home."""
    merged = table["merged"] != ""
    if merged.any() and "t.seconds" not in table:  # all of them are
        return table.assign(**{"t.seconds": np.nan})
    times = [column for column in table.columns if str(column).startswith("t.")]
    counts = (table["machine"] == home) & ~merged
    return table.assign(**{name: table[name].where(counts) for name in times})


def machines(table: pd.DataFrame) -> pd.DataFrame:
    """COUNTED, a row a machine of a collected table: its cells, those merged by status, those whose seconds count."""
    solved = table[table["machine"] != ""].drop_duplicates("id")
    rows = []
    for name, own in solved.groupby("machine", sort=False):
        counts = own["merged"].value_counts()
        seconds = int(own["t.seconds"].notna().sum()) if "t.seconds" in own else 0
        rows.append([name, len(own), *(int(counts.get(status, 0)) for status in STATUSES), seconds])
    return pd.DataFrame(rows, columns=list(COUNTED)).sort_values("seconds", ascending=False, kind="stable")
