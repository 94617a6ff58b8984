"""Which axis explains the difference: shares of the variance of log error and log cost, with bootstrap intervals.

Type II: what a factor explains beyond all other main effects, over the whole variance. Interactions of two factors are
one share together, what is left is the last one. In a table that is not balanced the shares need not add up to one:
what two factors explain alike counts for neither.
"""

from __future__ import annotations

from collections.abc import Mapping
from itertools import combinations

import numpy as np
import pandas as pd

from studies.analysis.cells.rows import mesh_ranks
from studies.analysis.ranking.fronts import COSTS

FACTORS = ("measure", "contact", "newton", "element", "mesh", "tolerance", "load", "section", "model")
INTERACTIONS, REST = "interactions", "rest"
FEWEST = 12  # cells, below which no share is given
SEED, RESAMPLES, COVER = 2004, 200, 0.95
COLUMNS = ("scope", "name", "response", "factor", "levels", "cells", "share", "low", "high")
LEAST_ERROR = 1e-12  # an error of zero has no logarithm


def attribution(table: pd.DataFrame, fronts: pd.DataFrame) -> pd.DataFrame:
    """Shares with COLUMNS for each scene and family, of its headline's log error and of the log of each cost.

    Of each scene the main question counts. Cells that are wrong count, with their error; those without an answer do
    not. In a family, errors and costs are centred by scene, and a mesh is known by its number among those of its scene.
    """
    more = [name for name in FACTORS if name not in fronts and name in table]
    rows = fronts.join(table.set_index("label")[more], on="label")
    rows = rows[rows["flag"].isin(("", "wrong", "unverified")) & rows["main"]]
    found = []
    for scope in ("scene", "family"):
        for name, own in rows.groupby(scope, sort=False):
            if scope == "family" and own["scene"].nunique() < 2:
                continue
            for response, logs in _responses(own).items():
                solved, values = logs.notna(), logs
                there = own[solved]
                factors = {each: there[each].astype(str) for each in FACTORS if each in own}
                if scope == "family":
                    factors["mesh"] = mesh_ranks(there).astype(str)
                    values = values - values.groupby(own["scene"]).transform("mean")
                found += [(scope, name, response, *row) for row in shares(values[solved].to_numpy(float), factors)]
    return pd.DataFrame(found, columns=list(COLUMNS))


def _responses(rows: pd.DataFrame) -> dict[str, pd.Series]:
    """Logarithms by name; NaN where there is none."""
    columns = {"error": "error", **{name: f"cost.{name}" for name in COSTS if f"cost.{name}" in rows}}
    values = pd.DataFrame({name: rows[column].astype(float) for name, column in columns.items()})
    values["error"] = values["error"].clip(lower=LEAST_ERROR)
    logs = pd.DataFrame(np.log10(values.where(values > 0)))
    return {name: logs[name] for name in columns}


def shares(values: np.ndarray, factors: Mapping[str, pd.Series]) -> list[tuple[str, int, int, float, float, float]]:
    """Factor, its levels, cells, its share and the bootstrap interval of that; nothing for less than FEWEST values.

    values (n,); factors: n labels each, those with one level are left out. The bootstrap draws residuals, not cells, so
    that a balanced table stays one: those of the main effects for the main effects, those of all effects for the rest.
    A share cannot be below zero, so that of a factor without effect the drawn ones are above it: the interval is
    extended to the share itself.
    """
    levels = {name: pd.factorize(labels)[0] for name, labels in factors.items() if labels.nunique() > 1}
    if len(values) < FEWEST or not levels or np.ptp(values) == 0.0:
        return []
    mains = [np.eye(int(codes.max()) + 1)[codes][:, 1:] for codes in levels.values()]
    pairs = [(a[:, :, None] * b[:, None, :]).reshape(len(values), -1) for a, b in combinations(mains, 2)]
    one = np.ones((len(values), 1))
    bases = [_basis(np.column_stack([one, *mains[:i], *mains[i + 1 :]])) for i in range(len(mains))]
    by_mains, by_all = (_basis(np.column_stack([one, *mains, *more])) for more in ([], pairs))
    rng = np.random.default_rng(SEED)
    point = _shares(values[:, None], bases, by_mains, by_all)
    drawn = [_shares(_redrawn(values, basis, rng), bases, by_mains, by_all) for basis in (by_mains, by_all)]
    samples = np.vstack([drawn[0][: len(mains)], drawn[1][len(mains) :]])
    low, high = np.quantile(samples, [(1 - COVER) / 2, (1 + COVER) / 2], axis=1)
    counts = [*(int(codes.max()) + 1 for codes in levels.values()), 0, 0]
    return [
        (name, count, len(values), float(share), float(min(a, share)), float(max(b, share)))
        for name, count, share, a, b in zip([*levels, INTERACTIONS, REST], counts, point[:, 0], low, high, strict=True)
    ]


def _basis(X: np.ndarray) -> np.ndarray:
    """Orthonormal columns (n, r) that span those of X (n, k), whose columns may depend on one another."""
    U, s, _ = np.linalg.svd(X, full_matrices=False)
    return np.asarray(U[:, s > 1e-10 * s[0]])


def _redrawn(values: np.ndarray, basis: np.ndarray, rng: np.random.Generator) -> np.ndarray:
    """RESAMPLES vectors (n, RESAMPLES): what the basis (n, r) fits, with residuals drawn from those it leaves."""
    fitted = basis @ (basis.T @ values)
    n, r = basis.shape
    residuals = (values - fitted) * (np.sqrt(n / (n - r)) if n > r else 0.0)  # least squares leaves too little
    return np.asarray(fitted[:, None] + rng.choice(residuals, size=(n, RESAMPLES)))


def _shares(Y: np.ndarray, without: list[np.ndarray], by_mains: np.ndarray, by_all: np.ndarray) -> np.ndarray:
    """Shares (factors + 2, m) of the columns of Y (n, m): of each factor, of the interactions, of what is left."""
    Y = Y - Y.mean(axis=0)
    total = np.sum(Y**2, axis=0)

    def left(basis: np.ndarray) -> np.ndarray:
        return np.asarray(np.maximum(total - np.sum((basis.T @ Y) ** 2, axis=0), 0.0))

    after_mains, after_all = left(by_mains), left(by_all)
    parts = [*(left(basis) - after_mains for basis in without), after_mains - after_all, after_all]
    return np.asarray(np.clip(np.array(parts) / total, 0.0, 1.0))
