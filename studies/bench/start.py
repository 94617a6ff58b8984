"""Processes of Python for the time that they take: what a command loads, beside what nothing is solved without."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path

from studies.pool.process import ONE_THREAD
from studies.store.source_hash import ROOT

FLOOR = ("-c", "import numpy, scipy.linalg, scipy.sparse.linalg")  # nothing is solved without
REFUSED = ("-m", "studies.cli", "solve", "tyre", "--mesh", "0x0", "--out", "unused")  # once all that solves is loaded


def child(words: Sequence[str], compiled: Path, code: int = 0) -> None:
    """Run Python on one thread to the end, with this exit code; what it compiles is kept, as on installation."""
    path = os.pathsep.join([str(ROOT), *filter(None, [os.environ.get("PYTHONPATH")])])
    environment = {**os.environ, **ONE_THREAD, "PYTHONPATH": path, "PYTHONPYCACHEPREFIX": str(compiled / "compiled")}
    environment.pop("PYTHONDONTWRITEBYTECODE", None)
    done = subprocess.run([sys.executable, "-P", *words], env=environment, capture_output=True, check=False)
    assert done.returncode == code, done.stderr
