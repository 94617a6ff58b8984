"""What an answer is worth: right ones of any size pass, wrong ones do not, however they are inflated or measured."""

from __future__ import annotations

from dataclasses import astuple, replace

import numpy as np
import pytest
from scipy import sparse

from contact.interchange.linearised_step import FrozenStep
from contact.solvers.qp_backends import Answer, Programme
from studies.arena.answers import Accuracy, Scales, accuracy
from studies.experiments.false_success import keeps
from support.problems.arena_steps import in_units, known_step

ROUNDING = 1e-13  # of an answer that was built in, whose own data are sums of it


def one_spring(k: float = 2.0, r: float = -6.0, gap: float = 1.0, scale: float = 0.0) -> FrozenStep:
    """One unknown on a spring k [N/mm], pulled down by -r, over a floor: k du + r = -f, gap - du >= 0."""
    K, G = sparse.csc_matrix([[k]]), sparse.csr_matrix([[-1.0]])
    return FrozenStep(K, np.array([r]), G, np.array([gap]), np.array([0.5]), scale)


@pytest.mark.parametrize("kind", ["definite", "obstacle", "inclined"])
@pytest.mark.parametrize("seed", range(5))
def test_built_in_answers_are_exact(kind: str, seed: int) -> None:
    assert accuracy(*known_step(seed, kind)).worst <= ROUNDING


def test_residuals_by_hand() -> None:
    """At du = 1 the floor carries 4 N over 0.5 mm^2; F = |r| = 6 N, and L = F/k = 3 mm, more than the largest gap."""
    step = one_spring()
    assert accuracy(step, np.array([1.0]), np.array([8.0])) == Accuracy(0.0, 0.0, 0.0, 0.0)
    deep = accuracy(step, np.array([1.3]), np.array([6.8]))
    assert deep.equilibrium == pytest.approx(0.0, abs=ROUNDING)
    assert deep.penetration == pytest.approx(0.3 / 3)
    assert deep.complementarity == pytest.approx(3.4 * 0.3 / (6 * 3))
    pulled = accuracy(step, np.array([1.0]), np.array([-2.0]))
    assert pulled.tension == pytest.approx(1 / 6)
    assert pulled.equilibrium == pytest.approx(5 / 6)


def test_scales_by_hand() -> None:
    assert Scales.of(one_spring()) == Scales(6.0, 3.0, 1.0)
    assert Scales.of(one_spring(scale=50.0)) == Scales(50.0, 25.0, 1.0)
    assert astuple(Scales.of(one_spring(r=0.0, gap=-0.7))) == pytest.approx((1.4, 0.7, 0.7))  # a spring pushed 0.7 mm
    assert Scales.of(one_spring(r=0.0)) == Scales(2.0, 1.0, 1.0)  # nothing happens


def test_a_body_that_only_the_floor_holds_has_scales() -> None:
    """K = 0 has no compliance; with no force in the file, nothing pushes it back."""
    free = replace(one_spring(r=-6.0, gap=-1.0), K=sparse.csc_matrix((1, 1)))
    assert Scales.of(free).force == 6.0
    assert accuracy(free, np.array([-1.0]), np.array([12.0])).worst <= ROUNDING


def test_an_inflated_answer_is_not_accepted() -> None:
    """Forces f >= 0 whose response opens all gaps: t f balances for any t, and relative to itself r vanishes."""
    step, *_ = known_step()
    C = step.G @ np.linalg.solve(step.K.toarray(), step.G.toarray().T)
    f = np.linalg.solve(C, np.ones(len(step.gap)))  # opens every gap by t
    push = np.maximum(f, 0.0)
    assert np.all(C @ push > 0)
    programme = Programme(step.K, step.r, sparse.csc_matrix(step.G), -step.gap)
    worth = []
    for t in (1e2, 1e6, 1e10, 1e14):
        large = np.linalg.solve(step.K.toarray(), step.G.T @ (t * push))  # without r: it is lost anyway
        worth.append(accuracy(step, large, t * push / step.weights).worst)
    assert keeps(programme, Answer(large, t * push, True, ""), 1e-8)
    assert min(worth) > 1.0
    assert worth == sorted(worth)


