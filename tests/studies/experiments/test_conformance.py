"""The conformance kit: the whole catalogue on every element passes it, and what is broken on purpose does not.

Here by itself, in no other module: objectivity of strained states, exchanged axes, changed units, homogeneous
deformation, the order and limit of a ring, and a manufactured solution, for every measure with every element that
suits it.
"""

import re
from collections.abc import Callable
from dataclasses import astuple, dataclass, replace
from itertools import product

import numpy as np
import pytest

from formulations.element.mixed import MEMBRANES, THICKNESS_STRAINS
from formulations.element.strain_operator import ON_LINES, ElementGeometry
from formulations.geometry.grid import Grid
from formulations.geometry.surfaces import sphere
from formulations.shell import ShellModel
from formulations.strains.catalogue import EXACT, LINEAR, MEASURES, SANDERS
from formulations.strains.measure import EXACT_LAW, StrainMeasure
from studies.experiments.conformance import claims_objectivity, conformance
from studies.experiments.specimens import ELEMENTS, Element, layup
from support.problems.differences import fitted_order, rotation

OTHER = ("isoparametric", "balanced", "relaxed")  # in every option
QUADS = Element("quads", "balanced", "relaxed")


def name(element: Element) -> str:
    return f"{element.interpolation}-{element.thickness_strain}-{element.membrane}"


def failed(measure: StrainMeasure, element: Element = ELEMENTS[0]) -> set[str]:
    return {check.law for check in conformance(measure, element) if not check.passed}


def by_turns(element: Element) -> list[str]:
    """All measures on the first element and on quadrilaterals; on others the exact one, and a third of the rest.

    So each measure meets every option of an element.
    """
    if element in (ELEMENTS[0], QUADS):
        return [*MEASURES]
    turn = sum(
        [*names].index(option)
        for names, option in zip((ON_LINES, THICKNESS_STRAINS, MEMBRANES), astuple(element), strict=True)
    )
    return [key for k, key in enumerate(MEASURES) if key == "exact" or k % 3 == turn % 3]


@pytest.mark.parametrize(
    "element", [ELEMENTS[0], *(pytest.param(each, marks=pytest.mark.slow) for each in (QUADS, *ELEMENTS[1:]))], ids=name
)
def test_catalogue_conforms(element: Element) -> None:
    for key in by_turns(element):
        assert not element.suits(MEASURES[key]) or not failed(MEASURES[key], element), key


def test_the_catalogue_is_complete() -> None:
    assert {(e.interpolation, e.thickness_strain, e.membrane) for e in ELEMENTS} == set(
        product(ON_LINES, THICKNESS_STRAINS, MEMBRANES)
    )
    left_out = [m for m in MEASURES if not Element("isoparametric").suits(MEASURES[m])]
    assert left_out == ["donnell", "thin-green-lagrange"]
    assert {m for m in MEASURES if claims_objectivity(MEASURES[m])} == {"exact", "thin-green-lagrange", "elongation"}
    with pytest.raises(ValueError, match="donnell leaves gradients out: not for isoparametric elements"):
        conformance(MEASURES["donnell"], Element("isoparametric"))


# --- measures that must fail --------------------------------------------------------------------------------------

RIGID = "rigid motions leave the declared strains"
TURN = "forces of a strained plate turn with it"
TURN_TORUS = "forces of a strained torus turn with it"
TANGENT = "remainder of the tangent is of second order"
ENERGY = "residual is the gradient of the energy"
SYMMETRY = "tangent of dead loads is symmetric"
PATCH = "homogeneous deformation needs one traction"
BENDING = "constant curvature is in balance at rest"
AXES = {f"the axes may be exchanged, {section}" for section in ("constant-s33", "nonsymmetric", "full-3d")}
UNITS = "the units may be changed"
RING = "deflection of a ring converges with the order"
LIMIT = "extrapolated deflection of a ring over the closed form"
MANUFACTURED = "error of a manufactured solution falls with the order"
STATED = "coefficients are those that the measure states"


@dataclass(frozen=True, eq=False)
class Wrong:
    """The exact measure with something else in place of one of its functions."""

    name: str = "wrong"
    reference: str = "none"
    rigid_body_law: object = EXACT_LAW
    kinematics: object = EXACT.kinematics
    strain: Callable = EXACT.strain
    gradient: Callable = EXACT.gradient
    contract: Callable = EXACT.contract


@pytest.mark.slow
def test_a_false_claim_is_found() -> None:
    assert failed(replace(SANDERS, rigid_body_law=EXACT_LAW)) == {RIGID, TURN}
    assert failed(replace(LINEAR, rigid_body_law=EXACT_LAW), Element("isoparametric")) == {RIGID, TURN, TURN_TORUS}


def test_a_false_confession_is_found() -> None:
    """A measure that passes where it says it fails is as wrong."""
    confessed = replace(EXACT, rigid_body_law=SANDERS.rigid_body_law)
    assert failed(confessed) == {RIGID, TURN}
    (worst,) = (check.said for check in conformance(confessed) if check.law == RIGID)
    assert re.fullmatch(r"plate out of plane by 3\.14 leaves \S+e-1\d, declared -2", worst)


