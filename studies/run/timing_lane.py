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
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
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
Samples = dict[str, dict[str, list[float]]]  # seconds by label: warm of blocks that count, cold, of discarded ones
COUNTERS = ("dofs", "newton_iterations", "factorisations", "assemblies", "operations")


@dataclass(frozen=True)
class Stopwatch:
    """What is timed: ``block()`` begins a fresh process, then ``canary()`` and ``cell(label)`` give seconds."""

    block: Callable[[], None]
    canary: Callable[[], float]
    cell: Callable[[str], float]


def shares(seconds: Mapping[str, float]) -> list[list[str]]:
    """Cells in their order, with what share a block: at most SHARE of these seconds, or a cell alone."""
    blocks: list[list[str]] = []
    spent = math.inf
    for label, own in seconds.items():
        if spent + own > SHARE:
            blocks.append([])
            spent = 0.0
        blocks[-1].append(label)
        spent += own
    return blocks


def sample(
    shared: Sequence[Sequence[str]],
    watch: Stopwatch,
    blocks: int,
    rounds: int,
    progress: Callable[[int, int, str], None] = lambda done, planned, label: None,
) -> tuple[Samples, list[tuple[float, float, bool]]]:
    """Interleaved rounds of the cells that share a block, which counts only when the canary has stood still.

    Returns the samples of each cell, and the canaries before and after each block with whether it counts.
    """
    samples: Samples = {label: {"warm": [], "cold": [], "discarded": []} for labels in shared for label in labels}
    canaries, quiet = list[tuple[float, float, bool]](), math.inf
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
            canaries.append((before, after, counts))
            for label in labels:
                samples[label]["cold"].append(cold[label])
                samples[label]["warm" if counts else "discarded"] += warm[label]
            if counts:
                break
    progress(len(planned) * rounds, len(planned) * rounds, "done")
    return samples, canaries


def time_campaign(
    campaign: Campaign,
    store: Path,
    only: Callable[[str], object] = lambda label: True,
    progress: Callable[[int, int, str], None] = lambda done, planned, label: None,
) -> pd.DataFrame:
    """Time the cells of a campaign that the store knows to be converged, keep all samples, and return the table.

    Raises UsageError when there is none, and when a cell does not end as it did.
    """
    archive = Archive(store)
    selected = [row for row in plan(campaign) if only(row.cell.label)]
    rows = {row.cell.label: (cell_id, row) for cell_id, row in solved_rows(selected)}
    records = {label: archive.record(cell_id) for label, (cell_id, _) in rows.items()}
    right = {label: record for label, record in records.items() if record and record["class"] in SOLVED}
    if not right:
        raise UsageError(f"{store}: no converged cell of {campaign.name!r} to time: footprint run comes first")
    child = Child()

    def ask(task: Task) -> dict[str, Any]:
        answer = child.ask(task, Limits())
        if answer["class"]:
            raise UsageError(f"{task.id} was solved before, and now: {answer['reason']}")
        return dict(json.loads(answer["text"]))

    def cell(label: str) -> float:
        record = ask(rows[label][1].task((*used(), *campaign.use)))
        return float(record["timing_s"]["cpu"])

    try:
        watch = Stopwatch(child.end, lambda: float(ask(Task("canary", "canary"))["seconds"]), cell)
        shared = shares({label: _spent(record) for label, record in right.items()})
        samples, canaries = sample(shared, watch, BLOCKS, ROUNDS, progress)
    finally:
        child.end()
    with archive.claimed():
        header = {"schema": SCHEMA, "campaign": campaign.name, "provenance": provenance(), "canaries": canaries}
        cells = [{"label": label, "id": rows[label][0], **samples[label]} for label in right]
        write_json(times_path(store, campaign.name), {**header, "rounds": ROUNDS, "cells": cells})
    return summary(store, campaign.name)


def _spent(record: Mapping[str, Any]) -> float:
    """Seconds of the solve that made a record, be it on another machine: enough to share out blocks."""
    return float((record.get("merged") or record).get("timing_s", {}).get("cpu", 0.0))


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
