"""The default element against the one of the paper: errors on the same meshes against their common limit."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
import pandas as pd

from studies.run.cells.rows import holds_from

ENOUGH = 0.01  # the error that a mesh is wanted for
EQUAL = 1e-3  # two errors this close are equal; so are two that the uncertainty of the limit does not tell apart
WHO = ("default", "paper")
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
    own = convergence[~convergence["at"].astype(str).str.startswith("load")]  # not the benchmarks at their many loads
    default, paper = (own[own["element"] == element] for element in ("refined", "paper"))
    by = ["ladder", "quantity"]
    rows = []
    for key, pair in default.merge(paper, on=[*by, "mesh"], suffixes=("_default", "_paper")).groupby(by, sort=False):
        first = pair.iloc[0]
        known = [who for who in WHO if not math.isnan(first[f"limit_{who}"])]
        if not known:
            continue
        best = min(known, key=lambda who: float(first[f"uncertainty_{who}"]))
        limit = float(first[f"limit_{best}"])
        uncertainty, meshes = abs(float(first[f"uncertainty_{best}"]) / limit), list(pair["mesh"])
        errors = [pair[f"value_{who}"].to_numpy(float) / limit - 1 for who in WHO]
        rows.append(
            [
                *(*key, verdict_of(errors[0][0], errors[1][0], uncertainty), " ".join(meshes), uncertainty),
                *(" ".join(map(repr, each.tolist())) for each in errors),
                *(elements_for(meshes, each) for each in errors),
                *(pair[f"iterations_{who}"].iloc[1] for who in WHO),
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
    first = holds_from(error <= ENOUGH)
    if first in (0, len(error)):
        return math.nan
    around = [first, first - 1]
    return float(np.exp(np.interp(np.log(ENOUGH), np.log(error[around]), size[around])))
