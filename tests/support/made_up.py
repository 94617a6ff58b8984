"""Stores that are made up: their tables made again after a change."""

from __future__ import annotations

from pathlib import Path

from studies.analysis.collect import collect
from studies.analysis.everything import compared, written


def analysed_again(store: Path, campaign: str = "report") -> None:
    """Write the tables of comparisons, as ``footprint analyse`` does."""
    written(store, campaign, compared(store, campaign, collect(store, campaign)))
