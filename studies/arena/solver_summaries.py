"""Summaries of a solver table: shares, false claims, means that include failures, profiles, and rank correlation.

An answer is a solution when it is claimed and as accurate as required. All others are failures: not claimed, claimed
falsely, killed at the limit, or refused by a solver that accepts other problems of the kind.
Sources: Dolan, Moré, Math. Program. 91 (2002) 201-213 (performance profiles); Moré, Wild, SIAM J. Optim. 20 (2009)
172-191 (data profiles); Achterberg, Constraint integer programming (2007), appendix A.3 (shifted geometric means).
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from typing import Literal

import numpy as np
import pandas as pd

from studies.arena.solver_table import KILLED

SHIFT_S = 0.01  # time of a small problem: times far below it, mostly calls of Python, count as equal
FACTORS = tuple(float(f"{10 ** (i / 4):.3g}") for i in range(13))  # of the time of the quickest, up to 1000
BUDGETS = tuple(float(f"{10 ** (i / 4):.3g}") for i in range(17))  # factorisations of K, up to 10,000
SIZES = {"small": (0, 1_000), "medium": (1_000, 10_000), "large": (10_000, np.inf)}  # unknowns
SUMMARY_COLUMNS = (
    *("tolerance", "kind", "size", "solver", "problems", "refused", "timed_out", "claimed", "solved"),
    *("solved_share", "false", "false_tenfold", "false_own", "worst_claim", "mean_s", "failed_at_limit"),
    *("memory_MB", "iterations", "why_not"),
)
PROFILE_COLUMNS = ("tolerance", "kind", "size", "solver", "problems", "of", "at", "share")
ALIKE: tuple[Literal["spearman", "kendall"], ...] = ("spearman", "kendall")
RANK_COLUMNS = ("tolerance", "kind", "problems", "solvers", *ALIKE)
ALL, TENFOLD = "all", 10.0
Shares = Callable[[pd.DataFrame, pd.Series], pd.DataFrame]  # times and unit of the problems -> point x solver


def within(matrix: pd.DataFrame, factors: tuple[float, ...]) -> pd.DataFrame:
    """Share of the problems in which each competitor is within a factor of the best one."""
    best = matrix.min(axis=1)
    ratios = matrix.div(best.where(best > 0, 1.0), axis=0)  # a cost of zero is the best
    return pd.DataFrame([(ratios <= factor).mean() for factor in factors])


def summary(table: pd.DataFrame, limit_s: float) -> pd.DataFrame:
    """One row per solver and tolerance, for each kind and size and for all sizes of a kind: SUMMARY_COLUMNS.

    refused: not run, most often for the reason ``why_not``.  timed_out: killed at the limit.  false: claims less
    accurate than required; false_tenfold: by more than ten times; false_own: that violate even the solver's own
    criterion.  worst_claim: accuracy of the worst claim over the tolerance.  mean_s: see :func:`shifted_mean`, with the
    limit for each of ``failed_at_limit``.  memory_MB, iterations: medians of the solves that were run.
    """
    rows = [
        (*place, solver, *_summed(own, limit_s))
        for place, every in _sized(table)
        for solver, own in every.groupby("solver", sort=False)
    ]
    return pd.DataFrame(rows, columns=list(SUMMARY_COLUMNS))


def _summed(own: pd.DataFrame, limit_s: float) -> tuple[object, ...]:
    asked, solved = own["asked"].astype(bool), solves(own)
    claims = own[own["claimed"].astype(bool)]
    excess = claims["accuracy"].astype(float) / claims["tolerance"]
    own_false = int((claims["kept"] == False).sum())  # noqa: E712  None where a solver has no criterion of its own
    reasons = own.loc[~asked, "reason"].mode()
    return (
        *(len(own), int((~asked).sum()), int(own["reason"].str.startswith(KILLED).sum())),
        *(len(claims), int(solved.sum()), float(solved.mean())),
        *(int(own["false"].sum()), int((excess > TENFOLD).sum()), own_false, float(excess.max())),
        *(shifted_mean(priced(own, limit_s)), int((~solved).sum())),
        *(own.loc[asked, "memory_MB"].astype(float).median(), own.loc[asked, "iterations"].astype(float).median()),
        reasons.iloc[0] if len(reasons) else "",
    )


def solves(table: pd.DataFrame) -> pd.Series:
    """Which rows are solutions: claimed, and as accurate as required in every round."""
    return table["claimed"].astype(bool) & (table["accuracy"].astype(float) <= table["tolerance"])


def priced(table: pd.DataFrame, limit_s: float) -> np.ndarray:
    """Seconds of each row, the limit for a failure."""
    return np.where(solves(table), np.minimum(table["seconds"].astype(float), limit_s), limit_s)


def shifted_mean(seconds: Iterable[float], shift: float = SHIFT_S) -> float:
    """exp(mean log(t + s)) - s [s]."""
    return float(np.exp(np.mean(np.log(np.asarray(list(seconds)) + shift))) - shift)


def performance_profiles(table: pd.DataFrame, factors: Sequence[float] = FACTORS) -> pd.DataFrame:
    """Share of the problems that a solver solves within a factor of the quickest one's time: PROFILE_COLUMNS."""
    return _profiles(table, "the quickest", lambda times, unit: within(times, tuple(factors)), factors)


