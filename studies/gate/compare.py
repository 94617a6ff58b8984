"""The regression gate: values of a fresh campaign against the committed baseline, each within its bound.

Accuracy (the error against a reference) and observed order are one-sided, and so are counters: they may become better.
A quantity that has a reference is judged by its error, one that has none must stay what it is. An outcome must not
change, no cell and no value may be missing, and none may be there that the baseline does not know: nothing guards it.
"""

from __future__ import annotations

import math
from collections import defaultdict
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import pandas as pd

from studies.ask.scene import UsageError
from studies.gate.baseline import (
    COLUMNS,
    COMMAND,
    OUTCOME,
    TOLERANCES,
    Bound,
    bound_of,
    read_baseline,
    read_bounds,
    record_update,
)
from studies.output.atomic import write_table
from studies.output.terminal import columns
from studies.run.answers import ERROR, ORDER, errors, ladders, quantities, reference_rows
from studies.solving.refinement.richardson import order_of
from studies.solving.result import CONVERGED, SOLVED

UNFINISHED = ("missing", "time", "memory", "crash")  # outcomes of the machine, not of the source
FEWEST = 3  # meshes of an observed order


class NothingComparedError(ValueError):
    """No cell is in both tables: not a comparison that found nothing, but none at all; one line."""


@dataclass(frozen=True)
class Finding:
    """One value that is not what the baseline says; ``what``: worse, better, changed, missing or new.

    before, now: as texts, empty where there is none.  allowed: in words.
    """

    label: str
    column: str
    what: str
    before: str
    now: str
    allowed: str = ""


def measured(table: pd.DataFrame) -> pd.DataFrame:
    """The values of a collected table that a baseline holds: COLUMNS, all as texts.

    Of every cell its outcome and command; of a solved one its quantities, counters, errors against references, and, on
    the finest mesh of a ladder, observed orders.
    """
    derived: dict[str, dict[str, float]] = defaultdict(dict)
    for row in errors(table, reference_rows(table)).to_dict("records"):
        derived[row["label"]][f"{ERROR}{row['quantity']}"] = row["error"]
    for rungs in ladders(table, FEWEST):
        for name in quantities(table):
            order = order_of(list(rungs["size"])[-3:], list(rungs[f"q.{name}"].astype(float))[-3:])
            derived[rungs["label"].iloc[-1]][f"{ORDER}{name}"] = order
    numbers = [str(name) for name in table if str(name).startswith(("q.", "c."))]
    rows: list[tuple[str, str, str]] = []
    for row in table.to_dict("records"):
        label = str(row["label"])
        rows += [(label, COMMAND, str(row[COMMAND])), (label, OUTCOME, str(row[OUTCOME]))]
        if row[OUTCOME] in SOLVED:
            values = {name: float(row[name]) for name in numbers} | derived[label]
            rows += [(label, name, _text(value)) for name, value in values.items() if not math.isnan(value)]
    return pd.DataFrame(rows, columns=list(COLUMNS))


def _text(value: float) -> str:
    """The shortest digits that read back to the number; whole numbers as such, no negative zero."""
    value += 0.0
    return str(int(value)) if math.isfinite(value) and value == int(value) and abs(value) < 2**53 else repr(value)


def compared(before: pd.DataFrame, now: pd.DataFrame, bounds: tuple[Bound, ...]) -> list[Finding]:
    """All differences beyond the bounds, the better ones, too, in the order of the baseline.

    Raises UsageError when a value has no bound, and NothingComparedError when not one cell is in both.
    """
    if not set(before["label"]) & set(now["label"]):
        raise NothingComparedError("zero cells compared: the campaign and the baseline have none in common")
    old, new = (_by_cell(each) for each in (before, now))
    findings: list[Finding] = []
    for label in dict.fromkeys([*old, *new]):
        if label not in new:
            findings.append(Finding(label, "", "missing", old[label][OUTCOME], ""))
        elif label not in old:
            findings.append(Finding(label, "", "new", "", new[label][OUTCOME]))
        elif old[label][OUTCOME] != new[label][OUTCOME]:
            what = "worse" if old[label][OUTCOME] == CONVERGED else "changed"
            findings.append(Finding(label, OUTCOME, what, old[label][OUTCOME], new[label][OUTCOME], "the same"))
        else:
            findings += _compare_cell(label, old[label], new[label], bounds)
    return findings


