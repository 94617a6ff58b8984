"""Performance profiles (Dolan and More): how often is who within a factor of the best, and does the ranking hold?

A profile depends on the whole field: with three competitors or more the order of two may turn when a third one leaves
(Gould and Scott). So pairs are compared alone, too, and the ranking is repeated without each one in turn.
"""

from __future__ import annotations

from collections.abc import Iterator
from itertools import combinations

import numpy as np
import pandas as pd

from studies.algorithm_settings import settings_of
from studies.analysis.cells.rows import PRICES
from studies.analysis.ranking.fronts import TIE, counting
from studies.analysis.verify import ELEMENT
from studies.request import Request
from studies.result import SOLVED

AXES = ("contact", "newton", "measure", "element")  # whose levels compete, where there are two
SOLVERS = ("contact", "newton")  # they solve the same problem; others are compared by the cost to reach an error
TARGETS = (0.1, 0.03, 0.01, 0.003, 0.001)
FACTORS = tuple(np.round(np.geomspace(1, 20, 40), 4))
RANKED_AT = 2.0  # the factor at which the ranking is read
SEED, RESAMPLES, COVER = 2004, 999, 0.95
RANKED_BY = tuple(PRICES)
FEWEST = 5  # problems that a ranking needs
NOT_ASKED = ("unsupported", "missing")  # outcomes that are no failure
PROFILE_COLUMNS = ("axis", "cost", "competitor", "problems", "solved", "factor", "share")
PAIR_COLUMNS = (
    *("axis", "cost", "a", "b", "problems", "a_solved", "b_solved", "both", "scenes", "a_better", "b_better", "ties"),
    *("ratio", "ratio_low", "ratio_high", "ratio_largest"),
)
FLIP_COLUMNS = ("axis", "cost", "problems", "removed", "ranking", "flips")
SOLVED_COLUMNS = ("axis", "competitor", "scene", "asked", "solved", "path_ends", "beyond", "ended")


def field(fronts: pd.DataFrame, axis: str, cost: str) -> pd.DataFrame:
    """Cost by scene and problem (rows) and competitor (columns): infinite for a failure, NaN for what was not asked.

    For a solver the problem is all else that was asked, and an answer that the judge certifies is a solution; for
    another axis it is a scene and an error to reach, at whatever mesh and way of solving is cheapest, in the scenes in
    which all compete.  fronts: of fronts.fronts.
    """
    if axis in SOLVERS:
        rows = _put(fronts, axis)
        price = rows[f"cost.{cost}"].astype(float).where(rows["outcome"].isin(SOLVED), np.inf)
        keys = ["scene", "problem"]
        return rows.assign(cost=price).pivot_table(index=keys, columns=axis, values="cost", aggfunc="min", sort=False)
    main = comparable(fronts, axis)
    good = main[main["flag"] == ""]
    reached = good.assign(bound=counting(good) + good["uncertainty"], cost=good[f"cost.{cost}"].astype(float))
    parts = {
        (scene, f"{target:g}"): own[own["bound"] <= target].groupby(axis)["cost"].min()
        for scene, own in reached.groupby("scene", sort=False)
        for target in TARGETS
    }
    return pd.DataFrame(parts, index=main[axis].unique()).T.fillna(np.inf) if parts else pd.DataFrame()


def comparable(fronts: pd.DataFrame, axis: str) -> pd.DataFrame:
    """The cells of ``main`` questions in the scenes in which all levels of an axis compete, on what all were asked.

    A mesh, or an algorithm, that one of them alone was given would be its advantage.
    """
    main = fronts[fronts["main"] & (fronts["flag"] != "unsupported")].dropna(subset=[axis])
    asked = main.groupby("scene")[axis].nunique()
    most = asked.max()
    main = main[main["scene"].isin(asked[asked == most].index)]
    chosen = ELEMENT if axis == "element" else (axis,)
    ways = main["request"].map(lambda request: request.key(chosen))
    return main[main.groupby(["scene", ways.rename("way")])[axis].transform("nunique") == most]


def problems(matrix: pd.DataFrame, axis: str) -> pd.DataFrame:
    """Of a ``field`` the largest part in which all competitors were asked all problems, without what none solves."""
    if axis in SOLVERS and len(matrix):
        matrix = _together(matrix)
    return matrix[np.isfinite(matrix.min(axis=1))] if len(matrix) else matrix


def _put(fronts: pd.DataFrame, axis: str) -> pd.DataFrame:
    """The cells that were put to a solver, each with its problem; problems that one solver alone was asked left out."""
    rows = fronts[~fronts["outcome"].isin(NOT_ASKED)].dropna(subset=[axis])
    rows = rows.assign(problem=[problem_of(request, axis) for request in rows["request"]])
    return rows[rows.groupby(["scene", "problem"])[axis].transform("nunique") > 1]


