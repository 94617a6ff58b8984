"""Observed orders of manufactured solutions: the exponents by which errors that are known fall from mesh to mesh.

log(e1/e2)/log(n2/n1) of two successive meshes; nothing is extrapolated, for nothing has to be guessed.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import pairwise

import numpy as np
import pandas as pd

from studies.solving.refinement.richardson import power_of
from studies.solving.result import SOLVED

THEORY: Mapping[str, float] = {  # of bilinear displacements with the strains of the mixed element
    "error_displacement": 2.0,
    "error_resultants": 1.0,
    "error_mean_resultants": 2.0,
    "error_energy": 1.0,
}
CASE = ("group", "measure", "surface", "element", "settings")
NEAR = 0.1  # of an order to the theory, in displacements
MEANS, BELOW = (
    "error_mean_resultants",
    0.05,
)  # orders this far below the theory are those of a coarse mesh, if they rise


def orders(data: pd.DataFrame, case: Sequence[str], errors: Sequence[str]) -> pd.DataFrame:
    """A row a case: the order of each error between its two finest meshes, and the error on the finest.

    ``change_``: what each order has changed by from the pair of meshes before; NaN without one.
    """
    rows = []
    for key, group in data.groupby(list(case), sort=False, dropna=False):
        own = group.sort_values("n")
        found = {name: _slopes(own["n"].to_numpy(float), own[name].to_numpy(float)) for name in errors}
        last = {name.replace("error_", "order_"): slopes[-1] for name, slopes in found.items()}
        changes = {
            name.replace("error_", "change_"): slopes[-1] - slopes[-2] if len(slopes) > 1 else np.nan
            for name, slopes in found.items()
        }
        finest = {name: float(own[name].iloc[-1]) for name in errors}
        rows.append(dict(zip(case, key, strict=True)) | last | changes | finest | {"n": own["n"].iloc[-1]})
    return pd.DataFrame(rows)


def _slopes(n: np.ndarray, error: np.ndarray) -> list[float]:
    pairs = pairwise(zip(n, error, strict=True))
    return [float(np.log(e / f) / np.log(m / k)) if e > 0 and f > 0 else np.nan for (k, e), (m, f) in pairs]


def manufactured_orders(data: pd.DataFrame) -> pd.DataFrame:
    """The orders of all cases; near: whether that of displacements is within NEAR of the theory, and all converged.

    coarse: whether the order of the means is more than BELOW below the theory; rising: and has risen.
    """
    named = data.assign(settings=data["settings"].astype(object).where(data["settings"].notna(), ""))
    found = orders(named, CASE, tuple(THEORY))
    solved = [bool(own["class"].isin(SOLVED).all()) for _, own in named.groupby(list(CASE), sort=False)]
    off = (found["order_displacement"] - THEORY["error_displacement"]).abs()
    coarse = found["order_mean_resultants"] < THEORY[MEANS] - BELOW
    rising = coarse & (found["change_mean_resultants"] > 0)
    return found.assign(near=(off <= NEAR) & pd.Series(solved), coarse=coarse, rising=rising)


def contact_orders(data: pd.DataFrame) -> pd.DataFrame:
    """The orders with contact, for every measure, surface and radius.

    The edge lies anywhere within an element, so that errors jump from mesh to mesh: orders of displacement, pressure
    and edge are slopes of straight lines through all meshes, in logarithms. edge_elements: the error of the edge over
    the size of the finest elements.
    """
    case = ["measure", "surface", "radius"]
    found = orders(data, case, tuple(THEORY))
    groups = [own.sort_values("n") for _, own in data.groupby(case, sort=False)]
    for name in ("error_displacement", "error_pressure", "error_edge"):
        slopes = [-power_of(own["n"], own[name]) for own in groups]
        finest = [float(own[name].iloc[-1]) for own in groups]
        found = found.assign(**{name.replace("error_", "order_"): slopes, name: finest})
    return found.assign(edge_elements=found["error_edge"] * found["radius"] * found["n"] / 2)
