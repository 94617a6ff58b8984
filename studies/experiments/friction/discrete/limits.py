"""Both ends of the coefficient on the GRECO plate: without friction, and with an infinite one.

mu = 0 is the contact problem alone: the same answer as by the algorithm without friction, but for rounding, as both
eliminate in other orders. With mu = inf who touches is tied to where it touched. From rest, who never leaves its place
is tied there, and what is left is linear: nodes that touch have no displacement, the others no force. Every set of
nodes can be tried, by elimination alone. There may be one for which no node is pulled and none penetrates, or none:
existence ends at a large coefficient (Klarbring, Ing.-Archiv 60 (1990) 529-541), and the plate has such meshes.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import product

import numpy as np
import pandas as pd
from scipy.sparse.linalg import splu

from contact.algorithms.semismooth import Semismooth as Frictionless
from contact.coulomb import State
from contact.problem import ContactSolution
from studies.experiments.friction.discrete.greco import solve
from studies.experiments.solids.greco_plate import LOADS, GrecoPlate

ELEMENTS = ("Q1", "Q2")
MESHES = (8, 16)
TIED = (("Q1", 4), ("Q1", 6), ("Q1", 8), ("Q1", 10), ("Q2", 4), ("Q2", 5))


def tied(plate: GrecoPlate) -> list[tuple[np.ndarray, np.ndarray]]:
    """Every answer with mu = inf: u (n,), and who is tied (m,) bool; 2^m sets are tried on the nodes that may touch."""
    m, f = len(plate.x), plate.forces[plate.free]
    touching = np.concatenate([plate.across.indices, plate.along.indices])
    inside = np.setdiff1d(np.arange(len(f)), touching)
    K = plate.stiffness.tocsr()
    factor = splu(K[inside][:, inside].tocsc())
    beside = K[inside][:, touching].toarray()
    condensed = K[touching][:, touching].toarray() - beside.T @ factor.solve(beside)
    load = f[touching] - beside.T @ factor.solve(f[inside])
    found = []
    for each in product((False, True), repeat=m):
        holds = np.array(each)
        free = np.flatnonzero(~np.tile(holds, 2))
        at = np.zeros(2 * m)
        at[free] = np.linalg.solve(condensed[np.ix_(free, free)], load[free])
        if np.all(np.where(holds, (condensed @ at - load)[:m], at[:m]) >= 0):
            u = np.zeros(len(f))
            u[touching], u[inside] = at, factor.solve(f[inside] - beside @ at)
            found.append((u, holds))
    return found


def tied_table(cases: Sequence[tuple[str, int]] = TIED) -> pd.DataFrame:
    """mu = inf under every load on each (element, elements), beside all answers of :func:`tied`.

    answers: how many there are.  tied: nodes of the first; otherwise: nodes that do something else; difference: of u
    from it, over its largest; NaN where there is none.  iterations: of Newton.
    """
    rows = []
    for (element, n), load in product(cases, LOADS):
        plate = GrecoPlate(element, n, load)
        answers, found = tied(plate), solve(plate, mu=math.inf)
        row = {"elements": n, "element": element, "load": load, "nodes": len(plate.x), "answers": len(answers)}
        row |= {"outcome": found.outcome.word, "iterations": found.counters["newton_iterations"]}
        row |= {"tied": math.nan, "otherwise": math.nan, "difference": math.nan}
        if answers:
            u, holds = answers[0]
            row |= {"tied": int(holds.sum()), "otherwise": int(np.sum((found.rubbed.state == State.STICK) != holds))}
            row |= {"difference": float(np.max(np.abs(found.u - u)) / np.max(np.abs(u)))}
        rows.append(row)
    return pd.DataFrame(rows)


def frictionless_table(elements: Sequence[str] = ELEMENTS, meshes: Sequence[int] = MESHES) -> pd.DataFrame:
    """mu = 0 under every load beside the algorithm without friction: difference of u and of f over their largest.

    iterations, iterations_without: of Newton.  otherwise: nodes in another state.
    """
    rows = []
    for element, n, load in product(elements, meshes, LOADS):
        plate = GrecoPlate(element, n, load)
        rest = ContactSolution.at_rest(len(plate.free), len(plate.x))
        alone, found = Frictionless(epsilon=math.inf).solve(plate.problem, rest), solve(plate, mu=0.0)
        force = plate.weights * alone.pressure
        rows.append(
            {"elements": n, "element": element, "load": load, "outcome": found.outcome.word}
            | {"iterations": found.counters["newton_iterations"]}
            | {"iterations_without": alone.counters["newton_iterations"]}
            | {"otherwise": int(np.sum(found.active != alone.active))}
            | {"difference": float(np.max(np.abs(found.u - alone.u)) / np.max(np.abs(alone.u)))}
            | {
                "force_difference": float(
                    np.max(np.abs(plate.weights * found.pressure - force)) / np.max(np.abs(force))
                )
            }
            | {"friction_N": float(np.max(np.abs(found.rubbed.force)))}
        )
    return pd.DataFrame(rows)
