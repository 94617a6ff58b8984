"""Tangents of the whole tyre as matrices to factorise: definite, indefinite with a known inertia, not symmetric."""

from __future__ import annotations

import importlib.util
from collections.abc import Iterator
from functools import partial

import numpy as np
from scipy import sparse
from scipy.sparse.linalg import LinearOperator, eigsh

from contact.solvers.multifrontal.factor import Multifrontal
from contact.solvers.sparse import BACKWARD_ERROR, Factor, backward_error, factorise
from formulations.shell import ShellModel
from studies.bench.newton import asked, tyre
from studies.bench.rounds import Group, Line

OVER_SPLU, OVER_PARDISO = 0.35, 2.2
LOWEST = 12  # eigenvalues that are found to shift between two of them
AT_LEAST = 3  # of them negative then
DEFINITE, INDEFINITE, GENERAL = "definite", "indefinite", "not symmetric"


def shell_of(mesh: str, **settings: str) -> ShellModel:
    """The whole tyre of the paper; raises UsageError."""
    return tyre(asked(mesh, **settings)).shell


def at_rest(shell: ShellModel) -> sparse.csc_matrix:
    """The tangent (n, n) at u = 0, definite where it is symmetric; its unknowns are in an order of elimination."""
    return sparse.csc_matrix(shell.linearise(np.zeros(shell.discretisation.n_free)).tangent)


def shifted(K: sparse.csc_matrix) -> tuple[sparse.csc_matrix, int]:
    """K - s with s in the widest relative gap between low eigenvalues of the definite K, and how many are below it.

    They are found by Lanczos's method on K^-1 by SuperLU: fronts have no part in it.
    """
    inverse = LinearOperator(K.shape, matvec=factorise(K, "splu", ordered=True).solve, dtype=float)
    low = np.sort(eigsh(K, k=LOWEST, sigma=0.0, OPinv=inverse, return_eigenvectors=False))
    below = AT_LEAST + int(np.argmax(low[AT_LEAST:] / low[AT_LEAST - 1 : -1]))
    found = K.copy()  # a difference would lose the zeros of its pattern
    found.setdiag(K.diagonal() - np.sqrt(low[below - 1] * low[below]))
    return found, below


def factorisations(mesh: str) -> Iterator[Group]:
    """The tangents of a mesh, a group each, by fronts, SuperLU and, where it is installed, PARDISO."""
    K = at_rest(shell_of(mesh))
    yield _of_kind(DEFINITE, K)
    yield _of_kind(INDEFINITE, *shifted(K))
    yield _of_kind(GENERAL, at_rest(shell_of(mesh, section="nonsymmetric")))


def _of_kind(kind: str, A: sparse.csc_matrix, negative: int = 0) -> Group:
    b = np.random.default_rng(12).normal(size=A.shape[0])

    def see(factor: Factor, seconds: float) -> dict[str, float]:
        found = {"backward error": backward_error(A, factor.solve(b), b)}
        if isinstance(factor, Multifrontal) and kind != GENERAL:
            found |= {"negative": factor.negative, "wrong inertia": abs(factor.negative - negative)}
        return found

    over, most = {"splu": OVER_SPLU}, {"backward error": BACKWARD_ERROR, "wrong inertia": 0.0}
    lines = [Line("splu", partial(factorise, A, "splu", ordered=True), see, cold=True)]
    if with_pardiso():
        from studies.bench.pardiso import Numeric

        over["PARDISO"] = OVER_PARDISO
        numeric = Numeric(A, definite=kind == DEFINITE, symmetric=kind != GENERAL)
        lines.append(Line("PARDISO", numeric.factorised, see, cold=True))
    fronts = Line("fronts", partial(factorise, A, "multifrontal", ordered=True), see, over, most)
    return Group(f"factorisation of {A.shape[0]} unknowns, {kind}", [fronts, *lines])


def with_pardiso() -> bool:
    """Whether the extra mkl is installed."""
    return importlib.util.find_spec("pypardiso") is not None
