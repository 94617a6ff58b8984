"""Eight planted corruptions are caught and named, on chain, membrane and shells; what fits none is not given a name."""

import math
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
import pytest
from scipy import sparse

from contact import diagnosis
from contact.catalogue import ALGORITHMS
from contact.continuation.load_stepping import follow
from contact.diagnosis import CORRUPTIONS, diagnose
from contact.obstacles.drum_sphere import Drum
from contact.obstacles.foundation import Candidates, Foundation, RigidPlane, against
from contact.problem import ContactProblem, ContactSolution, Linearisation, Outcome
from contact.verify import judge
from formulations.geometry.surfaces import Plate
from formulations.loads import Pressure
from formulations.section.laminate import Laminate, Ply
from support.problems.contact_problems import linear_mechanics
from support.problems.shells import PATCHES, make_shell

UP = np.array([0.0, 0.0, 1.0])
EPSILON = 1e4


@dataclass(frozen=True, eq=False)
class Case:
    """A body under a load factor, with candidates on two faces; contact is on the second."""

    mechanics: Callable[[float], Callable[[np.ndarray, object], Linearisation]]
    faces: tuple[Candidates, Candidates]
    foundation: Foundation
    epsilon: float = math.inf

    def problem(self, load: float = 1.0, face: int = 1, nearer: float = 0.0) -> ContactProblem:
        grown = self.foundation.moved(-nearer * UP)
        if isinstance(self.foundation, Drum):  # moving it would also turn its normals
            grown = replace(self.foundation, radius=self.foundation.radius + nearer)
        return against(self.mechanics(load), self.faces[face], grown)

    def solve(self, load: float = 1.0) -> ContactSolution:
        rest = ContactSolution.at_rest(self.faces[1].operator.shape[1], len(self.faces[1].weights))
        (point,) = follow(self.problem, 0.0, [load], ALGORITHMS["semismooth"](epsilon=self.epsilon), rest, steps=4)
        assert point.outcome is Outcome.CONVERGED
        return point.solution


def grid_case(n1: int, n2: int) -> Case:
    """A net of strings with unequal areas and two faces, coupled across the thickness by springs; load along z."""
    m = n1 * n2
    number = np.arange(m).reshape(n1, n2)
    K = np.zeros((m, m))
    along, across = (
        zip(number[:-1].flat, number[1:].flat, strict=True),
        zip(number[:, :-1].flat, number[:, 1:].flat, strict=True),
    )
    for a, b in (*along, *across):
        K[[a, b], [a, b]] += 1.0
        K[[a, b], [b, a]] -= 1.0
    edge = np.ones((n1, n2))
    edge[1:-1, slice(1, -1) if n2 > 1 else slice(None)] = 0.0
    K += np.diag(2.0 * edge.ravel() + 0.3)
    both = np.kron(np.eye(2), K) + 40.0 * np.kron([[1, -1], [-1, 1]], np.eye(m))
    weights = 1.0 + 0.5 * np.sin(np.arange(m))
    f = np.concatenate([1.1 * weights, 0.2 * weights])
    x = np.column_stack([np.repeat(np.arange(n1), n2), np.tile(np.arange(n2), n1), np.zeros(m)]).astype(float)

    def candidates(face: int) -> Candidates:
        rows, columns = 3 * np.arange(m) + 2, face * m + np.arange(m)
        operator = sparse.coo_matrix((np.ones(m), (rows, columns)), shape=(3 * m, 2 * m)).tocsr()
        return Candidates(x + (face - 1) * 0.2 * UP, operator, weights)

    def mechanics(load: float):
        return linear_mechanics(both, load * f)

    return Case(mechanics, (candidates(0), candidates(1)), RigidPlane(UP, 0.6))