@pytest.mark.slow
def test_a_wrong_gradient_is_found() -> None:
    def gradient(q: np.ndarray) -> np.ndarray:
        return EXACT.gradient(q) * (1 + 0.01 * np.arange(11)[:, None])

    assert {TANGENT, ENERGY} <= failed(Wrong(gradient=gradient))


def test_a_gradient_of_products_that_is_a_little_wrong_is_found() -> None:
    """By the ten-thousandth part, beside which the work of the loads is not small."""

    def gradient(q: np.ndarray) -> np.ndarray:
        at_rest = EXACT.gradient(np.zeros_like(q))
        return at_rest + (1 + 1e-4) * (EXACT.gradient(q) - at_rest)

    assert ENERGY in failed(Wrong(gradient=gradient))


def test_a_forgotten_or_unsymmetric_geometric_stiffness_is_found() -> None:
    def forgotten(q: np.ndarray, H: np.ndarray) -> np.ndarray:
        return np.zeros((*q.shape, q.shape[-1]))

    def unsymmetric(q: np.ndarray, H: np.ndarray) -> np.ndarray:
        return np.triu(EXACT.contract(q, H))

    assert failed(Wrong(contract=forgotten)) == {TANGENT, MANUFACTURED}
    assert failed(Wrong(contract=unsymmetric)) == {TANGENT, SYMMETRY, *AXES}


def test_an_axis_that_is_treated_otherwise_is_found() -> None:
    """E11 without its w^2/2: still a potential with its own tangent."""
    quadratic = EXACT.quadratic.copy()
    quadratic[0:2, 2:4, 2:4] = 0.0
    named = f"{STATED}; E11-: coefficient of w1- w1- is 0, stated 0.5; E11+: coefficient of w1+ w1+ is 0, stated 0.5"
    assert failed(replace(EXACT, quadratic=quadratic)) == {RIGID, TURN, *AXES, MANUFACTURED, named}


# --- elements that must fail --------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Broken(Element):
    """An element whose geometry is spoilt."""

    spoil: Callable[[ElementGeometry, Grid], ElementGeometry] = lambda geometry, grid: geometry

    def shell(self, *args, **loads) -> ShellModel:
        shell = super().shell(*args, **loads)
        discretisation = shell.discretisation
        geometry = self.spoil(discretisation.geometry, discretisation.grid)
        return replace(shell, discretisation=replace(discretisation, geometry=geometry))


def test_an_element_that_is_not_broken_passes() -> None:
    assert not failed(EXACT, Broken(*OTHER))


def test_uneven_weights_fail_the_patch_tests_and_an_absolute_area_the_units() -> None:
    def uneven(geometry: ElementGeometry, grid: Grid) -> ElementGeometry:
        return replace(geometry, weight=geometry.weight * (1 + 1e-3 * np.arange(len(geometry.weight))))

    def absolute(geometry: ElementGeometry, grid: Grid) -> ElementGeometry:
        return replace(geometry, weight=geometry.weight + 1e-6)

    for spoil, laws, others in ((uneven, {PATCH, BENDING}, {UNITS}), (absolute, {UNITS}, AXES)):
        actual = failed(EXACT, Broken(spoil=spoil))
        assert laws <= actual
        assert not actual & {RIGID, TANGENT, ENERGY, TURN, *others}


def test_wrong_gradients_of_an_element_fail_the_ring() -> None:
    """Too large by the order of the mesh size, or by a thousandth on every mesh."""
    for error, laws in ((lambda half: 0.5 * half, {RING, LIMIT}), (lambda half: 1e-3, {LIMIT})):

        def spoil(geometry: ElementGeometry, grid: Grid, error: Callable = error) -> ElementGeometry:
            return replace(geometry, Q=geometry.Q * (1 + error(grid.half[:, 1, None, None])))

        actual = failed(EXACT, Broken(spoil=spoil))
        assert {RING, LIMIT} & actual == laws
        assert (MANUFACTURED in actual) == (RING in laws)


# --- what curvilinear elements can do -----------------------------------------------------------------------------


@pytest.mark.parametrize("element", [e for e in ELEMENTS if e.interpolation == "curvilinear"], ids=name)
def test_a_curvilinear_element_is_objective_to_second_order(element) -> None:
    """Components interpolated in a turning frame: the strain energy of a turned, smoothly strained cap tends to that
    of the cap before it was turned, as the square of the mesh size."""
    R, sizes, errors = rotation(np.array([1.0, 2.0, 0.5]), 1.0), [], []
    for n in (8, 16, 32):
        grid = Grid.tensor(np.linspace(0.1, 0.7, n + 1), np.linspace(0.2, 0.8, n + 1))
        shell = element.shell(EXACT, sphere(2.0), grid, layup())
        frame = sphere(2.0).frame(*grid.nodes.T)
        energies = []
        for Q in (np.eye(3), R):
            v = np.empty((grid.n_nodes, 6))
            for face, x in enumerate(shell.discretisation.positions()):
                y = x * [1.05, 0.97, 1.02]
                v[:, face::2] = np.einsum("nij,nj->ni", frame, y @ Q.T - x)
            energies.append(shell.energy(v.ravel()))
        sizes.append(1 / n)
        errors.append(abs(energies[1] / energies[0] - 1))
    assert fitted_order(sizes, errors) > 1.8
