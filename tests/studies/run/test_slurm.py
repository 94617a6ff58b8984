"""The recipe for SLURM in the manual, line by line, with stand-ins for the commands of SLURM."""

from __future__ import annotations

import os
import re
import socket
import subprocess
import sys
from pathlib import Path

import pytest

from support.stores.campaigns import content, small

MANUAL = Path(__file__).parents[3] / "reports" / "manual" / "cluster.md"
# what sbatch(1) says of these options: --parsable prints the number of the job alone, --wrap is a script of sh for each
# task of the array, which runs in the directory of the call; scancel(1) stops a task by SIGTERM
SBATCH = """#!/bin/sh
for option in "$@"; do case "$option" in
    --parsable|--array=1-64|--cpus-per-task=1|--mem=*G|--time=*:*:*|--wrap) ;;
    --*) echo "sbatch: unrecognized option '$option'" >&2; exit 1 ;;
    *) script=$option ;;
esac; done
for task in 1 2; do
    SLURM_ARRAY_TASK_ID=$task sh -c "$script" >"$JOBS/slurm-7_$task.out" 2>&1 &
    echo $! >>"$JOBS/7"
done
echo 7
"""
SCANCEL = """#!/bin/sh
kill $(cat "$JOBS/$1")
"""
HOSTNAME = """#!/bin/sh
echo 127.0.0.1
"""


def free_port() -> int:
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return int(probe.getsockname()[1])


@pytest.mark.slow
def test_the_recipe_makes_the_same_store_and_leaves_nothing_running(solved: Path, tmp_path: Path) -> None:
    """Two tasks of the array find a place; the port, the programs and the campaign are those of the test."""
    pytest.importorskip("distributed", reason="needs the extra dask")
    (recipe,) = (each for each in re.findall(r"```sh\n(.*?)```", MANUAL.read_text(), re.DOTALL) if "sbatch" in each)
    (tmp_path / "bin").mkdir()
    for name, text in {"sbatch": SBATCH, "scancel": SCANCEL, "hostname": HOSTNAME}.items():
        (tmp_path / "bin" / name).write_text(text)
        (tmp_path / "bin" / name).chmod(0o755)
    here = recipe.replace("8786", str(free_port())).replace("run standard", f"run {small(tmp_path)}")
    environment = {
        **os.environ,
        "PATH": f"{tmp_path / 'bin'}:{Path(sys.executable).parent}:{os.environ['PATH']}",
        "JOBS": str(tmp_path),
    }
    done = subprocess.run(
        ["sh", "-c", here], cwd=tmp_path, env=environment, capture_output=True, text=True, timeout=120
    )
    assert "small: 6 cells: 6 converged; 6 solved now" in done.stdout, done.stderr
    assert content(tmp_path / "store") == content(solved)
    workers = (tmp_path / "7").read_text().split()
    assert len(workers) == 2
    gone = " ".join(f"while kill -0 {pid} 2>/dev/null; do sleep 0.1; done;" for pid in workers)
    subprocess.run(["sh", "-c", gone], check=True, timeout=30)
