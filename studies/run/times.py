"""The timing lane: cells that are known to be right, one at a time, in interleaved rounds, with a canary beside them.

And the repeated times that it leaves in a store.

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

import numpy as np
import pandas as pd
from scipy import sparse
from scipy.sparse.linalg import splu

from studies.ask.scene import UsageError
from studies.output.atomic import SCHEMA, write_json
from studies.output.provenance import machine_of, provenance
from studies.output.stopwatch import timed
from studies.run.archive import Archive, DamagedError, read_file
from studies.run.campaign import Campaign
from studies.run.children import Child
from studies.run.plan import plan, solved_rows
from studies.run.schema import TIMES, fault
from studies.run.task import Limits, Task
from studies.scenes.plugins import used
from studies.solving.result import SOLVED

DRIFT = 0.05  # of the canary, within a block and against the quickest one so far
CONFIDENCE = 0.95


def times_path(store: Path, campaign: str) -> Path:
    """Where the samples of a campaign are kept."""
    return store / "timing" / f"{campaign}.json"


def read_times(store: Path, campaign: str) -> dict[str, Any]:
    """What was kept of a campaign: canaries, rounds of a block, samples, provenance; raises UsageError."""
    try:
        times = read_file(times_path(store, campaign), ("canaries", "rounds", "cells"), lambda data: fault(data, TIMES))
    except DamagedError as error:
        raise UsageError(str(error)) from None
    if times is None:
        raise UsageError(f"{store} has no times of {campaign!r}: run footprint time first")
    return {"provenance": {}, **times}


def interval(samples: Sequence[float]) -> tuple[float, float, float]:
    """Median and its bootstrap interval; of fewer than two samples there is none."""
    if len(samples) < 2:
        return (samples[0] if samples else float("nan")), float("nan"), float("nan")
    if min(samples) == max(samples):
        return samples[0], samples[0], samples[0]
    from scipy.stats import bootstrap  # takes as long to load as all else here

    resampled = bootstrap((np.array(samples),), np.median, confidence_level=CONFIDENCE, method="percentile", rng=2004)
    low, high = resampled.confidence_interval
    return statistics.median(samples), float(low), float(high)


LOOKS = 100  # other programs disturb some of them, a slower machine all


def canary() -> float:
    """Processor time [s] of a fixed workload, a sparse factorisation and small and large products: the least of many.

    By the clock of the cells: of a virtual machine whose host had other work, the least of 100 lay within 3.5 %, by the
    wall clock and of 25 within 15 % (measured).
    """
    n = 100
    line = sparse.diags_array([-1.0, 2.0, -1.0], offsets=(-1, 0, 1), shape=(n, n))
    A = sparse.csc_matrix(sparse.kron(line, sparse.eye_array(n)) + sparse.kron(sparse.eye_array(n), line))
    batch, block = np.ones((1000, 24, 24)), np.ones((300, 300))

    def work() -> None:
        splu(A, permc_spec="MMD_AT_PLUS_A", options={"SymmetricMode": True})
        np.einsum("eij,ejk->eik", batch, batch, optimize=True)
        block @ block

    return min(timed(work)[0] for _ in range(LOOKS))


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
    """Time the cells of a campaign that the store knows to be converged, keep all samples, and return their table.

    Those of cells that are not selected now stay. Raises UsageError when there is none to time, when a cell does not
    end as it did, and when the samples that stay are of another machine.
    """
    archive, rows_of_all = Archive(store), plan(campaign)
    selected = [row for row in rows_of_all if only(row.cell.label)]
    rows = {row.cell.label: (cell_id, row) for cell_id, row in solved_rows(selected)}
    records = {label: archive.record(cell_id) for label, (cell_id, _) in rows.items()}
    right = {label: record for label, record in records.items() if record and record["class"] in SOLVED}
    if not right:
        raise UsageError(f"{store}: no converged cell of {campaign.name!r} to time: run footprint run first")
    others = len(selected) < len(rows_of_all)
    canaries_kept, kept = _kept(store, campaign.name, only) if others else ([], [])
    child = Child()

    def ask(task: Task) -> dict[str, Any]:
        answer = child.ask(task, Limits())
        if answer["class"]:
            raise UsageError(f"{task.id} was solved before, and now: {answer['reason']}")
        return dict(json.loads(answer["text"]))

    def cell(label: str) -> float:
        record = ask(rows[label][1].task(used()))
        return float(record["timing_s"]["cpu"])

    try:
        watch = Stopwatch(child.end, lambda: float(ask(Task("canary", "canary"))["seconds"]), cell)
        shared = shares({label: _spent(record) for label, record in right.items()})
        samples, canaries = sample(shared, watch, BLOCKS, ROUNDS, progress)
    finally:
        child.end()
    with archive.claimed():
        header = {"schema": SCHEMA, "campaign": campaign.name, "provenance": provenance(), "rounds": ROUNDS}
        cells = [{"label": label, "id": rows[label][0], **samples[label]} for label in right]
        data = {**header, "canaries": [*canaries_kept, *canaries], "cells": [*kept, *cells]}
        write_json(times_path(store, campaign.name), data)
    table = summary(store, campaign.name)
    return table[table["label"].isin(list(right))]


def _kept(store: Path, campaign: str, only: Callable[[str], object]) -> tuple[list[Any], list[Any]]:
    """Canaries and cells of the samples that are there, without the selected cells; nothing where no other was timed.

    Raises UsageError where they are of another machine, or of blocks of another length.
    """
    path = times_path(store, campaign)
    if not path.exists():
        return [], []
    times = read_times(store, campaign)
    cells = [cell for cell in times["cells"] if not only(cell["label"])]
    here = machine_of(provenance()), ROUNDS
    if cells and (machine_of(times["provenance"]), times["rounds"]) != here:
        raise UsageError(f"{path} has times of another machine, or of other rounds: time all cells, without --only")
    return (times["canaries"] if cells else []), cells


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
