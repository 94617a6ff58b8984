"""The collection and the held-out tier on this machine, and as on one of other kernels, without wide instructions."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from studies.arena.collected.collection import ROUNDING
from support.problems.kernels import Found, drawn, product, wrong

ROOT = Path(__file__).parents[3]

ROUNDED = 1e-9  # mm: of a gap that is closed

pytestmark = pytest.mark.slow


def elsewhere(directory: Path) -> Found:
    """What a process finds that has other kernels than this one."""
    config = np.show_config(mode="dicts")
    if "DYNAMIC_ARCH" not in config["Build Dependencies"]["blas"].get("openblas configuration", ""):
        pytest.skip("the BLAS of numpy has the kernels of one processor alone")
    own = os.environ.get("OPENBLAS_CORETYPE", "")
    environment = {
        **os.environ,
        "OPENBLAS_CORETYPE": "Haswell" if own == "Prescott" else "Prescott",
        "NPY_DISABLE_CPU_FEATURES": " ".join(config["SIMD Extensions"]["found"]),
        "PYTHONPATH": os.pathsep.join((str(ROOT), str(ROOT / "tests"))),
    }
    command = [sys.executable, "-m", "support.problems.kernels", str(directory)]
    done = subprocess.run(command, env=environment, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    return Found(**json.loads(done.stdout))


def test_a_sample_of_the_kept_manifest_is_made_and_certified_again(tmp_path: Path) -> None:
    assert wrong(tmp_path) == []


def test_it_is_the_same_and_certified_with_other_kernels(tmp_path: Path) -> None:
    """So are the held-out problems: whoever judges need not have the machine of who drew them."""
    other = elsewhere(tmp_path)
    if other.product == product():
        pytest.skip("the BLAS of numpy does not heed OPENBLAS_CORETYPE on this processor")
    assert other.wrong == []
    own = drawn()
    assert other.held_out.keys() == own.keys()
    for name, values in other.held_out.items():
        assert values == pytest.approx(own[name], rel=ROUNDING, abs=ROUNDED), name