def data_profiles(table: pd.DataFrame, budgets: Sequence[float] = BUDGETS) -> pd.DataFrame:
    """Share of the problems solved within so many times of a factorisation of their K: PROFILE_COLUMNS."""

    def shares(times: pd.DataFrame, unit: pd.Series) -> pd.DataFrame:
        return pd.DataFrame([(times.div(unit, axis=0) <= budget).mean() for budget in budgets])

    return _profiles(table, "a factorisation", shares, budgets)


def _profiles(table: pd.DataFrame, of: str, shares: Shares, points: Sequence[float]) -> pd.DataFrame:
    """Of times (problems, solvers), infinite for failures: problems that no solver solves count for all of them."""
    priced_rows = table.assign(cost=table["seconds"].astype(float).where(solves(table), np.inf))
    rows: list[tuple[object, ...]] = []
    for place, own in _sized(priced_rows):
        times = own.pivot_table(index="problem", columns="solver", values="cost", sort=False)
        unit = own.groupby("problem")["factorisation_s"].first()
        curves = shares(times, unit)
        rows += [
            (*place, name, len(times), of, point, float(share))
            for name in times
            for point, share in zip(points, curves[name], strict=True)
        ]
    return pd.DataFrame(rows, columns=list(PROFILE_COLUMNS))


def _sized(table: pd.DataFrame) -> Iterator[tuple[tuple[object, ...], pd.DataFrame]]:
    """Rows by tolerance, kind and size: all sizes of a kind, then each that is present."""
    for (tolerance, kind), rows in table.groupby(["tolerance", "kind"], sort=False):
        yield (tolerance, kind, ALL), rows
        for size, (low, up) in SIZES.items():
            own = rows[(rows["unknowns"] >= low) & (rows["unknowns"] < up)]
            if len(own):
                yield (tolerance, kind, size), own


def ranking(table: pd.DataFrame, limit_s: float) -> pd.Series:
    """Rank of each solver by its shifted mean, 1 the best, ties in the middle; by tolerance, kind and solver.

    A solver that is not installed, or refuses a whole kind, has no rank in it.
    """
    whole = summary(table, limit_s)
    whole = whole[(whole["size"] == ALL) & (whole["refused"] < whole["problems"])]
    places = whole.set_index(["tolerance", "kind", "solver"])["mean_s"]
    return places.groupby(level=["tolerance", "kind"]).rank()


def rank_correlation(first: pd.DataFrame, second: pd.DataFrame, limit_s: float) -> pd.DataFrame:
    """Spearman's and Kendall's of the rankings of two runs by tolerance and kind: RANK_COLUMNS.

    Of the ``solvers`` and on the ``problems`` that both runs have; NaN where fewer than two solvers are
    ranked, or all of a run alike.
    """
    shared = set(first["problem"]) & set(second["problem"])
    one, other = (run[run["problem"].isin(shared)] for run in (first, second))
    both = pd.concat({"one": ranking(one, limit_s), "other": ranking(other, limit_s)}, axis=1).dropna()
    rows = []
    for (tolerance, kind), ranks in both.groupby(level=["tolerance", "kind"]):
        problems = one.loc[(one["tolerance"] == tolerance) & (one["kind"] == kind), "problem"].nunique()
        alike = (float(ranks.corr(method=how).to_numpy()[0, 1]) for how in ALIKE)
        rows.append((tolerance, kind, problems, len(ranks), *alike))
    return pd.DataFrame(rows, columns=list(RANK_COLUMNS))


def effects(summed: pd.DataFrame) -> pd.DataFrame:
    """What each setting changes against the defaults of the same scale: a row per tolerance, kind, size and variant.

    summed: of :func:`summary`.  time_ratio: of the shifted means, below 1 where the
    setting is quicker.  more_solved, more_false: of the number of problems.
    """
    places = ["tolerance", "kind", "size", "scale"]
    scale, setting = (summed["solver"].str.split(": ", n=1).str[i] for i in (0, 1))
    table = summed.assign(scale=scale, setting=setting)
    table = table[[*places, "setting", "problems", "mean_s", "solved", "false"]]
    defaults = table[table["setting"] == "defaults"].drop(columns=["setting", "problems"])
    merged = table.merge(defaults, on=places, suffixes=("", "_default"))
    merged["time_ratio"] = merged["mean_s"] / merged["mean_s_default"]
    for column in ("solved", "false"):
        merged[f"more_{column}"] = merged[column] - merged[f"{column}_default"]
    return merged[[*places, "setting", "problems", "mean_s", "time_ratio", "more_solved", "more_false"]]
