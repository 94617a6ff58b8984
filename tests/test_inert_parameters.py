"""Parameters of tests that change nothing in what is solved: a planted one is found, those of the suite are known."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

from support.inert_parameters import HEADING, Variant, inert

TESTS = Path(__file__).parent
PLANTED = """
import pytest
from studies.scenes.complete import complete as resolve

@pytest.mark.parametrize("mu", [0.0, 0.3])
@pytest.mark.parametrize("mesh", ["8x1", "16x1"])
def test_friction(mesh, mu):
    scene, request = resolve("cantilever", {}, mesh)
    assert mu < 1
"""
HEMISPHERE = "tests/studies/scenes/test_cantilever_hemisphere.py"
KNOWN = {  # test: parameter, and why it changes no request
    "tests/studies/scenes/test_loads.py::test_an_edge_load_is_uniform_on_lines_of_any_spacing: cut": (
        "the request is changed afterwards"
    ),
    "tests/studies/solving/refinement/test_error_control.py::"
    "test_no_round_is_begun_beyond_the_budget_while_grids_fail: lacks": "its result is spoilt afterwards",
    "tests/studies/test_cli.py::test_a_refusal_is_an_outcome_and_one_line_of_a_solve: at": "another algorithm",
}


def listed(*arguments: str, cwd: Path = TESTS.parent) -> list[str]:
    """What the plugin lists at the end of a run of pytest."""
    paths = os.pathsep.join([str(TESTS.parent), str(TESTS)])
    run = [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", "-p", "support.inert_parameters", *arguments]
    done = subprocess.run(run, cwd=cwd, env={**os.environ, "PYTHONPATH": paths}, capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr
    after = done.stdout[done.stdout.index(HEADING) :].splitlines()[1:]
    return [line for line in after if line.partition(": ")[0].count("::")]


@pytest.mark.slow
def test_a_planted_parameter_is_found(tmp_path: Path) -> None:
    (tmp_path / "test_planted.py").write_text(PLANTED, encoding="utf-8")
    assert listed("--import-mode=importlib", "test_planted.py", cwd=tmp_path) == ["test_planted.py::test_friction: mu"]


def test_a_parameter_counts_where_the_others_are_the_same() -> None:
    asked = {(0, 0): "near", (0, 1): "near", (1, 0): "far", (1, 1): "farther"}
    variants = [
        Variant("test", {"a": str(a), "b": str(b), "alone": "x"}, frozenset({request}))
        for (a, b), request in asked.items()
    ]
    assert inert(variants) == []  # b has a say where a is 1
    assert inert(variants[:2]) == ["b"]
    assert inert([variants[0], variants[2]]) == []
    assert inert(variants[3:]) == []


@pytest.mark.slow
def test_parameters_of_the_suite_that_change_no_request_are_known() -> None:
    """Where a problem is solved by its name: the tests of scenes, commands and error control."""
    named = ("scenes", "test_cli.py", "solving/refinement/test_error_control.py")
    actual = listed("-m", "not slow", *(f"tests/studies/{name}" for name in named))
    assert actual == sorted(KNOWN)
