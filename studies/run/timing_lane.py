"""The timing lane: cells that are known to be right, one at a time, in interleaved rounds, with a canary beside them.

A block is a fresh process: some cells once, cold, then rounds over them. Before and after it a fixed workload is timed,
the canary; when that has moved, so has the machine, and the block is discarded and repeated, not for ever. So many
cells share a block that a machine may be expected to stand still that long. All samples are kept, those of discarded
blocks apart.
"""

from __future__ import annotations

import json
import math
import statistics
from collections import defaultdict
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from typing import Any

import pandas as pd

from studies.ask.scene import UsageError
from studies.output.atomic import SCHEMA, write_json
from studies.output.provenance import provenance
from studies.run.archive import Archive
from studies.run.campaign import Campaign
from studies.run.children import Child
from studies.run.plan import plan, solved_rows
from studies.run.task import Limits, Task
from studies.run.times import DRIFT, interval, read_times, times_path
from studies.scenes.plugins import used
from studies.solving.result import SOLVED

REPEATS = 3  # of a block that was discarded
SHARE = 10.0  # seconds of the solves that share a block, which takes five to ten times as long
BLOCKS, ROUNDS = 2, 4  # eight samples of each cell: the first number that a rank test over many cells can use
COUNTERS = ("dofs", "newton_iterations", "factorisations", "assemblies", "operations")


@dataclass
class Samples:
    """Seconds of each cell by its label: warm of the blocks that count, cold, and of discarded blocks.

    canaries: before and after each block, with whether it counts.
    """

    warm: dict[str, list[float]] = field(default_factory=partial(defaultdict, list))
    cold: dict[str, list[float]] = field(default_factory=partial(defaultdict, list))
    discarded: dict[str, list[float]] = field(default_factory=partial(defaultdict, list))
    canaries: list[tuple[float, float, bool]] = field(default_factory=list)


@dataclass(frozen=True)
class Stopwatch:
    """What is timed: ``block()`` begins a fresh process, then ``canary()`` and ``cell(label)`` give seconds."""

    block: Callable[[], None]
    canary: Callable[[], float]
    cell: Callable[[str], float]


def shares(seconds: Mapping[str, float]) -> list[list[str]]:
    """Cells in their order, with what share a block: at most SHARE of these seconds, or a cell alone."""
    found: list[list[str]] = []
    spent = math.inf
    for label, own in seconds.items():
        if spent + own > SHARE:
            found.append([])
            spent = 0.0
        found[-1].append(label)
        spent += own
    return found


def sample(
    shared: Sequence[Sequence[str]],
    watch: Stopwatch,
    blocks: int = BLOCKS,
    rounds: int = ROUNDS,
    progress: Callable[[int, int, str], None] = lambda done, planned, label: None,
) -> Samples:
    """Interleaved rounds of the cells that share a block, which counts only when the canary has stood still."""
    found, quiet = Samples(), float("inf")
    planned = [(f"block {block + 1}", labels) for block in range(blocks) for labels in shared]
    for done, (name, labels) in enumerate(planned):
        for _ in range(1 + REPEATS):
            watch.block()
            before = watch.canary()
            cold = {label: watch.cell(label) for label in labels}
            warm: dict[str, list[float]] = {label: [] for label in labels}
            for turn in range(rounds):
                progress(done * rounds + turn, len(planned) * rounds, f"{name}, round {turn + 1}")
                for label in labels:
                    warm[label].append(watch.cell(label))
            after = watch.canary()
            quiet = min(quiet, before, after)
            counts = max(before, after) <= (1 + DRIFT) * quiet
            found.canaries.append((before, after, counts))
            for label in labels:
                found.cold[label].append(cold[label])
                (found.warm if counts else found.discarded)[label] += warm[label]
            if counts:
                break
    progress(len(planned) * rounds, len(planned) * rounds, "done")
    return found


def time_campaign(
    campaign: Campaign,
    store: Path,
    only: Callable[[str], object] = lambda label: True,
    blocks: int = BLOCKS,
    rounds: int = ROUNDS,
    progress: Callable[[int, int, str], None] = lambda done, planned, label: None,
    longest: float = math.inf,
) -> pd.DataFrame:
    """Time the cells of a campaign that the store knows to be converged, keep all samples, and return the table.

    longest: processor time [s] of a solve beyond which a cell keeps its single time, which varies least.
    Raises UsageError when there is none, and when a cell does not end as it did.
    """
    archive = Archive(store)
    wanted = [row for row in plan(campaign) if only(row.cell.label)]
    rows = {row.cell.label: (cell_id, row) for cell_id, row in solved_rows(wanted)}
    records = {label: archive.record(cell_id) for label, (cell_id, _) in rows.items()}
    right = {label: record for label, record in records.items() if record and record["class"] in SOLVED}
    right = {label: record for label, record in right.items() if _spent(record) <= longest}
    if not right:
        within = f" within {longest:g} s" if longest < math.inf else ""
        raise UsageError(f"{store}: no converged cell of {campaign.name!r} to time{within}: footprint run comes first")
    child = Child()

    def ask(task: Task) -> dict[str, Any]:
        answer = child.ask(task, Limits())
        if answer["class"]:
            raise UsageError(f"{task.id} was solved before, and now: {answer['reason']}")
        return dict(json.loads(answer["text"]))

    def cell(label: str) -> float:
        told = ask(rows[label][1].task((*used(), *campaign.use)))
        return float(told["timing_s"]["cpu"])

    try:
        watch = Stopwatch(child.end, lambda: float(ask(Task("canary", "canary"))["seconds"]), cell)
        shared = shares({label: _spent(record) for label, record in right.items()})
        found = sample(shared, watch, blocks, rounds, progress)
    finally:
        child.end()
    with archive.claimed():
        _keep(archive, campaign.name, {label: rows[label][0] for label in right}, found, rounds)
    return summary(archive.root, campaign.name)


def _spent(record: Mapping[str, Any]) -> float:
    """Seconds of the solve that made a record, be it on another machine: enough to share out blocks."""
    return float((record.get("merged") or record).get("timing_s", {}).get("cpu", 0.0))


def _keep(archive: Archive, name: str, ids: dict[str, str], found: Samples, rounds: int) -> None:
    told = {"schema": SCHEMA, "campaign": name, "provenance": provenance(), "canaries": found.canaries}
    told["rounds"] = rounds
    cells = [
        {"label": label, "id": cell_id}
        | {kind: getattr(found, kind).get(label, []) for kind in ("warm", "cold", "discarded")}
        for label, cell_id in ids.items()
    ]
    write_json(times_path(archive.root, name), {**told, "cells": cells})


def summary(store: Path, campaign: str) -> pd.DataFrame:
    """label, samples, median_s with its interval low_s to high_s, cold_s, discarded, and the counters of each cell.

    Raises UsageError when the campaign was not timed.
    """
    rows = []
    for cell in read_times(store, campaign)["cells"]:
        record = Archive(store).record(cell["id"])
        counters = record["counters"] if record else {}
        median, low, high = interval(cell["warm"])
        row = {"label": cell["label"], "samples": len(cell["warm"]), "median_s": median, "low_s": low, "high_s": high}
        row |= {"cold_s": statistics.median(cell["cold"]), "discarded": len(cell["discarded"])}
        rows.append(row | {name: counters.get(name) for name in COUNTERS})
    return pd.DataFrame(rows)
