"""Every solver that is installed, and every setting of OSQP, on steps with a known answer; what is refused, and why."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy import sparse

from contact.interchange.linearised_step import FrozenStep
from studies.arena.answers import accuracy
from studies.arena.solvers import catalogue
from studies.arena.solvers.base import Answer
from studies.arena.solvers.catalogue import ABLATION, SETTINGS, SOLVERS
from studies.arena.solvers.outside import DENSE, Outside
from support.problems.contact_problems import Broken, Told, in_units, indefinite, known_step, lopsided

INSTALLED = [name for name, solver in SOLVERS.items() if solver.missing() is None]
REACHED = 1e-4  # by every one of them, asked for 1e-8 on six candidates; most are far below


def test_the_field_is_large_and_names_are_its_keys() -> None:
    assert len(INSTALLED) >= 8
    assert all(solver.name == name for name, solver in SOLVERS.items())
    assert {"OSQP", "Clarabel", "HiGHS", "SCS", "cvxpy", "Lemke", "active set", "nnls", "semismooth"} <= set(INSTALLED)


@pytest.mark.parametrize("name", INSTALLED)
def test_built_in_answers_are_found(name: str) -> None:
    solver = SOLVERS[name]
    for kind in ("definite", "inclined"):
        step, du, pressure = known_step(1, kind)
        assert solver.applies(step) is None
        answer = solver.solve(step, 1e-8)
        assert answer.claimed, answer.reason
        assert accuracy(step, answer.du, answer.pressure).worst <= REACHED
        np.testing.assert_allclose(answer.du, du, atol=1e-2)  # the largest is above 1
        np.testing.assert_allclose(answer.pressure, pressure, atol=1e-2)
        assert 0 <= answer.seconds < np.inf
        assert solver.keeps(step, answer, 1.0) in (True, None)


def test_no_quadratic_programme_of_what_is_not_convex() -> None:
    """Installed or not: a saddle point satisfies some of them (see contact.solvers.qp_backends)."""
    step, *_ = known_step()
    refused = {
        "not convex": indefinite(step),
        "not symmetric": lopsided(step),
        "consistent coupling": replace(step, coupling=sparse.csr_matrix(np.diag(step.weights))),
        "without area": replace(step, weights=np.where(step.gap > 0, step.weights, 0.0)),
    }
    for solver in SOLVERS.values():
        if isinstance(solver, Outside):
            for why, other in refused.items():
                assert why in str(solver.applies(other)), solver.name
    for name in ("nnls", "condensed QP, finished", "full QP, finished"):
        assert SOLVERS[name].applies(step) is None
        assert "not symmetric" in str(SOLVERS[name].applies(lopsided(step)))


def test_what_needs_no_function_solves_without_one() -> None:
    step, *_ = known_step()
    for name in ("semismooth", "Lemke", "active set"):
        answer = SOLVERS[name].solve(lopsided(step), 1e-8)
        assert answer.claimed
        assert accuracy(lopsided(step), answer.du, answer.pressure).worst < 1e-12
        assert accuracy(step, answer.du, answer.pressure).worst > 1e-6


def test_dense_solvers_refuse_what_is_large() -> None:
    n = DENSE + 1
    whole = sparse.eye_array(n, format="csc")
    large = FrozenStep(sparse.csc_matrix(whole), np.ones(n), sparse.csr_matrix(whole), np.ones(n), np.ones(n), 1.0)
    for name in ("DAQP", "quadprog", "qpsolvers", "OSQP, condensed"):
        assert "dense" in str(SOLVERS[name].applies(large))
    assert SOLVERS["OSQP"].applies(large) is None


def test_a_loose_tolerance_gives_a_loose_answer() -> None:
    """The tolerance arrives: first-order methods stop early, and say so rightly on a scaled programme."""
    step, *_ = known_step(1)
    for name in ("OSQP, scaled", "SCS, scaled"):
        worth = [accuracy(step, a.du, a.pressure).worst for a in (SOLVERS[name].solve(step, t) for t in (1e-2, 1e-9))]
        assert worth[0] > 1e3 * worth[1]


def test_what_is_missing_or_raises_says_so() -> None:
    assert Told("nobody", "no_such_module", "'another[extra]'").missing() == (
        "not installed: pip install 'another[extra]'"
    )
    assert Told("nobody", "no_such_module").missing() == "not installed: pip install no_such_module"
    answer = Broken("broken").solve(known_step()[0], 1e-8)
    assert not answer.claimed
    assert answer.reason == "ValueError: no such thing"


def test_the_own_criterion_is_that_of_the_programme_asked() -> None:
    """Of the same wrong answer: in mm and N it is below 1e-4 when the numbers are small, in a scaled programme not."""
    step, du, pressure = known_step(1)
    small = in_units(step, 1e-6, 1e-6)
    nothing = Answer(np.zeros_like(du), np.zeros_like(pressure), True)
    assert SOLVERS["OSQP"].keeps(small, nothing, 1e-4) is True
    assert SOLVERS["OSQP, scaled"].keeps(small, nothing, 1e-4) is False
    assert accuracy(small, nothing.du, nothing.pressure).worst > 0.1


# --- the settings of OSQP ---------------------------------------------------------------------------------------------

VARIANTS = {solver.name: solver for solver in ABLATION}


@pytest.mark.parametrize("scale", ["OSQP", "OSQP, scaled"])
def test_each_setting_is_there_and_finds_the_answer(scale: str) -> None:
    own = {name.split(": ")[1]: solver for name, solver in VARIANTS.items() if name.split(": ")[0] == scale}
    further = {"condensed"} if scale == "OSQP, scaled" else set()
    assert own.keys() == {*SETTINGS, "warm start", "reduced KKT"} | further
    assert (own["reduced KKT"].missing() is None) == bool(catalogue._algebra())
    step, *_ = known_step(1)
    for name, solver in own.items():
        if solver.missing() is None:
            answer = solver.solve(step, 1e-6)
            assert answer.claimed, f"{name}: {answer.reason}"
            assert accuracy(step, answer.du, answer.pressure).worst < 1e-4
    cold, warm = (own[name].solve(step, 1e-5).iterations for name in ("defaults", "warm start"))
    assert warm < cold


def test_settings_arrive() -> None:
    """Another first rho that is never adapted takes another number of iterations; a name OSQP does not know is told."""
    step, *_ = known_step(1)
    names = ("defaults", "rho 1e-3", "rho 1e3")
    assert len({VARIANTS[f"OSQP: {name}"].solve(step, 1e-8).iterations for name in names}) == 3
