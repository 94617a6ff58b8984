"""Performance profiles (Dolan and More): how often is who within a factor of the best, and does the ranking hold?

A profile depends on the whole field: with three competitors or more the order of two may turn when a third one leaves
(Gould and Scott). So pairs are compared alone, too, and the ranking is repeated without each one in turn.
"""

from __future__ import annotations

from collections.abc import Iterator
from itertools import combinations

import numpy as np
import pandas as pd
from scipy.stats import bootstrap

from studies.algorithm_settings import settings_of
from studies.analysis.fronts import COSTS
from studies.request import Request

AXES = ("contact", "newton", "measure", "element")  # whose levels compete, where there are two
SOLVERS = ("contact", "newton")  # they solve the same problem; others are compared by the cost to reach an error
TARGETS = (0.1, 0.03, 0.01, 0.003, 0.001)
FACTORS = tuple(np.round(np.geomspace(1, 20, 40), 4))
RANKED_AT = 2.0  # the factor at which the ranking is read
SEED, RESAMPLES, COVER = 2004, 999, 0.95
PROFILE_COLUMNS = ("axis", "cost", "competitor", "problems", "factor", "share")
PAIR_COLUMNS = ("axis", "cost", "a", "b", "problems", "a_better", "b_better", "ratio", "ratio_low", "ratio_high")
FLIP_COLUMNS = ("axis", "cost", "removed", "ranking", "flips")


def problems(fronts: pd.DataFrame, axis: str, cost: str) -> pd.DataFrame:
    """Cost by problem (rows) and competitor (columns), infinite for one that fails or is wrong.

    For a solver the problem is all else that was asked; for another axis it is a scene and an error to reach, at
    whatever mesh and way of solving is cheapest.  fronts: of tradeoff.fronts. Problems that nobody solves are left out.
    """
    rows = fronts.dropna(subset=[axis]).assign(cost=fronts[f"cost.{cost}"].astype(float))
    rows = rows[rows["flag"] != "unsupported"]
    if axis in SOLVERS:
        good = rows["flag"].isin(("", "unverified"))
        rows = rows.assign(cost=rows["cost"].where(good, np.inf))
        rows = rows.assign(problem=[_problem(request, axis) for request in rows["request"]])
        matrix = rows.pivot_table(index="problem", columns=axis, values="cost", aggfunc="min", sort=False)
        matrix = _together(matrix)
    else:
        main = fronts[fronts["main"]].dropna(subset=[axis])
        asked = main.groupby("scene")[axis].nunique()
        whole = asked[asked == asked.max()].index  # as above: scenes in which all compete
        rows = rows[(rows["flag"] == "") & rows["main"] & rows["scene"].isin(whole)]
        reached = rows.assign(bound=rows["error"] + rows["uncertainty"])
        parts = {
            f"{scene} {target:g}": own[own["bound"] <= target].groupby(axis)["cost"].min()
            for scene, own in reached.groupby("scene", sort=False)
            for target in TARGETS
        }
        competitors = main[main["scene"].isin(whole)][axis].unique()
        matrix = pd.DataFrame(parts, index=competitors).T.fillna(np.inf)
    return matrix[np.isfinite(matrix.min(axis=1))] if len(matrix) else matrix


def _problem(request: Request, axis: str) -> str:
    """All that was asked but the axis; an algorithm whose own parameters are not its defaults is another one."""
    usual = [own.key for own in settings_of(request.contact) if request.settings.get(own.key) == own.default]
    return request.key((axis, "epsilon", *usual))


def _together(matrix: pd.DataFrame) -> pd.DataFrame:
    """The problems and competitors of the largest group in which everybody was asked everything.

    NaN: not asked, or refused; that is no failure.
    """
    groups = matrix.notna().value_counts()  # by who was asked: a tuple of truths
    asked = {tuple(matrix.columns[np.asarray(who, bool)]): count for who, count in groups.items()}
    sizes = {
        group: len(group) * sum(count for other, count in asked.items() if set(group) <= set(other))
        for group in asked
        if len(group) > 1
    }
    if not sizes:
        return matrix.iloc[:0]
    group = max(sizes, key=lambda each: sizes[each])
    return matrix[list(group)].dropna()


