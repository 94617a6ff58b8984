"""Whether stated errors are honest and worth their price: quantities of all scenes to several errors.

The limit that counts for true is that of uniform grids, each with twice the elements of the one before both ways, far
beyond where a statement ends: Richardson's for the order 2 of the finest two, uncertain by what it differs from that of
the two before. A case whose true limit is not known to a third of what is stated, or comes from no finer grid, decides
nothing and counts apart.

The price of an answer is its CPU time over that of the cheapest grid, solved from rest, that is known to be as good:
its own error and those of all finer ones of its family are within what was asked. That grid is not known beforehand.
"""

import csv
import math
import time
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import pairwise
from pathlib import Path
from typing import Any

from studies.ask.request import Request
from studies.ask.scene import Scene
from studies.experiments import Row, tabulated
from studies.solving.refinement.cascade import answer
from studies.solving.refinement.grids import coarsest, first_grid
from studies.solving.refinement.richardson import correction, holds_from
from studies.solving.result import Result
from studies.solving.solve import solve

ERRORS = (0.05, 0.01)
FINEST = 40_000  # unknowns of the grids that count for true; a tenth where one element stands across
KNOWN = 1 / 3  # of the stated uncertainty, to which the true limit must be known


@dataclass(frozen=True)
class Case:
    """Quantities of a scene."""

    scene: str
    quantities: Sequence[str]
    settings: Mapping[str, str] = field(default_factory=dict)


def shipped_cases() -> Iterator[Case]:
    """Those of ``error_coverage.csv``: of all scenes; then loads and settings that no default names."""
    with Path(__file__).with_name("error_coverage.csv").open(encoding="utf-8") as file:
        for row in csv.DictReader(file):
            yield Case(row["scene"], row["quantities"].split(), settings_of(row["settings"]))


def settings_of(words: str) -> dict[str, str]:
    """Of "key=value key=value"."""
    return dict(word.split("=") for word in words.split())


@dataclass(frozen=True)
class Truth:
    """The limit of uniform grids, what it is known to a part of, and the unknowns of the finest of them."""

    limit: float
    known: float
    unknowns: int


@dataclass(frozen=True)
class Grid:
    """A grid solved from rest; seconds of CPU time."""

    unknowns: int
    seconds: float
    quantities: Mapping[str, float]


@tabulated
def error_coverage(cases: Iterable[Case] | None = None, errors: Sequence[float] = ERRORS) -> Iterator[Row]:
    """One row a case, quantity and error: what is stated, what counts for true, and what both cost.

    low, high: what is stated of the relative error of the value on the last grid; value_error: that error, against
    the limit ``true`` of other grids, ``known`` to a part of it.  stated, uncertainty: the limit and what is stated of
    it; off: how far the two limits are apart.  value_inside, inside: whether they are as stated; value_decided,
    decided: whether the true limit is known well enough to say so, or they are not, whatever it is.  cost: CPU time
    of the answer over that of the cheapest grid as good, NaN where none is known.
    """
    for case in shipped_cases() if cases is None else cases:
        uniform = uniform_grids(case)
        truths = {quantity: truth for quantity in case.quantities if (truth := limit_of_grids(uniform, quantity))}
        scene, request = first_grid(case.scene, case.settings)
        family: dict[tuple[int, int], Grid] = {}
        for quantity in case.quantities:
            for error in errors:
                start = time.process_time()
                result, known = answer(scene, request, error, quantity)
                seconds, truth = time.process_time() - start, truths.get(quantity)
                family |= {mesh: _cold(scene, replace(request, mesh=mesh)) for mesh in _meshes(result) - set(family)}
                least = min(cheapest(grids, quantity, error, truth) for grids in (uniform, list(family.values())))
                cost = seconds / least if math.isfinite(least) else math.nan
                row = _row(case, quantity, error, result, known=known) | {"cost": cost}
                yield row | (_against(row, truth) if truth is not None else {})


