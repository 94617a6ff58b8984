"""Powers fitted to what grows or falls as one: strains over small motions, errors over epsilon, times over unknowns."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
import pandas as pd

from studies.analysis.richardson import MeshSequence

NOTHING_LEFT = 1e-12  # a strain below this is rounding
STRAIGHT = 0.05  # local slopes this close to -1 belong to the law
SOFT = 0.01  # error of the force above which epsilon is too soft
LEVEL = 1e-12  # error of the force below which nothing but rounding is left
MOTION = ("measure", "surface", "motion")
STRAINS = ("strain", "declared", "largest")
POWER_COLUMNS = (*MOTION, *(f"{name}_{part}" for name in STRAINS for part in ("rate", "coefficient")), "told")
LAW_COLUMNS = (
    "case",
    *(f"{what}_{part}" for what in ("penetration", "force") for part in ("slope", "low", "high")),
    *("soft_until", "level_from", "breaks_at", "best", "best_error"),
)


def rigid_body_powers(small_motions: pd.DataFrame) -> pd.DataFrame:
    """POWER_COLUMNS, a row a motion of a surface; NaN where a strain is nothing but rounding.  told: a law is declared.

    small_motions: of studies.experiments.rigid_body.
    """
    rows = []
    for key, group in small_motions.groupby(list(MOTION), sort=False):
        amounts = list(group["amount"])
        found = (number for name in STRAINS for number in fitted_power(amounts, list(group[name])))
        rows.append((*key, *found, bool(group["declared"].notna().all())))
    return pd.DataFrame(rows, columns=list(POWER_COLUMNS))


def fitted_power(amounts: Sequence[float], strains: Sequence[float]) -> tuple[float, float]:
    """Rate n and coefficient of the smallest motions; NaN where a strain is nothing but rounding or changes its sign.

    The rate is the slope between the two smallest amounts; the coefficient is c(a) = strain/a^n with n the nearest
    whole number, its error of order a^2 extrapolated away.
    """
    (a, small), (b, large) = sorted(zip(amounts, strains, strict=True))[:2]
    if not min(abs(small), abs(large)) > NOTHING_LEFT or large / small <= 0:  # NaN is not above it either
        return math.nan, math.nan
    rate = math.log(large / small) / math.log(b / a)
    n = round(rate)
    low, high = small / a**n, large / b**n
    return rate, low + (low - high) / ((b / a) ** 2 - 1)


def curved_beam_limits(curved_beam: pd.DataFrame) -> pd.DataFrame:
    """Columns h_over_R, order, limit: of the ratio over all meshes.  curved_beam: of studies.experiments.locking."""
    rows = []
    for h, own in curved_beam.sort_values("elements").groupby("h_over_R", sort=False):
        sequence = MeshSequence(tuple(1 / own["elements"]), tuple(own["ratio"]))
        rows.append((h, sequence.orders[-1], sequence.limit))
    return pd.DataFrame(rows, columns=["h_over_R", "order", "limit"])


def epsilon_laws(study: pd.DataFrame) -> pd.DataFrame:
    """LAW_COLUMNS, a row a case: the slopes, and where epsilon is too soft, as good as exact, and breaks down.

    study: of studies.experiments.epsilon.  *_low, *_high: the epsilons over which a slope was fitted.  best: of the
    displacement form, with its error of the force.
    """
    return pd.DataFrame(
        [(case, *_laws(own)) for case, own in study.groupby("case", sort=False)], columns=list(LAW_COLUMNS)
    )


def _laws(own: pd.DataFrame) -> tuple[float, ...]:
    multiplier = own[(own["form"] == "multiplier") & np.isfinite(own["epsilon"])]
    displacement = own[own["form"] == "displacement"]
    error = multiplier["force_error"].abs()
    soft, level = multiplier["epsilon"][error > SOFT], multiplier["epsilon"][error > LEVEL]
    after = multiplier["epsilon"][multiplier["epsilon"] > (level.max() if len(level) else 0.0)]
    broken = displacement["epsilon"][displacement["outcome"] != "converged"]
    converged = displacement[displacement["outcome"] == "converged"]
    best = converged.iloc[int(converged["force_error"].abs().argmin())]
    laws = (fitted_law(multiplier["epsilon"], multiplier[name]) for name in ("penetration_mm", "force_error"))
    limits = (soft.max(), after.min(), broken.min(), best["epsilon"], abs(best["force_error"]))
    return (*(number for law in laws for number in law), *map(float, limits))


def fitted_law(epsilon: pd.Series, value: pd.Series) -> tuple[float, float, float]:
    """Least-squares slope, and between which epsilons: the longest run over which the local slope is -1; NaN without.

    Values that rounding makes, LEVEL and less, do not count.
    """
    x, y = np.log10(epsilon.to_numpy(float)), value.abs().to_numpy(float)
    y = np.where(y > LEVEL, y, np.nan)
    with np.errstate(divide="ignore", invalid="ignore"):
        straight = np.abs(np.diff(np.log10(y)) / np.diff(x) + 1) <= STRAIGHT
    best, run = (0, 0), 0
    for i, good in enumerate(straight):
        run = run + 1 if good else 0
        best = max(best, (run, i + 1))
    length, last = best
    if length == 0:
        return math.nan, math.nan, math.nan
    own = slice(last - length, last + 1)
    return float(np.polyfit(x[own], np.log10(y[own]), 1)[0]), float(10 ** x[own][0]), float(10 ** x[own][-1])
