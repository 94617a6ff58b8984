"""A solve from Python needs numpy and scipy alone, also where a system has no processes to hold to limits."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
OPTIONAL = ("clarabel", "cvxpy", "markdown_it", "matplotlib", "osqp", "pandas", "PIL", "skfem")
SYSTEM = ("_multiprocessing", "fcntl", "resource", "termios")  # WebAssembly lacks the first and third, Windows the rest
SOLVE = """
import json, sys
gone = set(sys.argv[1].split(","))
class Refuse:
    def find_spec(self, name, path=None, target=None):
        if name in gone:
            raise ModuleNotFoundError(f"No module named {name!r}", name=name)
sys.meta_path.insert(0, Refuse())
import studies.footprint
run = studies.footprint.solve("tyre", mesh="6x6", mesh_error=False)
print(json.dumps([run.verdict, run.quantities["force_N"], sorted(gone & set(sys.modules))]))
"""


def solved(gone: tuple[str, ...]) -> subprocess.CompletedProcess[str]:
    words = [sys.executable, "-c", SOLVE, ",".join(gone)]
    return subprocess.run(words, cwd=ROOT, capture_output=True, text=True, check=False)


@pytest.mark.slow
def test_a_tyre_is_pressed_with_numpy_and_scipy_alone() -> None:
    bare, full = solved(OPTIONAL + SYSTEM), solved(("nothing",))
    assert bare.returncode == 0, bare.stderr
    verdict, force, loaded = json.loads(bare.stdout)
    assert (verdict, loaded) == ("converged", [])
    assert force == pytest.approx(json.loads(full.stdout)[1], rel=1e-12)


@pytest.mark.slow
def test_what_is_refused_is_missed() -> None:
    ended = solved(("scipy",))
    assert ended.returncode != 0
    assert "No module named 'scipy'" in ended.stderr
