"""When a shell is not enough: where the error of its kinematics passes a level, and whether a scene lies beyond.

Between two thicknesses the error is a power of h: log error over log thickness is interpolated; where it changes its
sign between them, two powers work against each other, and it is interpolated as it is. Nothing is extrapolated: what
is not passed on the way is infinite, what is passed from the start is 0.

A scene declares the case of studies.experiments.shell_limits that it is, or that comes nearest to it, and its thickness
in the terms of that case. Outside the thicknesses of its table nothing is said, but that a thicker wall is at least as
far off as the thickest known. The table is shipped to six digits without its costs, which are of one machine, as it was
when the sources were last published: advice has it where no campaign has been run.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from studies.ask.declarations import ShellLimit
from studies.ask.request import Settings
from studies.experiments.shell_limits.bodies import DEFAULT, MIDDLE, OF_SURFACES, REISSNER
from studies.scenes import SCENES
from studies.solving.refinement.richardson import power_of

SHIPPED = Path(__file__).parent / "advice" / "shell_limits.csv"
TABLE = "shell_limits"
LEVELS = (0.01, 0.05)
TOLD = 3.0  # times what it is known to: an error smaller than that is not told from zero
ASYMPTOTIC = 1e-4, 0.05  # errors between which the order shows: below is rounding in thin walls, above the next term
ZERO = 1e-15  # an error that is nothing but rounding
THICK = 0.01  # thinner walls are not what a solid is for
KEY = ("case", "scene", "quantity", "thickness", "variant")
COLUMNS = (
    *(*KEY, "judge", "solid_off", "thinnest", "thickest", "at_thickest", "known_to"),
    *(f"boundary_{100 * level:g}" for level in LEVELS),
    *("decided", "order", "headline", "fails", "unknowns_ratio", "seconds_ratio"),
)


def boundaries(table: pd.DataFrame) -> pd.DataFrame:
    """COLUMNS, a row a case, quantity and variant, in the order of the table.

    judge: "closed form" or "solid".  solid_off: the largest distance of the solid's limit from the closed form at
    thicknesses of a hundredth and more, where there is one.
    boundary_N: thickness at which the error passes N %.  known_to: the largest of the points.  decided: whether the
    points on either side of every boundary that is passed are told from its level.  order: see :func:`order`.
    headline: the first quantity of its case.  *_ratio: median of solid over shell, over the thicknesses, of meshes
    equally good.
    """
    rows: list[dict[str, Any]] = []
    for _, own in table.groupby(["case", "quantity", "variant"], sort=False):
        own = own.sort_values("ratio")
        first = own.iloc[0]
        error, ratio, known = (own[name].to_numpy(float) for name in ("error", "ratio", "known_to"))
        passed = [boundary(ratio, error, level) for level in LEVELS]
        ratios = {f"{cost}_ratio": own[f"solid_{cost}"] / own[f"shell_{cost}"] for cost in ("unknowns", "seconds")}
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
                **{name: each.median() for name, each in ratios.items()},
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
    (before, there), around = (np.asarray(each, float)[after - 1 : after + 1] for each in (error, ratio))
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


def beyond(scene: str, settings: Settings, quantity: str | None, tolerance: float, table: pd.DataFrame) -> str | None:
    """What is beyond the tolerance, in a line for a terminal; None within it, or where nothing is known of such a wall.

    table: of studies.experiments.shell_limits, or what is shipped of it.  Options of the shell that the scene sets and
    the table knows count: the law through the thickness, the shear correction, the pressure's area; of several the one
    that is farthest off. An error must exceed the tolerance by more than it is known to.
    """
    kind = getattr(SCENES[scene], "shell_limit", None)
    if kind is None or not (table["case"] == kind.case).any():
        return None
    case = table[table["case"] == kind.case]
    named = (own for start, own in kind.quantities.items() if (quantity or start).startswith(start))
    judged = str(next(named, case["quantity"].iloc[0]))
    of_case = case[case["quantity"] == judged].sort_values("ratio")
    asked = [name for name in _options(settings) if (of_case["variant"] == name).any()]
    ratio = kind.ratio(settings)
    solid = f"footprint solve {kind.solid}, as it is set" if kind.solid else "a solid, of which there is no scene"
    worst, line = tolerance, None
    for variant in asked or [DEFAULT]:
        own = of_case[of_case["variant"] == variant]
        x, errors, known = (own[name].to_numpy(float) for name in ("ratio", "error", "known_to"))
        error = error_at(x, errors, ratio)
        if error <= worst or not error - float(np.interp(ratio, x, known)) > tolerance:  # NaN is not beyond
            continue
        limit = boundary(x, errors, tolerance)
        size = f"{'at least ' if ratio > x[-1] * (1 + 1e-9) else ''}{100 * error:.2g} %"
        option = "" if variant == DEFAULT else f", {variant}"
        instead = ", or ".join(filter(None, (_fewest_surfaces(of_case, ratio, tolerance), solid)))
        passed = f"passed at {limit:.2g}" if limit else "passed in the thinnest wall known"
        worst = error
        line = f"shell not enough: at {own['thickness'].iloc[0]} = {ratio:.3g} its kinematics are {size} off a solid"
        line += f" ({judged} of {_known_as(kind, settings)}{option}); {100 * tolerance:.3g} % is {passed}; "
        line += f"solve instead: {instead}"
    return line


def _fewest_surfaces(of_case: pd.DataFrame, ratio: float, tolerance: float) -> str | None:
    """The option of the table with the fewest surfaces through the wall that is within the tolerance."""
    for variant in dict.fromkeys(of_case["variant"]):
        own = of_case[of_case["variant"] == variant]
        x, errors, known = (own[name].to_numpy(float) for name in ("ratio", "error", "known_to"))
        if not variant.startswith(OF_SURFACES) or ratio > x[-1] * (1 + 1e-9):
            continue
        error = error_at(x, errors, ratio)
        if error + float(np.interp(ratio, x, known)) <= tolerance:
            return f"the same with --set {variant}, {100 * error:.2g} % off"
    return None


def _known_as(kind: ShellLimit, settings: Settings) -> str:
    """The case of the table that a scene is of, or that comes nearest to it."""
    same = kind.same and (not kind.only_with or kind.only_with in settings)
    return kind.case if same else f"the nearest kind known, {kind.case}"


def _options(settings: Settings) -> tuple[str, ...]:
    """The variants of the table that these settings ask for."""
    asked = []
    if settings.get("pressure_area") == "mid":
        asked.append(MIDDLE.name)
    if "section" in settings:
        asked.append(f"section {settings['section']}")
    if abs(float(str(settings.get("shear_correction", 1.0))) - REISSNER.shear_correction) < 0.01:
        asked.append(REISSNER.name)
    return tuple(asked)


def known_limits(store: Path) -> pd.DataFrame:
    """The table of a store, or the one that is shipped where it has none."""
    own = store / "tables" / f"{TABLE}.csv"
    return pd.read_csv(own if own.exists() else SHIPPED)
