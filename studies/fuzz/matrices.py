"""Contact of a few unknowns with random matrices, made from its answer: displacements, pressures and gaps are chosen.

f = K u - G^T W p and g0 = g - G u make (u, p) the answer, with p > 0 and g = -p/epsilon at some candidates, p = 0 and
g > 0 at others, and both zero at the rest: touch without pressure. The symmetric part of K is positive definite, so u
and the contact forces are unique. No two candidates share an unknown, as nodes before an obstacle do not; sizes differ
by powers of ten.
"""

from __future__ import annotations

import numpy as np
from scipy import sparse

from contact.catalogue import ALGORITHMS
from contact.newton.solves import RESIDUAL_TOLERANCE
from contact.problem import ContactAlgorithm, ContactProblem, ContactSolution, Outcome, linear_mechanics
from contact.verify import claim, judge
from studies.ask.settings import configured, parameters_of
from studies.fuzz.attempt import CONVERGED, ENDED, REFUSED, Broken, Passed, no_traceback, one_line, quiet, watched
from studies.fuzz.comparing import Answer, compared
from studies.fuzz.values import drawn, generator

MOST_UNKNOWNS, MOST_CANDIDATES = 12, 6
SPREAD, UNITS = 2.0, 3.0  # powers of ten: of the eigenvalues of K, of the sizes of forces and areas
PRESSED, TOUCHING = 0.4, 0.25  # shares of the candidates
SETTINGS = 2  # parameters of the algorithm that leave their defaults


def algorithm_of(seed: int) -> tuple[str, dict[str, str]]:
    """The algorithm of a case and those of its parameters that are drawn."""
    rng = generator(seed, "algorithm")
    contact = str(rng.choice(list(ALGORITHMS)))
    known = {setting.key: setting for setting in parameters_of(contact) if setting.key != "solver"}
    keys = rng.permutation(list(known))[: int(rng.integers(0, SETTINGS + 1))]
    return contact, {str(key): drawn(known[key], seed) for key in keys}


def made(seed: int, epsilon: float) -> tuple[ContactProblem, ContactSolution]:
    """A problem and its answer."""
    rng = generator(seed, "matrices")
    n = int(rng.integers(1, MOST_UNKNOWNS + 1))
    m = int(rng.integers(1, min(n, MOST_CANDIDATES) + 1))
    owner = np.append(np.arange(m), rng.integers(-1, m, size=n - m))  # -1: an unknown that moves no candidate
    Q, _ = np.linalg.qr(rng.normal(size=(n, n)))
    force, area = 10.0 ** rng.uniform(-UNITS, UNITS, size=2)
    K = (Q * 10.0 ** rng.uniform(-SPREAD, SPREAD, size=n)) @ Q.T
    K = force * (K + K.T) / 2
    if rng.random() < 0.2:  # as under loads that follow
        skew = rng.normal(size=(n, n))
        K = K + 0.3 * float(np.linalg.norm(K)) / n * (skew - skew.T) / 2
    G = rng.normal(size=(m, n)) * (rng.permutation(owner) == np.arange(m)[:, None])
    weights = area * 10.0 ** rng.uniform(-1, 1, size=m)
    state = rng.random(m)
    pressed, touching = state < PRESSED, (state >= PRESSED) & (state < PRESSED + TOUCHING)
    p = np.where(pressed, rng.uniform(0.1, 1, size=m) * force / area, 0.0)
    g = np.where(pressed, -p / epsilon, np.where(touching, 0.0, rng.uniform(0.1, 1, size=m)))
    u = rng.normal(size=n)
    g0, f = g - G @ u, K @ u - G.T @ (weights * p)
    rows = sparse.csr_matrix(G)
    problem = ContactProblem(linear_mechanics(sparse.csc_matrix(K), f), lambda x: g0 + G @ x, lambda x: rows, weights)
    return problem, ContactSolution(u, p, p > 0, Outcome.CONVERGED)


def about(seed: int) -> str:
    """The algorithm and its parameters, in words."""
    contact, settings = algorithm_of(seed)
    return " ".join([contact, *(f"{key}={value}" for key, value in settings.items())])


def check(seed: int) -> Passed:
    """Solve, judge, and compare with the answer; raises Broken."""
    contact, given = algorithm_of(seed)
    values = {s.key: s.parse(given[s.key]) for s in parameters_of(contact) if s.key in given}
    try:
        algorithm = configured(contact, values)
    except ValueError as error:
        return Passed(REFUSED, said=one_line(str(error)))
    problem, answer = made(seed, algorithm.epsilon)
    refused = algorithm.supports(problem)
    if refused is not None:
        return Passed(REFUSED, said=one_line(refused))
    with no_traceback():
        found = algorithm.solve(watched(problem), ContactSolution.at_rest(len(answer.u), len(answer.pressure)))
    with quiet():
        return _judged(algorithm, problem, found, answer)


def _judged(
    algorithm: ContactAlgorithm, problem: ContactProblem, found: ContactSolution, answer: ContactSolution
) -> Passed:
    if found.outcome is Outcome.REFUSED:
        return Passed(REFUSED, said=one_line(str(found.history[-1].get("event", ""))))
    if not found.outcome.converged:
        return Passed(f"{ENDED}: {found.outcome.word}")
    tolerance = float(getattr(algorithm, "tolerance", RESIDUAL_TOLERANCE))
    verdict = judge(problem, found.u, found.pressure, epsilon=algorithm.epsilon)
    failures = verdict.failures(**claim(tolerance, len(found.u)))
    if failures:
        told = ", ".join(f"{name} {value:.2e}" for name, value in {**verdict.kkt, **verdict.balances}.items())
        raise Broken("certified", f"{', '.join(failures)}: {told}")
    said = compared(*(Answer(problem, state, algorithm) for state in (answer, found)))
    if not said or said.startswith("two"):  # K is definite: there is one answer
        raise Broken("the made answer", "converged to another state")
    return Passed(CONVERGED, "the made answer", said)
