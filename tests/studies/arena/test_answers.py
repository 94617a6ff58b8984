"""What an answer is worth: right ones of any size pass, wrong ones do not, and each false claim is found."""

from __future__ import annotations

import json
import subprocess
import sys
from dataclasses import asdict, astuple, replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy import sparse

from contact.interchange.linearised_step import FrozenStep
from contact.solvers.qp_backends import Answer, Programme
from studies.arena.answers import Accuracy, Given, Scales, accuracy, judge_answer, read_answer
from studies.ask.request import UsageError
from studies.experiments.false_success import keeps
from support.problems.contact_problems import in_units, indefinite, known_step, lopsided


def residuals_by_hand(step: FrozenStep, du: np.ndarray, p: np.ndarray) -> dict[str, float]:
    """The four residuals, see :mod:`studies.arena.answers`, of which no line is used here."""
    eps, K, G, g, r = np.finfo(float).eps, step.K.toarray(), step.G.toarray(), step.gap, step.r
    nodal, held = step.weights * p, max(1 / sum(G[i] ** 2 / abs(np.diag(K))) for i in range(len(g)) if G[i].any())
    f = nodal if step.coupling is None else step.coupling.toarray() @ p
    i, deepest = np.argmin(g), max(-g.min(), 0.0)
    compliance = G[i] @ np.linalg.solve(K, G[i])
    pushed = np.linalg.norm(G[i]) * deepest / compliance if deepest and compliance > 0 else 0.0
    F = max(step.scale, np.linalg.norm(r), pushed)
    L = max(deepest, F / held, min(max(abs(G @ du)), max(abs(g))))
    balance, terms = K @ du + r - G.T @ f, abs(K) @ abs(du) + abs(r) + abs(G).T @ abs(f)
    s, rounding = g + G @ du, eps * (abs(g) + abs(G) @ abs(du))
    return {
        "equilibrium": max(np.linalg.norm(balance) - eps * np.linalg.norm(terms), 0.0) / F,
        "penetration": max(max(-s - rounding), 0.0) / L,
        "tension": max(max(-nodal), 0.0) / F,
        "complementarity": sum(abs(nodal) * np.maximum(abs(s) - rounding, 0.0)) / (F * L),
    }


ROUNDING = 1e-13  # of an answer that was built in, whose own data are sums of it
STRANGER = Path(__file__).with_name("stranger.py")


def one_spring(k: float = 2.0, r: float = -6.0, gap: float = 1.0, scale: float = 0.0) -> FrozenStep:
    """One unknown on a spring k [N/mm], pulled down by -r, over a floor: k du + r = -f, gap - du >= 0."""
    K, G = sparse.csc_matrix([[k]]), sparse.csr_matrix([[-1.0]])
    return FrozenStep(K, np.array([r]), G, np.array([gap]), np.array([0.5]), scale)


# --- accuracy ---------------------------------------------------------------------------------------------------------


def test_built_in_answers_are_exact_and_an_error_is_seen_in_proportion() -> None:
    for kind in ("definite", "obstacle", "inclined"):
        for seed in range(5):
            step, du, pressure = known_step(seed, kind)
            assert accuracy(step, du, pressure).worst <= ROUNDING
            assert accuracy(step, du, pressure).complementarity == 0
            for t in (0.0, 0.5, 2.0, 1e3, 1e9):
                assert accuracy(step, t * du, t * pressure).worst > 1e-2
    step, du, pressure = known_step(2)
    for error in (1e-3, 1e-5, 1e-7, 1e-9):
        assert 0.05 * error < accuracy(step, du, pressure * (1 + error)).worst < 20 * error
    # consistent coupling has forces of its own
    W = sparse.diags_array(step.weights).tocsr() + sparse.csr_matrix(np.full((len(pressure),) * 2, 0.05))
    r = step.r + step.G.T @ (W @ pressure - step.weights * pressure)
    coupled = replace(step, coupling=sparse.csr_matrix(W), r=r)
    assert accuracy(coupled, du, pressure).worst <= ROUNDING
    assert accuracy(replace(coupled, coupling=None), du, pressure).worst > 1e-3


def test_residuals_are_those_of_the_definition(rng: np.random.Generator) -> None:
    """Of answers that are off, in dense numpy without a line of the module that computes them."""
    step, *_ = known_step(5)
    coupled = replace(step, coupling=sparse.csr_matrix(np.diag(step.weights) + 0.02))
    stiff = replace(step, K=1e3 * step.K, gap=np.abs(step.gap))  # whose length is the largest gap
    for each in (step, replace(step, gap=step.gap - 0.5), indefinite(step), lopsided(step), coupled, stiff):
        du, pressure = rng.normal(size=step.r.shape), rng.normal(size=step.gap.shape)
        computed = asdict(accuracy(each, du, pressure))
        assert computed == pytest.approx(residuals_by_hand(each, du, pressure), rel=1e-9)


