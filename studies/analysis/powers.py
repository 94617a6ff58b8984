"""Powers of what grows or falls as one: strains over small motions, errors over epsilon, laws over the largest strain.

A law that is linear in Green's strain has to first order S = E (e - k e^2): the strain of a membrane under a given load
differs by k e of itself, k = 3 between St. Venant-Kirchhoff and Hencky (:mod:`formulations.solid.laws`). In bending the
two sides of the wall cancel that.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
import pandas as pd

from studies.experiments.epsilon import CASES, wall
from studies.solving.refinement.richardson import power_of

NOTHING_LEFT = 1e-12  # a strain below this is rounding
STRAIGHT = 0.05  # local slopes this close to -1 belong to the law
LEVEL = 1e-12  # error of the force below which nothing but rounding is left
TEN = 10.0  # times E/h
REFERENCE, OTHERS = "svk", {"hencky": "off_hencky", "neo-hooke": "off_neo_hooke"}
ONE_PERCENT = 0.01
SPAN = 2.0  # largest over least strain from which on a power is fitted
MOTION = ("measure", "surface", "motion")
STRAINS = ("strain", "declared", "largest")
POWER_COLUMNS = (*MOTION, *(f"{name}_{part}" for name in STRAINS for part in ("rate", "coefficient")), "told")
LAW_COLUMNS = (
    *("case", "wall", "element_over_h", "force_slope"),
    *("error_at_wall", "growth_at_wall", "growth_at_ten", "fails_at"),
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


def epsilon_laws(study: pd.DataFrame) -> pd.DataFrame:
    """LAW_COLUMNS, a row a case: what ε = E/h gives a penalty method, and what it costs the matrix.

    study: of studies.experiments.epsilon.  wall: E/h [MPa/mm], with the largest modulus of the wall.  force_slope: of
    the error over epsilon.  error_at_wall: of the force, by the displacement form.  growth_*: its
    condition over that of exact contact, at E/h and at TEN times as much.  fails_at: the smallest epsilon with which
    the displacement form does not reach the tolerance, over E/h; NaN where it always does.
    """
    walls = {case.label: wall(case) for case in CASES}
    rows = [(case, *_laws(own, *walls[str(case)])) for case, own in study.groupby("case", sort=False)]
    return pd.DataFrame(rows, columns=list(LAW_COLUMNS))


def _laws(own: pd.DataFrame, modulus: float, thickness: float, side: float) -> tuple[float, ...]:
    multiplier = own[(own["form"] == "multiplier") & np.isfinite(own["epsilon"])]
    exact = own.loc[~np.isfinite(own["epsilon"]), "condition"]
    displacement = own[own["form"] == "displacement"].sort_values("epsilon")
    stiff = modulus / thickness
    fails_at = displacement.loc[displacement["outcome"] != "converged", "epsilon"].min() / stiff
    error = _between(displacement, displacement["force_error"].abs(), stiff)
    growths = (_between(displacement, displacement["condition"], at * stiff) / exact.iloc[0] for at in (1.0, TEN))
    slope = fitted_law(multiplier["epsilon"], multiplier["force_error"])
    return (stiff, side / thickness, slope, error, *growths, float(fails_at))


def _between(own: pd.DataFrame, value: pd.Series, at: float) -> float:
    """At an epsilon between those that were solved, along straight lines in logarithms."""
    return float(np.exp(np.interp(math.log(at), np.log(own["epsilon"]), np.log(value))))


def fitted_law(epsilon: pd.Series, value: pd.Series) -> float:
    """Least-squares slope over the longest run of epsilons over which the local slope is -1; NaN without one.

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
        return math.nan
    own = slice(last - length, last + 1)
    return float(np.polyfit(x[own], np.log10(y[own]), 1)[0])


def law_offsets(study: pd.DataFrame) -> pd.DataFrame:
    """A row for each specimen and load: value and strain with svk, off_hencky, off_neo_hooke and factor.

    off: of the value with svk over that with the other law, less 1; factor: |off_hencky| over the strain.
    """
    own = study[study["law"] == REFERENCE].drop(columns="law").reset_index(drop=True)
    for law, column in OTHERS.items():
        other = study[study["law"] == law].reset_index(drop=True)
        if not other[["specimen", "load"]].equals(own[["specimen", "load"]]):
            raise ValueError(f"the loads with {law} are not those with {REFERENCE}")
        own[column] = own["value"] / other["value"] - 1
    return own.assign(factor=own["off_hencky"].abs() / own["strain"])


def law_rules(study: pd.DataFrame) -> pd.DataFrame:
    """A row for each specimen: factor, its largest; percent_at, the strain at which that makes 1 %; power, fitted.

    percent_at: NaN beyond the strains that were reached.  power: of |off_hencky| over the strain, by least squares; NaN
    where strains span less than a factor of two.
    """
    rows = []
    for _, own in law_offsets(study).groupby("specimen", sort=False):
        factor = float(own["factor"].max())
        row = {name: own[name].iloc[0] for name in ("specimen", "carries", "quantity")}
        least, largest = float(own["strain"].min()), float(own["strain"].max())
        at = ONE_PERCENT / factor if ONE_PERCENT / factor <= largest else math.nan
        row |= {"least_strain": least, "largest_strain": largest, "factor": factor, "percent_at": at}
        rows.append(
            {**row, "power": power_of(own["strain"], own["off_hencky"]) if largest >= SPAN * least else math.nan}
        )
    return pd.DataFrame(rows)
