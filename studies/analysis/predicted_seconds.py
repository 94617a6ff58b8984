"""How far operations predict seconds: a rate for each kind, and what the calls of a step and of a cell take.

    seconds = sum of operations/rate over their kinds + the calls of each factorisation, assembly and load step, of each
              load step with contact and of each of its iterations by the algorithm, and of the cell

fitted to one half of the cells and checked on the other, and the other way round, so that no
cell is predicted by a law that it has a part in. Alternate cells of each scene make the halves.
"""

from __future__ import annotations

import numpy as np
import pandas as pd
from scipy.optimize import nnls

from contact.catalogue import ALGORITHMS
from formulations.strains.catalogue import MEASURES
from formulations.strains.measure import QuadraticMeasure
from studies.operations import KINDS
from studies.result import SOLVED
from studies.scene import has_contact
from studies.scenes import SCENES

LEAST = 0.02  # seconds; below it the clock and the calls decide
WITHIN = 1.5
BY_FUNCTIONS = "assembly by functions"  # of measures that are no polynomial: roots and sines take longer than products
CALLS = {"factorisation": "c.factorisations", "assembly": "c.assemblies", "load step": "c.substeps"}
OF_CONTACT = ("load step with contact", *(f"iteration of {name}" for name in ALGORITHMS))
OUTLIER = 0.1  # relative error from which a cell counts less: what a busy machine has disturbed
ROUNDS = 20
FEWEST = 40  # cells: there are twice ten numbers to be found
PREDICTED_COLUMNS = ("label", "scene", "contact", "unknowns", "seconds", "predicted", "factor", "within")
SHARE_COLUMNS = ("scene", "cells", "share", "factor", "least", "low", "median", "high")
ENDS = (0.05, 0.5, 0.95)
RATE_COLUMNS = ("what", "kind", "seconds_each", "share")


def predicted_seconds(table: pd.DataFrame) -> dict[str, pd.DataFrame]:
    """Tables ``predicted_seconds``, a row a solved cell from LEAST on, with ``predicted_shares`` by scene, and
    ``operation_rates``, fitted to all; none of them where too few cells are solved.

    factor: predicted over measured.  within: of WITHIN.  seconds_each: of 10^9 operations of a kind, of a call, of a
    cell; share: of all seconds.
    """
    counted = table.reindex(columns=[f"w.{kind}" for kind in KINDS]).notna().any(axis=1)
    cells = table[counted & table["outcome"].isin(SOLVED) & (table["t.seconds"] > 0)].drop_duplicates("label")
    if len(cells) < FEWEST:
        return {}
    work, seconds = _work(cells), cells["t.seconds"].to_numpy(float)
    half = (cells.groupby("scene").cumcount() % 2).to_numpy(bool)
    predicted = np.empty(len(cells))
    for own in (half, ~half):
        predicted[~own] = work[~own] @ _rates(work[own], seconds[own])
    named = cells.rename(columns={"c.dofs": "unknowns"})
    found = named.assign(seconds=seconds, predicted=predicted, factor=predicted / seconds)
    found["within"] = found["factor"].between(1 / WITHIN, WITHIN)
    rates = _rates(work, seconds)
    told = (
        [(kind, "10^9 operations") for kind in (*KINDS, BY_FUNCTIONS)]
        + [(f"{name} call", "call") for name in (*CALLS, *OF_CONTACT)]
        + [("cell", "cell")]
    )
    spent = work.sum(axis=0) * rates
    rows = [(*names, rate, share) for names, rate, share in zip(told, rates, spent / spent.sum(), strict=True)]
    shown = found.loc[found["seconds"] >= LEAST, list(PREDICTED_COLUMNS)]
    return {
        "predicted_seconds": shown,
        "predicted_shares": _shares(shown),
        "operation_rates": pd.DataFrame(rows, columns=list(RATE_COLUMNS)),
    }


def _shares(shown: pd.DataFrame) -> pd.DataFrame:
    """SHARE_COLUMNS, a row a scene and one of all, whose name is empty."""
    groups = [("", shown), *shown.groupby("scene", sort=False)]
    rows = [
        (name, len(own), own["within"].mean(), WITHIN, LEAST, *own["factor"].quantile(ENDS)) for name, own in groups
    ]
    return pd.DataFrame(rows, columns=list(SHARE_COLUMNS))


def _work(cells: pd.DataFrame) -> np.ndarray:
    """10^9 operations by kind, those of assembly by functions apart, calls, and 1 a cell."""
    kinds = cells.reindex(columns=[f"w.{kind}" for kind in KINDS]).fillna(0.0).to_numpy(float) / 1e9
    by_functions = kinds[:, 0] * [not isinstance(MEASURES.get(name), QuadraticMeasure) for name in cells["measure"]]
    kinds[:, 0] -= by_functions
    calls = cells.reindex(columns=list(CALLS.values())).fillna(0.0).to_numpy(float)
    touching = np.array([name in SCENES and has_contact(SCENES[name]) for name in cells["scene"]])
    iterations = cells.reindex(columns=["c.newton_iterations"]).fillna(0.0).to_numpy(float)[:, 0]
    of_contact = [calls[:, -1], *(iterations * (cells["contact"] == name) for name in ALGORITHMS)]
    return np.column_stack([kinds, by_functions, calls, *(touching * each for each in of_contact), np.ones(len(cells))])


def _rates(work: np.ndarray, seconds: np.ndarray) -> np.ndarray:
    """The least sum of errors as factors, rates not below zero: least squares, outliers weighing less each time."""
    relative, weights = work / seconds[:, None], np.ones(len(seconds))
    rates = np.zeros(work.shape[1])
    for _ in range(ROUNDS):
        root = np.sqrt(weights)
        rates, _ = nnls(relative * root[:, None], root)
        ratio = np.maximum(relative @ rates, OUTLIER)
        weights = 1.0 / (ratio * np.maximum(np.abs(np.log(ratio)), OUTLIER))  # twice too much is as bad as half
    return rates
