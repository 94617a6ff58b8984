"""Contact through the shell element without a scene: patch test on a plane, string and membrane over obstacles."""

from itertools import product

import numpy as np
import pytest

from contact.catalogue import ALGORITHMS
from contact.obstacles.foundation import RigidPlane, against_plane
from contact.problem import ContactSolution, Outcome
from contact.verify import judge
from formulations.conditions.boundary import Supports
from formulations.geometry.grid import Grid, graded_lines
from formulations.geometry.surfaces import Plate, annulus
from formulations.loads import Pressure
from formulations.section.laminate import Laminate, Ply
from formulations.shell import ShellModel
from studies.scenes.contact.base import outer_face
from support.problems.contact_problems import EXACT
from support.problems.shells import make_shell

ROUNDING = 1e-10
RIM = 0.05  # error of a reaction, in loads of a row of nodes: the rim wanders within its element
INSIDE = 0.005  # of the pressure inside the contact: the wall bends a little, which its nodes feel as a zigzag
UP = np.array([0.0, 0.0, 1.0])


def touching(name: str, shell: ShellModel, nodes: np.ndarray, plane: RigidPlane, lying: bool = False):
    """The problem and its converged solution; a body that lies free starts in contact."""
    problem = against_plane(shell.linearise, outer_face(shell.discretisation, nodes), plane)
    algorithm = ALGORITHMS[name](epsilon=np.inf)
    assert algorithm.supports(problem) is None
    m = len(nodes)
    start = ContactSolution(np.zeros(shell.discretisation.n_free), np.zeros(m), np.full(m, lying), Outcome.CONVERGED)
    solution = algorithm.solve(problem, start)
    if name == "qp" and shell.section == "nonsymmetric":  # no energy to minimise
        assert solution.outcome is Outcome.REFUSED
        return problem, None
    assert solution.outcome is Outcome.CONVERGED
    verdict = judge(problem, solution.u, solution.pressure)
    assert verdict.failures() == []
    return problem, solution


E, NU, H = 20.0, 0.3, 0.5
OEDOMETRIC = E * (1 - NU) / ((1 + NU) * (1 - 2 * NU))
WIDTHS = np.array([0.35, 0.5, 0.7, 0.55]), np.array([0.2, 0.75, 0.65, 0.1])  # that the nodes of the patch carry
SECTIONS = ("constant-s33", "nonsymmetric", "full-3d")
by_measure = pytest.mark.parametrize("measure", ["linear", "exact"])


def patch_on_a_plane() -> tuple[Grid, Supports, Laminate]:
    """Unequal elements, sides held in the plane, nu not zero: S33 and E33 are the only ones that work."""
    grid = Grid.tensor(np.array([0.0, 0.7, 1.0, 2.1]), np.array([0.0, 0.4, 1.5, 1.7]))
    supports = Supports.none(grid)
    for axis in (0, 1):
        for end in (grid.nodes[:, axis].min(), grid.nodes[:, axis].max()):
            supports = supports.symmetric(grid.on_line(axis, end), axis)
    return grid, supports, Laminate((Ply.isotropic(E, NU, H),), -H / 2)


# an algorithm that inverts the tangent without contact cannot have a body that lies free
@by_measure
def test_signorini_patch(measure) -> None:
    """Uniform pressure on one face of a plate that lies on the other: every node carries its area times p."""
    for name, section in product(("trial-and-error", "semismooth"), SECTIONS):
        p = 0.3
        grid, supports, laminate = patch_on_a_plane()
        fixed, hinged = supports.masks
        options = {"measure": measure, "section": section, "pressure": Pressure(p)}
        shell = make_shell(Plate(), grid, laminate, fixed=fixed, hinged=hinged, **options)
        nodes = np.arange(grid.n_nodes)
        problem, solution = touching(name, shell, nodes, RigidPlane(UP, H / 2), lying=True)
        assert solution.active.all()
        np.testing.assert_allclose(solution.pressure, p, rtol=ROUNDING)
        np.testing.assert_allclose(
            problem.nodal_forces(solution.pressure), p * np.outer(*WIDTHS).ravel(), rtol=ROUNDING
        )
        inner, outer = shell.discretisation.expand(solution.u)[:, 4:].T
        np.testing.assert_allclose(outer, 0, atol=ROUNDING)
        np.testing.assert_allclose(inner, inner[0], rtol=ROUNDING)
        assert inner[0] > 0
        if measure == "linear":
            np.testing.assert_allclose(inner, H * p / OEDOMETRIC, rtol=ROUNDING)


