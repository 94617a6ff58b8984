"""Several pairs in one problem: three nets in a row by differences, by the judge, and against an independent QP."""

import math
from dataclasses import dataclass, replace

import numpy as np
import pytest
from scipy import sparse

from contact.catalogue import ALGORITHMS
from contact.coulomb import State
from contact.faces.pair import Pair, between
from contact.faces.rubbings import Rubbings, rubbed
from contact.faces.sampling import areas, at_nodes, mortar
from contact.faces.several import Several
from contact.interchange.friction_oracle import confirm
from contact.interchange.linearised_step import FrozenFrictionalStep, freeze
from contact.interchange.oracle import minimise
from contact.problem import ContactProblem, ContactSolution, linear_mechanics
from contact.verify import PAIR, judge
from support.problems.nets import sheet

STEP, BY_DIFFERENCES, EXACT = 1e-5, 2e-8, 1e-8


def stack(pairing: str, noise: float = 0.0, apart: float = 0.05) -> Several:
    """Three sheets in a row, the middle one a master from below and a slave above; every coordinate is an unknown."""
    rng = np.random.default_rng(5)
    sheets = [sheet(*cuts, 1.2 - 0.1 * i, apart * i, 0.0, up=True) for i, cuts in enumerate([(5, 3), (3, 4), (4, 5)])]
    x = np.vstack([each for each, _ in sheets])
    x += noise * rng.normal(size=x.shape)
    starts = np.cumsum([0, *(len(each) for each, _ in sheets)])
    everything = sparse.csr_matrix(sparse.eye_array(x.size, format="csr"))

    def pair(upper: int) -> Pair:
        nodes = np.arange(starts[upper], starts[upper + 1])
        slave, master = sheets[upper][1][:, ::-1] + starts[upper], sheets[upper - 1][1] + starts[upper - 1]
        points = at_nodes(nodes, len(x), areas(x, slave)[nodes])
        return Pair(x, everything, master, points if pairing == "nodes" else mortar(x, slave, master, nodes), slave)

    return Several((pair(1), pair(2)))


@pytest.mark.parametrize("pairing", ["nodes", pytest.param("mortar", marks=pytest.mark.slow)])
def test_rows_and_curvature_are_derivatives(pairing: str, rng: np.random.Generator) -> None:
    whole = stack(pairing, 0.02, 0.2)
    n = whole.operator.shape[1]
    u = 0.005 * rng.normal(size=n)
    problem = between(linear_mechanics(sparse.csc_matrix(sparse.eye_array(n)), np.zeros(n)), whole)
    force = rng.uniform(0.5, 1.0, len(problem.weights))
    ways = rng.normal(size=(6, n))
    ends = [(u + STEP * way, u - STEP * way) for way in ways]
    gaps = np.array([(problem.gap(more) - problem.gap(less)) / (2 * STEP) for more, less in ends])
    pushes = [(problem.gap_jacobian(more).T @ force, problem.gap_jacobian(less).T @ force) for more, less in ends]
    bent = np.array([(more - less) / (2 * STEP) for more, less in pushes])
    assert problem.gap_curvature is not None
    np.testing.assert_allclose((problem.gap_jacobian(u) @ ways.T).T, gaps, rtol=0, atol=BY_DIFFERENCES)
    size = BY_DIFFERENCES * np.max(np.abs(bent))
    np.testing.assert_allclose((problem.gap_curvature(u, force) @ ways.T).T, bent, rtol=0, atol=size)


@dataclass(frozen=True, eq=False)
class Biased(Pair):
    """A pair whose forces on its master are wrong by ``off`` [N]."""

    off: float = 0.0

    def forces(self, u: np.ndarray, nodal: np.ndarray) -> np.ndarray:
        actual = super().forces(u, nodal)
        actual[self.master[0, 0], 2] += self.off
        return actual


def test_the_judge_looks_at_every_pair_by_itself() -> None:
    """Faults of two pairs that cancel each other in the sum."""
    whole = stack("nodes")
    n, m = whole.operator.shape[1], len(whole.weights)
    fields = [{name: getattr(each, name) for name in each.__dataclass_fields__} for each in whole.pairs]
    wrong = Several(tuple(Biased(**each, off=off) for each, off in zip(fields, (0.1, -0.1), strict=True)))
    problem = between(linear_mechanics(sparse.csc_matrix(sparse.eye_array(n)), np.zeros(n)), whole)
    pressure = np.ones(m)
    right, stated = (judge(replace(problem, faces=each), np.zeros(n), pressure) for each in (whole, wrong))
    assert max(right.balances["pair_force"], right.balances["pair_moment"]) <= PAIR
    nodal = problem.nodal_forces(pressure)
    assert abs(wrong.forces(np.zeros(n), nodal).sum()) <= PAIR * nodal.sum()
    assert stated.balances["pair_force"] > 1e-3
    assert {"pair_force", "pair_moment"} <= set(stated.failures())


