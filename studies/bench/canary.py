"""A fixed workload, whose time says whether the machine is what it was."""

from __future__ import annotations

import time

import numpy as np
from scipy import sparse
from scipy.sparse.linalg import splu

LOOKS = 25  # other programs disturb some of them, a slower machine all


def canary() -> float:
    """Seconds of a fixed workload, a sparse factorisation and small and large matrix products: the least of several."""
    n = 100
    line = sparse.diags_array([-1.0, 2.0, -1.0], offsets=(-1, 0, 1), shape=(n, n))
    A = sparse.csc_matrix(sparse.kron(line, sparse.eye_array(n)) + sparse.kron(sparse.eye_array(n), line))
    batch, block = np.ones((1000, 24, 24)), np.ones((300, 300))
    found = []
    for _ in range(LOOKS):
        start = time.perf_counter()
        splu(A, permc_spec="MMD_AT_PLUS_A", options={"SymmetricMode": True})
        np.einsum("eij,ejk->eik", batch, batch, optimize=True)
        block @ block
        found.append(time.perf_counter() - start)
    return min(found)
