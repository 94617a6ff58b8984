"""Every algorithm with friction on small problems against values written down once: whatever is rebuilt, they stay."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from contact.catalogue import ALGORITHMS
from contact.continuation.friction_path import follow
from contact.problem import ContactProblem, ContactSolution
from studies.arena.frictional_steps import random_step
from studies.experiments.friction.bars import Bar
from support.problems.frictional import manufactured
from support.problems.planted_friction import linear, planted, tied, with_mu

GOLDEN = json.loads(Path(__file__).with_name("golden.json").read_text(encoding="utf-8"))
EXACT = 1e-12  # of the largest
COUNTERS = ("newton_iterations", "factorisations", "assemblies", "set_changes")
WAYS: dict[str, tuple[str, dict[str, Any]]] = {
    "trial-and-error": ("trial-and-error", {}),
    "semismooth": ("semismooth", {}),
    "semismooth, settled": ("semismooth", {"settle": 0.0}),
    "semismooth on springs": ("semismooth", {"epsilon": 30.0}),
    "regularised": ("regularised", {"epsilon": 1e4}),
    "regularised, stiff": ("regularised", {"epsilon": 1e8}),
    "augmented-lagrangian": ("augmented-lagrangian", {}),
    "qp": ("qp", {}),
    "qp on discs": ("qp", {"backend": "clarabel"}),
    "lcp": ("lcp", {}),
    "lcp on springs": ("lcp", {"epsilon": 30.0}),
    "lcp, polygon": ("lcp", {"finish": False}),
}
EXACT_LAW = {"epsilon": np.inf}
BARS = {
    "strip": (Bar(10, 100.0, 1.0, press=0.5), (20.0, 0.0, -20.0)),
    "drum": (Bar(8, 200.0, 0.3, curvature=0.01, tension=10.0, held=True), (5.0, 2.5)),
}


def floating() -> ContactProblem:
    """Two masses and springs between them that only the foundation holds."""
    K, along, off = np.zeros((4, 4)), [0, 2], [1, 3]
    K[np.ix_(along, along)] = K[np.ix_(off, off)] = [[1.0, -1.0], [-1.0, 1.0]]
    G, S = np.eye(4)[off], np.zeros((4, 4))
    S[[0, 2]] = np.eye(4)[along]
    return linear(K, np.array([0.0, -1.0, 0.8, -1.0]), G, S, np.zeros(2), np.zeros((2, 2)), np.full(2, 0.5))


def problems() -> dict[str, ContactProblem]:
    """By name."""
    one = planted(5, 0.5).problem
    return {
        "planted": one,
        "mixed": with_mu(one, np.where(np.arange(7) % 2, 0.5, 0.0)),
        "one way": planted(6, 0.4, components=1).problem,
        "strong": planted(3, 1.0, m=10, coupled=0.8).problem,
        "smooth": planted(2, 0.0).problem,
        "tied": tied(3),
        "random": random_step(1).problem(),
        "random, another": random_step(4).problem(),
        "floating": floating(),
        "shared": manufactured(np.random.default_rng(0), 4, np.array([0, 1, 2, 2]))[0].problem(),
    }


def compare(found: ContactSolution, normal: np.ndarray, wanted: dict[str, Any]) -> None:
    """The answer with what is written down; where there is none, why alone."""
    assert found.outcome.word == wanted["outcome"]
    if not found.outcome.converged:
        return
    assert "".join("OSL"[state] for state in found.rubbed.state) == wanted["states"]
    assert [found.counters[name] for name in COUNTERS] == wanted["counts"]
    for name, values in (("u", found.u), ("normal", normal), ("friction", found.rubbed.force.ravel())):
        weighed = float(values @ np.cos(np.arange(1, len(values) + 1)))
        size = float(np.max(np.abs(values), initial=0.0))
        assert weighed == pytest.approx(wanted[name], rel=EXACT, abs=EXACT * size), name


@pytest.mark.parametrize("case", [name for name in GOLDEN if name.partition(": ")[2] in problems()])
def test_an_answer_is_what_it_was(case: str) -> None:
    way, _, name = case.partition(": ")
    kind, options = WAYS[way]
    problem = problems()[name]
    n = problem.coulomb.slip_jacobian(np.zeros(0)).shape[1]
    found = ALGORITHMS[kind](**EXACT_LAW | options).solve(problem, ContactSolution.at_rest(n, len(problem.weights)))
    compare(found, problem.nodal_forces(found.pressure), GOLDEN[case])


@pytest.mark.parametrize("name", BARS)
@pytest.mark.parametrize("way", ["semismooth", "regularised", "augmented-lagrangian", "qp", "lcp"])
def test_a_path_is_what_it_was(way: str, name: str) -> None:
    bar, pulls = BARS[name]
    kind, options = WAYS[way]
    states = list(follow(bar.stage_at, pulls, ALGORITHMS[kind](**EXACT_LAW | options), bar.rest))
    for pull, state in zip(pulls, states, strict=False):
        wanted = GOLDEN[f"{way}: {name} at {pull:g}"]
        compare(state.solution, bar.shares * state.solution.pressure, wanted)
        assert state.dissipation == pytest.approx(wanted["dissipation"], rel=EXACT, abs=EXACT)