def shell_case(foundation: Foundation, coupling: bool = False, epsilon: float = math.inf) -> Case:
    """A clamped plate of two unequal divisions lifted against a foundation by a pressure."""
    grid = PATCHES["plate"].grid(10, 4)
    fixed = np.zeros((grid.n_nodes, 6), bool)
    edges = np.concatenate([grid.on_line(0, -1.0), grid.on_line(0, 1.0)])
    fixed[edges] = True
    ply = Ply.isotropic(100.0, 0.3, 0.05)
    shell = make_shell(Plate(), grid, Laminate((ply,), d_minus=0.0), fixed=fixed, pressure=Pressure(0.02))
    part, free = shell.discretisation, np.setdiff1d(np.arange(grid.n_nodes), edges)
    areas, mass = part.nodal_areas("mid")[free], part.nodal_mass("mid")[free][:, free]
    inner, outer = (
        Candidates(x[free], part.displacement_operator(free, face), areas, mass if coupling else None)
        for face, x in enumerate(part.positions())
    )
    return Case(lambda load: shell.scaled(load).linearise, (inner, outer), foundation, epsilon)


PLANE = RigidPlane(UP, 0.1)
DRUM = Drum(np.array([0.0, 1.0, 1.6]), np.array([0.0, 1.0, 0.0]), 1.5)
CASES = {
    "chain": lambda: grid_case(12, 1),
    "membrane": lambda: grid_case(7, 6),
    "shell": lambda: shell_case(PLANE),
    "shell on a drum": lambda: shell_case(DRUM),
    "shell, consistent": lambda: shell_case(PLANE, coupling=True),
    "shell, regularised": lambda: shell_case(PLANE, epsilon=EPSILON),
}


@pytest.fixture(scope="module")
def solved() -> dict[str, tuple[Case, ContactSolution, ContactSolution]]:
    return {}


@pytest.fixture(params=CASES)
def sound(request, solved):
    """A case, its answer, and its answer under 0.9 of the load; each is solved once."""
    if request.param not in solved:
        case = CASES[request.param]()
        solved[request.param] = case, case.solve(), case.solve(0.9)
    case, answer, before = solved[request.param]
    assert 3 < answer.active.sum() < len(answer.active)
    return case, answer, before


# --- the eight ----------------------------------------------------------------------------------------------------


def sign_flip(case, answer, before):
    return case.problem(), answer.u, -answer.pressure


def one_wrong_node(case, answer, before):
    """A pressed candidate's pressure is written to an open one."""
    wrong, pressed, still = answer.pressure.copy(), np.argmax(answer.pressure), np.argmin(answer.pressure)
    wrong[still], wrong[pressed] = wrong[pressed], 0.0
    return case.problem(), answer.u, wrong


def swapped_face(case, answer, before):
    """The candidates are those of the other face."""
    return case.problem(face=0), answer.u, answer.pressure


def wrong_units(case, answer, before):
    return case.problem(), answer.u, 1e3 * answer.pressure


def stale_pressure(case, answer, before):
    return case.problem(), answer.u, before.pressure


def missing_weight(case, answer, before):
    """The multipliers, which are forces, are handed over as pressures."""
    return case.problem(), answer.u, case.problem().nodal_forces(answer.pressure)


def shifted_gap(case, answer, before):
    return case.problem(nearer=1e-4), answer.u, answer.pressure


def unconverged_equilibrium(case, answer, before):
    """One Newton step too few: the displacement is a little off everywhere."""
    return case.problem(), answer.u * (1 + 1e-5 * np.sin(np.arange(len(answer.u)))), answer.pressure


EIGHT = {
    sign_flip: diagnosis.SIGN_FLIP,
    one_wrong_node: diagnosis.ONE_WRONG_NODE,
    swapped_face: diagnosis.SWAPPED_FACE,
    wrong_units: diagnosis.WRONG_UNITS,
    stale_pressure: diagnosis.STALE_PRESSURE,
    missing_weight: diagnosis.MISSING_WEIGHT,
    shifted_gap: diagnosis.SHIFTED_GAP,
    unconverged_equilibrium: diagnosis.UNCONVERGED,
}


def names(findings: list[str]) -> list[str]:
    return [finding.partition(":")[0] for finding in findings]


def test_a_sound_answer_has_no_findings(sound) -> None:
    case, answer, _ = sound
    assert diagnose(case.problem(), answer.u, answer.pressure, epsilon=case.epsilon) == []
    assert judge(case.problem(), answer.u, answer.pressure, epsilon=case.epsilon).failures() == []


