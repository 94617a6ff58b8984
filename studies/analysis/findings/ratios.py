"""Costs of one competitor over those of another, on the problems that both solve."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import pandas as pd

from studies.analysis.cells.rows import PRICES
from studies.analysis.findings.states import SOLVED_STATE
from studies.analysis.ranking.profiles import FEWEST, median_ratio

ENDS = ("ratio", "low", "high")
RATIO_COLUMNS = ("both", "both_scenes", *(f"{cost}_{end}" for cost in PRICES for end in ENDS))


def ratios(found: pd.DataFrame, name: str, base: str) -> Mapping[str, float]:
    """RATIO_COLUMNS of ``name`` over ``base``; NaN for what rests on fewer than FEWEST problems, or on one scene.

    both: problems that both solve, of both_scenes scenes.  found: of states.  The intervals are those of drawing
    scenes, whose problems are alike.
    """
    solved = found[found["state"] == SOLVED_STATE].set_index(["scene", "problem"])
    own, other = (solved.loc[solved["name"] == each, list(PRICES)] for each in (name, base))
    pair = own.join(other.add_suffix(".base"), how="inner")
    scenes = pair.index.get_level_values("scene").to_numpy()
    row: dict[str, float] = {"both": len(pair), "both_scenes": len(set(scenes))}
    for cost in PRICES:
        over = (pair[cost] / pair[f"{cost}.base"]).to_numpy(float)
        known = np.isfinite(over) & (over > 0)
        few = known.sum() < FEWEST
        middle = (np.nan,) * len(ENDS) if few else median_ratio(over[known], scenes[known])
        row |= {f"{cost}_{end}": value for end, value in zip(ENDS, middle, strict=True)}
    return row