def test_residuals_by_hand() -> None:
    """At du = 1 the floor carries 4 N over 0.5 mm^2; F = |r| = 6 N, and L = F/k = 3 mm, more than the largest gap."""
    step = one_spring()
    assert accuracy(step, np.array([1.0]), np.array([8.0])) == Accuracy(0.0, 0.0, 0.0, 0.0)
    deep = accuracy(step, np.array([1.3]), np.array([6.8]))
    assert astuple(deep) == pytest.approx((0.0, 0.3 / 3, 0.0, 3.4 * 0.3 / (6 * 3)), abs=ROUNDING)
    pulled = accuracy(step, np.array([1.0]), np.array([-2.0]))
    assert (pulled.tension, pulled.equilibrium) == pytest.approx((1 / 6, 5 / 6))


def test_scales_by_hand() -> None:
    assert Scales.of(one_spring()) == Scales(6.0, 3.0, 1.0)
    assert Scales.of(one_spring(scale=50.0)) == Scales(50.0, 25.0, 1.0)
    assert astuple(Scales.of(one_spring(r=0.0, gap=-0.7))) == pytest.approx((1.4, 0.7, 0.7))  # a spring pushed 0.7 mm
    assert Scales.of(one_spring(r=0.0)) == Scales(2.0, 1.0, 1.0)  # nothing happens
    # K = 0 has no compliance; with no force in the file, nothing pushes it back
    free = replace(one_spring(r=-6.0, gap=-1.0), K=sparse.csc_matrix((1, 1)))
    assert Scales.of(free).force == 6.0
    assert accuracy(free, np.array([-1.0]), np.array([12.0])).worst <= ROUNDING


def test_an_inflated_answer_is_not_accepted() -> None:
    """Forces f >= 0 whose response opens all gaps: t f balances for any t, and relative to itself r vanishes."""
    step, *_ = known_step()
    C = step.G @ np.linalg.solve(step.K.toarray(), step.G.toarray().T)
    f = np.linalg.solve(C, np.ones(len(step.gap)))  # opens every gap by t
    push = np.maximum(f, 0.0)
    assert np.all(C @ push > 0)
    programme = Programme(step.K, step.r, sparse.csc_matrix(step.G), -step.gap)
    worth = []
    for t in (1e2, 1e6, 1e10, 1e14):
        large = np.linalg.solve(step.K.toarray(), step.G.T @ (t * push))  # without r: it is lost anyway
        worth.append(accuracy(step, large, t * push / step.weights).worst)
    assert keeps(programme, Answer(large, t * push, True, ""), 1e-8)
    assert min(worth) > 1.0
    assert worth == sorted(worth)


def test_scales_ignore_the_answer_and_units() -> None:
    """A foundation that presses twice as hard is as wrong as the difference, however large the answer has become."""
    step, du, pressure = known_step()
    worth = [accuracy(step, du, pressure * t).equilibrium / (t - 1) for t in (2.0, 2e3, 2e6)]
    np.testing.assert_allclose(worth, worth[0], rtol=1e-9)
    step, du, pressure = known_step(3)
    rng = np.random.default_rng(1)
    off, press = du + 1e-3 * rng.normal(size=du.shape), pressure * (1 + 1e-3 * rng.normal(size=pressure.shape))
    here = accuracy(step, off, press).worst
    assert 1e-5 < here < 1e-1
    for force, length in ((1e6, 1.0), (1e-6, 1.0), (1.0, 1e-3), (1e3, 1e3)):
        there = accuracy(in_units(step, force, length), off * length, press * force)
        assert there.worst == pytest.approx(here, rel=1e-9)


def test_rounding_is_no_error_but_ten_times_it_is() -> None:
    """A thin beam in two unknowns: what a last digit of du costs is far above 1e-9 of the load."""
    stiff = 1e12
    K = sparse.csc_matrix([[stiff + 1.0, -stiff], [-stiff, stiff + 1.0]])
    step = FrozenStep(K, np.array([-1.0, -1.0]), sparse.csr_matrix((0, 2)), np.zeros(0), np.zeros(0), 1.0)
    du = np.array([1.0, np.nextafter(1.0, 2.0)])
    assert np.linalg.norm(K @ du + step.r) > 1e-5
    assert accuracy(step, du, np.zeros(0)).worst == 0.0
    assert accuracy(step, np.array([1.0, 1.0 + 1e-14]), np.zeros(0)).worst > 1e-3


