"""The tutorial of the README runs, stays short, and does what it says."""

from __future__ import annotations

import math
import re
from pathlib import Path

import numpy as np
import pytest

from formulations.measures import MEASURES
from formulations.quantities import N_Q, QUANTITIES, STRAINS
from studies.solve import resolve, solve

README = Path(__file__).parent.parent / "README.md"


@pytest.fixture
def tutorial(monkeypatch: pytest.MonkeyPatch) -> str:
    """The code of the README, executed on a copy of the catalogue; returns it."""
    (code,) = re.findall(r"```python\n(.*?)```", README.read_text(encoding="utf-8"), re.DOTALL)
    for name, measure in dict(MEASURES).items():
        monkeypatch.setitem(MEASURES, name, measure)
    monkeypatch.setitem(MEASURES, "no-drilling", None)
    exec(code, {})
    return code


def test_a_measure_takes_under_twenty_lines(tutorial: str) -> None:
    assert len([line for line in tutorial.splitlines() if line.strip()]) < 20


def test_the_new_measure_leaves_its_declared_strain(tutorial: str) -> None:
    theta = 0.7
    q = np.zeros(N_Q)
    for face in "-+":  # a rotation about the normal: l = c - 1, w1 = s, w2 = -s
        for name, value in (("l1", math.cos(theta) - 1), ("l2", math.cos(theta) - 1)):
            q[QUANTITIES.index(name + face)] = value
        q[QUANTITIES.index("w1" + face)] = math.sin(theta)
        q[QUANTITIES.index("w2" + face)] = -math.sin(theta)
    strain = MEASURES["no-drilling"].strain(q)
    declared = MEASURES["no-drilling"].rigid_body_law.drilling(theta, 1.0)
    assert strain[STRAINS.index("E11-")] == pytest.approx(declared, abs=1e-14)
    assert declared < -0.2


def test_the_new_measure_solves_a_scene(tutorial: str) -> None:
    found = solve(*resolve("tyre", {"delta_mm": "5"}, "12x12", measure="no-drilling"))
    assert found.outcome.converged
