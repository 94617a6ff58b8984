"""What every result tells of where it was made: versions, BLAS, machine, commit, date."""

from __future__ import annotations

import importlib.metadata
import os
import re
from datetime import UTC, datetime, timedelta
from pathlib import Path

import numpy as np
import pytest

from studies.output import provenance as module
from studies.output.provenance import PACKAGES, provenance

ROOT = Path(__file__).parents[2]
INFO = "model name\t: One CPU\ncpu family\t: 25\nmodel\t\t: 1\n\nmodel name\t: Another\n"


def test_packages_are_those_installed_with_their_versions() -> None:
    record = provenance()["packages"]
    there = {each.metadata["Name"]: each.version for each in importlib.metadata.distributions()}
    assert record == {name: there[name] for name in PACKAGES if name in there}
    assert {"numpy", "scipy", "scikit-fem", "pandas", "osqp", "clarabel", "cvxpy"} <= set(record)


def test_every_package_that_may_decide_a_result_is_among_them() -> None:
    """All that the project itself asks for, but for those that draw, test or talk."""
    text = (ROOT / "pyproject.toml").read_text(encoding="utf-8")
    asked = set(re.findall(r'^    "([\w-]+)>=', text, re.MULTILINE))
    asked |= {name for line in re.findall(r"^(?:mkl|qp) = \[(.*)\]", text, re.MULTILINE) for name in words(line)}
    others = {"markdown-it-py", "matplotlib", "distributed", "hatchling", "hypothesis", "mypy", "pandas-stubs"}
    others |= {"hatch-vcs", "pillow", "pytest", "pytest-xdist", "ruff", "scipy-stubs", "sympy"}
    others |= {"KratosLinearSolversApplication", "KratosStructuralMechanicsApplication"}  # of one version with Kratos
    assert asked - others <= set(PACKAGES)


def words(line: str) -> list[str]:
    return re.findall(r'"([\w-]+)>=', line)


def test_blas_is_the_one_that_numpy_names_and_its_threads(monkeypatch: pytest.MonkeyPatch) -> None:
    record = provenance()["blas"]
    built = np.show_config(mode="dicts")["Build Dependencies"]["blas"]
    assert record["numpy"] == f"{built['name']} {built['version']}"
    assert record["scipy"]
    for name in module.THREADS:
        monkeypatch.delenv(name, raising=False)
    assert module._threads() == "any"
    monkeypatch.setenv("OMP_NUM_THREADS", "3")
    assert module._threads() == "3"


def test_machine_names_processor_cores_and_memory(monkeypatch: pytest.MonkeyPatch) -> None:
    record = provenance()["machine"]
    assert record["cores"] == os.cpu_count()
    assert record["memory_GiB"] > 0.1
    monkeypatch.setattr(Path, "read_text", lambda self, **how: INFO)
    assert module._cpu() == "Another (family 25, model 1)"
    monkeypatch.setattr(Path, "read_text", lambda self, **how: "Features\t: fp\n")
    monkeypatch.setattr(module.platform, "processor", lambda: "arm")
    assert module._cpu() == "arm"


def test_the_date_is_that_of_the_call_and_the_rest_is_asked_for_once(monkeypatch: pytest.MonkeyPatch) -> None:
    first = provenance()
    monkeypatch.setattr(module.subprocess, "run", None)
    again = provenance()
    assert {**first, "date": ""} == {**again, "date": ""}
    assert timedelta() <= datetime.now(UTC) - datetime.fromisoformat(again["date"]) < timedelta(minutes=1)
