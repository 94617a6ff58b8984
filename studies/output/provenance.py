"""Where a result comes from: version, commit, packages and machine of this process. Nothing here decides a result."""

from __future__ import annotations

import importlib.metadata
import os
import platform
import subprocess
from collections.abc import Mapping
from datetime import UTC, datetime
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import scipy

from studies.output import DISTRIBUTION

PACKAGES = (
    *("numpy", "scipy", "scikit-fem", "pandas", "meshio", "osqp", "clarabel", "cvxpy", "qdldl"),
    *("proxsuite", "piqp", "daqp", "pypardiso", "mkl", "ngsolve", "KratosMultiphysics"),
)
THREADS = ("OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "OMP_NUM_THREADS")
GIB = 2**30
UNKNOWN = "not told"


def provenance() -> dict[str, Any]:
    """As of now: commit (or "unknown"), and whether the work tree differs from it (None where there is none).

    Packages that are not installed have no entry. The date is that of the call; all the rest is asked for once.
    """
    return {**_steady(), "date": datetime.now(UTC).isoformat(timespec="seconds")}


def machine_of(origin: Mapping[str, Any]) -> str:
    """What decides a time, of a record's provenance: processor, cores, system, BLAS and its threads."""
    machine, blas = origin.get("machine") or {}, origin.get("blas") or {}
    cores = f"{machine['cores']} cores" if machine.get("cores") else ""
    brought = ", ".join(dict.fromkeys(str(version) for name, version in blas.items() if name != "threads"))
    threads = f"threads {blas['threads']}" if "threads" in blas else ""
    names = (machine.get("cpu"), cores, machine.get("system"), machine.get("processor"), brought, threads)
    return ", ".join(str(name) for name in names if name) or UNKNOWN


@cache
def _steady() -> dict[str, Any]:
    status = _git_status()
    versions = {name: _version(name) for name in PACKAGES}
    return {
        "version": _version(DISTRIBUTION),
        "commit": next((line.split()[-1] for line in status or () if line.startswith("# branch.oid ")), "unknown"),
        "modified": None if status is None else any(not line.startswith("#") for line in status),
        "packages": {name: version for name, version in versions.items() if version},
        "blas": {**{each.__name__: _blas(each) for each in (np, scipy)}, "threads": _threads()},
        "machine": _machine(),
    }


def _machine() -> dict[str, Any]:
    pages = {name: os.sysconf(name) for name in ("SC_PAGE_SIZE", "SC_PHYS_PAGES") if name in os.sysconf_names}
    memory = round(pages["SC_PAGE_SIZE"] * pages["SC_PHYS_PAGES"] / GIB, 1) if len(pages) == 2 else None
    return {
        "system": platform.system(),
        "processor": platform.machine(),
        "cores": os.cpu_count(),
        "memory_GiB": memory,
        "cpu": _cpu(),
        "python": platform.python_version(),
    }


def _blas(package: Any) -> str:
    """Name and version of the BLAS that a package was built with."""
    library = package.show_config(mode="dicts")["Build Dependencies"]["blas"]
    return " ".join(str(library[key]) for key in ("name", "version") if library.get(key))


def _threads() -> str:
    """How many threads BLAS was allowed, as the environment says; "any" where it says nothing."""
    return next((os.environ[name] for name in THREADS if os.environ.get(name)), "any")


def _git_status() -> list[str] | None:
    """The commit and the changed files of the work tree of this file, asked for at once; None without a work tree."""
    here = Path(__file__).parent
    if not any((folder / ".git").exists() for folder in here.parents):  # installed: no process is started
        return None
    options = ("--porcelain=v2", "--branch", "--no-ahead-behind", "--untracked-files=no")
    try:
        command = ("git", "--no-optional-locks", "status", *options)
        process = subprocess.run(command, cwd=here, capture_output=True, text=True, check=False)
    except OSError:
        return None
    return None if process.returncode else process.stdout.splitlines()


def _version(package: str) -> str | None:
    """From the head of the metadata; to parse them whole takes longer than all the rest here."""
    try:
        metadata = importlib.metadata.distribution(package).read_text("METADATA") or ""
    except importlib.metadata.PackageNotFoundError:
        return None
    return next((line[9:].strip() for line in metadata.splitlines() if line.startswith("Version: ")), None)


def _cpu() -> str:
    """The processor, as far as the system tells: its name, and the numbers of its family and model."""
    try:
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines()
    except OSError:
        lines = []
    fields = {key.strip(): value.strip() for key, _, value in (line.partition(":") for line in lines)}
    numbers = ", ".join(f"{key.split()[-1]} {fields[key]}" for key in ("cpu family", "model") if key in fields)
    name = fields.get("model name") or platform.processor()  # which starts a process to ask
    return f"{name} ({numbers})" if name and numbers else name
