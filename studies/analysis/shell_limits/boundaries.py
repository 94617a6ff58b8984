"""Where the error of the shell's kinematics passes a level, with what power of the thickness it grows, and the costs.

Between two thicknesses the error is a power of h: log error over log thickness is interpolated; where it changes its
sign between them, two powers work against each other, and it is interpolated as it is. Nothing is extrapolated: what
is not passed on the way is infinite, what is passed from the start is 0.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
import pandas as pd

from studies.solving.refinement.richardson import power_of

LEVELS = (0.01, 0.05)
TOLD = 3.0  # times what it is known to: an error smaller than that is not told from zero
ASYMPTOTIC = 1e-4, 0.05  # errors between which the order shows: below is rounding in thin walls, above the next term
ZERO = 1e-15  # an error that is nothing but rounding
THICK = 0.01  # thinner walls are not what a solid is for
KEY = ("case", "scene", "quantity", "thickness", "variant")
COLUMNS = (
    *(*KEY, "judge", "solid_off", "thinnest", "thickest", "at_thickest", "known_to"),
    *(f"boundary_{100 * level:g}" for level in LEVELS),
    *("decided", "order", "headline", "fails", "shell_unknowns", "solid_unknowns", "unknowns_ratio", "seconds_ratio"),
)


def boundaries(table: pd.DataFrame) -> pd.DataFrame:
    """COLUMNS, a row a case, quantity and variant, in the order of the table.

    judge: "closed form" or "solid".  solid_off: the largest distance of the solid's limit from the closed form at
    thicknesses of a hundredth and more, where there is one.
    boundary_N: thickness at which the error passes N %.  known_to: the largest of the points.  decided: whether the
    points on either side of every boundary that is passed are told from its level.  order: see :func:`order`.
    headline: the first quantity of its case.  *_ratio: median of solid over shell, over the thicknesses, of meshes
    equally good; *_unknowns: medians.
    """
    rows: list[dict[str, Any]] = []
    for _, own in table.groupby(["case", "quantity", "variant"], sort=False):
        own = own.sort_values("ratio")
        first = own.iloc[0]
        error, ratio, known = (own[name].to_numpy(float) for name in ("error", "ratio", "known_to"))
        passed = [boundary(ratio, error, level) for level in LEVELS]
        costs = own.reindex(columns=["shell_unknowns", "solid_unknowns", "shell_seconds", "solid_seconds"])
        costs["unknowns_ratio"] = costs["solid_unknowns"] / costs["shell_unknowns"]
        costs["seconds_ratio"] = costs["solid_seconds"] / costs["shell_seconds"]
        off = own.loc[own["ratio"] >= THICK, "solid_against_exact"].abs().max()
        headline = table.loc[table["case"] == first["case"], "quantity"].iloc[0]
        rows.append(
            {
                **{name: first[name] for name in KEY},
                **{"judge": "solid" if own["exact"].isna().any() else "closed form", "solid_off": off},
                **{"thinnest": ratio[0], "thickest": ratio[-1], "at_thickest": error[-1], "known_to": known.max()},
                **{f"boundary_{100 * level:g}": at for level, at in zip(LEVELS, passed, strict=True)},
                "decided": all(decided(ratio, error, known, level) for level in LEVELS),
                "order": order(ratio, error, known),
                "headline": first["quantity"] == headline,
                "fails": first.get("fails", ""),
                **{str(name): costs[name].median() for name in COLUMNS[-4:]},
            }
        )
    return pd.DataFrame(rows, columns=list(COLUMNS))


def boundary(ratio: Sequence[float] | np.ndarray, error: Sequence[float] | np.ndarray, level: float) -> float:
    """The thickness from which on |error| is beyond ``level``: inf where it never is, 0 where it is from the start.

    ratio increases. Of an error that passes the level more than once the first time counts.
    """
    size = np.abs(np.asarray(error, float))
    after = _first_beyond(size, level)
    if after is None:
        return math.inf
    if after == 0:
        return 0.0
    (before, there), around = (
        np.asarray(error, float)[after - 1 : after + 1],
        np.asarray(ratio, float)[after - 1 : after + 1],
    )
    if before * there < 0:
        return float(np.interp(level, [-abs(before), abs(there)], around))
    (x0, x1), (y0, y1) = np.log(around), np.log(_positive(size)[after - 1 : after + 1])
    share = (math.log(level) - y0) / (y1 - y0)
    return float(np.exp(x0 + share * (x1 - x0)))


def _positive(size: np.ndarray) -> np.ndarray:
    """Sizes that have a logarithm."""
    return np.maximum(size, ZERO)


def _first_beyond(size: np.ndarray, level: float) -> int | None:
    beyond = np.flatnonzero(size > level)
    return int(beyond[0]) if len(beyond) else None


def decided(ratio: np.ndarray, error: np.ndarray, known: np.ndarray, level: float) -> bool:
    """Are the points between which the level is passed on their sides of it, whatever the meshes left?"""
    size = np.abs(error)
    after = _first_beyond(size, level)
    if after is None:
        return bool(np.all(size + known <= level))
    return bool(size[after] - known[after] > level and (after == 0 or np.all((size + known)[:after] <= level)))


def error_at(ratio: Sequence[float] | np.ndarray, error: Sequence[float] | np.ndarray, at: float) -> float:
    """|error| at a thickness, between the known ones; at the thickest beyond it, NaN below the thinnest."""
    x, size = np.asarray(ratio, float), _positive(np.abs(np.asarray(error, float)))
    if at < x[0] * (1 - 1e-9):
        return math.nan
    return float(np.exp(np.interp(math.log(at), np.log(x), np.log(size))))


def order(ratio: np.ndarray, error: np.ndarray, known: np.ndarray) -> float:
    """The p of error ~ h^p, least squares over the points that are told from zero and within ASYMPTOTIC.

    NaN with fewer than three of them, or where the error changes its sign: two errors work against each other there.
    """
    size, (low, high) = np.abs(error), ASYMPTOTIC
    own = (size > TOLD * known) & (size >= low) & (size <= high)
    if own.sum() < 3 or np.ptp(np.sign(error[own])) > 0:
        return math.nan
    return power_of(ratio[own], size[own])
