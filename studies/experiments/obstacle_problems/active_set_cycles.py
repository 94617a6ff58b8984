"""Where plain sets go round in circles: published and small problems, by the textbook's swaps and by our algorithms."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import replace

import numpy as np
from scipy import sparse

from contact.catalogue import ALGORITHMS
from contact.events import EventKind, events
from contact.problem import ContactSolution
from studies.experiments.obstacle_problems.collection import Bounded, classic, obstacle, torsion
from studies.experiments.rows import Row, tabulated

WAYS: dict[str, tuple[str, dict[str, float]]] = {
    "trial-and-error": ("trial-and-error", {}),
    "semismooth, settle 1": ("semismooth", {"settle": 1.0}),
    "semismooth": ("semismooth", {}),
    "regularised": ("regularised", {"epsilon": 1e8}),
}


def small() -> Bounded:
    """A symmetric, positive definite problem of three unknowns x >= 0 on which swapping all violators has period 3.

    The matrix is recalled from Curtis, Han, Robinson, Comput. Optim. Appl. 60 (2015) 311-341; f was found by search.
    """
    K = sparse.csc_matrix(np.array([[4.0, 5.0, -5.0], [5.0, 9.0, -5.0], [-5.0, -5.0, 7.0]]))
    above, zero = np.full(3, np.inf), np.zeros(3)
    return Bounded("3x3", K, np.array([2.0, 1.0, -3.0]), zero, above, zero)


def plain_period(body: Bounded) -> int:
    """Period of the plain active set, 0 when it settles: both bounds are one set, an unknown may jump between them.

    Source: Bergounioux, Ito, Kunisch, SIAM J. Control Optim. 37 (1999) 1176-1194, with one bound.
    """
    seen: dict[bytes, int] = {}
    x, force = body.start, body.K @ body.start - body.f
    while True:
        side = _side(body, x, force)
        if side.tobytes() in seen:
            period = len(seen) - seen[side.tobytes()]
            return 0 if period == 1 else period
        seen[side.tobytes()] = len(seen)
        free = side == 0
        x = np.where(side < 0, body.low, np.where(side > 0, body.up, 0.0))
        x[free] = sparse.linalg.spsolve(body.K[free][:, free], (body.f - body.K @ x)[free])
        force = np.where(free, 0.0, body.K @ x - body.f)


def _side(body: Bounded, x: np.ndarray, force: np.ndarray) -> np.ndarray:
    """-1 at the lower bound, 1 at the upper, 0 free (n,), by force and violation together."""
    return np.where(force + body.low - x > 0, -1, np.where(force + body.up - x < 0, 1, 0))


def _begin(body: Bounded) -> ContactSolution:
    """The start of the body with the set that the plain one begins with."""
    side = _side(body, body.start, body.K @ body.start - body.f)
    below, above = np.isfinite(body.low), np.isfinite(body.up)
    return replace(body.begin(), active=np.concatenate([side[below] < 0, side[above] > 0]))


def problems() -> list[Bounded]:
    """Those on which the plain set goes round, and one on which it does not."""
    sides = [obstacle(f"OBSTCLB{start}", 23) for start in "LMU"]
    cyclic = [replace(classic("Ben Gharbia-Gilbert", n), start=-np.eye(n)[0]) for n in (3, 5, 7)]
    return [small(), *cyclic, *sides, torsion(5.0, 22)]


@tabulated
def cycles() -> Iterator[Row]:
    """One row a problem: period of the plain set; then, for each way, its outcome and whether it noticed a cycle."""
    for body in problems():
        row: Row = {"problem": body.name, "plain_period": plain_period(body)}
        for way, (name, settings) in WAYS.items():
            found = ALGORITHMS[name](**{"epsilon": math.inf} | settings).solve(body.problem(), _begin(body))
            noticed = events(found.history, EventKind.CYCLE)
            row[way] = found.outcome.word + (", cycle detected" if noticed else "")
        yield row
