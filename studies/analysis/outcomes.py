"""Solved, failed and refused: what became of every problem that was put to several measures, or contact algorithms.

A problem is all that was asked but the competitor: scene, mesh, settings, tolerance. It may stand in several cells,
which differ in a parameter of the algorithm alone; then the best of them counts. Competitors are compared by medians of
ratios.
"""

from __future__ import annotations

import re

import numpy as np
import pandas as pd

from studies.ask.request import Request
from studies.ask.settings import settings_of
from studies.run.answers import PRICES
from studies.solving.result import CAP_HIT, CRASH, MEMORY, NOT_CONVERGED, SOLVED, TIME, UNSUPPORTED, WRONG

SEED, RESAMPLES, COVER = 2004, 999, 0.95
FEWEST = 5  # problems that a ratio needs


def problem_of(request: Request, axis: str) -> str:
    """All that was asked but the axis; an algorithm whose own parameters are not its defaults is another one."""
    usual = [own.key for own in settings_of(request.contact) if request.settings.get(own.key) == own.default]
    return request.key((axis, "epsilon", *usual))


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


SOLVED_STATE, PATH_ENDS, FAILED, REFUSED = "solved", "path ends", "failed", "refused"
STATES = (SOLVED_STATE, PATH_ENDS, FAILED, REFUSED)  # the best first
AXES = ("contact", "measure")
SOLVES = "contact"  # whose competitors solve the same problem: each measure has a path of its own
DEFAULT = "semismooth"  # what the other algorithms are held against
PASSED = ", which another passes"
CAUSES = {  # of a failure, by its outcome
    CAP_HIT: "iteration limit",
    NOT_CONVERGED: "steps too small",
    WRONG: "refused by the judge",
    TIME: "time limit",
    MEMORY: "memory limit",
    CRASH: "process died",
}
HOW_MUCH = re.compile(r" by \d\S* of its size")  # told apart by it, all refusals were unlike
DOES_NOT_APPLY = " does not apply: "  # before the reason of a refusal
COLUMNS = ("name", "scene", "problem", "state", "cause", *PRICES)
OUTCOME_COLUMNS = ("axis", "name", "scene", "planned", "solved", "path_ends", "failed", "refused", "cause")
ENDS = ("ratio", "low", "high")
RATIO_COLUMNS = ("both", "both_scenes", *(f"{cost}_{end}" for cost in PRICES for end in ENDS))
SUMMARY_COLUMNS = (
    *("algorithm", "scenes", "problems", "solved", "path_ends", "failed", "refused", "solved_share"),
    *("causes", "refusals", "default", *RATIO_COLUMNS),
)


def states(table: pd.DataFrame, axis: str) -> pd.DataFrame:
    """COLUMNS, a row a problem and competitor; cells that are not solved yet are left out.

    cause: kind of the end of the path, what a failure ended at, or why the problem was refused.  A path that ends is a
    failure where another algorithm certifies the load by the same measure.  table: of collect.
    """
    rows = table[table["outcome"] != "missing"].dropna(subset=[axis])
    rows = rows.assign(problem=[problem_of(request, axis) for request in rows["request"]], name=rows[axis])
    rows = rows[rows.groupby(["scene", "problem"])["name"].transform("nunique") > 1]
    if rows.empty:
        return pd.DataFrame(columns=list(COLUMNS))
    texts = rows.reindex(columns=["outcome", "path_end", "reason"]).astype(object).fillna("")
    judged = [_state(*each) for each in texts.to_numpy().tolist()]
    rows = _passed(rows.assign(state=[state for state, _ in judged], cause=[cause for _, cause in judged]))
    costs = rows.reindex(columns=list(PRICES.values())).set_axis(list(PRICES), axis=1).astype(float)
    rows = rows.drop(columns=[name for name in costs if name in rows]).join(costs)
    best = rows.assign(order=rows["state"].map(STATES.index)).sort_values("order", kind="stable")
    return best.drop_duplicates(["name", "scene", "problem"]).sort_index()[list(COLUMNS)]