def test_what_is_no_number_is_worth_nothing_and_another_size_is_refused() -> None:
    step, du, pressure = known_step()
    with pytest.raises(ValueError, match="candidates"):
        accuracy(step, du[:-1], pressure)
    for bad in (np.nan, np.inf, 1e300):
        du[0] = bad
        assert accuracy(step, du, pressure).worst > 1e100
    assert not judge_answer(step, Given(du * np.nan, pressure, {"accuracy": 1e-3})).sound


# --- answers from outside ---------------------------------------------------------------------------------------------


def test_a_right_answer_of_either_format_is_certified_and_its_claims_are_true(tmp_path: Path) -> None:
    step, du, pressure = known_step()
    claims = {"accuracy": 1e-12, "equilibrium": 1e-12, "force": float(np.sum(step.weights * pressure))}
    claims["pressed"] = np.flatnonzero(pressure > 0).tolist()
    fields = {"du": du.tolist(), "pressure": pressure.tolist(), "claims": claims}
    (tmp_path / "answer.json").write_text(json.dumps(fields), encoding="utf-8")
    np.savez(tmp_path / "answer.npz", du=du, pressure=pressure, claims=np.array(json.dumps(claims)))
    for suffix in ("json", "npz"):
        answer = read_answer(tmp_path / f"answer.{suffix}")
        assert np.array_equal(answer.du, du)
        assert np.array_equal(answer.pressure, pressure)
        judgement = judge_answer(step, answer)
        assert judgement.sound
        assert len(judgement.claims) == 4


def test_a_false_claim_is_named() -> None:
    """du off by 1e-3 of its size: certified at 1, but nothing that is claimed of a better one is true."""
    step, du, pressure = known_step()
    claims: dict[str, Any] = {"accuracy": 1e-9, "equilibrium": 1e-9, "penetration": 1e-12}
    claims["force"] = float(np.sum(step.weights * pressure)) * 1.001
    claims["pressed"] = np.flatnonzero(pressure > 0).tolist()[1:]
    for what, value in claims.items():
        judgement = judge_answer(step, Given(du * (1 + 1e-3), pressure, {what: value}), asked=1.0)
        assert judgement.certified
        assert not judgement.sound
        (false,) = (line for line in judgement.lines() if line.startswith(f"claim {what} ") and "FALSE" in line)
        assert {"force": " of the larger of it and F, ", "pressed": " candidates, "}.get(what, " times, ") in false


def test_what_is_no_answer_is_refused_in_a_line(tmp_path: Path) -> None:
    path = tmp_path / "answer.json"
    for text, fault in (
        ('{"du": [1.0]}', "'pressure' is missing"),
        ('{"du": [[1.0]], "pressure": []}', "each be a list of numbers"),
        ('{"du": [1.0], "pressure": [1.0], "claims": {"speed": 3}}', "claim 'speed' must be one of accuracy"),
        ('{"du": [1.0], "pressure": [1.0], "claims": []}', "claims must be a JSON object"),
        ("[]", "must be a JSON object"),
        ("{", "is not an answer"),
    ):
        path.write_text(text, encoding="utf-8")
        with pytest.raises(UsageError, match=fault) as error:
            read_answer(path)
        assert "\n" not in str(error.value)
    step, du, pressure = known_step()
    with pytest.raises(UsageError, match="unknowns"):
        judge_answer(step, Given(du[:-1], pressure, {}))
    for what, value in (("accuracy", -1.0), ("force", "big"), ("pressed", [1000]), ("pressed", 3)):
        with pytest.raises(UsageError, match=what):
            judge_answer(step, Given(du, pressure, {what: value}))


def test_a_stranger_reads_solves_and_is_judged(tmp_path: Path) -> None:
    """With numpy and scipy, isolated from this suite, in fewer than 30 lines."""
    text = STRANGER.read_text(encoding="utf-8")
    imported = [line for line in text.splitlines() if line.startswith(("import", "from"))]
    assert len(text.splitlines()) < 30
    assert not any("studies" in line or "contact" in line for line in imported)
    step, _, _ = known_step()
    problem, answer = tmp_path / "problem.npz", tmp_path / "answer.json"
    step.write(problem)
    subprocess.run([sys.executable, "-I", str(STRANGER), str(problem), str(answer)], check=True)
    judgement = judge_answer(step, read_answer(answer))
    assert judgement.sound
    assert {claim.what for claim in judgement.claims} == {"accuracy", "pressed"}
