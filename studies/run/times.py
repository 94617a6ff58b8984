"""The canary, and repeated times of the cells of a campaign, as the timing lane leaves them in a store.

What is timed, and how often, is the business of :mod:`studies.run.timing_lane`.
"""

from __future__ import annotations

import statistics
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from scipy import sparse
from scipy.sparse.linalg import splu

from studies.ask.request import UsageError
from studies.output.stopwatch import timed
from studies.run.archive import DamagedError, read_file
from studies.run.schema import TIMES, fault

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
        raise UsageError(f"{store} has no times of {campaign!r}: footprint time makes them")
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