def solved(fronts: pd.DataFrame) -> pd.DataFrame:
    """How many problems were put to each solver, how many it has solved, and how the others ended: SOLVED_COLUMNS.

    path_ends: of those not solved, how many have a path that ends before the load asked for, by the tangent or by arc
    length: there is no state of it to be found, which is no failure.  beyond: at how many of these another solver has
    a state for that load, on the far side of the end.  ended: how the rest have failed.
    A row a scene, and one of all scenes, whose name is empty.
    """
    found = []
    for axis in SOLVERS:
        rows = _put(fronts, axis)
        rows = rows.assign(failed=~rows["outcome"].isin(SOLVED)).sort_values("failed", kind="stable")
        rows = rows.drop_duplicates([axis, "scene", "problem"]).sort_index()
        ends = rows["failed"] & rows["path_end"].astype(object).fillna("").ne("")
        reached = ~rows.groupby(["scene", "problem"])["failed"].transform("min").astype(bool)
        rows = rows.assign(ends=ends, beyond=ends & reached)
        for name, own in rows.groupby(axis, sort=False):
            for scene, cells in [("", own), *own.groupby("scene", sort=False)]:
                ended = cells.loc[cells["failed"] & ~cells["ends"], "outcome"].value_counts()
                failed = ", ".join(f"{count} {word}" for word, count in ended.items())
                counts = (int(cells[column].sum()) for column in ("failed", "ends", "beyond"))
                lost, *of_the_path = counts
                found.append((axis, name, scene, len(cells), len(cells) - lost, *of_the_path, failed))
    return pd.DataFrame(found, columns=list(SOLVED_COLUMNS))


def problem_of(request: Request, axis: str) -> str:
    """All that was asked but the axis; an algorithm whose own parameters are not its defaults is another one."""
    usual = [own.key for own in settings_of(request.contact) if request.settings.get(own.key) == own.default]
    return request.key((axis, "epsilon", *usual))


def _together(matrix: pd.DataFrame) -> pd.DataFrame:
    """The largest group of problems and competitors in which each problem was put to each competitor.

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
    """Profiles against the virtual best, pairs, and the flip check, with the columns above, for all axes and costs.

    Fewer than FEWEST problems make no profile and no ranking, only their number.
    """
    profile: list[tuple[object, ...]] = []
    pairs: list[tuple[object, ...]] = []
    flips: list[tuple[object, ...]] = []
    for axis in AXES:
        for cost in (name for name in RANKED_BY if f"cost.{name}" in fronts and fronts[axis].nunique() > 1):
            whole = field(fronts, axis, cost)
            matrix = problems(whole, axis)
            pairs += [(axis, cost, *row) for row in pairs_of(whole)]
            if len(matrix) < FEWEST or matrix.shape[1] < 2:
                flips.append((axis, cost, len(matrix), "", "", ""))
                continue
            shares = within(matrix, FACTORS)
            reached = np.isfinite(matrix).mean()
            profile += [
                (axis, cost, name, len(matrix), float(reached[name]), factor, float(share))
                for name in matrix
                for factor, share in zip(FACTORS, shares[name], strict=True)
            ]
            flips += [(axis, cost, len(matrix), *row) for row in flip_check(matrix)]
    return (
        pd.DataFrame(profile, columns=list(PROFILE_COLUMNS)),
        pd.DataFrame(pairs, columns=list(PAIR_COLUMNS)),
        pd.DataFrame(flips, columns=list(FLIP_COLUMNS)),
    )


def within(matrix: pd.DataFrame, factors: tuple[float, ...]) -> pd.DataFrame:
    """Share of the problems in which each competitor needs at most so many times what the best one needs."""
    best = matrix.min(axis=1)
    ratios = matrix.div(best.where(best > 0, 1.0), axis=0)  # a cost of nothing is its own best
    return pd.DataFrame([(ratios <= factor).mean() for factor in factors])


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


def pairs_of(matrix: pd.DataFrame) -> Iterator[tuple[object, ...]]:
    """Each two alone: PAIR_COLUMNS from ``a`` on.

    problems: put to both and solved by anybody, with the share that each solves; ratios, of b over a, on those that
    both solve, from FEWEST of them on.  better: cheaper by more than TIE, or alone.
    ratio_largest: the median on the FEWEST largest problems, by the cost of the cheaper of the two: most are small.
    """
    for a, b in combinations(matrix, 2):
        pair = matrix[[a, b]].dropna()
        pair = pair[np.isfinite(matrix.min(axis=1)).loc[pair.index]]
        both = pair[(np.isfinite(pair) & (pair > 0)).all(axis=1)]
        better = int((pair[a] < (1 - TIE) * pair[b]).sum()), int((pair[b] < (1 - TIE) * pair[a]).sum())
        ties = int(np.isfinite(pair).any(axis=1).sum()) - sum(better)
        scenes = both.index.get_level_values(0)
        ratios = (both[b] / both[a]).to_numpy(float)[: None if len(both) >= FEWEST else 0]
        largest_first = np.argsort(-both.min(axis=1).to_numpy(float), kind="stable")
        largest = float(np.median(ratios[largest_first[:FEWEST]])) if len(ratios) else np.nan
        middle = median_ratio(ratios, np.asarray(scenes))
        shares = (float(np.isfinite(pair[each]).mean()) if len(pair) else np.nan for each in (a, b))
        yield a, b, len(pair), *shares, len(both), scenes.nunique(), *better, ties, *middle, largest


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
