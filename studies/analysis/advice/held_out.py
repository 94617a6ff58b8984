"""How good is advice for a scene whose reference is unknown? Each scene is left out once, and advised all the same.

The adviser then sees values only, no reference and no mesh finer than the one it stops at: it climbs. Its estimate of
the error of a cell is

    what the mesh leaves       |v_j - v_(j-1)| / (r^2 - 1) by Richardson's law of second order, of the last two steps
                               the larger one; three times as much where the last three meshes have no sensible order,
                               but not where the last two steps are opposite: then the limit lies between their ends
  + what the measure leaves    its distance from the exact measure on the second-coarsest mesh
  + what the solver leaves     its distance from the tightest tolerance there

relative to the value. How much too small such estimates are, it learns from the other scenes, whose references it does
know: the COVER quantile of true error over estimate is the factor of safety, one for opposite steps and one for all
others. The cheapest cell whose estimate times its factor meets the tolerance is the advice; its regret is the cost of
that over that of the cheapest cell that truly does, and its success whether the advised cell truly does.
"""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np
import pandas as pd

from studies.analysis.advice.questions import COST, Question, cheapest_of, questions
from studies.analysis.verify import EXACT, headline, judged
from studies.run.answers import keys, sizes
from studies.solving.refinement.richardson import FORMAL, UNSAFE, correction, order_of

TARGETS = (0.1, 0.05, 0.02, 0.01, 0.005)
COVER = 0.8  # quantile of true error over estimate elsewhere; 0.9: 1 % more met, 1.4 times the mean price
LEAST, MOST = 5e-4, 0.3  # estimates of which the factor is learnt: below is the reference's own error, above is none
SENSIBLE = (0.7, 4.5)  # observed orders that do not raise a doubt
DECIDABLE = 2.0  # a tolerance below so many uncertainties of the reference decides nothing
COLUMNS = (
    *("scene", "quantity", "headline", "tolerance", "factor", "advised", "best", "met", "regret"),
    *("true_error", "estimate"),
)
DEAR = 1.5  # regret that is too much
SUMMARY_COLUMNS = (
    *("quantities", "scenes", "cases", "advised", "met", "worst_miss", "median_regret", "mean_regret", "worst_regret"),
    *("dear", "share_above", "abstained"),
)


def held_out(table: pd.DataFrame, verified: pd.DataFrame) -> pd.DataFrame:
    """One row a scene, quantity and tolerance that its reference can decide, with COLUMNS; empty names for none."""
    known: list[tuple[str, str, bool, pd.DataFrame]] = []
    for scene in dict.fromkeys(table["scene"]):
        first = headline(table, scene)
        for name in judged(table, scene):
            for question in questions(table, verified, scene, name, COST)[:1]:
                known.append((scene, name, name == first, estimated(question)))
    rows: list[list[object]] = []
    for scene, name, leads, cells in known:
        factor = cells["between"].map(factors_of([other for it, _, _, other in known if it != scene]))
        rows += [[scene, name, leads, *row] for row in _advised(cells.assign(factor=factor))]
    return pd.DataFrame(rows, columns=list(COLUMNS))


def summary(cases: pd.DataFrame) -> pd.DataFrame:
    """SUMMARY_COLUMNS, of the headline quantities and of all: cases, and scenes, of which there are fewer.

    met: share of the advised cases.  worst_miss: the largest true error over its tolerance.  share_above: share of the
    regrets above ``dear``.  abstained: without advice, though a cell would do.
    """
    rows = [
        _summary(words, own) for words, own in (("headline", cases[cases["headline"].astype(bool)]), ("all", cases))
    ]
    return pd.DataFrame(rows, columns=list(SUMMARY_COLUMNS))


def _summary(words: str, cases: pd.DataFrame) -> dict[str, object]:
    given, regret = cases[cases["advised"] != ""], cases["regret"].astype(float)
    return {
        **{"quantities": words, "scenes": cases["scene"].nunique(), "cases": len(cases), "advised": len(given)},
        "met": given["met"].astype(float).mean(),
        "worst_miss": (given["true_error"] / given["tolerance"]).astype(float).max(),
        **{"median_regret": regret.median(), "mean_regret": regret.mean(), "worst_regret": regret.max()},
        **{"dear": DEAR, "share_above": (regret.dropna() > DEAR).mean()},
        "abstained": int(((cases["advised"] == "") & (cases["best"] != "")).sum()),
    }


def ratios_of(cells: pd.DataFrame) -> np.ndarray:
    """True error over estimate (n,), of those estimates that teach something."""
    usable = cells[(cells["estimate"] >= LEAST) & (cells["estimate"] <= MOST)]
    return np.asarray(usable["error"] / usable["estimate"], float)


def factors_of(others: list[pd.DataFrame]) -> dict[bool, float]:
    """The factors of safety from other questions: of estimates by opposite steps, and of all others."""
    return {
        between: factor_of([ratios_of(cells[cells["between"] == between]) for cells in others], without)
        for between, without in ((False, UNSAFE), (True, 1.0))
    }


