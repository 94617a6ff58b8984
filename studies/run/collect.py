"""A campaign of a store as one table: a row for each planned cell, whatever became of it.

The cells that compare shares of the thickness strain and those that are drawn on the sheets are held apart: their
meshes are too coarse on purpose, and would be taken for rungs of the ladders of their scenes.

Seconds of two machines are never in one table. Those of a table are of its home: the machine of the timing lane where
the campaign was timed, else the one that solved most of the cells here. A merged cell brings no seconds that count:
nobody can verify a time. What it claims stands by itself, beside its machine.
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from studies.ask.request import Request, Settings
from studies.output.provenance import UNKNOWN, machine_of
from studies.run.answers import Answers, number
from studies.run.lists import SHARES, SHEETS
from studies.run.times import interval, read_times, times_path
from studies.scenes.element import ELEMENTS
from studies.solving.result import UNSUPPORTED, seen_in

MISSING = "missing"
APART = (SHARES, SHEETS)
OPTIONS = ("measure", "contact", "newton", "model")
SETTINGS = ("section", "load", "epsilon", "tolerance")
COLUMNS = (
    *("label", "id", "scene", "measure", "contact", "newton", "mesh", "n1", "n2", "model"),
    *("element", "section", "load", "epsilon", "tolerance", "outcome", "reason"),
    *("path_end", "path_end_at", "path_end_by", "command", "canary", "machine", "merged", "seconds_there", "request"),
)
NUMBERS = ("epsilon", "tolerance", "path_end_at", "seconds_there")


def collect(store: Path, campaign: str, *, apart: bool = False) -> pd.DataFrame:
    """One row a planned cell: ``COLUMNS``, then q.<quantity>, c.<counter>, w.<operations of a kind>, t.<time in s>,
    k.<residual of the judge>.

    apart: of the cells that are held apart, instead of all others.
    t.seconds: processor time, the median of the timing lane with its interval t.seconds_low to t.seconds_high where the
    cell was timed and the canary stood still, else that of the solve itself.  canary: "quiet" where it is of the lane,
    "moved" where the cell was timed in vain, nothing where it was not timed.  c.operations: of all kinds.
    machine: that solved the cell; only the seconds of one count.
    merged: how far a cell of another store was verified, whose seconds as it claims them are seconds_there.
    request: what was asked, by whose key rows are compared.
    outcome: a class of :data:`studies.solving.result.CLASSES`, or "missing".  q: headline quantities and the numbers of
    the last step.  path_end: kind of what the path of the problem itself ends at, with its parameter and what has found
    it; nothing where it does not end, or a record of old does not say.  Empty text, or NaN, where a scene has no such
    thing. Raises UsageError when the store has no such campaign, or a record that cannot be read.
    """
    answers = Answers.of(store, campaign)
    rows = (planned for planned in answers.planned.values() if (planned.get("group") in APART) == apart)
    table = pd.DataFrame([_row(answers, planned) for planned in rows])
    for name in ("machine", "merged"):
        table[name] = table[name].fillna("") if name in table else ""
    timed_on, timed = _lane(store, campaign)
    table = _with_lane(of_one_machine(table, home_of(table, timed_on)), timed)
    more = [name for kind in "qcwtk" for name in sorted(c for c in table.columns if c.startswith(f"{kind}."))]
    table = table.reindex(columns=[*COLUMNS, *more])
    for name in NUMBERS:
        table[name] = pd.to_numeric(table[name], errors="coerce")
    return table


def _row(answers: Answers, planned: Mapping[str, Any]) -> dict[str, Any]:
    row = {**_asked(planned), "reason": planned["reason"]}
    if planned["id"] is None:
        return {**row, "outcome": UNSUPPORTED}
    answer = answers.get(planned["label"])
    if answer is None:
        failure = answers.archive.failure(planned["id"]) or {"class": MISSING, "reason": ""}
        return {**row, "outcome": failure["class"], "reason": failure["reason"]}
    record = answer.record
    last = record["steps"][-1] if record["steps"] else {}
    numbers = {key: value for key, value in seen_in(last, record["counters"]).items() if _is_number(value)}
    return {
        **row,
        **{"outcome": record["class"], "reason": record["reason"]},
        **of_record(record),
        **_end(record.get("path_end") or {}),
        **{f"q.{key}": number(value) for key, value in {**numbers, **record["quantities"]}.items()},
        **{f"c.{key}": value for key, value in record["counters"].items()},
        **{f"w.{key}": value for key, value in record.get("work", {}).items()},
        "c.substeps": sum(step.get("substeps", 1) for step in record["steps"]),
        **{f"t.{key}": value for key, value in record["timing_s"].items()},
        **_seconds(record["timing_s"]),
        **{f"k.{key}": number(value) for key, value in last.get("kkt", {}).items()},
    }


def _end(path_end: Mapping[str, Any]) -> dict[str, Any]:
    at = number(path_end.get("parameter"))
    return {"path_end": path_end.get("kind", ""), "path_end_at": at, "path_end_by": path_end.get("found_by", "")}


def _seconds(timing: Mapping[str, float]) -> dict[str, float]:
    """The processor time of a cell; where an old record has none, the time on the clock."""
    spent = timing.get("cpu", timing.get("total"))
    return {} if spent is None else {"t.seconds": spent}


def _with_lane(table: pd.DataFrame, timed: Mapping[str, Mapping[str, Any]]) -> pd.DataFrame:
    """The table with what the timing lane says of its cells, by their ids."""
    names = dict.fromkeys(name for each in timed.values() for name in each)
    for name in names:
        known = table[name] if name in table else pd.Series(np.nan, table.index, dtype=object)
        lane = table["id"].map(lambda cell, name=name: timed.get(cell, {}).get(name))
        table[name] = lane.where(lane.notna(), known)
        if name.startswith("t."):
            table[name] = pd.to_numeric(table[name])
    return table.assign(canary=table["canary"].fillna("") if "canary" in table else "")


def _lane(store: Path, campaign: str) -> tuple[str, dict[str, dict[str, Any]]]:
    """The machine of the timing lane, and what it says of each cell that it has timed, by its id.

    Nothing where the campaign was not timed, or the samples do not say on what.
    """
    if not times_path(store, campaign).exists():
        return "", {}
    times = read_times(store, campaign)
    machine = machine_of(times["provenance"])
    return "" if machine == UNKNOWN else machine, {cell["id"]: _median(cell["warm"]) for cell in times["cells"]}


def _median(samples: list[float]) -> dict[str, Any]:
    median, low, high = interval(samples)
    if math.isnan(median):
        return {"canary": "moved"}
    return {"t.seconds": median, "t.seconds_low": low, "t.seconds_high": high, "canary": "quiet"}


def _asked(planned: Mapping[str, Any]) -> dict[str, Any]:
    """What was asked for: the resolved request, or as much of it as was given."""
    request = _given(planned) if planned["request"] is None else Request.of(planned["request"])
    mesh = request.mesh if min(request.mesh) > 0 else ()
    return {
        **{key: planned[key] for key in ("label", "scene", "command")},
        "id": planned["id"] or "",
        **{key: getattr(request, key) for key in OPTIONS},
        "mesh": "x".join(map(str, mesh)),
        **dict(zip(("n1", "n2"), mesh, strict=False)),
        "element": _element(request.settings),
        **{key: request.settings.get(key, "") for key in SETTINGS},
        "request": request,
    }


def _given(planned: Mapping[str, Any]) -> Request:
    """A request that could not be resolved."""
    n1, _, n2 = str(planned["options"].get("mesh", "0x0")).partition("x")
    mesh = (int(n1), int(n2)) if n1.isdigit() and n2.isdigit() else (0, 0)
    return Request(planned["scene"], **{**planned["options"], "mesh": mesh}, settings=Settings(planned["settings"]))


def _element(settings: Mapping[str, Any]) -> str:
    """The name of the three options of the element, if they have one."""
    if "element" in settings:
        return str(settings["element"])
    names = (name for name, preset in ELEMENTS.items() if all(settings.get(k) == v for k, v in preset.items()))
    return next(names, "")


def _is_number(value: object) -> bool:
    return (isinstance(value, int | float) and not isinstance(value, bool)) or value in ("inf", "-inf", None)


STATUSES = VERIFIED, _, UNVERIFIED = "verified", "solved again", "unverified failure"  # of cells merged now, or once
COUNTED = ("machine", "cells", *STATUSES, "seconds")


def of_record(record: Mapping[str, Any]) -> dict[str, Any]:
    """machine; merged: how far the cell was verified, nothing where it was solved here; seconds_there: as claimed."""
    mark = record.get("merged") or {}
    columns = {"machine": machine_of(record.get("provenance") or {}), "merged": mark.get("status", "")}
    return {**columns, "seconds_there": mark.get("timing_s", {}).get("cpu", np.nan)} if mark else columns


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
