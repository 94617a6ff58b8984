"""Answers from outside: what is right is certified, and each false claim is found by what it is off."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from studies.arena.answers import Given, judge_answer, read_answer
from studies.ask.request import UsageError
from support.problems.arena_steps import known_step

STRANGER = Path(__file__).with_name("stranger.py")


def given(**claims: Any) -> tuple[Any, Given]:
    """A step and its answer, with claims about it."""
    step, du, pressure = known_step()
    return step, Given(du, pressure, claims)


def test_a_right_answer_is_certified_and_its_claims_are_true() -> None:
    step, answer = given()
    truth = {"accuracy": 1e-12, "equilibrium": 1e-12, "force": float(np.sum(step.weights * answer.pressure))}
    truth["pressed"] = np.flatnonzero(answer.pressure > 0).tolist()
    found = judge_answer(step, Given(answer.du, answer.pressure, truth))
    assert found.sound
    assert len(found.claims) == 4


@pytest.mark.parametrize("what", ["accuracy", "equilibrium", "penetration", "force", "pressed"])
def test_a_false_claim_is_named(what: str) -> None:
    """du off by 1e-3 of its size: certified at 1, but nothing that is claimed of a better one is true."""
    step, answer = given()
    off = answer.du * (1 + 1e-3)
    forces = float(np.sum(step.weights * answer.pressure))
    said: dict[str, Any] = {"accuracy": 1e-9, "equilibrium": 1e-9, "penetration": 1e-12, "force": forces * 1.001}
    said["pressed"] = np.flatnonzero(answer.pressure > 0).tolist()[1:]
    found = judge_answer(step, Given(off, answer.pressure, {what: said[what]}), asked=1.0)
    assert found.certified
    assert not found.sound
    assert f"claim {what}" in "\n".join(found.lines())
    (false,) = (line for line in found.lines() if line.startswith(f"claim {what} ") and "FALSE" in line)
    assert {"force": " of the larger of it and F, ", "pressed": " candidates, "}.get(what, " times, ") in false


def test_residuals_are_those_of_the_equations() -> None:
    """Of a du that is off, by the definitions, without the module that computes them."""
    step, answer = given()
    du = answer.du + 1e-4
    found = judge_answer(step, Given(du, answer.pressure, {}))
    forces, gap = step.weights * answer.pressure, step.gap + step.G @ du
    F, L = found.force_N, found.length_mm
    assert found.residuals["equilibrium"] == pytest.approx(np.linalg.norm(step.K @ du + step.r - step.G.T @ forces) / F)
    assert found.residuals["penetration"] == pytest.approx(max(float(-gap.min()), 0) / L)
    assert found.residuals["complementarity"] == pytest.approx(float(np.abs(forces) @ np.abs(gap)) / (F * L))
    assert not found.certified


@pytest.mark.parametrize("suffix", [".json", ".npz"])
def test_answers_are_read_from_both_formats(suffix: str, tmp_path: Path) -> None:
    step, answer = given()
    path, claims = tmp_path / f"answer{suffix}", {"accuracy": 1e-9}
    if suffix == ".json":
        told = {"du": answer.du.tolist(), "pressure": answer.pressure.tolist(), "claims": claims}
        path.write_text(json.dumps(told), encoding="utf-8")
    else:
        np.savez(path, du=answer.du, pressure=answer.pressure, claims=np.array(json.dumps(claims)))
    found = read_answer(path)
    assert np.array_equal(found.du, answer.du)
    assert np.array_equal(found.pressure, answer.pressure)
    assert found.claims == claims
    assert judge_answer(step, found).sound


@pytest.mark.parametrize(
    ("told", "fault"),
    [
        ('{"du": [1.0]}', "'pressure' is missing"),
        ('{"du": [[1.0]], "pressure": []}', "each be a list of numbers"),
        ('{"du": [1.0], "pressure": [1.0], "claims": {"speed": 3}}', "claim 'speed' must be one of accuracy"),
        ('{"du": [1.0], "pressure": [1.0], "claims": []}', "claims must be a JSON object"),
        ("[]", "must be a JSON object"),
        ("{", "is no answer"),
    ],
)
def test_what_is_no_answer_is_refused_in_a_line(told: str, fault: str, tmp_path: Path) -> None:
    path = tmp_path / "answer.json"
    path.write_text(told, encoding="utf-8")
    with pytest.raises(UsageError, match=fault) as error:
        read_answer(path)
    assert "\n" not in str(error.value)


@pytest.mark.parametrize(("what", "said"), [("accuracy", -1.0), ("force", "big"), ("pressed", [1000]), ("pressed", 3)])
def test_a_claim_out_of_its_range_is_refused(what: str, said: object) -> None:
    with pytest.raises(UsageError, match=what):
        judge_answer(*given(**{what: said}))


def test_numbers_that_are_none_are_not_certified() -> None:
    step, answer = given()
    assert not judge_answer(step, Given(answer.du * np.nan, answer.pressure, {"accuracy": 1e-3})).sound


def test_an_answer_of_another_problem_is_refused() -> None:
    step, answer = given()
    with pytest.raises(UsageError, match="unknowns"):
        judge_answer(step, Given(answer.du[:-1], answer.pressure, {}))


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
    found = judge_answer(step, read_answer(answer))
    assert found.sound
    assert {claim.what for claim in found.claims} == {"accuracy", "pressed"}