def profiles(fronts: pd.DataFrame) -> tuple[pd.DataFrame, pd.DataFrame, pd.DataFrame]:
    """Profiles against the virtual best, pairs, and the flip check, with the columns above, for all axes and costs."""
    profile, pairs, flips = [], [], []
    for axis in AXES:
        if fronts[axis].nunique() < 2:
            continue
        for cost in (name for name in COSTS if f"cost.{name}" in fronts):
            matrix = problems(fronts, axis, cost)
            if matrix.shape[0] == 0 or matrix.shape[1] < 2:
                continue
            shares = within(matrix, FACTORS)
            profile += [
                (axis, cost, name, len(matrix), factor, float(share))
                for name in matrix
                for factor, share in zip(FACTORS, shares[name], strict=True)
            ]
            pairs += [(axis, cost, *row) for row in _pairs(matrix)]
            flips += [(axis, cost, *row) for row in flip_check(matrix)]
    return (
        pd.DataFrame(profile, columns=list(PROFILE_COLUMNS)),
        pd.DataFrame(pairs, columns=list(PAIR_COLUMNS)),
        pd.DataFrame(flips, columns=list(FLIP_COLUMNS)),
    )


def within(matrix: pd.DataFrame, factors: tuple[float, ...]) -> pd.DataFrame:
    """Share of the problems in which each competitor needs at most so many times what the best one needs."""
    best = matrix.min(axis=1)
    ratios = matrix.div(best.where(best > 0, 1.0), axis=0)  # a cost of nothing is its own best
    return pd.DataFrame({name: [(ratios[name] <= factor).mean() for factor in factors] for name in matrix})


def ranking(matrix: pd.DataFrame) -> dict[str, float]:
    """Competitors by their share within RANKED_AT of the best, best first."""
    shares = within(matrix, (RANKED_AT,)).iloc[0]
    return {str(name): float(share) for name, share in shares.sort_values(ascending=False, kind="stable").items()}


def flip_check(matrix: pd.DataFrame) -> Iterator[tuple[str, str, str]]:
    """For each competitor removed: the ranking of the others, and the pairs whose order has turned by it, if any."""
    whole = ranking(matrix)
    yield "", " > ".join(whole), ""
    if matrix.shape[1] < 3:
        return
    for removed in matrix:
        rest = matrix.drop(columns=removed)
        rest = rest[np.isfinite(rest.min(axis=1))]
        if rest.empty:
            continue
        order = ranking(rest)
        turned = [
            f"{a} and {b}" for a, b in combinations(order, 2) if (whole[a] - whole[b]) * (order[a] - order[b]) < 0
        ]
        yield str(removed), " > ".join(order), "; ".join(turned)


def _pairs(matrix: pd.DataFrame) -> Iterator[tuple[object, ...]]:
    """Each two alone: problems that one of them solves, who is cheaper how often, and the median of b over a."""
    for a, b in combinations(matrix, 2):
        pair = matrix[[a, b]]
        pair = pair[np.isfinite(pair.min(axis=1))]
        both = pair[np.isfinite(pair).all(axis=1) & (pair > 0).all(axis=1)]
        low, middle, high = _median_ratio((both[b] / both[a]).to_numpy(float))
        yield a, b, len(pair), int((pair[a] < pair[b]).sum()), int((pair[b] < pair[a]).sum()), middle, low, high


def _median_ratio(ratios: np.ndarray) -> tuple[float, float, float]:
    """Median with its bootstrap interval; NaN without two values."""
    if len(ratios) < 2:
        return np.nan, float(ratios[0]) if len(ratios) else np.nan, np.nan
    found = bootstrap(
        (ratios,),
        np.median,
        n_resamples=RESAMPLES,
        confidence_level=COVER,
        method="percentile",
        rng=np.random.default_rng(SEED),
    ).confidence_interval
    return float(found.low), float(np.median(ratios)), float(found.high)
