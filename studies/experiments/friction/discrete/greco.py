"""The GRECO plate with friction, mu = 1: open, sliding and sticking in one contact; the problem that separates methods.

Source: Code_Aster SSNV128; Feijoo, Barbosa, Zouain. The values here are those of graded meshes of 9-node
quadrilaterals, 64x64 and 96x96 alike.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pandas as pd
from scipy import sparse

from contact.algorithms.semismooth import Semismooth
from contact.catalogue import by_the_exact_law
from contact.coulomb import Coulomb
from contact.operations import SPENT
from contact.problem import ContactAlgorithm, ContactProblem, ContactSolution
from studies.experiments.solids.greco_plate import GrecoPlate

PLACES = (0.0, 1.25, 5.0, 7.5, 11.25)  # mm
SLIPS = (2.8603e-2, 2.7226e-2, 2.2868e-2, 1.9808e-2, 1.5414e-2)  # mm
FRICTION = -1405.3  # N/mm
STIFF = 1e8  # MPa/mm, of regularised: penetrations of 1e-6 mm beside slips of 1e-2 mm


def frictional(plate: GrecoPlate, mu: float = 1.0) -> ContactProblem:
    """The plate on a plane with friction; its second slip is none."""
    slips = sparse.csr_matrix(sparse.kron(plate.along, [[1.0], [0.0]]))
    law = Coulomb(np.full(len(plate.x), mu), lambda u: (slips @ u).reshape(-1, 2), lambda u: slips)
    return replace(plate.problem, coulomb=law)


def solve(plate: GrecoPlate, algorithm: ContactAlgorithm | None = None, mu: float = 1.0) -> ContactSolution:
    """From rest, by semismooth Newton unless another algorithm is given."""
    rest = ContactSolution.at_rest(len(plate.free), len(plate.x))
    return (algorithm or Semismooth()).solve(frictional(plate, mu), rest)


def algorithms() -> list[ContactAlgorithm]:
    """All of the catalogue, on springs of STIFF where there are any."""
    return list(by_the_exact_law(STIFF).values())


def friction_table(meshes: Sequence[int] = (16, 32)) -> pd.DataFrame:
    """All algorithms on 9-node quadrilaterals: worst relative error of the five slips, the sum of friction, the cost.

    operations: in millions, by :mod:`contact.operations`.
    """
    rows = []
    for n in meshes:
        plate = GrecoPlate("Q2", n)
        for algorithm in algorithms():
            before = SPENT.total()
            found = solve(plate, algorithm)
            spent = (SPENT.total() - before) / 1e6
            slips = np.interp(PLACES, plate.x, plate.along @ found.u)
            row = {"elements": n, "algorithm": algorithm.name, "outcome": found.outcome.word}
            row |= {key: found.counters[key] for key in ("newton_iterations", "factorisations")}
            row |= {"operations": spent, "error": np.max(np.abs(slips / SLIPS - 1))}
            row |= {f"slip_{place:g}": slip for place, slip in zip(PLACES, slips, strict=True)}
            rows.append(row | {"friction_N": float(np.sum(found.rubbed.force[:, 0]))})
    return pd.DataFrame(rows)
