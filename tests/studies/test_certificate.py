"""Every entry of ``steps`` carries the judge's certificate, by the law of the algorithm's epsilon."""

from __future__ import annotations

import math
from dataclasses import replace

import pytest

from contact.catalogue import ALGORITHMS
from contact.problem import ContactSolution
from studies.solving import certificate, resolve, solve

KEYS = {"failures", "diagnosis", "kkt", "balances", "rounding"}
MESH = "12x12"


@pytest.fixture(scope="module")
def tyre():
    return pressed({})


def pressed(given: dict[str, str], contact: str = "semismooth"):
    """A tyre at 8 mm: its last problem, its state, and the result."""
    found = solve(*resolve("tyre", {"delta_mm": "8", **given}, MESH, contact=contact, model="full"))
    assert found.outcome.converged
    assert all(set(step) >= KEYS for step in found.steps)
    assert [step["failures"] + step["diagnosis"] for step in found.steps] == [[]] * len(found.steps)
    inflation, press = found.model.stages()
    problem_at, rest = inflation.begin(None)
    inflated = ALGORITHMS["semismooth"]().solve(problem_at(1.0), rest)
    return press.begin(inflated)[0](press.targets[-1]), found.last, found


def test_a_converged_tyre_is_certified(tyre) -> None:
    problem, state, found = tyre
    again = certificate(problem, state)
    assert again["failures"] == []
    assert set(again["balances"]) == set(found.steps[-1]["balances"]) == {"energy", "force"}
    assert max(again["balances"].values()) <= 1e-10


@pytest.mark.slow
@pytest.mark.parametrize(
    ("spoil", "name"),
    [
        (lambda s: replace(s, pressure=-s.pressure), "sign flip"),
        (lambda s: replace(s, pressure=1e3 * s.pressure), "wrong units"),
        (lambda s: replace(s, u=1.00001 * s.u), "unconverged equilibrium"),
        (lambda s: replace(s, pressure=0 * s.pressure), "stale pressure"),
    ],
)
def test_a_spoilt_tyre_is_not_and_says_why(tyre, spoil, name) -> None:
    problem, state, _ = tyre
    found = certificate(problem, spoil(state))
    assert "equilibrium" in found["failures"]
    assert found["balances"]["energy"] > 1e-8
    (finding,) = found["diagnosis"]
    assert finding.startswith(name)


def test_a_regularised_state_is_certified_by_its_own_law_only() -> None:
    problem, state, found = pressed({"epsilon": "1e4"}, "trial-and-error")
    assert found.steps[-1]["kkt"]["penetration"] > 1e-6  # the true one is told
    assert certificate(problem, state, 1e4)["failures"] == []
    assert certificate(problem, state, 5e3)["failures"] == ["complementarity"]
    assert "penetration" in certificate(problem, state, math.inf)["failures"]


def test_scenes_without_contact_are_certified_too() -> None:
    for scene, balances in (("cantilever", {"energy", "force"}), ("pressurised-sphere", {"force"})):
        found = solve(*resolve(scene, {}, "4x2" if scene == "cantilever" else "6x6"))
        for step in found.steps:
            assert set(step) >= KEYS
            assert step["failures"] == []
            assert set(step["balances"]) == balances
            assert max(step["balances"].values()) <= 1e-8


def test_a_state_of_rest_is_certified_against_an_open_foundation(tyre) -> None:
    """Zero displacement under load is no equilibrium, and is named so."""
    problem, state, _ = tyre
    rest = ContactSolution.at_rest(len(state.u), len(state.pressure))
    assert "equilibrium" in certificate(problem, rest)["failures"]
