"""The softest motions that a contact set leaves free, against dense algebra."""

from itertools import product

import numpy as np
import pytest
from scipy.linalg import null_space

from contact.continuation.spectrum import MODES, spectrum
from contact.problem import ContactSolution, Outcome
from support.problems.contact_problems import Quadratic, random_quadratic


def test_the_softest_motion_by_dense_algebra() -> None:
    kinds = "obstacle", "definite", "inclined"
    # the shift takes the lowest eigenvalues below zero; with 4 dense, with 25 sparse
    for epsilon, kind, shift, m in product((np.inf, 10.0), kinds, (0.0, 0.5), (4, 25)):
        data = random_quadratic(np.random.default_rng(m), kind, m)
        K = data.K - shift * np.eye(len(data.K))
        problem = Quadratic(K, data.f, data.G, data.g0, data.w).problem()
        active = np.arange(m) % 3 == 0
        state = ContactSolution(np.zeros(len(K)), active.astype(float), active, Outcome.CONVERGED)
        G, w = data.G[active], data.w[active]
        Z = null_space(G) if np.isinf(epsilon) else np.eye(len(K))
        restricted = Z.T @ (K if np.isinf(epsilon) else K + epsilon * (G.T * w) @ G) @ Z
        values, modes = np.linalg.eigh(restricted)
        order = np.argsort(np.abs(values))[:MODES] if m > 4 else np.argsort(np.abs(values))
        actual = spectrum(problem, state, epsilon)
        assert actual.eigenvalues == pytest.approx(values[order], rel=1e-7)
        assert np.abs(np.sum(actual.modes * (Z @ modes[:, order]), axis=0)) == pytest.approx(1.0, rel=1e-6)
        assert actual.negative == np.sum(values < 0)


def test_an_unsymmetric_tangent_has_an_eigenvalue_but_no_count() -> None:
    rng = np.random.default_rng(1)
    root = rng.normal(size=(30, 30))
    values = np.append(0.01, np.linspace(1, 2, 29))
    K = root @ np.diag(values) @ np.linalg.inv(root)
    problem = Quadratic(K, np.zeros(30), np.eye(30)[:1], np.zeros(1), np.ones(1)).problem()
    actual = spectrum(problem, ContactSolution.at_rest(30, 1))
    assert actual.eigenvalues[0] == pytest.approx(0.01, rel=1e-6)
    assert abs(actual.modes[:, 0] @ root[:, 0]) == pytest.approx(np.linalg.norm(root[:, 0]), rel=1e-6)
    assert actual.negative is None


def test_nothing_is_free_to_move() -> None:
    problem = Quadratic(np.eye(1), np.zeros(1), np.eye(1), np.zeros(1), np.ones(1)).problem()
    state = ContactSolution(np.zeros(1), np.zeros(1), np.ones(1, bool), Outcome.CONVERGED)
    assert len(spectrum(problem, state).eigenvalues) == 0
