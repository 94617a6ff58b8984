"""The first exact algorithm: planted answers, its limits without friction and with an endless one, its tangent."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy import sparse

from contact.algorithms.semismooth import Semismooth
from contact.algorithms.trial_and_error import TrialAndError
from contact.coulomb import State
from contact.newton.friction_states import Local, directed, friction_of
from contact.problem import ContactProblem, ContactSolution, Outcome
from tests.contact.friction.test_step import linear_step
from tests.support.problems.planted_friction import linear, planted, tied


def from_rest(problem: ContactProblem, algorithm: Semismooth | TrialAndError | None = None) -> ContactSolution:
    n = problem.coulomb.slip_jacobian(np.zeros(0)).shape[1]
    return (algorithm or Semismooth()).solve(problem, ContactSolution.at_rest(n, len(problem.coulomb.mu)))


@pytest.mark.parametrize("components", [1, 2])
@pytest.mark.parametrize("mu", [0.1, 0.4, 0.7, 1.0])
@pytest.mark.parametrize("seed", range(5))
def test_the_planted_answer_is_found(seed: int, mu: float, components: int) -> None:
    """All three states are in each; with one component of slip the linearisation is exact and one iteration does."""
    wanted = planted(seed, mu, components=components)
    found = from_rest(wanted.problem)
    assert found.outcome is Outcome.CONVERGED
    assert np.array_equal(found.rubbed.state, wanted.state)
    for mine, built in ((found.u, wanted.u), (found.pressure, wanted.normal), (found.rubbed.force, wanted.friction)):
        assert np.max(np.abs(mine - built)) < 1e-9
    assert found.counters["newton_iterations"] <= (1 if components == 1 else 6)


@pytest.mark.parametrize("seed", range(5))
def test_the_naive_set_finds_it_too_where_it_does_not_cycle(seed: int) -> None:
    wanted = planted(seed, 0.4, components=1)
    found = from_rest(wanted.problem, TrialAndError(epsilon=np.inf))
    assert found.outcome is Outcome.CONVERGED
    assert np.max(np.abs(found.u - wanted.u)) < 1e-9


@pytest.mark.parametrize("seed", range(5))
def test_friction_stays_on_its_disc_and_never_drives(seed: int) -> None:
    problem = planted(seed, 0.6).problem
    found = from_rest(problem)
    size, slip = np.linalg.norm(found.rubbed.force, axis=1), problem.coulomb.slip(found.u)
    assert np.all(size <= problem.coulomb.bound(found.pressure))
    slips = found.rubbed.state == State.SLIP
    assert np.all(np.einsum("mk,mk->m", found.rubbed.force, slip)[slips] < 0)
    assert np.max(np.abs(slip[found.rubbed.state == State.STICK])) < 1e-12
    unit = slip[slips] / np.linalg.norm(slip[slips], axis=1)[:, None]
    assert np.max(np.abs(found.rubbed.force[slips] + problem.coulomb.bound(found.pressure)[slips, None] * unit)) < 1e-9


@pytest.mark.parametrize("seed", range(5))
def test_without_friction_it_gives_what_the_frictionless_algorithm_gives(seed: int) -> None:
    problem = planted(seed, 0.0).problem
    found = from_rest(problem)
    rest = ContactSolution.at_rest(len(found.u), len(problem.weights))
    wanted = Semismooth().solve(replace(problem, coulomb=None), rest)
    assert wanted.outcome is found.outcome is Outcome.CONVERGED
    assert np.array_equal(found.active, wanted.active)
    assert not np.any(found.rubbed.force)
    assert np.max(np.abs(found.u - wanted.u)) <= 1e-12 * np.max(np.abs(wanted.u))
    assert np.max(np.abs(found.pressure - wanted.pressure)) <= 1e-12 * np.max(wanted.pressure)


@pytest.mark.parametrize("seed", range(5))
def test_an_endless_friction_ties_who_touches(seed: int) -> None:
    """Against K du - J_A^T F_A = f, v_A = 0 of the candidates that touch."""
    problem = tied(seed)
    found = from_rest(problem)
    assert found.outcome is Outcome.CONVERGED
    touch = found.rubbed.state == State.STICK
    assert touch.any()
    assert np.all(touch | (found.rubbed.state == State.OPEN))
    u = np.zeros_like(found.u)
    lin = problem.linearise(u, None)
    J = sparse.vstack([problem.gap_jacobian(u)[touch], problem.coulomb.slip_jacobian(u)[np.repeat(touch, 2)]]).toarray()
    v = np.append(problem.gap(u)[touch], problem.coulomb.slip(u)[touch].ravel())
    zero = np.zeros((len(J), len(J)))
    x = np.linalg.solve(np.block([[lin.tangent.toarray(), -J.T], [J, zero]]), np.append(-lin.residual, -v))
    assert np.max(np.abs(found.u - x[: len(u)])) <= 1e-9 * np.max(np.abs(found.u))
    assert np.all(problem.gap(found.u)[~touch] >= 0)
    assert np.all(found.pressure[touch] >= 0)


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


def test_operations_are_counted() -> None:
    from contact.operations import FACTORISATIONS, SPENT

    before = SPENT[FACTORISATIONS]
    found = from_rest(planted(2, 0.5).problem)
    assert SPENT[FACTORISATIONS] > before
    assert found.counters["factorisations"] >= found.counters["newton_iterations"]


class TestKlarbring:
    """Two springs: K = [[Ktt, Ktn], [Ktn, Knn]] of one candidate, u = (u_t, u_n), gap -u_n + g0, slip u_t.

    A candidate that sticks, slips to either side, or is open: its candidate answers are worked out by hand, and which
    of them are answers is looked up. Where mu |Knt| < Ktt there is one; beyond there may be several, and
    the rate problem may have none.
    Source: Klarbring, Ingenieur-Archiv 60 (1990) 529-541.
    """

    K = np.array([[1.0, 0.6], [0.6, 1.0]])

    def problem(self, mu: float, load: tuple[float, float], slip0: float = 0.0) -> ContactProblem:
        G, S = np.array([[0.0, -1.0]]), np.array([[1.0, 0.0], [0.0, 0.0]])
        return linear(self.K, np.array(load), G, S, np.zeros(1), np.array([[slip0, 0.0]]), np.array([mu]))

    def answers(self, mu: float, load: tuple[float, float], slip0: float = 0.0) -> list[tuple[float, float, str]]:
        """(u_t, u_n, state) of all answers."""
        Ft, Fn = load
        found = []
        u = np.linalg.solve(self.K, load)
        if u[1] < 0:
            found.append((float(u[0]), float(u[1]), "open"))
        ut = -slip0
        f, t = Fn - self.K[1, 0] * ut, self.K[0, 0] * ut - Ft
        if f >= 0 and abs(t) <= mu * f:
            found.append((ut, 0.0, "stick"))
        for way in (1.0, -1.0):  # Ktt ut - Ft = -way mu f, f = Fn - Knt ut
            slope = self.K[0, 0] - way * mu * self.K[1, 0]
            ut = (Ft - way * mu * Fn) / slope
            f = Fn - self.K[1, 0] * ut
            if f >= 0 and way * (ut + slip0) > 0:
                found.append((ut, 0.0, "slip"))
        return found

    @pytest.mark.parametrize("load", [(0.2, 1.0), (2.0, 1.0), (-2.0, 1.0), (0.3, -1.0), (5.0, 1.0)])
    def test_below_the_bound_there_is_one_answer_and_it_is_found(self, load: tuple[float, float]) -> None:
        answers = self.answers(0.8, load)
        assert len(answers) == 1
        found = from_rest(self.problem(0.8, load))
        assert found.outcome is Outcome.CONVERGED
        assert found.u == pytest.approx(answers[0][:2], abs=1e-12)

    @pytest.mark.parametrize("slip0", [-0.7, 0.0, 0.7])
    @pytest.mark.parametrize("force", [-3.0, -1.0, 0.3, 1.5, 1.8, 2.5, 4.0])
    @pytest.mark.parametrize("mu", [1.8, 2.5, 6.0])
    def test_beyond_it_no_false_answer_is_claimed(self, mu: float, force: float, slip0: float) -> None:
        """One of several is found, or none is claimed."""
        load = (force, 1.0)
        answers, found = self.answers(mu, load, slip0), from_rest(self.problem(mu, load, slip0))
        if found.outcome is Outcome.CONVERGED:
            assert any(np.allclose(found.u, each[:2], atol=1e-10) for each in answers), (found, answers)
        else:
            assert found.outcome in {Outcome.CYCLING, Outcome.SINGULAR, Outcome.ITERATION_LIMIT}

    def test_several_are_among_them(self) -> None:
        """Never none: a definite K has an answer for every mu (Brouwer's theorem on passes of Tresca's friction)."""
        loads, slips = (-3.0, -1.0, 0.3, 1.5, 1.8, 2.5, 4.0), (-0.7, 0.0, 0.7)
        counts = {len(self.answers(mu, (force, 1.0), s)) for mu in (1.8, 2.5, 6.0) for force in loads for s in slips}
        assert min(counts) == 1
        assert max(counts) > 1
