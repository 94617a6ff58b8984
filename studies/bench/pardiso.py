"""PARDISO at its best, as a rival of fronts: the matrix type of each kind, and an analysis that is kept.

The solver ``pardiso`` of a solve analyses each matrix anew, and takes all for matrices that are not symmetric.
"""

from __future__ import annotations

import numpy as np
from pypardiso import PyPardisoSolver
from scipy import sparse

ANALYSIS, NUMERIC, SOLUTION = 11, 22, 33
TYPES = {"definite": 2, "indefinite": -2, "general": 11}
# own values for all; METIS; no refinement; pivots perturbed at 1e-13; neither scaling nor matching; Bunch and Kaufman
OPTIONS = {1: 1, 2: 2, 8: 0, 10: 13, 11: 0, 13: 0, 21: 1}


class Numeric:
    """A matrix that is analysed, and factorised as often as it is asked for."""

    def __init__(self, A: sparse.csc_matrix, *, definite: bool, symmetric: bool) -> None:
        kind = "definite" if definite else "indefinite" if symmetric else "general"
        self._solver = PyPardisoSolver(mtype=TYPES[kind])
        for index, value in OPTIONS.items():
            self._solver.set_iparm(index, value)
        rows = sparse.csr_matrix(sparse.triu(A) if symmetric else A)
        rows.sort_indices()
        self._matrix, self._nothing = rows, np.zeros(A.shape[0])
        self._phase(ANALYSIS, self._nothing)

    def factorised(self) -> Numeric:
        """The numbers of L and U, in the places known."""
        self._phase(NUMERIC, self._nothing)
        return self

    def solve(self, b: np.ndarray) -> np.ndarray:
        """x with A x = b."""
        return self._phase(SOLUTION, b)

    def _phase(self, phase: int, b: np.ndarray) -> np.ndarray:
        self._solver.set_phase(phase)
        return np.asarray(self._solver._call_pardiso(self._matrix, b))

    def __del__(self) -> None:
        self._solver.free_memory(everything=True)
