"""Numbers of negative eigenvalues against dense algebra, and stability in closed form."""

import math
from dataclasses import replace
from itertools import product

import numpy as np
import pytest
from scipy import sparse
from scipy.linalg import null_space

from contact.catalogue import ALGORITHMS
from contact.continuation.stability import NOT_COUNTED, STABLE, UNSTABLE, stability
from contact.problem import ContactProblem, ContactSolution, Linearisation, Outcome
from support.problems.contact_problems import Quadratic, random_quadratic

EPSILONS = (math.inf, 1e4, 3.0, 1e-3)


def indefinite(seed: int, kind: str, *, skew: float = 0.0) -> tuple[Quadratic, np.ndarray]:
    """A problem whose tangent has some negative eigenvalues, and a set of its candidates; skew: size of K - K^T."""
    rng = np.random.default_rng(seed)
    data = random_quadratic(rng, kind)
    values, vectors = np.linalg.eigh(data.K)
    values[rng.choice(len(values), rng.integers(0, 5), replace=False)] *= -1
    noise = rng.normal(size=data.K.shape)
    K = vectors @ np.diag(values) @ vectors.T + skew * (noise - noise.T)
    return Quadratic((K + K.T) / 2 if skew == 0 else K, data.f, data.G, data.g0, data.w), rng.random(len(data.w)) < 0.6


def on(active: np.ndarray, n: int) -> ContactSolution:
    """A state with that set; all that the tangent of a quadratic problem depends on."""
    return ContactSolution(np.zeros(n), np.zeros(len(active)), active, Outcome.CONVERGED)


def projected(data: Quadratic, active: np.ndarray, epsilon: float) -> np.ndarray:
    """The tangent on the motions that the set leaves free, or with its springs, dense."""
    G = data.G[active]
    if math.isinf(epsilon):
        Z = null_space(G) if active.any() else np.eye(len(data.K))
        return Z.T @ data.K @ Z
    return data.K + epsilon * G.T @ np.diag(data.w[active]) @ G


def test_negative_eigenvalues_are_those_of_dense_algebra() -> None:
    for kind, epsilon in product(("obstacle", "definite", "inclined"), EPSILONS):
        seen = set()
        for seed in range(8):
            data, active = indefinite(seed, kind)
            wanted = int(np.sum(np.linalg.eigvalsh(projected(data, active, epsilon)) < 0))
            for ordered in (False, True):  # by SuperLU, by fronts
                problem = replace(data.problem(), ordered=ordered)
                actual = stability(problem, on(active, len(data.f)), epsilon)
                assert (actual.negative, actual.rounding) == (wanted, 0)
                assert actual.word == (UNSTABLE if wanted else STABLE)
            seen.add(wanted)
        assert len(seen) > 2


def test_the_state_of_every_algorithm_is_judged_by_its_own_law() -> None:
    for name in ALGORITHMS:
        algorithm = ALGORITHMS[name]()
        data = random_quadratic(np.random.default_rng(3), "inclined")
        problem = data.problem()
        state = algorithm.solve(problem, ContactSolution.at_rest(len(data.f), len(data.w)))
        assert state.outcome.converged
        assert state.active.any()
        assert stability(problem, state, algorithm.epsilon).word == STABLE


def test_a_tangent_that_is_not_symmetric_is_stable_unstable_or_not_counted() -> None:
    """Each against its definition by dense eigenvalues; no state is called stable or unstable that is not."""
    words = set()
    for seed in range(40):
        data, active = indefinite(seed, "inclined", skew=0.1)
        actual = stability(data.problem(), on(active, len(data.f)))
        M = projected(data, active, math.inf)
        divergent = int(np.sum(np.linalg.eigvals(M).real < 0))
        work = np.linalg.eigvalsh((M + M.T) / 2)
        assert actual.word == (STABLE if work[0] > 0 else UNSTABLE if divergent else NOT_COUNTED)
        assert (actual.negative or 0) <= divergent
        words.add(actual.word)
    assert words >= {STABLE, UNSTABLE}
    turned = np.array([[-1.0, 10.0], [-10.0, 2.0]])  # work is negative along the first axis; eigenvalues 1/2 +- 9.9i
    problem = Quadratic(turned, np.zeros(2), np.zeros((0, 2)), np.zeros(0), np.zeros(0)).problem()
    assert stability(problem, on(np.zeros(0, bool), 2)).word == NOT_COUNTED