def test_all_are_planted() -> None:
    assert sorted(EIGHT.values()) == sorted(CORRUPTIONS)


def test_a_corruption_is_caught_and_named(sound) -> None:
    for spoil, name in EIGHT.items():
        case, *answers = sound
        spoilt = spoil(case, *answers)
        assert judge(*spoilt, epsilon=case.epsilon).failures()
        assert names(diagnose(*spoilt, epsilon=case.epsilon)) == [name]


# --- details of the findings --------------------------------------------------------------------------------------


@pytest.fixture
def chain():
    case = grid_case(12, 1)
    return case, case.solve()


def test_details_are_those_that_were_planted(chain) -> None:
    case, answer = chain
    problem, u, p = case.problem(), answer.u, answer.pressure
    assert "1000 times" in diagnose(problem, u, 1e3 * p)[0]
    assert "9.80665 times" in diagnose(problem, u, 9.80665 * p)[0]
    assert "-0.0001 mm" in diagnose(case.problem(nearer=1e-4), u, p)[0]
    assert "0.0001 mm" in diagnose(case.problem(nearer=-1e-4), u, p)[0]
    node = int(np.argmax(p))
    wrong = p.copy()
    wrong[node] *= 1.01
    assert f"candidate {node} of {answer.active.sum()}" in diagnose(problem, u, wrong)[0]
    wrong = p.copy()
    wrong[node] = 0.0
    assert f"candidate {node} of {answer.active.sum()}" in diagnose(problem, u, wrong)[0]


def test_pressures_divided_twice_miss_a_weight_too(chain) -> None:
    case, answer = chain
    finding = diagnose(case.problem(), answer.u, answer.pressure / case.faces[1].weights)
    assert finding == ["missing weight: the pressures are divided by the areas twice"]


def test_two_mistakes_are_both_named(chain) -> None:
    case, answer = chain
    assert names(diagnose(case.problem(nearer=1e-3), answer.u, 10 * answer.pressure)) == ["wrong units", "shifted gap"]


def test_no_pressure_at_all_under_contact_is_stale_not_unconverged(chain) -> None:
    """u presses against the foundation, and the pressures are those of the start."""
    case, answer = chain
    assert names(diagnose(case.problem(), answer.u, 0 * answer.pressure)) == ["stale pressure"]


def test_what_fits_nothing_names_the_conditions(chain) -> None:
    """In equilibrium without any foundation: the gap is violated, by another amount everywhere."""
    case, answer = chain
    free = case.problem()
    K, f = free.linearise(0 * answer.u, None).tangent, -free.linearise(0 * answer.u, None).residual
    u = sparse.linalg.spsolve(K, f)
    assert diagnose(free, u, 0 * answer.pressure) == ["violated: penetration"]


def test_not_a_number_is_said(chain) -> None:
    for bad in (math.nan, math.inf):
        case, answer = chain
        p, u = answer.pressure.copy(), answer.u.copy()
        p[0] = bad
        with np.errstate(invalid="ignore"):
            assert names(diagnose(case.problem(), answer.u, p)) == ["not a number in the answer; violated"]
        u[0] = bad
        with np.errstate(invalid="ignore"):
            assert names(diagnose(case.problem(), u, answer.pressure)) == ["not a number in the answer; violated"]


def test_wrong_unit_of_one_node_is_one_wrong_node(chain) -> None:
    case, answer = chain
    p = np.where(np.arange(len(answer.pressure)) == np.argmax(answer.pressure), 1e3, 1.0) * answer.pressure
    assert names(diagnose(case.problem(), answer.u, p)) == ["one wrong node"]


def test_small_corruptions_keep_their_names(chain) -> None:
    """Down to ten times what the judge lets pass."""
    for size in (1e-4, 1e-5, 1e-6, 1e-7):
        case, answer = chain
        problem, u, p = case.problem(), answer.u, answer.pressure
        assert names(diagnose(case.problem(nearer=size), u, p)) == ["shifted gap"]
        bent = u * (1 + size * np.sin(np.arange(len(u))))
        assert names(diagnose(problem, bent, p)) == ["unconverged equilibrium"]
        assert judge(problem, u, p).failures() == []