def _state(outcome: str, end: str, reason: str) -> tuple[str, str]:
    """State and cause of a cell."""
    if outcome in SOLVED:
        return SOLVED_STATE, ""
    if outcome == UNSUPPORTED:
        return REFUSED, HOW_MUCH.sub("", reason.partition(DOES_NOT_APPLY)[2] or reason)
    if end:
        return PATH_ENDS, end
    return FAILED, CAUSES.get(outcome, outcome)


def _passed(rows: pd.DataFrame) -> pd.DataFrame:
    """A path that ends where another algorithm certifies the load is a failure: there is such a state."""
    same = [problem_of(request, SOLVES) for request in rows["request"]]
    passed = (rows["state"] == SOLVED_STATE).groupby([rows["scene"], same]).transform("any")
    lost = passed & (rows["state"] == PATH_ENDS)
    return rows.assign(state=rows["state"].mask(lost, FAILED), cause=rows["cause"].mask(lost, rows["cause"] + PASSED))


def outcomes(table: pd.DataFrame) -> pd.DataFrame:
    """OUTCOME_COLUMNS, a row a competitor and scene, and one of all scenes, whose name is empty.

    planned: problems that were put to two competitors at least, and are solved or not by now.  path_ends: of which the
    path itself ends before the load that was asked for.  cause: of all that are not solved.
    """
    rows: list[tuple[object, ...]] = []
    for axis in AXES:
        for name, own in states(table, axis).groupby("name", sort=False):
            for scene, cells in [("", own), *own.groupby("scene", sort=False)]:
                rows.append((axis, name, scene, *totals(cells)[:-1], counted(cells["cause"])))
    return pd.DataFrame(rows, columns=list(OUTCOME_COLUMNS))


def totals(cells: pd.DataFrame) -> tuple[int, int, int, int, int, float]:
    """Problems, solved, path ends, failed, refused, and the share that is solved of those that could be."""
    solved, ends, failed, refused = (int((cells["state"] == state).sum()) for state in STATES)
    share = solved / (solved + failed) if solved + failed else float("nan")
    return len(cells), solved, ends, failed, refused, share


def counted(causes: pd.Series) -> str:
    """Each cause with its number, the most frequent first."""
    return "; ".join(f"{count} {cause}" for cause, count in causes[causes != ""].value_counts().items())


def contact_summary(table: pd.DataFrame) -> pd.DataFrame:
    """SUMMARY_COLUMNS, a row an algorithm, the one that solves most first.

    causes: of failures, with the scenes.  refusals: why it was not tried.
    """
    rows: list[tuple[object, ...]] = []
    judged = states(table, "contact")
    for name, own in judged.groupby("name", sort=False):
        lost = own[own["state"] == FAILED]
        causes = counted(lost["cause"] + " in " + lost["scene"])
        refusals = counted(own.loc[own["state"] == REFUSED, "cause"])
        said = (own["scene"].nunique(), *totals(own), causes, refusals, DEFAULT)
        rows.append((name, *said, *ratios(judged, str(name), DEFAULT)))
    summary = pd.DataFrame(rows, columns=list(SUMMARY_COLUMNS))
    return summary.sort_values(["solved_share", "seconds_ratio"], ascending=[False, True], ignore_index=True)


def ratios(judged: pd.DataFrame, name: str, base: str) -> list[float]:
    """RATIO_COLUMNS of ``name`` over ``base``; NaN for what rests on fewer than FEWEST problems, or on one scene.

    both: problems that both solve, of both_scenes scenes.  judged: of states.  The intervals are those of drawing
    scenes, whose problems are alike.
    """
    solved = judged[judged["state"] == SOLVED_STATE].set_index(["scene", "problem"])
    own, other = (solved.loc[solved["name"] == each, list(PRICES)] for each in (name, base))
    pair = own.join(other.add_suffix(".base"), how="inner")
    scenes = pair.index.get_level_values("scene").to_numpy()
    row: list[float] = [len(pair), len(set(scenes))]
    for cost in PRICES:
        over = (pair[cost] / pair[f"{cost}.base"]).to_numpy(float)
        known = np.isfinite(over) & (over > 0)
        row += [np.nan] * len(ENDS) if known.sum() < FEWEST else median_ratio(over[known], scenes[known])
    return row
