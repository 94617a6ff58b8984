"""The judge: a clean answer passes, every way of spoiling it is caught and named."""

import math
from dataclasses import replace

import numpy as np
import pytest

from contact.balances import last_digits
from contact.catalogue import ALGORITHMS
from contact.problem import ContactSolution, Outcome, without_contact
from contact.verify import Verdict, claim, judge
from support.problems.contact_problems import Quadratic, linear_mechanics, random_quadratic

ROUNDING = 1e-12


@pytest.fixture
def case():
    """A problem with open and pressed candidates and its answer, converged at epsilon = infinity."""
    data = random_quadratic(np.random.default_rng(5), "inclined")
    problem = data.problem()
    solution = ALGORITHMS["trial-and-error"](epsilon=math.inf).solve(
        problem, ContactSolution.at_rest(len(data.f), len(data.w))
    )
    assert solution.outcome is Outcome.CONVERGED
    assert 1 < solution.active.sum() < len(data.w)
    return data, problem, solution.u, solution.pressure


def test_the_clean_answer_passes(case) -> None:
    _, problem, u, pressure = case
    verdict = judge(problem, u, pressure)
    assert verdict.failures() == []
    assert max(verdict.kkt.values()) <= ROUNDING


def sign_flip(data, problem, u, pressure):
    return problem, u, -pressure


def one_wrong_node(data, problem, u, pressure):
    """The pressure of a pressed candidate is written to an open one."""
    wrong, pressed, still = pressure.copy(), np.argmax(pressure), np.argmin(pressure)
    wrong[still], wrong[pressed] = pressure[pressed], 0.0
    return problem, u, wrong


def wrong_unit(data, problem, u, pressure):
    return problem, u, 1e3 * pressure


def stale_pressure(data, problem, u, pressure):
    """The pressures of a load 1 % smaller."""
    before = replace(data, f=0.99 * data.f).problem()
    start = ContactSolution.at_rest(len(u), len(pressure))
    return problem, u, ALGORITHMS["trial-and-error"](epsilon=math.inf).solve(before, start).pressure


def forgotten_contact(data, problem, u, pressure):
    """The equilibrium without any foundation."""
    return problem, np.linalg.solve(data.K, data.f), np.zeros_like(pressure)


def perturbed_u(data, problem, u, pressure):
    return problem, u + 1e-6 * np.sin(np.arange(len(u))), pressure


def foundation_nearer(data, problem, u, pressure):
    return replace(data, g0=data.g0 - 1e-6).problem(), u, pressure


def foundation_further(data, problem, u, pressure):
    """Equilibrium, no penetration, no tension: only the pressure over an open gap gives it away."""
    return replace(data, g0=data.g0 + 1e-6).problem(), u, pressure


def adhesion(data, problem, u, pressure):
    """A closed gap that pulls: the equilibrium with every candidate held at zero gap."""
    n, m = len(u), len(pressure)
    system = np.block([[data.K, -data.G.T * data.w], [data.G, np.zeros((m, m))]])
    both = np.linalg.solve(system, np.append(data.f, -data.g0))
    return problem, both[:n], both[n:]


def not_a_number(data, problem, u, pressure):
    spoilt = pressure.copy()
    spoilt[0] = math.nan
    return problem, u, spoilt


SPOILT = {  # what is done to the answer: the names that must appear, the names that must not
    sign_flip: ({"equilibrium", "tension"}, {"penetration"}),
    one_wrong_node: ({"equilibrium", "complementarity"}, {"penetration", "tension"}),
    wrong_unit: ({"equilibrium"}, {"penetration", "tension"}),
    stale_pressure: ({"equilibrium"}, {"penetration", "tension"}),
    forgotten_contact: ({"penetration"}, {"equilibrium", "tension", "complementarity"}),
    perturbed_u: ({"equilibrium", "penetration"}, {"tension"}),
    foundation_nearer: ({"penetration"}, {"equilibrium", "tension"}),
    foundation_further: ({"complementarity"}, {"equilibrium", "penetration", "tension"}),
    adhesion: ({"tension"}, {"equilibrium", "penetration", "complementarity"}),
    not_a_number: ({"equilibrium", "tension"}, {"penetration"}),
}


@pytest.mark.parametrize("spoil", SPOILT, ids=lambda f: f.__name__)
def test_a_spoilt_answer_is_caught_and_named(case, spoil) -> None:
    present, absent = SPOILT[spoil]
    names = set(judge(*spoil(*case)).failures())
    assert present <= names
    assert not absent & names


