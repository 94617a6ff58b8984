"""Where a result comes from: version, commit, packages and machine of this process. Nothing here decides a result."""

from __future__ import annotations

import importlib.metadata
import os
import platform
import subprocess
from functools import cache
from pathlib import Path
from typing import Any

PACKAGES = ("numpy", "scipy", "scikit-fem", "pandas", "meshio", "osqp", "clarabel", "cvxpy")


@cache
def provenance() -> dict[str, Any]:
    """Asked for once: commit (or "unknown"), and whether the work tree differs from it (None where there is none)."""
    commit, changes = _git("rev-parse", "HEAD"), _git("status", "--porcelain", "--untracked-files=no")
    machine = {"system": platform.system(), "processor": platform.machine(), "cores": os.cpu_count()}
    return {
        "version": importlib.metadata.version("footprint"),
        "commit": commit or "unknown",
        "modified": None if changes is None else bool(changes),
        "packages": {name: _version(name) for name in PACKAGES},
        "machine": {**machine, "cpu": _cpu(), "python": platform.python_version()},
    }


def _git(*words: str) -> str | None:
    """What git says of the folder of this file; None when it says nothing of it."""
    try:
        said = subprocess.run(["git", *words], cwd=Path(__file__).parent, capture_output=True, text=True, check=False)
    except OSError:
        return None
    return None if said.returncode else said.stdout.strip()


def _version(package: str) -> str | None:
    try:
        return importlib.metadata.version(package)
    except importlib.metadata.PackageNotFoundError:
        return None


def _cpu() -> str:
    """The model of the processor, as far as the system tells."""
    try:
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines()
    except OSError:
        lines = []
    names = (line.partition(":")[2].strip() for line in lines if line.startswith("model name"))
    return next(names, platform.processor())
