"""Performance profiles (Dolan and More): how often is who within a factor of the best; and medians of ratios."""

from __future__ import annotations

import numpy as np
import pandas as pd

from studies.ask.request import Request
from studies.ask.settings import settings_of

SEED, RESAMPLES, COVER = 2004, 999, 0.95
FEWEST = 5  # problems that a ratio needs


def problem_of(request: Request, axis: str) -> str:
    """All that was asked but the axis; an algorithm whose own parameters are not its defaults is another one."""
    usual = [own.key for own in settings_of(request.contact) if request.settings.get(own.key) == own.default]
    return request.key((axis, "epsilon", *usual))


def within(matrix: pd.DataFrame, factors: tuple[float, ...]) -> pd.DataFrame:
    """Share of the problems in which each competitor needs at most so many times what the best one needs."""
    best = matrix.min(axis=1)
    ratios = matrix.div(best.where(best > 0, 1.0), axis=0)  # a cost of nothing is its own best
    return pd.DataFrame([(ratios <= factor).mean() for factor in factors])


def median_ratio(ratios: np.ndarray, scenes: np.ndarray) -> tuple[float, float, float]:
    """Median with its bootstrap interval; problems of one scene are alike, so scenes are drawn, not problems.

    NaN for what there is too little of: ratios, or a second scene.
    """
    if len(ratios) == 0:
        return np.nan, np.nan, np.nan
    groups = [ratios[scenes == name] for name in dict.fromkeys(scenes)]
    if len(groups) < 2:
        return float(np.median(ratios)), np.nan, np.nan
    drawn = np.random.default_rng(SEED).integers(len(groups), size=(RESAMPLES, len(groups)))
    medians = [np.median(np.concatenate([groups[i] for i in row])) for row in drawn]
    low, high = np.quantile(medians, [(1 - COVER) / 2, (1 + COVER) / 2])
    return float(np.median(ratios)), float(low), float(high)
