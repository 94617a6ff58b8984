"""What measures state in vectors against their tables: the same, and a planted coefficient is named."""

from dataclasses import replace

import numpy as np
import pytest

from formulations.strains.catalogue import MEASURES
from formulations.strains.measure import QuadraticMeasure
from formulations.strains.quantities import QUANTITIES, STRAINS
from studies.scenes.manufactured.statements import (
    STATEMENTS,
    WrongCoefficient,
    own_statement,
    statement_of,
    work_gradient,
    wrong_coefficients,
)
from support.problems.differences import rotation

QUADRATIC = [name for name, measure in MEASURES.items() if isinstance(measure, QuadraticMeasure)]


@pytest.mark.parametrize("name", QUADRATIC)
def test_tables_are_what_the_measures_state(name: str) -> None:
    assert wrong_coefficients(MEASURES[name], STATEMENTS[name]) == []


def test_every_measure_states_something() -> None:
    assert set(STATEMENTS) == set(MEASURES)


@pytest.mark.parametrize("name", QUADRATIC)
def test_a_planted_coefficient_is_named(name: str) -> None:
    """One of the table's own, 5 % off, and a product that nobody has."""
    measure = MEASURES[name]
    linear, quadratic = measure.linear.copy(), measure.quadratic.copy()
    row, i = STRAINS.index("2E13+"), QUANTITIES.index("t1+")
    linear[row, i] *= 1.05
    e22, j, k = STRAINS.index("E22-"), QUANTITIES.index("l1-"), QUANTITIES.index("beta3")
    quadratic[e22, j, k] = quadratic[e22, k, j] = 0.02
    actual = wrong_coefficients(replace(measure, linear=linear, quadratic=quadratic), STATEMENTS[name])
    assert set(actual) == {
        WrongCoefficient("2E13+", "t1+", -1.05, -1.0),
        WrongCoefficient("E22-", "l1- beta3", 0.02, 0.0),
    }
    assert str(actual[0]) in (
        "2E13+: coefficient of t1+ is -1.05, stated -1",
        "E22-: coefficient of l1- beta3 is 0.02, stated 0",
    )


def test_statements_of_a_rotation() -> None:
    """F = R: what measures without objectivity see of it is 1 - cos, the exact ones see nothing."""
    H = rotation(np.array([0.3, -0.5, 0.8]), 0.7) - np.eye(3)
    for name in ("exact", "elongation"):
        np.testing.assert_allclose(STATEMENTS[name](H), 0, atol=1e-14)
    np.testing.assert_allclose(STATEMENTS["linear"](H)[:2], np.diag(H)[:2], atol=1e-14)


@pytest.mark.parametrize("name", MEASURES)
def test_the_work_of_a_statement_is_its_derivative(name: str) -> None:
    """By complex steps, which share nothing with the differences."""
    rng = np.random.default_rng(1)
    H, S = 0.3 * rng.normal(size=(5, 3, 3)), rng.normal(size=(5, 6))
    P = work_gradient(STATEMENTS[name], H, S)
    for i, a in np.ndindex(3, 3):
        moved = H.astype(complex)
        moved[:, i, a] += 1e-30j
        np.testing.assert_allclose(P[:, i, a], np.sum(S * STATEMENTS[name](moved).imag, axis=1) / 1e-30, atol=1e-10)


def test_a_measure_from_outside_is_taken_at_its_own_word() -> None:
    """The same strains as the statement of the catalogue, where it is one of these under another name."""
    own = replace(MEASURES["sanders"], name="of one's own")
    H = 0.2 * np.random.default_rng(2).normal(size=(7, 3, 3))
    np.testing.assert_allclose(statement_of(own)(H), STATEMENTS["sanders"](H), atol=1e-15)
    np.testing.assert_allclose(own_statement(own)(H), STATEMENTS["sanders"](H), atol=1e-15)