@pytest.mark.parametrize("t", [0.0, 0.5, 2.0, 1e3, 1e9])
def test_multiples_of_the_answer_are_wrong(t: float) -> None:
    step, du, pressure = known_step()
    assert accuracy(step, t * du, t * pressure).worst > 1e-2


def test_the_scale_of_forces_ignores_the_answer() -> None:
    """A foundation that presses twice as hard is as wrong as the difference, however large the answer has become."""
    step, du, pressure = known_step()
    worth = [accuracy(step, du, pressure * t).equilibrium / (t - 1) for t in (2.0, 2e3, 2e6)]
    np.testing.assert_allclose(worth, worth[0], rtol=1e-9)


@pytest.mark.parametrize(("force", "length"), [(1e6, 1.0), (1e-6, 1.0), (1.0, 1e-3), (1e3, 1e3)])
def test_units_do_not_matter(force: float, length: float) -> None:
    step, du, pressure = known_step(3)
    rng = np.random.default_rng(1)
    off, press = du + 1e-3 * rng.normal(size=du.shape), pressure * (1 + 1e-3 * rng.normal(size=pressure.shape))
    here = accuracy(step, off, press)
    there = accuracy(in_units(step, force, length), off * length, press * force)
    assert there.worst == pytest.approx(here.worst, rel=1e-9)
    assert 1e-5 < here.worst < 1e-1


@pytest.mark.parametrize("error", [1e-3, 1e-5, 1e-7, 1e-9])
def test_an_error_is_seen_in_proportion(error: float) -> None:
    step, du, pressure = known_step(2)
    worth = accuracy(step, du, pressure * (1 + error)).worst
    assert 0.05 * error < worth < 20 * error


@pytest.mark.parametrize("bad", [np.nan, np.inf, 1e300])
def test_what_is_no_number_is_worth_nothing(bad: float) -> None:
    step, du, pressure = known_step()
    du[0] = bad
    assert accuracy(step, du, pressure).worst > 1e100


def test_rounding_is_no_error_but_ten_times_it_is() -> None:
    """A thin beam in two unknowns: what a last digit of du costs is far above 1e-9 of the load."""
    stiff = 1e12
    K = sparse.csc_matrix([[stiff + 1.0, -stiff], [-stiff, stiff + 1.0]])
    step = FrozenStep(K, np.array([-1.0, -1.0]), sparse.csr_matrix((0, 2)), np.zeros(0), np.zeros(0), 1.0)
    du = np.array([1.0, np.nextafter(1.0, 2.0)])
    assert np.linalg.norm(K @ du + step.r) > 1e-5
    assert accuracy(step, du, np.zeros(0)).worst == 0.0
    assert accuracy(step, np.array([1.0, 1.0 + 1e-14]), np.zeros(0)).worst > 1e-3


def test_consistent_coupling_is_judged_by_its_own_forces() -> None:
    step, du, pressure = known_step(4)
    W = sparse.diags_array(step.weights).tocsr() + sparse.csr_matrix(np.full((len(pressure),) * 2, 0.05))
    r = step.r + step.G.T @ (W @ pressure - step.weights * pressure)
    coupled = replace(step, coupling=sparse.csr_matrix(W), r=r)
    assert accuracy(coupled, du, pressure).worst <= ROUNDING
    assert accuracy(replace(coupled, coupling=None), du, pressure).worst > 1e-3


def test_an_answer_of_another_problem_is_refused() -> None:
    step, du, pressure = known_step()
    with pytest.raises(ValueError, match="candidates"):
        accuracy(step, du[:-1], pressure)
