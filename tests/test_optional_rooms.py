"""Rooms that a plain solve does without: benchmarks, the arena, other programs, experiments, conclusions."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
OURS = ("formulations", "contact", "studies", "reports")
WITHOUT = (
    *("formulations.element.walls", "formulations.element.quad_element", "formulations.element.arc_element"),
    *("formulations.section.laws", "formulations.geometry.quadtree", "contact.coulomb", "contact.newton.condensed"),
    *("studies.arena", "studies.bench", "studies.exchange", "studies.experiments", "studies.analysis"),
    *(
        "studies.fuzz",
        "studies.gate",
        "studies.run",
        "studies.solving.friction_stages",
        "studies.solving.load_steps",
        "reports",
    ),
)
MOST = 95  # modules of ours
SOLVED = """
import sys
from studies.cli import main
main(["solve", "hemisphere", "--set", "load_fraction=0.1", "--out", sys.argv[1]])
print(*sys.modules, file=open(sys.argv[1] + "/modules", "w"))
"""


@pytest.fixture(scope="module")
def loaded(tmp_path_factory: pytest.TempPathFactory) -> set[str]:
    """Modules of ours after ``footprint solve hemisphere``."""
    out = tmp_path_factory.mktemp("solved")
    environment = {**os.environ, "OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"}
    subprocess.run([sys.executable, "-c", SOLVED, str(out)], cwd=ROOT, env=environment, capture_output=True, check=True)
    names = (out / "modules").read_text(encoding="utf-8").split()
    return {name for name in names if name.split(".")[0] in OURS}


@pytest.mark.parametrize("room", WITHOUT)
def test_a_solve_of_the_hemisphere_loads_nothing_of(room: str, loaded: set[str]) -> None:
    assert loaded
    assert {name for name in loaded if name == room or name.startswith(f"{room}.")} == set()


def test_a_solve_of_the_hemisphere_loads_no_more_than_it_did(loaded: set[str]) -> None:
    assert len(loaded) <= MOST