def factor_of(others: list[np.ndarray], without: float = UNSAFE) -> float:
    """The factor of safety from the ratios of other questions, each with the same weight; or the one without any."""
    groups = [ratios for ratios in others if len(ratios)]
    if not groups:
        return without
    weights = np.concatenate([np.full(len(ratios), 1 / len(ratios)) for ratios in groups])
    return float(np.quantile(np.concatenate(groups), COVER, method="inverted_cdf", weights=weights))


def _advised(cells: pd.DataFrame) -> Iterator[list[object]]:
    """From the tolerance to the estimate, for each tolerance that can be decided."""
    uncertainty = float(cells["uncertainty"].iloc[0])
    for target in TARGETS:
        if target < DECIDABLE * uncertainty:
            continue
        offered, good = cells[cells["factor"] * cells["estimate"] <= target], cells[cells["error"] <= target]
        best = "" if good.empty else good["label"].iloc[0]
        if offered.empty:
            yield [target, math.nan, "", best, math.nan, math.nan, math.nan, math.nan]
            continue
        advised = cheapest_of(offered, "estimate")
        regret = math.nan if good.empty else advised["price"] / good["price"].iloc[0]
        met = float(advised["error"] <= target)
        yield [target, advised["factor"], advised["label"], best, met, regret, advised["error"], advised["estimate"]]


def estimated(question: Question) -> pd.DataFrame:
    """The question's cells, in their order, with ``estimate`` of the relative error, from values only; NaN: unknown.

    between: whether the last two steps of the mesh are opposite.
    """
    cells = question.cells.assign(size=sizes(question.cells))
    ordered = cells.sort_values("size", ascending=False, kind="stable")
    ladders = ordered.groupby(keys(ordered, "mesh"), sort=False)
    parts = {label: part for _, rows in ladders for label, *part in _mesh_parts(rows)}
    mesh, between = ({label: part[i] for label, part in parts.items()} for i in (0, 1))
    by_measure, by_tolerance = _measures(_probe(cells)), _tolerances(cells)
    estimate = cells["label"].map(mesh) + cells["measure"].map(by_measure) + keys(cells, "mesh").map(by_tolerance)
    return cells.assign(estimate=estimate, between=cells["label"].map(between).eq(True))


def _probe(cells: pd.DataFrame) -> pd.DataFrame:
    """Those on the second-coarsest mesh, or on the only one."""
    return cells[cells["size"] == sorted(cells["size"].unique(), reverse=True)[:2][-1]]


def _mesh_parts(rungs: pd.DataFrame) -> Iterator[tuple[str, float, bool]]:
    """Label, estimate and whether the last steps are opposite, on every mesh, coarse to fine, from the meshes up to it.

    The coarsest asks the second one.
    """
    rungs = rungs.drop_duplicates("size")
    h, f = (rungs[name].astype(float).tolist() for name in ("size", "value"))
    for j, label in enumerate(rungs["label"] if len(h) > 1 else ()):
        steps = [abs(correction(h[: i + 1], f[: i + 1])) * (h[j] / h[i]) ** FORMAL for i in {max(1, j - 1), max(1, j)}]
        between = j >= 2 and (f[j] - f[j - 1]) * (f[j - 1] - f[j - 2]) < 0
        doubt = 1.0
        if j >= 2 and not between and not SENSIBLE[0] <= order_of(h[j - 2 : j + 1], f[j - 2 : j + 1]) <= SENSIBLE[1]:
            doubt = UNSAFE
        yield str(label), doubt * max(steps) / abs(f[j]) if f[j] else math.inf, between


def _measures(probe: pd.DataFrame) -> dict[str, float]:
    """Relative distance of each measure from the exact one, or from the most frequent where there is none."""
    tight = probe[probe["tolerance"].fillna(0.0) == probe["tolerance"].fillna(0.0).min()]
    values = tight.groupby("measure")["value"].median()
    base = EXACT if EXACT in values else str(tight["measure"].mode().iloc[0])
    return {str(name): abs(value / values[base] - 1) for name, value in values.items() if values[base]}


def _tolerances(cells: pd.DataFrame) -> dict[str, float]:
    """By the key without the mesh, the relative distance from the same with the tightest tolerance, on its own probe.

    Of several meshes of this size, which differ across the refined direction, the largest distance on any one counts.
    """
    tolerances: dict[str, float] = {}
    probes = pd.concat([_probe(own) for _, own in cells.groupby(keys(cells, "mesh", "tolerance"), sort=False)])
    for _, rows in probes.groupby(keys(probes, "tolerance"), sort=False):
        tightest = rows.sort_values("tolerance", kind="stable")["value"].iloc[0]
        for key, value in zip(keys(rows, "mesh"), rows["value"], strict=True):
            left = abs(value / tightest - 1) if tightest else math.inf
            tolerances[key] = max(left, tolerances.get(key, 0.0))
    return tolerances
