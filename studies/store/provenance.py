"""Where a result comes from: version, commit, packages and machine of this process. Nothing here decides a result."""

from __future__ import annotations

import importlib.metadata
import os
import platform
import subprocess
from functools import cache
from pathlib import Path
from typing import Any

PACKAGES = ("numpy", "scipy", "scikit-fem", "pandas", "osqp", "clarabel", "cvxpy")


@cache
def provenance() -> dict[str, Any]:
    """Asked for once: commit (or "unknown"), and whether the work tree differs from it (None where there is none)."""
    told = _git_status()
    machine = {"system": platform.system(), "processor": platform.machine(), "cores": os.cpu_count()}
    return {
        "version": _version("footprint"),
        "commit": next((line.split()[-1] for line in told or () if line.startswith("# branch.oid ")), "unknown"),
        "modified": None if told is None else any(not line.startswith("#") for line in told),
        "packages": {name: _version(name) for name in PACKAGES},
        "machine": {**machine, "cpu": _cpu(), "python": platform.python_version()},
    }


def _git_status() -> list[str] | None:
    """The commit and the changed files of the work tree of this file, asked for at once; None without a work tree."""
    here = Path(__file__).parent
    if not any((folder / ".git").exists() for folder in here.parents):  # installed: no process is started
        return None
    words = ("git", "--no-optional-locks", "status", "--porcelain=v2", "--branch", "--no-ahead-behind")
    try:
        said = subprocess.run([*words, "--untracked-files=no"], cwd=here, capture_output=True, text=True, check=False)
    except OSError:
        return None
    return None if said.returncode else said.stdout.splitlines()


def _version(package: str) -> str | None:
    """From the head of the metadata; to parse them whole takes longer than all the rest here."""
    try:
        told = importlib.metadata.distribution(package).read_text("METADATA") or ""
    except importlib.metadata.PackageNotFoundError:
        return None
    return next((line[9:].strip() for line in told.splitlines() if line.startswith("Version: ")), None)


def _cpu() -> str:
    """The model of the processor, as far as the system tells."""
    try:
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines()
    except OSError:
        lines = []
    names = (line.partition(":")[2].strip() for line in lines if line.startswith("model name"))
    return next(names, "") or platform.processor()  # which starts a process to ask