@by_measure
def test_signorini_patch_pressed_by_a_stamp(measure) -> None:
    """The other face moved by d: beta = -d/h, p = E_oed d/h, with exact strains -(1 + beta) E_oed (beta + beta^2/2)."""
    for name, section in product(EXACT, SECTIONS):
        d = 0.02
        grid, supports, laminate = patch_on_a_plane()
        nodes = np.arange(grid.n_nodes)
        fixed, hinged = supports.hold(nodes, (2,), ("inner",)).masks
        prescribed = np.zeros((grid.n_nodes, 6))
        prescribed[:, 4] = d
        options = {"measure": measure, "section": section, "prescribed": prescribed}
        shell = make_shell(Plate(), grid, laminate, fixed=fixed, hinged=hinged, **options)
        # without contact nothing would be loaded, and no residual relative to the forces means anything
        problem, solution = touching(name, shell, nodes, RigidPlane(UP, H / 2), lying=True)
        if solution is None:
            continue
        beta = -d / H
        p = -OEDOMETRIC * (beta if measure == "linear" else (1 + beta) * (beta + beta**2 / 2))
        np.testing.assert_allclose(solution.pressure, p, rtol=ROUNDING)
        np.testing.assert_allclose(
            problem.nodal_forces(solution.pressure), p * np.outer(*WIDTHS).ravel(), rtol=ROUNDING
        )


MANY_STEPS = ("trial-and-error", "augmented-lagrangian")
every_algorithm = pytest.mark.parametrize(
    "name", [pytest.param(name, marks=[pytest.mark.slow] * (name in MANY_STEPS)) for name in EXACT]
)

TENSION, GAP = 1.0, 0.01  # N/mm, mm: so shallow that stretching adds 1e-7 to the tension
SOFT = Laminate.single(Ply.isotropic(10.0, 0.0, 0.05))  # bends and is squeezed over less than 0.05 mm


def held_as_a_membrane(grid: Grid, end: float) -> Supports:
    """Directors turn freely: against a clamp they would zigzag along the whole string, which hardly bends at all."""
    nodes = grid.on_line(0, end)
    return Supports.none(grid).hold(nodes, (2,)).hinged(nodes, (0,))


def membrane(surface, grid: Grid, supports: Supports, load: float) -> ShellModel:
    """A shell so soft that the tension T it starts with carries the load."""
    fixed, hinged = supports.masks
    initial = np.zeros(11)
    initial[:4] = TENSION / 2  # both faces in both directions
    return make_shell(
        surface, grid, SOFT, fixed=fixed, hinged=hinged, measure="von-karman", initial=initial, pressure=Pressure(load)
    )


@every_algorithm
def test_string_of_shell_elements_over_an_obstacle(name) -> None:
    """Free length l = sqrt(2 T g/q) of a string; the reaction is what the string does not carry to its end."""
    L, free = 100.0, 38.0
    q = 2 * TENSION * GAP / free**2
    for n in (20, 40, 80):
        grid = Grid.tensor(np.linspace(0, L, n + 1), np.array([0.0, 10.0]))
        supports = held_as_a_membrane(grid, 0.0).symmetric(grid.on_line(0, L), 0)
        for side in (0.0, 10.0):
            supports = supports.symmetric(grid.on_line(1, side), 1)
        shell = membrane(Plate(), grid, supports, q)
        nodes = np.setdiff1d(np.arange(grid.n_nodes), grid.on_line(0, 0.0))
        problem, solution = touching(name, shell, nodes, RigidPlane(UP, SOFT.d_plus + GAP))
        force = problem.nodal_forces(solution.pressure).sum() / 10.0
        assert abs(force - q * (L - free)) <= RIM * q * L / n
        at = grid.nodes[nodes, 0]
        assert abs(at[solution.active].min() - free) <= L / n
        inside = at > free + 2 * L / n
        np.testing.assert_allclose(solution.pressure[inside], q, rtol=INSIDE)


@every_algorithm
def test_circular_membrane_over_an_obstacle(name) -> None:
    """Disc of radius a: q a^2/(T g) = 4/(1 - x^2 - 2 x^2 ln(1/x)), x = c/a; no line force, F = q pi c^2."""
    a, hole, x = 100.0, 1.0, 0.3
    load = 4 / (1 - x**2 - 2 * x**2 * np.log(1 / x))
    assert load == pytest.approx(5.769634, abs=1e-6)
    q = load * TENSION * GAP / a**2
    for n in (24, 48, 96):
        lines = graded_lines([hole, a], [n])
        grid = Grid.tensor(lines, np.array([0.0, 0.3]))
        supports = held_as_a_membrane(grid, a).symmetric(grid.on_line(0, hole), 0)
        for side in (0.0, 0.3):
            supports = supports.symmetric(grid.on_line(1, side), 1)
        shell = membrane(annulus(), grid, supports, q)
        nodes = np.setdiff1d(np.arange(grid.n_nodes), grid.on_line(0, a))
        problem, solution = touching(name, shell, nodes, RigidPlane(-UP, SOFT.d_plus + GAP))
        force = problem.nodal_forces(solution.pressure).sum() * 2 * np.pi / 0.3
        assert abs(force - q * np.pi * (x * a) ** 2) <= RIM * q * 2 * np.pi * x * a * (a - hole) / n
