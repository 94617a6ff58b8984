"""Powers: of strains over small motions, of errors over epsilon and meshes, of laws of a material over the strain.

A law that is linear in Green's strain has to first order S = E (e - k e^2): the strain of a membrane under a given load
differs by k e of itself, k = 3 between St. Venant-Kirchhoff and Hencky (:mod:`formulations.section.laws`). In bending
the two sides of the wall cancel that. Errors of manufactured solutions are known: nothing has to be extrapolated.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from itertools import pairwise

import numpy as np
import pandas as pd

from studies.experiments.epsilon import CASES, wall
from studies.solving.refinement.richardson import power_of
from studies.solving.result import SOLVED

NOTHING_LEFT = 1e-12  # a strain below this is rounding
STRAIGHT = 0.05  # local slopes this close to -1 belong to the law
LEVEL = 1e-12  # error of the force below which nothing but rounding is left
TEN = 10.0  # times E/h
REFERENCE, OTHER = "svk", "hencky"
ONE_PERCENT = 0.01
MOTION = ("measure", "surface", "motion")
POWER_COLUMNS = (*MOTION, "strain_rate", "strain_coefficient")
LAW_COLUMNS = (
    *("case", "wall", "element_over_h", "force_slope"),
    *("error_at_wall", "growth_at_wall", "growth_at_ten", "fails_at"),
)


def rigid_body_powers(small_motions: pd.DataFrame) -> pd.DataFrame:
    """POWER_COLUMNS, a row a motion of a surface; NaN where a strain is nothing but rounding.

    small_motions: of studies.experiments.rigid_body.
    """
    rows = []
    for key, group in small_motions.groupby(list(MOTION), sort=False):
        rows.append((*key, *fitted_power(list(group["amount"]), list(group["strain"]))))
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


def law_rules(study: pd.DataFrame) -> pd.DataFrame:
    """A row for each specimen: factor, the largest change of the value from Hencky's law to St. Venant-Kirchhoff's over
    the strain with the latter, and percent_at, the strain at which that makes 1 %; NaN beyond those reached.
    """
    own, other = (study[study["law"] == law].reset_index(drop=True) for law in (REFERENCE, OTHER))
    if not other[["specimen", "load"]].equals(own[["specimen", "load"]]):
        raise ValueError(f"the loads with {OTHER} are not those with {REFERENCE}")
    own = own.assign(factor=(own["value"] / other["value"] - 1).abs() / own["strain"])
    rows = []
    for (specimen, carries), each in own.groupby(["specimen", "carries"], sort=False):
        factor, least, largest = each["factor"].max(), each["strain"].min(), each["strain"].max()
        at = ONE_PERCENT / factor if ONE_PERCENT / factor <= largest else math.nan
        row = {"specimen": specimen, "carries": carries, "least_strain": least, "largest_strain": largest}
        rows.append({**row, "factor": factor, "percent_at": at})
    return pd.DataFrame(rows)


THEORY: Mapping[str, float] = {  # of bilinear displacements with the strains of the mixed element
    "error_displacement": 2.0,
    "error_resultants": 1.0,
    "error_mean_resultants": 2.0,
    "error_energy": 1.0,
}
CASE = ("group", "measure", "surface", "element", "settings")
NEAR = 0.1  # of an order to the theory, in displacements
MEANS, BELOW = (
    "error_mean_resultants",
    0.05,
)  # orders this far below the theory are those of a coarse mesh, if they rise


def orders(data: pd.DataFrame, case: Sequence[str], errors: Sequence[str]) -> pd.DataFrame:
    """A row a case: the order of each error between its two finest meshes, and the error on the finest.

    ``change_``: what each order has changed by from the pair of meshes before; NaN without one.
    """
    rows = []
    for key, group in data.groupby(list(case), sort=False, dropna=False):
        own = group.sort_values("n")
        slopes_of = {name: _slopes(own["n"].to_numpy(float), own[name].to_numpy(float)) for name in errors}
        last = {name.replace("error_", "order_"): slopes[-1] for name, slopes in slopes_of.items()}
        changes = {
            name.replace("error_", "change_"): slopes[-1] - slopes[-2] if len(slopes) > 1 else np.nan
            for name, slopes in slopes_of.items()
        }
        finest = {name: float(own[name].iloc[-1]) for name in errors}
        rows.append(dict(zip(case, key, strict=True)) | last | changes | finest | {"n": own["n"].iloc[-1]})
    return pd.DataFrame(rows)


def _slopes(n: np.ndarray, error: np.ndarray) -> list[float]:
    pairs = pairwise(zip(n, error, strict=True))
    return [float(np.log(e / f) / np.log(m / k)) if e > 0 and f > 0 else np.nan for (k, e), (m, f) in pairs]


def manufactured_orders(data: pd.DataFrame) -> pd.DataFrame:
    """The orders of all cases; near: whether that of displacements is within NEAR of the theory, and all converged.

    coarse: whether the order of the means is more than BELOW below the theory; rising: and has risen.
    """
    named = data.assign(settings=data["settings"].astype(object).where(data["settings"].notna(), ""))
    fitted = orders(named, CASE, tuple(THEORY))
    solved = [bool(own["class"].isin(SOLVED).all()) for _, own in named.groupby(list(CASE), sort=False)]
    off = (fitted["order_displacement"] - THEORY["error_displacement"]).abs()
    coarse = fitted["order_mean_resultants"] < THEORY[MEANS] - BELOW
    rising = coarse & (fitted["change_mean_resultants"] > 0)
    return fitted.assign(near=(off <= NEAR) & pd.Series(solved), coarse=coarse, rising=rising)


def distortion_orders(data: pd.DataFrame) -> pd.DataFrame:
    """The orders of all measures and distortions on meshes of quadrilaterals.

    times: error of the displacement on the finest mesh over that of the same mesh whose nodes stay.
    """
    fitted = orders(data, ("measure", "distortion", "amount"), tuple(THEORY))
    still = fitted[fitted["amount"] == 0].set_index("measure")["error_displacement"]
    return fitted.assign(times=fitted["error_displacement"] / fitted["measure"].map(still))


def contact_orders(data: pd.DataFrame) -> pd.DataFrame:
    """The orders with contact, for every measure, surface and radius.

    The edge lies anywhere within an element, so that errors jump from mesh to mesh: orders of displacement, pressure
    and edge are slopes of straight lines through all meshes, in logarithms. edge_elements: the error of the edge over
    the size of the finest elements.
    """
    case = ["measure", "surface", "radius"]
    fitted = orders(data, case, tuple(THEORY))
    groups = [own.sort_values("n") for _, own in data.groupby(case, sort=False)]
    for name in ("error_displacement", "error_pressure", "error_edge"):
        slopes = [-power_of(own["n"], own[name]) for own in groups]
        finest = [float(own[name].iloc[-1]) for own in groups]
        fitted = fitted.assign(**{name.replace("error_", "order_"): slopes, name: finest})
    return fitted.assign(edge_elements=fitted["error_edge"] * fitted["radius"] * fitted["n"] / 2)
