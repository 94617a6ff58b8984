"""The step under given states: against the saddle-point system, from whatever states it was factorised on."""

from __future__ import annotations

import numpy as np
import pytest
from scipy import sparse

from contact.coulomb import State
from contact.newton.friction_states import Directions, Laws
from contact.newton.friction_step import FrictionalStep, Linear, Stepped
from contact.newton.step import NewtonRun
from contact.problem import ContactProblem
from tests.support.problems.planted_friction import planted


def random_laws(rng: np.random.Generator, m: int, *, flat: bool) -> Laws:
    """Any states, directions and springs."""
    state = rng.integers(0, 3, m).astype(np.int8)
    angle = rng.uniform(0, 2 * np.pi, m)
    d = np.column_stack([np.cos(angle), np.sin(angle)])
    if flat:
        d = np.column_stack([np.sign(d[:, 0]), np.zeros(m)])
    slips = state == State.SLIP
    return Laws(state, d * slips[:, None], rng.uniform(0, 2, m) * slips)


def saddle_point(problem: ContactProblem, u: np.ndarray, laws: Laws) -> Stepped:
    """The same with every force an unknown."""
    n, m = len(u), len(problem.weights)
    lin = problem.linearise(u, None)
    G, S = problem.gap_jacobian(u).toarray(), problem.coulomb.slip_jacobian(u).toarray()
    g, s = problem.gap(u), problem.coulomb.slip(u)
    A = np.zeros((n + 3 * m, n + 3 * m))
    b = np.zeros(n + 3 * m)
    A[:n, :n], b[:n] = lin.tangent.toarray(), -lin.residual
    A[:n, n : n + m], A[:n, n + m :] = -G.T, -S.T
    for i in range(m):
        f, t, state = n + i, [n + m + 2 * i, n + m + 2 * i + 1], laws.state[i]
        if state == State.OPEN:
            A[f, f] = 1
        else:
            A[f, :n], b[f] = G[i], -g[i]
        for k, row in enumerate(t):
            way = S[2 * i + k]
            A[row, row] = 1
            if state == State.STICK and way.any():
                A[row, row], A[row, :n], b[row] = 0, way, -s[i, k]
            elif state == State.SLIP:
                A[row, f] = problem.coulomb.mu[i] * laws.direction[i, k]
                A[row, :n] += laws.spring[i, k] @ S[2 * i : 2 * i + 2]
                b[row] = -laws.spring[i, k] @ s[i]
    x = np.linalg.solve(A, b)
    du = x[:n]
    return Stepped(du, g + G @ du, s + (S @ du).reshape(-1, 2), x[n : n + m], x[n + m :].reshape(-1, 2))


def linear_step(problem: ContactProblem, u: np.ndarray, base: Laws) -> FrictionalStep:
    ways = Directions.of(problem.gap_jacobian(u), problem.coulomb.slip_jacobian(u))
    now = np.column_stack([problem.gap(u), problem.coulomb.slip(u)]).ravel()
    lin = problem.linearise(u, None)
    linear = Linear(sparse.csc_matrix(lin.tangent), lin.residual, ways, now, problem.coulomb.mu)
    return FrictionalStep(NewtonRun(problem), linear, base)


@pytest.mark.parametrize("anew", [True, False])
@pytest.mark.parametrize("components", [1, 2])
@pytest.mark.parametrize("seed", range(4))
def test_a_step_is_that_of_the_saddle_point_system_on_any_states(
    seed: int, components: int, anew: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Factorised on every choice of states, and by the columns of one factorisation alone."""
    monkeypatch.setattr("contact.newton.friction_step.factor_flops", lambda factor: 0.0 if anew else np.inf)
    problem = planted(seed, 0.5, components=components).problem
    m, rng = len(problem.coulomb.mu), np.random.default_rng(100 + seed)
    u = rng.standard_normal(problem.coulomb.slip_jacobian(np.zeros(0)).shape[1])
    base = random_laws(rng, m, flat=components == 1)
    step = linear_step(problem, u, base)
    for laws in (base, *(random_laws(rng, m, flat=components == 1) for _ in range(4))):
        step = step.near(laws)
        wanted, foreseen, found = saddle_point(problem, u, laws), step.foreseen(laws), step.step(laws)
        assert (step.base is laws) == (anew or laws is base)
        assert np.max(np.abs(found.du - wanted.du)) < 1e-11
        for told in (foreseen, found):
            for name in ("gap", "slip", "normal", "friction"):
                assert np.max(np.abs(getattr(told, name) - getattr(wanted, name))) < 1e-11, (name, laws.state)
