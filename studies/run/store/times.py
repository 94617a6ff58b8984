"""Repeated times of the cells of a campaign, as the timing lane leaves them in a store: read, and their medians.

What is timed, and how often, is the business of :mod:`studies.run.timing_lane`.
"""

from __future__ import annotations

import statistics
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from scipy.stats import bootstrap

from contact.interchange.untrusted import read_json
from studies.ask.request import UsageError
from studies.run.store.schema import TIMES, fault

DRIFT = 0.05  # of the canary, within a block and against the quickest one so far
CONFIDENCE = 0.95


def times_path(store: Path, campaign: str) -> Path:
    """Where the samples of a campaign are kept."""
    return store / "timing" / f"{campaign}.json"


def read_times(store: Path, campaign: str) -> dict[str, Any]:
    """What was kept of a campaign: canaries, rounds of a block, samples, provenance; raises UsageError."""
    path = times_path(store, campaign)
    try:
        found = read_json(path)
        told = {key: found[key] for key in ("canaries", "rounds", "cells")}
        told["provenance"] = found.get("provenance") or {}
    except FileNotFoundError:
        raise UsageError(f"{store} has no times of {campaign!r}: footprint time makes them") from None
    except (OSError, ValueError, KeyError, TypeError, AttributeError) as error:
        raise UsageError(f"{path} cannot be read: {' '.join(str(error).split())}") from None
    if wrong := fault(told, TIMES):
        raise UsageError(f"{path} cannot be read: {wrong}")
    return told


def interval(samples: Sequence[float]) -> tuple[float, float, float]:
    """Median and its bootstrap interval; of fewer than two samples there is none."""
    if len(samples) < 2:
        return (samples[0] if samples else float("nan")), float("nan"), float("nan")
    if min(samples) == max(samples):
        return samples[0], samples[0], samples[0]
    found = bootstrap((np.array(samples),), np.median, confidence_level=CONFIDENCE, method="percentile", rng=2004)
    low, high = found.confidence_interval
    return statistics.median(samples), float(low), float(high)
