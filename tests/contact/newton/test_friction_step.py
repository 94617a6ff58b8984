"""The step under given states: against the saddle-point system, from whatever states it was factorised on.

Friction on springs: its tangent, its limit, one candidate in closed form, and the judge of a finite epsilon.
"""

from itertools import product

import numpy as np
import pytest
from scipy import sparse

from contact.algorithms.regularised import Regularised
from contact.coulomb import State
from contact.newton.friction_held import Directions
from contact.newton.friction_states import Laws, Local, directed, friction_of
from contact.newton.friction_step import FrictionalStep, Linear, SprungStep, Stepped
from contact.newton.step import NewtonRun
from contact.problem import ContactProblem, ContactSolution, Outcome
from support.problems.frictional import linear, planted


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
def test_a_step_is_that_of_the_saddle_point_system_on_any_states(anew: bool, monkeypatch: pytest.MonkeyPatch) -> None:
    """Factorised on every choice of states, and by the columns of one factorisation alone."""
    for seed, components in product(range(4), (1, 2)):
        monkeypatch.setattr("contact.newton.friction_step.factor_flops", lambda factor: 0.0 if anew else np.inf)
        problem = planted(seed, 0.5, components=components).problem
        m, rng = len(problem.coulomb.mu), np.random.default_rng(100 + seed)
        u = rng.standard_normal(problem.coulomb.slip_jacobian(np.zeros(0)).shape[1])
        base = random_laws(rng, m, flat=components == 1)
        step = linear_step(problem, u, base)
        for laws in (base, *(random_laws(rng, m, flat=components == 1) for _ in range(4))):
            step = step.near(laws)
            wanted, foreseen, actual = saddle_point(problem, u, laws), step.foreseen(laws), step.step(laws)
            assert (step.base is laws) == (anew or laws is base)
            assert np.max(np.abs(actual.du - wanted.du)) < 1e-11
            for stated in (foreseen, actual):
                for name in ("gap", "slip", "normal", "friction"):
                    assert np.max(np.abs(getattr(stated, name) - getattr(wanted, name))) < 1e-11, (name, laws.state)


def test_the_law_of_a_slip_has_the_derivatives_of_friction() -> None:
    """dt = -mu df d - kappa e (e.ds) where t = -mu f s/|s|: the error of a difference is of second order."""
    rng = np.random.default_rng(3)
    m = 6
    mu, f, s, c = np.full(m, 0.4), rng.uniform(1, 2, m), rng.standard_normal((m, 2)), np.full(m, 3.0)
    df, ds = rng.standard_normal(m), rng.standard_normal((m, 2))
    slips = np.full(m, State.SLIP, np.int8)

    def friction(h: float) -> np.ndarray:
        moved = s + h * ds
        return -(mu * (f + h * df))[:, None] * moved / np.linalg.norm(moved, axis=1)[:, None]

    local = Local(np.zeros(m), s, f, friction(0.0), c)
    laws = directed(local, slips, mu * f)
    linear_part = -(mu * df)[:, None] * laws.direction - np.einsum("mij,mj->mi", laws.spring, ds)
    steps = np.array([1e-2, 1e-3])
    errors = [np.max(np.abs((friction(h) - friction(-h)) / (2 * h) - linear_part)) for h in steps]
    assert np.log10(errors[0] / errors[1]) == pytest.approx(2, abs=0.05)
    assert np.max(np.abs(friction_of(local, laws, mu, 0.0) - local.friction)) < 1e-15


def test_the_step_is_newtons_on_the_residual() -> None:
    """R = r - G^T f - S^T t(f, s) falls like 1 - h on the way of the step, but for terms in h^2."""
    planted_one = planted(1, 0.5, m=5)
    problem, rng = planted_one.problem, np.random.default_rng(8)
    n, m = len(planted_one.u), 5
    u, f = planted_one.u + 0.1 * rng.standard_normal(n), rng.uniform(1, 2, m)
    slips, c = np.full(m, State.SLIP, np.int8), np.ones(m)

    def lawful(u: np.ndarray, f: np.ndarray) -> np.ndarray:
        s = problem.coulomb.slip(u)
        return -(problem.coulomb.mu * f)[:, None] * s / np.linalg.norm(s, axis=1)[:, None]

    def residual(u: np.ndarray, f: np.ndarray) -> np.ndarray:
        return problem.linearise(u, None).residual - problem.contact_force(u, f, lawful(u, f))

    laws = directed(Local(problem.gap(u), problem.coulomb.slip(u), f, lawful(u, f), c), slips, problem.coulomb.mu * f)
    stepped = linear_step(problem, u, laws).step(laws)
    lengths = np.array([1e-2, 1e-3])
    left = [residual(u + h * stepped.du, f + h * (stepped.normal - f)) - (1 - h) * residual(u, f) for h in lengths]
    sizes = np.max(np.abs(left), axis=1)
    assert np.log10(sizes[0] / sizes[1]) == pytest.approx(2, abs=0.05)
    assert np.max(np.abs(stepped.gap)) < 1e-12