def _by_cell(values: pd.DataFrame) -> dict[str, dict[str, str]]:
    return {
        str(label): dict(zip(rows["column"], rows["value"], strict=True))
        for label, rows in values.groupby("label", sort=False)
    }


def _compare_cell(label: str, old: dict[str, str], new: dict[str, str], bounds: tuple[Bound, ...]) -> Iterator[Finding]:
    if old[COMMAND] != new[COMMAND]:  # values of another request say nothing
        yield Finding(label, COMMAND, "changed", old[COMMAND], new[COMMAND], "the same")
        return
    judged = {f"q.{name.removeprefix(ERROR)}" for name in old.keys() & new.keys() if name.startswith(ERROR)}
    for column in dict.fromkeys([*old, *new]):
        if column in (OUTCOME, COMMAND) or column in judged:
            continue
        bound = bound_of(bounds, label, column)
        if column not in new or column not in old:
            what = "missing" if column in old else "new"
            yield Finding(label, column, what, old.get(column, ""), new.get(column, ""))
            continue
        a, b = float(old[column]), float(new[column])
        if bound.exceeded(a, b):
            what = "changed" if bound.worse == "either" else "worse"
            yield Finding(label, column, what, old[column], new[column], _words(bound, a))
        elif bound.worse != "either" and abs(b - a) > bound.allowed(a):
            yield Finding(label, column, "better", old[column], new[column], _words(bound, a))


def _words(bound: Bound, before: float) -> str:
    sign = {"up": "+", "down": "-", "either": "±"}[bound.worse]
    return f"{sign}{bound.allowed(before):.3g}"


def check(table: pd.DataFrame, baseline: Path) -> list[Finding]:
    """Findings of a collected table against a baseline file; raises NothingComparedError, or UsageError."""
    if table.empty:
        raise NothingComparedError("zero cells compared: the campaign is empty")
    return compared(read_baseline(baseline), measured(table), read_bounds(baseline.parent / TOLERANCES))


def failures(findings: list[Finding]) -> list[Finding]:
    """Those that fail the check: all but what became better."""
    return [finding for finding in findings if finding.what != "better"]


def update(table: pd.DataFrame, baseline: Path, owner: str, reason: str) -> list[Finding]:
    """Replace the baseline by the table and record it; returns what changed.

    Raises UsageError for an empty table, one with cells the machine has not finished, or one with values that no bound
    covers. Nothing is written then.
    """
    if table.empty:
        raise UsageError("zero cells: an empty campaign is not a baseline")
    unfinished = table[table[OUTCOME].isin(UNFINISHED)]
    if len(unfinished):
        first = unfinished.iloc[0]
        raise UsageError(f"{len(unfinished)} cells are not finished, the first is {first['label']!r}: {first[OUTCOME]}")
    bounds = read_bounds(baseline.parent / TOLERANCES)
    now = measured(table)
    for row in now.itertuples(index=False):
        if row.column not in (OUTCOME, COMMAND):
            bound_of(bounds, str(row.label), str(row.column))
    before = read_baseline(baseline) if baseline.exists() else now.iloc[:0]
    shared = set(before["label"]) & set(now["label"])
    findings = compared(before, now, bounds) if shared else []
    counts = pd.Series([finding.what for finding in findings], dtype=str).value_counts()
    changed = ", ".join(f"{n} {what}" for what, n in counts.items()) if shared else "first baseline"
    write_table(baseline, now)
    record_update(baseline, owner, reason, now, changed or "nothing beyond the bounds")
    return findings


def lines(findings: list[Finding], most: int = 40) -> Iterator[str]:
    """Findings as a table for a terminal, at most so many."""
    if not findings:
        return
    rows = [
        (f.label, f.column or "the cell", f.what, shortened(f.before), shortened(f.now), f.allowed)
        for f in findings[:most]
    ]
    yield from columns([("cell", "column", "what", "baseline", "now", "allowed"), *rows])
    if len(findings) > most:
        yield f"and {len(findings) - most} more"


def shortened(text: str, most: int = 60) -> str:
    """A value for people: eight digits, or so many letters."""
    try:
        return f"{float(text):.8g}"
    except ValueError:
        return text if len(text) <= most else text[: most - 3] + "..."
