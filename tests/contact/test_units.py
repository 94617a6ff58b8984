"""Units change nothing: every algorithm and the judge, where a mm is 1e12 units or 1e-12, and so a MPa."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import cache
from itertools import product

import numpy as np
import pytest
from scipy import sparse

from contact.catalogue import ALGORITHMS
from contact.diagnosis import diagnose
from contact.obstacles.drum_sphere import Drum
from contact.obstacles.foundation import Candidates, against
from contact.problem import ContactProblem, ContactSolution, Linearisation, Outcome
from contact.verify import judge
from support.problems.contact_problems import linear_mechanics, random_quadratic


@dataclass(frozen=True)
class Units:
    """How many units a mm and a MPa are taken as; powers of 4 change no digit of any number, not even of a root."""

    length: float = 1.0
    stress: float = 1.0

    @property
    def force(self) -> float:
        """Units of force in a N."""
        return self.stress * self.length**2

    @property
    def stiffness(self) -> float:
        """Units of an epsilon in a MPa/mm."""
        return self.stress / self.length

    def of(self, problem: ContactProblem) -> ContactProblem:
        """The problem in these units; without balances and choice of candidates."""
        length, force, curvature = self.length, self.force, problem.gap_curvature

        def linearise(u: np.ndarray, memory: object) -> Linearisation:
            lin = problem.linearise(u / length, memory)
            return Linearisation(
                force * lin.residual,
                force / length * lin.tangent,
                force * lin.scale,
                lambda du: lin.remember(du / length),
            )

        return replace(
            problem,
            linearise=linearise,
            gap=lambda u: length * problem.gap(u / length),
            gap_jacobian=lambda u: problem.gap_jacobian(u / length),
            weights=length**2 * problem.weights,
            coupling=None if problem.coupling is None else length**2 * problem.coupling,
            gap_curvature=None if curvature is None else lambda u, f: curvature(u / length, f) / length,
            gap_size=length * problem.gap_size,
            energy=None,
            directions=None,
            others=None,
            residual=None,
            only=None,
            travel=None,
        )

    def state(self, solution: ContactSolution) -> ContactSolution:
        """A state in these units."""
        return replace(solution, u=self.length * solution.u, pressure=self.stress * solution.pressure)


FAR = 4.0**20  # 1.1e12
UNITS = {
    "far longer and softer": Units(length=FAR, stress=FAR**-4),  # forces and energies are small, too
    "far longer": Units(length=FAR),
    "far shorter": Units(length=1 / FAR),
    "far stiffer": Units(stress=FAR),
    "far softer": Units(stress=1 / FAR),
}


M = 6
SOFT, STIFF = 1e-1, 1e4  # MPa/mm
ROUNDING = 1e-9  # of what is not a power of two apart


def inclined() -> ContactProblem:
    """Three unknowns a gap, linear."""
    return random_quadratic(np.random.default_rng(5), "inclined").problem()


def on_a_drum() -> ContactProblem:
    """A string of masses that move along x and z, lifted against a drum."""
    row = 2 * np.eye(M) - np.eye(M, k=1) - np.eye(M, k=-1)
    K = np.kron(np.eye(2), row) + 0.2 * np.eye(2 * M)
    places = np.concatenate([3 * np.arange(M), 3 * np.arange(M) + 2])
    operator = sparse.csr_matrix((np.ones(2 * M), (places, np.arange(2 * M))), shape=(3 * M, 2 * M))
    x = np.column_stack([np.arange(M), np.zeros(M), np.zeros(M)]).astype(float)
    weights = np.linspace(0.7, 1.3, M)
    f = np.concatenate([0.05 * np.arange(M), 0.6 * weights])
    drum = Drum(np.array([2.4, 0.0, 1.4]), np.array([0.0, 1.0, 0.0]), 1.0)
    return against(linear_mechanics(K, f), Candidates(x, operator, weights), drum)


PROBLEMS = {"inclined": (inclined, 20), "on a drum": (on_a_drum, 12)}
CASES = [
    (which, name, epsilon)
    for which, (make, _) in PROBLEMS.items()
    for name in ALGORITHMS
    for epsilon in (math.inf, STIFF, SOFT)
    if ALGORITHMS[name](epsilon=epsilon).supports(make()) is None
]
each_unit = pytest.mark.parametrize(
    "units",
    [
        pytest.param(units, marks=[] if units.length != 1 != units.stress else [pytest.mark.slow], id=name)
        for name, units in UNITS.items()
    ],
)


@cache
def solved(which: str, name: str = "semismooth", epsilon: float = math.inf) -> tuple[ContactProblem, ContactSolution]:
    """The problem and its answer in mm and MPa."""
    make, n = PROBLEMS[which]
    problem = make()
    return problem, ALGORITHMS[name](epsilon=epsilon).solve(problem, ContactSolution.at_rest(n, M))


@each_unit
def test_every_algorithm_does_the_same_in_any_units(units) -> None:
    """Units that are powers of four apart: the same sets, iterations and digits, to the last one; certified."""
    for which, name, epsilon in CASES:
        problem, one = solved(which, name, epsilon)
        assert one.outcome is Outcome.CONVERGED
        assert 0 < one.active.sum() < M
        there, stiffness = units.of(problem), units.stiffness * epsilon
        other = ALGORITHMS[name](epsilon=stiffness).solve(there, ContactSolution.at_rest(len(one.u), M))
        assert other.outcome is one.outcome
        assert {k: v for k, v in other.counters.items() if not k.endswith("_s")} == {
            k: v for k, v in one.counters.items() if not k.endswith("_s")
        }
        np.testing.assert_array_equal(other.active, one.active)
        np.testing.assert_allclose(other.u, units.length * one.u, rtol=ROUNDING, atol=0)
        np.testing.assert_allclose(other.pressure, units.stress * one.pressure, rtol=ROUNDING, atol=0)
        assert judge(there, other.u, other.pressure, epsilon=stiffness).failures() == []


# --- the judge ------------------------------------------------------------------------------------------------------


def one_wrong_node(u, p):
    wrong, pressed, still = p.copy(), np.argmax(p), np.argmin(p)
    wrong[still], wrong[pressed] = p[pressed], 0.0
    return u, wrong


SPOILT = (
    lambda u, p: (u, -p),
    one_wrong_node,
    lambda u, p: (u, 1e3 * p),
    lambda u, p: (u, (1 - 1e-6) * p),
    lambda u, p: ((1 + 1e-6) * u, p),
    lambda u, p: ((1 - 1e-6) * u, p),
    lambda u, p: (u, 0 * p),
    lambda u, p: (0 * u, 0 * p),
)


@each_unit
def test_planted_faults_are_found_and_named_alike_in_any_units(units) -> None:
    for which, spoil in product(PROBLEMS, SPOILT):
        problem, answer = solved(which)
        there, u, p = units.of(problem), *spoil(answer.u, answer.pressure)
        at_home, abroad = judge(problem, u, p), judge(there, units.length * u, units.stress * p)
        assert at_home.failures()
        assert abroad.failures() == at_home.failures()
        assert [finding.split(":")[0] for finding in diagnose(there, units.length * u, units.stress * p)] == [
            finding.split(":")[0] for finding in diagnose(problem, u, p)
        ]
        assert abroad.length == units.length * at_home.length
        assert abroad.pressure == units.stress * at_home.pressure


@each_unit
@pytest.mark.parametrize("which", PROBLEMS)
def test_a_foundation_that_is_off_is_found_at_any_size_of_all(which, units) -> None:
    """Penetration and opening of a share of the length scale, down to five times the bound."""
    problem, answer = solved(which)
    there, u, p = units.of(problem), units.length * answer.u, units.stress * answer.pressure
    length = judge(there, u, p).length
    for share, (side, name) in product((1e-11, 1e-6, 1.0), ((-1, "penetration"), (1, "complementarity"))):
        shifted = replace(there, gap=lambda v, by=side * share * length: there.gap(v) + by)
        assert name in judge(shifted, u, p).failures()
