"""The default element against the one of the paper: errors on the same meshes against their common limit."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
import pandas as pd

from studies.analysis.comparisons.ladders import of_ladders

ENOUGH = 0.01  # the error that a mesh is wanted for
EQUAL = 1e-3  # two errors this close are equal; so are two that the uncertainty of the limit does not tell apart
COLUMNS = (
    *("ladder", "quantity", "verdict", "meshes", "uncertainty", "default", "paper"),
    *("default_elements", "paper_elements", "default_iterations", "paper_iterations"),
)


def element_choice(convergence: pd.DataFrame) -> pd.DataFrame:
    """COLUMNS, a row a quantity with a limit, which is that of the element whose limit is the more certain.

    default, paper: relative errors over the meshes, separated by blanks, coarse to fine.  uncertainty: relative, of the
    limit.  verdict: is the default better, equal or worse on the coarsest mesh, where it costs?  *_elements: from which
    the error stays below ENOUGH.  *_iterations: Newton's, on the second mesh.
    """
    defaults, papers = (of_ladders(convergence, element) for element in ("refined", "paper"))
    rows = []
    for key, default in defaults.items():
        paper = papers.get(key)
        known = [own for own in (default, paper) if own is not None and own["limit"].notna().all()]
        if paper is None or not known:
            continue
        best = min(known, key=lambda own: float(own["uncertainty"].iloc[0])).iloc[0]
        uncertainty = abs(float(best["uncertainty"]) / float(best["limit"]))
        pair = (default.iloc[: len(paper)], paper)
        errors = [own["value"].to_numpy(float) / float(best["limit"]) - 1 for own in pair]
        meshes = list(paper["mesh"])
        rows.append(
            [
                *(*key, verdict_of(errors[0][0], errors[1][0], uncertainty), " ".join(meshes), uncertainty),
                *(" ".join(map(repr, each.tolist())) for each in errors),
                *(elements_for(meshes, each) for each in errors),
                *(own["iterations"].iloc[1] for own in pair),
            ]
        )
    return pd.DataFrame(rows, columns=list(COLUMNS))


def verdict_of(default: float, paper: float, uncertainty: float) -> str:
    """Of two relative errors against a limit that is known to ``uncertainty``."""
    default, paper = abs(default), abs(paper)
    if math.isnan(default) or math.isnan(paper):
        return "not solved by both"
    if abs(default - paper) <= max(EQUAL, uncertainty):
        return "equal"
    return "better" if default < paper else "worse"


def elements_for(meshes: Sequence[str], errors: np.ndarray) -> float:
    """Elements from which the error stays below ENOUGH, log-log between two meshes; NaN outside the meshes."""
    size = np.log([math.prod(map(int, mesh.split("x"))) for mesh in meshes])
    error = np.abs(errors)
    above = np.flatnonzero(~(error <= ENOUGH))
    if len(above) == 0 or above[-1] == len(error) - 1:
        return math.nan
    i = above[-1]
    return float(np.exp(np.interp(np.log(ENOUGH), np.log(error[[i + 1, i]]), size[[i + 1, i]])))