def pressed(pairing: str, aside: float = 0.0) -> tuple[ContactProblem, Several]:
    """Springs hold every point; the uppermost net is pressed on the middle one and pulled aside, and so is that."""
    whole = stack(pairing)
    above = whole.pairs[1].weights
    load = np.zeros((len(whole.pairs[0].reference), 3))
    load[-len(above) :] = np.array([aside, 0.4 * aside, -2.5]) * above[:, None]
    load[-len(above) :: 3, 0] *= 0.2
    K = sparse.csc_matrix(
        sparse.diags_array(np.repeat([50.0, 3.0, 1.0], [3 * 24, 3 * 20, 3 * 30]))  # each stiffer than the next
    )
    return between(linear_mechanics(K, load.ravel()), whole), whole


@pytest.mark.parametrize("pairing", ["nodes", pytest.param("mortar", marks=pytest.mark.slow)])
def test_three_nets_in_a_row_are_what_an_oracle_makes_of_them(pairing: str) -> None:
    problem, whole = pressed(pairing)
    n, m = whole.operator.shape[1], len(whole.weights)
    solution = ALGORITHMS["semismooth"](epsilon=math.inf).solve(problem, ContactSolution.at_rest(n, m))
    assert solution.outcome.converged
    verdict = judge(problem, solution.u, solution.pressure)
    assert not verdict.failures()
    assert all(solution.active[own].any() for own in whole.candidates)
    _, pressure = minimise(freeze(problem, solution.u, solution.pressure, {}))
    np.testing.assert_allclose(solution.pressure, pressure, rtol=0, atol=EXACT * np.max(pressure))


@pytest.mark.parametrize("pairing", ["nodes", pytest.param("mortar", marks=pytest.mark.slow)])
def test_three_nets_that_rub_are_what_an_oracle_makes_of_them(pairing: str) -> None:
    """Tresca programmes of an interior point on the step at its solution; each pair is balanced by itself."""
    plain, whole = pressed(pairing, aside=1.0)
    problem = rubbed(plain, 0.3)
    n, m = whole.operator.shape[1], len(whole.weights)
    solution = ALGORITHMS["semismooth"](epsilon=math.inf).solve(problem, ContactSolution.at_rest(n, m))
    assert solution.outcome.converged
    verdict = judge(problem, solution.u, solution.pressure, solution.rubbed.force)
    assert not verdict.failures()
    assert max(verdict.balances["pair_force"], verdict.balances["pair_moment"]) <= PAIR
    assert set(solution.rubbed.state.tolist()) == set(State)
    assert all(solution.rubbed.force[own].any() for own in whole.candidates)
    step = freeze(problem, solution.u, solution.pressure, {})
    assert isinstance(step, FrozenFrictionalStep)
    assert confirm(step, np.zeros(n), problem.nodal_forces(solution.pressure), solution.rubbed.force).agrees


def test_the_slips_of_all_pairs_have_their_derivatives_and_anchors(rng: np.random.Generator) -> None:
    whole = stack("nodes", 0.02, 0.2)
    n = whole.operator.shape[1]
    problem = rubbed(between(linear_mechanics(sparse.csc_matrix(sparse.eye_array(n)), np.zeros(n)), whole), 0.3)
    slip = problem.coulomb.sliding
    assert isinstance(slip, Rubbings)
    u, t = 0.1 * rng.normal(size=n), rng.normal(size=(len(problem.weights), 2))
    assert np.max(np.abs(slip(u))) > 0.2
    for way in rng.normal(size=(3, n)):
        ends = u + STEP * way, u - STEP * way
        ds = np.subtract(*(slip(each).ravel() for each in ends)) / (2 * STEP)
        bent = np.subtract(*(slip.jacobian(each).T @ t.ravel() for each in ends)) / (2 * STEP)
        np.testing.assert_allclose(slip.jacobian(u) @ way, ds, rtol=0, atol=BY_DIFFERENCES)
        size = BY_DIFFERENCES * np.max(np.abs(bent))
        np.testing.assert_allclose(slip.curvature(u, t) @ way, bent, rtol=0, atol=size)
    np.testing.assert_allclose(slip.measured(u), slip(u), rtol=0, atol=1e-13)
    np.testing.assert_allclose(slip.since(slip.places(u))(u), 0, atol=1e-13)


def test_the_judge_looks_at_the_friction_of_every_pair_by_itself() -> None:
    """Friction of one pair put on the points of the other balances none of both."""
    problem, whole = pressed("nodes", aside=1.0)
    problem = rubbed(problem, 0.3)
    n, m = whole.operator.shape[1], len(whole.weights)
    law = problem.coulomb
    assert isinstance(law.sliding, Rubbings)
    solution = ALGORITHMS["semismooth"](epsilon=math.inf).solve(problem, ContactSolution.at_rest(n, m))
    lower, upper = law.sliding.each
    lame = Rubbings((lower, replace(upper, anchors=np.roll(upper.anchors, 1, axis=0))))
    wrong = replace(problem, coulomb=replace(law, sliding=lame))
    assert not judge(problem, solution.u, solution.pressure, solution.rubbed.force).failures()
    assert judge(wrong, solution.u, solution.pressure, solution.rubbed.force).failures()


def test_a_smooth_pair_has_no_friction_beside_one_that_rubs() -> None:
    problem, whole = pressed("nodes")
    smooth = Several((whole.pairs[0], replace(whole.pairs[1], smooth=True)))
    law = rubbed(between(problem, smooth), 0.3).coulomb
    for mu, own in zip((0.3, 0.0), smooth.candidates, strict=True):
        assert set(law.mu[own].tolist()) == {mu}
