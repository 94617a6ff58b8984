"""What a measure costs over the exact one to reach the same error: is any classical nonlinear measure worth it?"""

from __future__ import annotations

from collections.abc import Iterator, Mapping

import numpy as np
import pandas as pd

from studies.analysis.cells.rows import PRICES
from studies.analysis.ranking.fronts import TIE, counting
from studies.analysis.ranking.profiles import FEWEST, comparable, field, median_ratio
from studies.analysis.verify import EXACT

LINEAR, CLASSICAL, OTHER = "linear", "classical nonlinear", "other"
KINDS = {EXACT: EXACT, LINEAR: LINEAR, "elongation": "exact by elongations"} | dict.fromkeys(
    ("von-karman", "donnell", "sanders", "novozhilov", "moderate-rotation", "thin-green-lagrange"), CLASSICAL
)
EQUAL_COLUMNS = (
    *("cost", "measure", "kind", "problems", "scenes", "exact_solved", "solved", "both", "both_scenes"),
    *("ratio", "low", "high", "cheaper", "ties", "dearer", "alone", "exact_alone", "cheaper_both"),
)
CHEAPER_COLUMNS = ("cost", "measure", "kind", "scene", "tolerance", "spent", "exact_spent", "ratio", "command")


def equal_accuracy(fronts: pd.DataFrame) -> pd.DataFrame:
    """EQUAL_COLUMNS, a row a cost and measure, and one of all classical nonlinear ones, whose measure is empty.

    problems: a scene and an error that the measure or the exact one reaches; solved: the share that it reaches.
    both: reached by both, of which ``cheaper`` by more than TIE, ties, dearer.  alone: reached by the measure only,
    exact_alone: by the exact one only.  ratio: the median over both, NaN for fewer than FEWEST, with the interval of
    drawing scenes.  cheaper_both: problems in which it is cheaper, or alone, by every cost: a single time of a small
    cell may be off by more than TIE.
    """
    rows: list[tuple[object, ...]] = []
    fields = {cost: _field(fronts, cost) for cost in PRICES}
    for cost, matrix in fields.items():
        if EXACT not in matrix:
            continue
        names = [str(name) for name in matrix if name != EXACT]
        always = {name: sum(_always_less(fields, name)) for name in names}
        pairs = {name: matrix[[EXACT, name]] for name in names}
        rows += [(cost, name, kind_of(name), *_compared([pairs[name]]), always[name]) for name in names]
        own = [name for name in names if kind_of(name) == CLASSICAL]
        if own:
            rows.append((cost, "", CLASSICAL, *_compared([pairs[n] for n in own]), sum(always[n] for n in own)))
    return pd.DataFrame(rows, columns=list(EQUAL_COLUMNS))


def _always_less(fields: Mapping[str, pd.DataFrame], measure: str) -> Iterator[bool]:
    """Of each problem, whether the measure spends less than the exact one by every cost there is."""
    matrices = [matrix for matrix in fields.values() if EXACT in matrix and measure in matrix]
    for problem in matrices[0].index:
        yield all(_less(matrix.loc[[problem]], measure).any() for matrix in matrices if problem in matrix.index)


def _less(matrix: pd.DataFrame, measure: str) -> pd.Series:
    """Where the measure spends less than the exact one, or gets there alone."""
    return np.isfinite(matrix[measure]) & (matrix[measure] < (1 - TIE) * matrix[EXACT])


def kind_of(measure: str) -> str:
    """What kind of measure it is."""
    return KINDS.get(measure, OTHER)


def _field(fronts: pd.DataFrame, cost: str) -> pd.DataFrame:
    return field(fronts, "measure", cost) if f"cost.{cost}" in fronts else pd.DataFrame()


def _compared(pairs: list[pd.DataFrame]) -> tuple[object, ...]:
    """EQUAL_COLUMNS from problems on, of pairs with the exact measure first."""
    pair = pd.concat([each.set_axis([EXACT, "own"], axis=1) for each in pairs]).dropna()
    pair = pair[np.isfinite(pair.min(axis=1))]
    scenes = pair.index.get_level_values(0)
    reached = np.isfinite(pair)
    both = pair[reached.all(axis=1)]
    over = (both["own"] / both[EXACT]).to_numpy(float)
    of = both.index.get_level_values(0).to_numpy()
    middle = median_ratio(over, of) if both.index.nunique() >= FEWEST else (np.nan,) * 3
    counts = (int((over < 1 - TIE).sum()), 0, int((over > 1 / (1 - TIE)).sum()))
    alone = (int((~reached[EXACT]).sum()), int((~reached["own"]).sum()))
    shares = tuple(float(reached[name].mean()) if len(pair) else np.nan for name in (EXACT, "own"))
    ties = len(over) - sum(counts)
    told = (len(pair), scenes.nunique(), *shares, len(both), len(set(of)))
    return (*told, *middle, counts[0], ties, counts[2], *alone)


def cheaper_measures(fronts: pd.DataFrame) -> pd.DataFrame:
    """CHEAPER_COLUMNS: every scene and error that another measure reaches for less than the exact one, or alone.

    ratio: of the costs, 0 where the exact measure has no cell that reaches it.  command: of the cheaper cell.
    """
    rows: list[tuple[object, ...]] = []
    cells = comparable(fronts, "measure")
    reaching = cells.assign(bound=counting(cells) + cells["uncertainty"])[cells["flag"] == ""]
    for cost in PRICES:
        matrix = _field(fronts, cost)
        for measure in (str(name) for name in matrix if name != EXACT and EXACT in matrix):
            less = matrix[_less(matrix, measure)]
            for (scene, target), own, exact in zip(less.index, less[measure], less[EXACT], strict=True):
                found = (measure, kind_of(measure), scene, float(target), own, exact, own / exact)
                rows.append((cost, *found, _cheapest(reaching, str(scene), measure, float(target), cost)))
    return pd.DataFrame(rows, columns=list(CHEAPER_COLUMNS))


def _cheapest(cells: pd.DataFrame, scene: str, measure: str, target: float, cost: str) -> str:
    """The command of the cheapest cell that reaches the error."""
    own = cells[(cells["scene"] == scene) & (cells["measure"] == measure) & (cells["bound"] <= target)]
    return str(own.sort_values(f"cost.{cost}", kind="stable")["command"].iloc[0])
