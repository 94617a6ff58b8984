"""Is a cell slower than before, or is it the machine? Samples of the timing lane of two stores, cell by cell.

A cell has become slower when Mann and Whitney's rank test says so after Benjamini and Hochberg's control of false
discoveries over all cells, and its median has moved by more than three times what it moves by itself (the floor of an
A/A comparison of its own samples), and by more than a share that matters.
"""

from __future__ import annotations

from pathlib import Path
from statistics import median
from typing import Any

import numpy as np
import pandas as pd
from scipy.stats import false_discovery_control, mannwhitneyu

from studies.ask.scene import UsageError
from studies.gate.compare import NothingComparedError
from studies.run.times import DRIFT, read_times

FEWEST = 8  # samples a side: 1/C(16, 8) = 7.8e-5 is the first p that survives the control over a hundred cells
SIGNIFICANT = 0.01  # of the adjusted p
FLOORS, SHARE = 3.0, 0.03  # least change of the median: over the floor, and relative
SPLITS, COVER = 400, 0.95  # random halves of a cell's samples, and the quantile of their differences
SEED = 2004
COLUMNS = ("label", "samples", "before_s", "now_s", "change", "floor", "p", "verdict")


def samples_of_both(before: Path, now: Path, campaign: str) -> tuple[pd.DataFrame, pd.DataFrame]:
    """Warm times of the timing lane in two stores, a row a sample: label, seconds, block.

    Raises UsageError without any, and when the canary of one store runs at another speed than the other's.
    """
    times = [read_times(store, campaign) for store in (before, now)]
    sides = tuple(_samples(store, each) for store, each in zip((before, now), times, strict=True))
    quiet = [median(pair[0] for pair in each["canaries"] if pair[2]) for each in times]
    if not abs(quiet[1] / quiet[0] - 1) <= DRIFT:
        raise UsageError(
            f"the canary takes {quiet[1] / quiet[0]:.2f} times as long: another machine, or another state of it"
        )
    return sides[0], sides[1]


def _samples(store: Path, times: dict[str, Any]) -> pd.DataFrame:
    rounds, cells = times["rounds"], times["cells"]
    rows = [(cell["label"], seconds, i // rounds) for cell in cells for i, seconds in enumerate(cell["warm"])]
    if not rows:
        raise UsageError(f"{store}: every block of times was discarded, the machine was not quiet")
    return pd.DataFrame(rows, columns=["label", "seconds", "block"])


def floor_of(samples: np.ndarray, blocks: np.ndarray | None = None) -> float:
    """By how much the median of the same cell moves by itself, relative; samples (n,) in any unit.

    The COVER quantile over random halves, or, if larger, the largest distance between the medians of two ``blocks``
    (n,) that were measured one after the other.
    """
    rng = np.random.default_rng(SEED)
    shuffled = rng.permuted(np.tile(samples, (SPLITS, 1)), axis=1)
    half = len(samples) // 2
    first, second = np.median(shuffled[:, :half], axis=1), np.median(shuffled[:, half:], axis=1)
    floor = float(np.quantile(np.abs(first - second), COVER)) / float(np.median(samples))
    if blocks is None or len(np.unique(blocks)) < 2:
        return floor
    medians = [float(np.median(samples[blocks == block])) for block in np.unique(blocks)]
    return max(floor, (max(medians) - min(medians)) / float(np.median(samples)))


def compare_times(before: pd.DataFrame, now: pd.DataFrame, worse: str = "slower") -> pd.DataFrame:
    """One row a cell of both sides, with COLUMNS; verdict: ``worse``, "same", or "too few samples".

    before, now: a row a sample with ``label``, ``seconds`` > 0 and, if known, ``block``.  worse: "slower" or "faster".
    Raises NothingComparedError when no cell has enough samples on both sides.
    """
    sides = [dict(iter(side.groupby("label", sort=False))) for side in (before, now)]
    rows = [_row(str(label), sides[0][label], sides[1][label], worse) for label in sides[0] if label in sides[1]]
    table = pd.DataFrame(rows, columns=list(COLUMNS[:-1]))
    enough = (table["samples"] >= FEWEST).to_numpy(bool)
    if not enough.any():
        raise NothingComparedError(f"zero cells compared: none has {FEWEST} samples on both sides")
    adjusted = np.full(len(table), np.nan)
    adjusted[enough] = false_discovery_control(table["p"].to_numpy(float)[enough])
    moved = table["change"] if worse == "slower" else -table["change"]
    alarm = (adjusted < SIGNIFICANT) & (moved > FLOORS * table["floor"]) & (moved > SHARE)
    verdict = np.where(~enough, "too few samples", np.where(alarm, worse, "same"))
    return table.assign(p=adjusted, verdict=verdict)


def _row(label: str, before: pd.DataFrame, now: pd.DataFrame, worse: str) -> list[object]:
    a, b = before["seconds"].to_numpy(float), now["seconds"].to_numpy(float)
    n = min(len(a), len(b))
    row = [label, n, np.median(a), np.median(b)]
    if n < FEWEST:
        return [*row, np.nan, np.nan, np.nan]
    floor = max(
        floor_of(s, side["block"].to_numpy() if "block" in side else None) for s, side in ((a, before), (b, now))
    )
    p = mannwhitneyu(b, a, alternative="greater" if worse == "slower" else "less").pvalue
    return [*row, np.median(b) / np.median(a) - 1, floor, float(p)]
