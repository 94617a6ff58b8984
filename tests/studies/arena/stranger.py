"""Solves a frozen contact problem with numpy and scipy alone: python stranger.py PROBLEM.npz ANSWER.json."""

import json
import sys
from pathlib import Path

import numpy as np
from scipy.sparse import block_array, csc_array, csr_array, diags_array
from scipy.sparse.linalg import spsolve

with np.load(sys.argv[1]) as file:
    r, gap, weights = file["r"], file["gap"], file["weights"]
    n, m = len(r), len(gap)
    K = csc_array((file["K_data"], file["K_indices"], file["K_indptr"]), shape=(n, n))
    G = csr_array((file["G_data"], file["G_indices"], file["G_indptr"]), shape=(m, n))
pressed = gap < 0
for _ in range(50):  # a primal-dual active set: closed where pressed, no pressure elsewhere
    closed, free = diags_array(pressed.astype(float)), diags_array((~pressed).astype(float))
    A = block_array([[K, -G.T @ diags_array(weights)], [closed @ G, free]], format="csc")
    x = spsolve(A, np.concatenate([-r, -gap * pressed]))
    du, pressure = x[:n], x[n:]
    expected = np.where(pressed, pressure > 0, gap + G @ du < 0)
    if np.array_equal(expected, pressed):
        break
    pressed = expected
claims = {"accuracy": 1e-8, "pressed": np.flatnonzero(pressure > 0).tolist()}
answer = {"du": du.tolist(), "pressure": pressure.tolist(), "claims": claims}
Path(sys.argv[2]).write_text(json.dumps(answer), encoding="utf-8")
