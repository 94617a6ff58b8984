"""CalculiX on one deck, in a directory of its own that is gone afterwards."""

from __future__ import annotations

import re
import shutil
import subprocess
import tempfile
from collections.abc import Iterable
from pathlib import Path

from studies.ask.request import UsageError
from studies.exchange.problem import Problem
from studies.exchange.results import Found, read_results

NAME, COMMAND = "CalculiX", "ccx"
ABSENT = "bench programs needs CalculiX: the command ccx, of Debian's package calculix-ccx"
FINISHED = "Job finished"


def version() -> str:
    """Of the program that is installed, "ccx 2.20"; raises UsageError where there is none."""
    command = shutil.which(COMMAND)
    if command is None:
        raise UsageError(ABSENT)
    told = subprocess.run([command, "-v"], capture_output=True, text=True, check=False, timeout=60).stdout
    found = re.search(r"Version (\S+)", told)
    return f"{COMMAND} {found[1] if found else 'unknown'}"


def found_by(lines: Iterable[str], problem: Problem) -> list[Found]:
    """What it finds for a deck, step by step; raises UsageError where it does not come to the end."""
    command = shutil.which(COMMAND)
    if command is None:
        raise UsageError(ABSENT)
    with tempfile.TemporaryDirectory(prefix="footprint-") as place:
        folder = Path(place)
        (folder / "scene.inp").write_text("\n".join(lines) + "\n", encoding="ascii")
        run = subprocess.run([command, "scene"], cwd=folder, capture_output=True, text=True, check=False)
        if FINISHED not in run.stdout:
            said = next((line.strip() for line in run.stdout.splitlines() if "*ERROR" in line), "no reason told")
            raise UsageError(f"{NAME} does not come to the end of {problem.request.scene}: {said}")
        return read_results(folder / "scene.dat", problem)
