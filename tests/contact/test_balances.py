"""Balances of energy and force: closed on sound answers, open when a force, a potential or a support is wrong."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from scipy import sparse

from contact.catalogue import ALGORITHMS
from contact.continuation.load_stepping import follow
from contact.obstacles.drum_sphere import Drum
from contact.obstacles.foundation import Candidates, against
from contact.problem import ContactProblem, ContactSolution, Linearisation, Outcome
from contact.verify import judge
from formulations.loads import Pressure
from formulations.section.laminate import Laminate, Ply
from formulations.shell import ShellModel
from formulations.strains.catalogue import MEASURES
from formulations.strains.quantities import FULL
from support.problems.differences import fitted_order
from support.problems.shells import PATCHES, make_shell

CLOSED = 1e-11  # a balance of forces or energies that is only rounding
OPEN = 1e-4
ORDER = 0.1  # half-width of the interval around the order 8 of Lobatto's rule over a whole way


@pytest.fixture
def chain():
    """Springs k e + c e^3 in a row before walls: a potential of the fourth degree."""
    n, k, c = 6, 2.0, 5.0
    f, walls = np.array([0.5, 1.2, -0.8, 1.5, -0.4, 1.0]), np.full(6, 0.4)
    B, G = np.eye(n) - np.eye(n, k=-1), sparse.csr_matrix(-np.eye(n))

    def linearise(u, memory):
        e = B @ u
        tangent = sparse.csc_matrix(B.T @ np.diag(k + 3 * c * e**2) @ B)
        return Linearisation(B.T @ (k * e + c * e**3) - f, tangent, float(np.linalg.norm(f)))

    def energy(u):
        e = B @ u
        return float(np.sum(k * e**2 / 2 + c * e**4 / 4) - f @ u)

    problem = ContactProblem(linearise, lambda u: walls + G @ u, lambda u: G, np.linspace(0.5, 2, n), energy=energy)
    solution = ALGORITHMS["semismooth"]().solve(problem, ContactSolution.at_rest(n, n))
    assert solution.outcome is Outcome.CONVERGED
    assert solution.active.any()
    return problem, solution


def test_energy_of_a_fourth_degree_potential_is_balanced_from_anywhere(chain, rng) -> None:
    problem, solution = chain
    for since in (None, solution.u / 2, rng.normal(size=6)):
        verdict = judge(problem, solution.u, solution.pressure, since=since)
        assert verdict.energy <= CLOSED
        assert verdict.failures() == []


def test_work_of_wrong_pressures_does_not_balance(chain) -> None:
    problem, solution = chain
    verdict = judge(problem, solution.u, 1.1 * solution.pressure)
    assert verdict.energy > OPEN
    assert {"equilibrium", "energy"} <= set(verdict.failures())


def test_a_potential_that_is_not_that_of_the_forces_is_caught(chain) -> None:
    """All four conditions hold: the mechanics is wrong in itself, and only the energy tells."""
    problem, solution = chain
    wrong = replace(problem, energy=lambda u: 1.01 * problem.energy(u))
    assert judge(wrong, solution.u, solution.pressure).failures() == ["energy"]


def test_other_potentials_are_balanced_up_to_the_eighth_order() -> None:
    """exp(u): relative error of the eighth order in the length of the way, as long as one panel is enough."""
    lengths, errors = np.array([1.2, 0.9, 0.6]), []
    for length in lengths:
        u = np.array([length])
        verdict = judge(exponential(), u, np.exp(u), since=np.zeros(1))  # the pressure is the force at the end
        errors.append(verdict.energy * 2 * np.exp(length / 2) / length)  # over the mean derivative, too
    assert abs(fitted_order(lengths, errors) - 8) <= ORDER


def exponential() -> ContactProblem:
    """P = exp(u) held by one pressure."""
    return ContactProblem(
        lambda u, memory: Linearisation(np.exp(u), sparse.csc_matrix(np.diag(np.exp(u))), 1.0),
        lambda u: np.ones(1),
        lambda u: sparse.csr_matrix([[1.0]]),
        np.ones(1),
        energy=lambda u: float(np.sum(np.exp(u))),
    )


def test_a_long_way_is_balanced_in_panels_and_still_tells_what_is_wrong() -> None:
    """One panel over exp(8) is off by more than the bound; what is wrong stays wrong whatever the panels."""
    problem, u = exponential(), np.array([8.0])
    right = judge(problem, u, np.exp(u), since=np.zeros(1))
    assert right.energy <= 1e-8
    too_large = replace(problem, energy=lambda u: 1.0001 * problem.energy(u))
    assert judge(too_large, u, np.exp(u), since=np.zeros(1)).energy > 1e-5
    assert judge(problem, u, 1.0001 * np.exp(u), since=np.zeros(1)).energy > 1e-6


def test_no_potential_no_balance(chain) -> None:
    problem, solution = chain
    verdict = judge(replace(problem, energy=None), solution.u, solution.pressure)
    assert verdict.energy is None
    assert verdict.force is None
    assert verdict.balances == {}
    assert set(verdict.certificate) == {"failures", "kkt", "balances", "rounding", "scales"}
    assert verdict.certificate["failures"] == []


# --- shells -------------------------------------------------------------------------------------------------------


@cache
def pressed(
    name: str, measure: str = "exact", interpolation: str = "curvilinear", n: int = 6, follower: bool = False
) -> tuple[ShellModel, ContactProblem, ContactSolution]:
    """A clamped patch pushed by its pressure against a drum beside its middle; model, problem, answer."""
    patch = PATCHES[name]
    grid = patch.grid(n, n, 0.5)
    fixed = np.zeros((grid.n_nodes, 6), bool)
    lines = [(axis, grid.nodes[:, axis].min()) for axis in (0, 1)] + [
        (axis, grid.nodes[:, axis].max()) for axis in (0, 1)
    ]
    edges = np.unique(np.concatenate([grid.on_line(axis, value) for axis, value in lines]))
    fixed[edges] = True
    pressure = Pressure(0.4, follower)
    laminate = Laminate((Ply.isotropic(60.0, 0.3, 0.08),), d_minus=-0.03)
    options = {"measure": measure, "interpolation": interpolation}
    shell = make_shell(patch.surface, grid, laminate, fixed=fixed, pressure=pressure, **options)
    part, free = shell.discretisation, np.setdiff1d(np.arange(grid.n_nodes), edges)
    candidates = Candidates(
        part.positions()[1][free], part.displacement_operator(free, 1), part.nodal_areas("outer")[free]
    )
    middle = np.argmin(np.linalg.norm(grid.nodes - grid.nodes.mean(axis=0), axis=1))
    frame = part.surface.frame(*grid.nodes[middle])
    drum = Drum(part.positions()[1][middle] + 3.004 * frame[2], frame[0], 3.0)

    def problem(load: float) -> ContactProblem:
        loaded = shell.scaled(load)
        against_drum = against(loaded.linearise, candidates, drum)
        return replace(against_drum, energy=loaded.energy, others=lambda u: loaded.outside_and_spurious(u)[0])

    rest = ContactSolution.at_rest(part.n_free, len(free))
    (point,) = follow(problem, 0.0, [1.0], ALGORITHMS["semismooth"](), rest, steps=4)
    assert point.outcome is Outcome.CONVERGED
    assert point.solution.active.sum() > 1
    return shell, problem(1.0), point.solution


@pytest.mark.parametrize(
    ("name", "measure"), [*(("sphere", measure) for measure in MEASURES), ("plate", "exact"), ("cylinder", "exact")]
)
def test_both_balances_close_on_a_shell(name, measure) -> None:
    interpolation = "isoparametric" if MEASURES[measure].kinematics == FULL else "curvilinear"
    shell, problem, answer = pressed(name, measure, interpolation)
    assert shell.conservative
    verdict = judge(problem, answer.u, answer.pressure)
    assert verdict.energy <= CLOSED
    if interpolation == "isoparametric" or name == "plate":
        assert verdict.failures() == []
        assert verdict.force <= CLOSED + 10 * verdict.equilibrium
    else:
        assert verdict.failures() == ["force"]


def test_a_missing_support_or_load_leaves_a_force() -> None:
    shell, problem, answer = pressed("sphere", "exact", "isoparametric")
    reactions = shell.reactions(answer.u)
    assert np.abs(reactions).max() > OPEN
    held = np.argmax(np.abs(reactions[:, 4]))
    lost = replace(
        problem, others=lambda u: shell.outside_and_spurious(u)[0] - reactions[held, 4] * np.array([0.6, 0.0, 0.8])
    )
    assert judge(lost, answer.u, answer.pressure).failures() == ["force"]
    lighter = replace(problem, others=lambda u: shell.scaled(0.9).outside_and_spurious(u)[0])
    assert judge(lighter, answer.u, answer.pressure).force > OPEN


def test_wrong_normals_leave_a_force() -> None:
    """The pressures act along the gradient of the gap; told otherwise, the resultant does not close."""
    _, problem, answer = pressed("plate", "exact", "isoparametric")
    tilted = replace(
        problem, directions=lambda u: problem.directions(u) @ np.array([[1, 0, 0], [0, 1, 0], [0.01, 0, 1]])
    )
    assert judge(tilted, answer.u, answer.pressure).failures() == ["force"]


def test_the_papers_interpolation_does_not_translate_a_curved_shell() -> None:
    """Known of the element, and now measured in every contact: the force is lost with the square of the mesh size."""
    values = []
    for n in (6, 12):
        shell, problem, answer = pressed("sphere", n=n)
        verdict = judge(problem, answer.u, answer.pressure)
        assert verdict.energy <= CLOSED
        assert verdict.failures() == ["force"]
        changed = replace(
            problem, others=lambda u, shell=shell: shell.outside_and_spurious(u)[0] - shell.outside_and_spurious(u)[1]
        )
        assert judge(changed, answer.u, answer.pressure).force <= CLOSED + 10 * verdict.equilibrium
        size = np.sum(np.abs(problem.nodal_forces(answer.pressure)))
        values.append(verdict.force * max(problem.linearise(answer.u, None).scale, size))
    assert values[0] > 2 * values[1]


def test_follower_loads_and_unsymmetric_sections_have_no_potential() -> None:
    shell, problem, answer = pressed("plate", follower=True)
    assert not shell.conservative
    verdict = judge(problem, answer.u, answer.pressure)
    assert verdict.energy > OPEN  # what the balance would say of the energy of the strains alone
    assert verdict.force <= CLOSED
    assert judge(replace(problem, energy=None), answer.u, answer.pressure).failures() == []
    plate = PATCHES["plate"]
    sections = {s: make_shell(plate.surface, plate.grid(2, 2), section=s) for s in ("constant-s33", "nonsymmetric")}
    assert {name: shell.conservative for name, shell in sections.items()} == {
        "constant-s33": True,
        "nonsymmetric": False,
    }
    assert not make_shell(plate.surface, plate.grid(2, 2), initial=np.ones(11)).conservative