def on_springs(problem: ContactProblem, epsilon: float, n: int) -> ContactSolution:
    return Regularised(epsilon=epsilon).solve(problem, ContactSolution.at_rest(n, len(problem.coulomb.mu)))


def returned(problem: ContactProblem, u: np.ndarray, k: float) -> tuple[np.ndarray, np.ndarray]:
    """f = k <-g>, and t = -k s pulled back to the disc: the law, written apart from the algorithm."""
    f, y = k * np.maximum(-problem.gap(u), 0.0), -k * problem.coulomb.slip(u)
    size = np.linalg.norm(y, axis=1)
    return f, y * np.minimum(1.0, problem.coulomb.mu * f / np.where(size > 0, size, 1.0))[:, None]


def test_the_error_falls_with_the_inverse_of_epsilon() -> None:
    for seed in range(3):
        wanted, stiff = planted(seed, 0.5), np.array([1e3, 1e4, 1e5, 1e6])
        errors = []
        for epsilon in stiff:
            actual = on_springs(wanted.problem, epsilon, len(wanted.u))
            assert actual.outcome is Outcome.CONVERGED
            assert np.array_equal(actual.rubbed.state, wanted.state)
            errors.append(np.max(np.abs(actual.rubbed.force - wanted.friction)))
        assert np.polyfit(np.log(stiff), np.log(errors), 1)[0] == pytest.approx(-1, abs=0.02)


def test_no_digit_is_lost_on_stiff_springs() -> None:
    """By the law where that can be worked out from u, by the answer without springs where it cannot."""
    for mu, epsilon in product((0.1, 1.0), (1.0, 1e4, 1e12)):
        wanted = planted(7, mu)
        actual = on_springs(wanted.problem, epsilon, len(wanted.u))
        assert actual.outcome is Outcome.CONVERGED
        f, t = returned(wanted.problem, actual.u, epsilon) if epsilon < 1e5 else (wanted.normal, wanted.friction)
        assert np.max(np.abs(actual.pressure - f)) < 1e-8
        assert np.max(np.abs(actual.rubbed.force - t)) < 1e-8


def test_one_candidate_in_closed_form() -> None:
    """Body springs K beside the foundation's k: u_n = F_n/(K + k); in stick u_t = F_t/(K + k), else (F_t - mu f)/K."""
    for along in (0.1, 3.0):
        K, k, mu, pressed = 2.0, 50.0, 0.3, 1.0
        G, S = np.array([[0.0, 0.0, 1.0]]), np.eye(3)[:2]
        load = np.array([0.6 * along, 0.8 * along, -pressed])
        problem = linear(K * np.eye(3), load, G, S, np.zeros(1), np.zeros((1, 2)), np.full(1, mu))
        actual, f = on_springs(problem, k, 3), k * pressed / (K + k)
        sticks = along * k / (K + k) <= mu * f
        u_t = along / (K + k) if sticks else (along - mu * f) / K
        assert actual.u == pytest.approx([0.6 * u_t, 0.8 * u_t, -pressed / (K + k)], rel=1e-12)
        assert actual.pressure[0] == pytest.approx(f, rel=1e-12)
        assert np.linalg.norm(actual.rubbed.force) == pytest.approx(k * u_t if sticks else mu * f, rel=1e-12)
        assert actual.rubbed.state[0] == (State.STICK if sticks else State.SLIP)


def test_the_step_on_springs_is_newtons_on_the_residual() -> None:
    """R = r - G^T f - S^T t(g, s) falls like 1 - h on the way of the step, but for terms in h^2."""
    one, k = planted(1, 0.5, m=5), 30.0
    problem, rng = one.problem, np.random.default_rng(8)
    u = one.u + 0.01 * rng.standard_normal(len(one.u))
    G = problem.gap_jacobian(u)
    u = u - G.T @ (problem.gap(u) + rng.uniform(0.2, 0.4, 5))  # rows of G are orthonormal: all are pushed in
    f, t = returned(problem, u, k)
    stuck = np.linalg.norm(t, axis=1) < 0.999 * problem.coulomb.mu * f
    assert 0 < stuck.sum() < 5
    state = np.where(stuck, State.STICK, State.SLIP).astype(np.int8)
    local = Local(problem.gap(u) + f / k, problem.coulomb.slip(u) + t / k, f, t, np.ones(5))
    laws = directed(local, state, problem.coulomb.mu * f)
    lin, now = problem.linearise(u, None), np.column_stack([problem.gap(u), problem.coulomb.slip(u)]).ravel()
    ways = Directions.of(G, problem.coulomb.slip_jacobian(u))
    linear = Linear(lin.tangent, lin.residual, ways, now, problem.coulomb.mu)
    du = SprungStep(NewtonRun(problem, k), linear, np.full(5, k)).step(laws).du

    def residual(h: float) -> np.ndarray:
        at = u + h * du
        return problem.linearise(at, None).residual - problem.contact_force(at, *returned(problem, at, k))

    lengths = np.array([1e-2, 1e-3])
    left = [np.max(np.abs(residual(h) - (1 - h) * residual(0.0))) for h in lengths]
    assert np.log10(left[0] / left[1]) == pytest.approx(2, abs=0.05)
