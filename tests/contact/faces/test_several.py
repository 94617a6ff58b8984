"""Several pairs in one problem: three nets in a row by differences, by the judge, and against an independent QP."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
import pytest
from scipy import sparse

from contact.catalogue import ALGORITHMS
from contact.faces.pair import Pair, between
from contact.faces.sampling import areas, at_nodes, mortar
from contact.faces.several import Several
from contact.interchange.linearised_step import FrozenStep
from contact.interchange.oracle import minimise
from contact.problem import ContactSolution, linear_mechanics
from contact.verify import PAIR, judge
from support.problems.sheets import sheet

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
        found = super().forces(u, nodal)
        found[self.master[0, 0], 2] += self.off
        return found


def test_the_judge_looks_at_every_pair_by_itself() -> None:
    """Faults of two pairs that cancel each other in the sum."""
    whole = stack("nodes")
    n, m = whole.operator.shape[1], len(whole.weights)
    fields = [{name: getattr(each, name) for name in each.__dataclass_fields__} for each in whole.pairs]
    wrong = Several(tuple(Biased(**each, off=off) for each, off in zip(fields, (0.1, -0.1), strict=True)))
    problem = between(linear_mechanics(sparse.csc_matrix(sparse.eye_array(n)), np.zeros(n)), whole)
    pressure = np.ones(m)
    right, told = (judge(replace(problem, faces=each), np.zeros(n), pressure) for each in (whole, wrong))
    assert max(right.balances["pair_force"], right.balances["pair_moment"]) <= PAIR
    nodal = problem.nodal_forces(pressure)
    assert abs(wrong.forces(np.zeros(n), nodal).sum()) <= PAIR * nodal.sum()
    assert told.balances["pair_force"] > 1e-3
    assert {"pair_force", "pair_moment"} <= set(told.failures())


@pytest.mark.parametrize("pairing", ["nodes", pytest.param("mortar", marks=pytest.mark.slow)])
def test_three_nets_in_a_row_are_what_an_oracle_makes_of_them(pairing: str) -> None:
    """Springs hold every point; the uppermost net is pressed on the middle one, and that on the lowest."""
    whole = stack(pairing)
    n, m = whole.operator.shape[1], len(whole.weights)
    above = whole.pairs[1].weights
    load = np.zeros((n // 3, 3))
    load[-len(above) :, 2] = -2.5 * above
    K = sparse.csc_matrix(
        sparse.diags_array(np.repeat([50.0, 3.0, 1.0], [3 * 24, 3 * 20, 3 * 30]))  # each stiffer than the next
    )
    problem = between(linear_mechanics(K, load.ravel()), whole)
    found = ALGORITHMS["semismooth"](epsilon=math.inf).solve(problem, ContactSolution.at_rest(n, m))
    assert found.outcome.converged
    told = judge(problem, found.u, found.pressure)
    assert not told.failures()
    assert all(found.active[own].any() for own in whole.candidates)
    lin = problem.linearise(found.u, None)
    step = FrozenStep(
        problem.stiffness(lin, found.u, found.pressure),
        lin.residual,
        problem.gap_jacobian(found.u),
        problem.gap(found.u),
        whole.weights,
        lin.scale,
    )
    _, pressure = minimise(step)
    np.testing.assert_allclose(found.pressure, pressure, rtol=0, atol=EXACT * np.max(pressure))