def test_a_consistent_coupling_is_not_counted() -> None:
    data = random_quadratic(np.random.default_rng(0), "definite")
    coupling = np.diag(data.w) + 0.1
    actual = stability(data.problem(coupling), on(np.ones(len(data.w), bool), len(data.f)))
    assert actual.word == NOT_COUNTED
    assert "consistent" in actual.sentence


def springs(n: int) -> sparse.csc_matrix:
    """Masses in a row in a plane (2n unknowns), stretched by springs across it, with free ends: two translations."""
    along = sparse.diags_array([-np.ones(n - 1), np.ones(n - 1)], offsets=[0, 1], shape=(n - 1, n))
    K = along.T @ along
    return sparse.csc_matrix(sparse.block_diag([K, 1e3 * K]))


@pytest.mark.parametrize("n", [5, 40, 200])
def test_a_body_that_only_the_foundation_holds_has_an_eigenvalue_without_a_sign(n: int) -> None:
    """One node is pressed down; the other translation is free, and is not an instability."""
    K = springs(n)
    rotation = np.linalg.qr(np.random.default_rng(n).normal(size=(2, 2)))[0]
    turn = sparse.csc_matrix(sparse.kron(rotation, sparse.eye_array(n)))
    K = sparse.csc_matrix(turn @ K @ turn.T)
    G = sparse.csr_matrix((turn @ np.eye(2 * n)[:, [n]]).T)
    problem = ContactProblem(
        lambda u, memory: Linearisation(K @ u, K, 1.0), lambda u: G @ u, lambda u: G, np.ones(1), ordered=False
    )
    actual = stability(problem, on(np.ones(1, bool), 2 * n))
    assert actual.word == STABLE
    assert actual.rounding <= 1


K_LINK, LENGTH = 3.0, 2.0


@pytest.mark.parametrize(("load", "tilt", "negative"), [(0.99, 0.0, 0), (1.01, 0.0, 1), (1.2, None, 0)])
def test_the_column_of_euler(load: float, tilt: float | None, negative: int) -> None:
    """An upright link on a spring k under P, the simplest column: P_cr = k/l; the tilted branch k th = P l sin th."""
    P = load * K_LINK / LENGTH
    angle = tilt if tilt is not None else tilted(load)

    def linearise(u, memory):
        stiffness = sparse.csc_matrix([[K_LINK - P * LENGTH * np.cos(u[0])]])
        return Linearisation(np.array([K_LINK * u[0] - P * LENGTH * np.sin(u[0])]), stiffness, P)

    nothing = sparse.csr_matrix((0, 1))
    problem = ContactProblem(linearise, lambda u: np.zeros(0), lambda u: nothing, np.zeros(0))
    state = ContactSolution(np.array([angle]), np.zeros(0), np.zeros(0, bool), Outcome.CONVERGED)
    assert abs(linearise(state.u, None).residual[0]) < 1e-12
    assert stability(problem, state).negative == negative


def tilted(load: float) -> float:
    """The angle with th = load sin th."""
    angle = 1.0
    for _ in range(50):
        angle -= (angle - load * math.sin(angle)) / (1 - load * math.cos(angle))
    return angle


def test_an_element_with_a_mode_is_cut_in_two_at_the_least() -> None:
    """Also where the drive of its stress alone asks for no cut."""

    class One:
        stiffness = (sparse.csc_matrix(np.diag([2.0, 0.0])), sparse.csc_matrix((2, 2)))
        cuts, aspect, order = (1, 1), 1.0, None

        def alternating(self, modes: np.ndarray) -> int:
            return 1

    data = Quadratic(np.diag([-1.0, 1.0]), np.zeros(2), np.zeros((0, 2)), np.zeros(0), np.zeros(0))
    problem = replace(data.problem(), element_modes=lambda u: One())
    actual = stability(problem, on(np.zeros(0, bool), 2))
    assert (actual.negative, actual.element_modes, actual.cuts) == (0, 1, (2, 1))
    assert "elements cut in 2 along a1 have none" in actual.sentence