def uniform_grids(case: Case) -> list[Grid]:
    """Coarse to fine, those that carry the load."""
    scene, request = coarsest(case.scene, case.settings)
    most = FINEST if min(request.mesh) > 1 else FINEST / 10
    grids = list[Grid]()
    for times in range(10):
        n1, n2 = (n * 2**times if n > 1 else 1 for n in request.mesh)
        grid = _cold(scene, replace(request, mesh=(n1, n2)))
        if grid.quantities:
            grids.append(grid)
        if 4 * grid.unknowns > most:
            break
    return grids


def limit_of_grids(grids: Sequence[Grid], quantity: str) -> Truth | None:
    """What uniform grids say of a quantity; None where fewer than three have it."""
    seen = [grid.quantities[quantity] for grid in grids if quantity in grid.quantities]
    if len(seen) < 3:
        return None
    before, limit = (pair[1] + correction((2.0, 1.0), pair) for pair in pairwise(seen[-3:]))
    return Truth(limit, abs(limit - before) / abs(limit), grids[-1].unknowns)


def cheapest(grids: Sequence[Grid], quantity: str, error: float, truth: Truth | None) -> float:
    """CPU seconds of the cheapest of a family's grids that has the quantity to an error, as all finer ones have.

    What the truth is not known to counts as error. Infinite where there is none, or no truth.
    """
    if truth is None:
        return math.inf
    finer = sorted(grids, key=lambda each: each.unknowns)
    off = [abs(grid.quantities.get(quantity, math.nan) / truth.limit - 1) for grid in finer]
    enough = finer[holds_from([each + truth.known <= error for each in off]) :]
    return min((grid.seconds for grid in enough), default=math.inf)


def _cold(scene: Scene, request: Request) -> Grid:
    result = solve(scene, request)
    quantities = result.quantities if result.outcome.converged else {}
    return Grid(int(result.counters["dofs"]), result.timing["cpu"], quantities)


def _meshes(result: Result) -> set[tuple[int, int]]:
    """Of the cascade of an answer; none where grids were cut locally."""
    rows = result.table("refinement").rows() if "refinement" in result.tables else []
    sides = [str(row["mesh"]).split("x") for row in rows if "mesh" in row]
    return {(int(n1), int(n2)) for n1, n2 in sides}


def _row(case: Case, quantity: str, error: float, result: Result, *, known: bool) -> Row:
    """What was asked for, and what was stated."""
    quantities = result.quantities
    row = {
        "scene": case.scene,
        "settings": " ".join(f"{key}={value}" for key, value in case.settings.items()),
        "quantity": quantity,
        "asked": error,
        "reached": known,
        "reason": "" if known else result.reason,
        "unknowns": int(result.counters["dofs"]),
    }
    if "uncertainty" not in quantities:
        return row
    stated = {"stated": f"extrapolated_{quantity}", "low": "error_low", "high": "error_high"}
    known_to = {name: quantities[key] for name, key in stated.items()} | {"uncertainty": quantities["uncertainty"]}
    return row | {"value": quantities[quantity]} | known_to


def _against(row: Mapping[str, Any], truth: Truth) -> Row:
    """What is stated, beside the truth."""
    errors: Row = {"true": truth.limit, "known": truth.known}
    if "stated" not in row:
        return errors
    known, coarser = truth.known, row["unknowns"] < truth.unknowns
    off, error = abs(row["stated"] / truth.limit - 1), abs(row["value"] / truth.limit - 1)
    inside = off <= row["uncertainty"] + known
    value_inside = row["low"] - known <= error <= row["high"] + known
    return errors | {
        "value_error": error,
        "value_decided": coarser and (known <= KNOWN * (row["high"] - row["low"]) or not value_inside),
        "value_inside": value_inside,
        "off": off,
        "decided": coarser and (known <= KNOWN * row["uncertainty"] or not inside),
        "inside": inside,
    }