def test_residuals_are_those_of_the_definition(rng) -> None:
    """Against the formulas written out densely, at an arbitrary state."""
    data = random_quadratic(rng, "inclined")
    u, p = rng.normal(size=len(data.f)), rng.normal(size=len(data.w))
    gap, force = data.g0 + data.G @ u, data.G.T @ (data.w * p)
    forces = [np.linalg.norm(x) for x in (data.K @ u, data.f, force)]
    verdict = judge(data.problem(), u, p)
    assert verdict.equilibrium == pytest.approx(np.linalg.norm(data.K @ u - data.f - force) / max(forces), rel=ROUNDING)
    assert verdict.penetration == pytest.approx(-gap.min(), rel=ROUNDING)
    assert verdict.tension == pytest.approx(-p.min(), rel=ROUNDING)
    assert verdict.complementarity == pytest.approx(np.abs(p * gap).max(), rel=ROUNDING)


def test_consistent_coupling_is_judged_by_its_own_matrix(rng) -> None:
    data = random_quadratic(rng, "definite")
    W = np.diag(data.w) + 0.2 * np.eye(6, k=1) + 0.2 * np.eye(6, k=-1)
    u, p = rng.normal(size=len(data.f)), rng.uniform(0, 1, 6)
    balanced = replace(data, f=data.K @ u - data.G.T @ W @ p)
    assert judge(balanced.problem(W), u, p).equilibrium <= ROUNDING
    assert judge(balanced.problem(), u, p).equilibrium > 1e-3


@pytest.mark.parametrize("shape", [(5,), (7,), (6, 1), ()])
def test_pressures_that_do_not_fit_are_refused(case, shape) -> None:
    _, problem, u, _ = case
    with pytest.raises(ValueError, match="pressures for"):
        judge(problem, u, np.zeros(shape))


def test_rounding_excuses_itself_and_nothing_above() -> None:
    clean = {"penetration": 0.0, "tension": 0.0, "complementarity": 0.0}
    assert Verdict(equilibrium=5e-8, rounding=1e-7, **clean).failures() == []
    assert Verdict(equilibrium=2e-7, rounding=1e-7, **clean).failures() == ["equilibrium"]
    assert Verdict(equilibrium=2e-6, rounding=1.0, **clean).failures() == ["equilibrium"]
    assert Verdict(equilibrium=math.nan, rounding=1.0, **clean).failures() == ["equilibrium"]


def test_rounding_above_its_cap_is_excused_by_what_it_moves() -> None:
    clean = {"penetration": 0.0, "tension": 0.0, "complementarity": 0.0}
    assert Verdict(equilibrium=2e-6, rounding=1e-5, correction=1e-10, **clean).failures() == []
    assert Verdict(equilibrium=2e-2, rounding=1e-1, correction=0.0, **clean).failures() == ["equilibrium"]
    assert Verdict(equilibrium=2e-6, rounding=1e-5, correction=1e-8, **clean).failures() == ["equilibrium"]
    assert Verdict(equilibrium=2e-6, rounding=1e-6, correction=0.0, **clean).failures() == ["equilibrium"]
    assert Verdict(equilibrium=2e-6, rounding=1e-5, correction=math.nan, **clean).failures() == ["equilibrium"]


def test_rounding_floor_bounds_the_rounding_of_a_stiff_residual(rng) -> None:
    """K u evaluated in double against extended precision: within the floor, and the floor is not a blank cheque."""
    if np.finfo(np.longdouble).eps >= np.finfo(float).eps:
        pytest.skip("no extended precision here")
    n = 60
    stiff = 10 ** rng.uniform(-4, 4, n)
    K, u = np.sqrt(np.outer(stiff, stiff)) * rng.normal(size=(n, n)), rng.normal(size=n)
    lin = linear_mechanics(K, np.zeros(n))(u, None)
    exact = K.astype(np.longdouble) @ u.astype(np.longdouble)
    error = float(np.linalg.norm(lin.residual - exact))
    assert 0 < error <= last_digits(lin, u) <= 1e4 * error


def test_problem_without_contact_is_plain_equilibrium(rng) -> None:
    data = random_quadratic(rng, "definite")
    problem = without_contact(linear_mechanics(data.K, data.f), len(data.f))
    u = np.linalg.solve(data.K, data.f)
    assert judge(problem, u, np.zeros(0)).failures() == []
    assert judge(problem, 1.001 * u, np.zeros(0)).failures() == ["equilibrium"]
    for make in ALGORITHMS.values():
        solution = make().solve(problem, ContactSolution.at_rest(len(u), 0))
        assert solution.outcome is Outcome.CONVERGED
        np.testing.assert_allclose(solution.u, u, rtol=0, atol=1e-10)


def test_a_body_at_rest_without_load_is_not_divided_by_zero() -> None:
    data = Quadratic(np.eye(2), np.zeros(2), np.eye(2), np.ones(2), np.ones(2))
    verdict = judge(data.problem(), np.zeros(2), np.zeros(2))
    assert verdict.failures() == []


def test_a_claim_widens_equilibrium_by_its_tolerance_and_balances_by_the_root_of_the_unknowns() -> None:
    assert claim(1e-9, 10_000) == {}
    assert claim(1e-4, 100) == {"equilibrium": 1e-4, "balance": pytest.approx(1e-3)}
    assert claim(1.01e-8, 1)["balance"] == pytest.approx(1.01e-8)
