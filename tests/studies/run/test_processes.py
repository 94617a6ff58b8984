"""Faults of the machine: a store that takes nothing, kills, a clock that jumps, memory that ends in compiled code."""

from __future__ import annotations

import errno
import json
import os
import random
import re
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path

import pytest

from studies.cli import main
from studies.commands import FAILED
from studies.commands.limits import LARGEST_MB, LARGEST_S
from studies.output.atomic import PART
from studies.run import archive
from studies.run.campaign import find
from studies.run.children import TABLES_TAKE, Child
from studies.run.collect import collect
from studies.run.plan import planned
from studies.run.running import run
from studies.run.task import Limits
from studies.scenes.complete import Cell
from support.stores.campaigns import again, content, small

ROOT = Path(__file__).parents[3]
KILLS = 10
LINUX = pytest.mark.skipif(sys.platform != "linux", reason="asks the kernel for what only Linux has")


def command(campaign: Path, store: Path, *more: str) -> list[str]:
    return [sys.executable, "-m", "studies.cli", "run", str(campaign), "--store", str(store), *more]


# --- a store that takes nothing -----------------------------------------------------------------------------------


@LINUX
@pytest.mark.parametrize("words", [["run", "quick", "--store"], ["solve", "cantilever", "--mesh", "2x1", "--out"]])
def test_a_place_where_nobody_may_write_is_one_line(words: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    """The kernel makes no directory in /sys, for root either."""
    assert main([*words, "/sys/store"]) == 2
    said = capsys.readouterr().err
    assert said.count("\n") == 1
    assert "/sys/store" in said
    assert "Errno" not in said
    assert os.strerror(errno.EPERM if os.geteuid() == 0 else errno.EACCES) in said


def test_a_file_where_a_folder_should_be_is_one_line(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    store = tmp_path / "store"
    store.mkdir()
    (store / "cells").write_text("mine")
    assert main(["run", str(small(tmp_path)), "--store", str(store)]) == 2
    said = capsys.readouterr().err
    assert said.count("\n") == 1
    assert f"{store} cannot be written to: {store / 'cells'}" in said
    assert (store / "cells").read_text() == "mine"
    assert list(store.rglob(f"{PART}*")) == []


@LINUX
@pytest.mark.slow
def test_a_file_system_that_is_read_only_is_read_and_not_written(own: Path, solved: Path, tmp_path: Path) -> None:
    """A real one, which binds root: what reads a store works, what writes to it says so in a line."""
    mounted = f"mount --bind {own} {own} && mount -o remount,ro,bind {own} && exec "
    apart = ["unshare", "--mount", "sh", "-c"]
    if shutil.which("unshare") is None or subprocess.run([*apart, mounted + "true"], capture_output=True).returncode:
        pytest.skip("no mounts of its own for a process here")
    campaign = small(tmp_path)

    def said(*words: str) -> tuple[int, str]:
        text = mounted + " ".join([sys.executable, "-m", "studies.cli", *words, "--store", str(own)])
        done = subprocess.run([*apart, text], capture_output=True, text=True, cwd=tmp_path, env=ENVIRONMENT)
        return done.returncode, done.stderr if done.returncode else done.stdout

    read_only = os.strerror(errno.EROFS)
    refused = f"footprint: --store {own} cannot be written to: {read_only}\n"
    for engine in ("serial", "local:2"):
        assert said("run", str(campaign), "--engine", engine) == (2, refused)
    assert said("table", "small")[1].endswith("6 cells: 6 converged\n")
    assert said("report", "--campaign", "small")[0] == 0
    code, text = said("analyse", "small")
    assert (code, text.count("\n"), read_only in text) == (2, 1, True)
    assert content(own) == content(solved)


@pytest.mark.slow
@pytest.mark.parametrize("code", [errno.EROFS, errno.EACCES, errno.EPERM], ids=errno.errorcode.get)
def test_a_store_that_becomes_read_only_is_one_line_and_what_was_finished_is_kept(
    code: int, solved: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    refuse_after(3, code, monkeypatch)
    store = tmp_path / "store"
    assert main(["run", str(small(tmp_path)), "--store", str(store), "--engine", "local:2"]) == 2
    line = "footprint: {} cannot be written to: {}; finished cells are kept, run again to continue\n"
    assert capsys.readouterr().err == line.format(store, os.strerror(code))
    monkeypatch.undo()
    assert len(list((store / "cells").glob("*.json"))) == 3
    assert list(store.rglob(f"{PART}*")) == []
    assert again(tmp_path, store).solved == 3
    assert content(store) == content(solved)


@LINUX
@pytest.mark.slow
def test_files_that_the_process_of_a_cell_cannot_write_are_no_crash(tmp_path: Path) -> None:
    """Its fields and tables, of which none is left by half; the process goes on."""
    refusing = tmp_path / "refusing.py"
    task, child = replace(planned(Cell("x", "cantilever", {"mesh": "2x1"})), id="x").task((str(refusing),)), Child()
    refusing.write_text(REFUSING)
    try:
        assert child.ask(task, Limits(), Path("/sys/cells/x"))["class"] == "disk"
        for code in (errno.EROFS, errno.EACCES, errno.EPERM):
            folder = tmp_path / f"refused-{code}"
            assert child.ask(task, Limits(), folder) == {"class": "disk", "reason": os.strerror(code)}
            assert {path.suffix for path in folder.iterdir()} == {".csv"}
        assert child.ask(task, Limits(), tmp_path / "taken")["class"] == ""
    finally:
        child.end()


@pytest.mark.slow
def test_the_largest_limits_are_those_that_a_process_can_be_held_to() -> None:
    """A table may take longer than a cell."""
    task, child = replace(planned(Cell("x", "cantilever", {"mesh": "2x1"})), id="x").task(), Child()
    try:
        assert child.ask(task, Limits(TABLES_TAKE * LARGEST_S, LARGEST_MB))["class"] == ""
    finally:
        child.end()


def refuse_after(count: int, code: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """Records beyond so many are refused."""
    left, write = [count], archive.write_text

    def refusing(path: Path, text: str) -> None:
        if path.parent.name == "cells":
            left[0] -= 1
            if left[0] < 0:
                raise OSError(code, os.strerror(code), str(path))
        write(path, text)

    monkeypatch.setattr(archive, "write_text", refusing)


ENVIRONMENT = {**os.environ, "PYTHONPATH": str(ROOT)}
REFUSING = """
import os, sys, tempfile

made = tempfile.mkstemp


def refusing(*arguments, dir=None, suffix="", **more):
    told, _, code = str(dir).rpartition("refused-")
    if told and suffix == ".vtu":
        raise OSError(int(code), os.strerror(int(code)), f"{dir}/.part-planted{suffix}")
    return made(*arguments, dir=dir, suffix=suffix, **more)


tempfile.mkstemp = refusing
"""


# --- kills --------------------------------------------------------------------------------------------------------


def children(process: subprocess.Popen[bytes]) -> list[int]:
    """Processes that one has started, as the kernel of Linux knows them."""
    files = Path(f"/proc/{process.pid}/task").glob("*/children")
    return [int(pid) for file in files for pid in file.read_text().split()]


def kill_all(process: subprocess.Popen[bytes]) -> None:
    """The scheduler and all of its children with what they have started, none after the other has noticed."""
    groups = children(process)
    process.send_signal(signal.SIGKILL)
    for group in groups:
        os.killpg(group, signal.SIGKILL)


def kill_scheduler(process: subprocess.Popen[bytes]) -> None:
    process.send_signal(signal.SIGKILL)


@pytest.mark.slow
def test_killed_again_and_again_and_resumed_it_is_the_same_store(tmp_path: Path) -> None:
    """By turns at the first look, before anything is imported, and while cells are written.

    Many cells: a busy machine makes several between two looks at the folder. Whenever it gets to its end before, it
    begins again from nothing.
    """
    store, rng = tmp_path / "store", random.Random(2004)
    campaign = small(tmp_path)
    tolerances = ", ".join(f"{digit}e-9" for digit in range(1, 9))
    campaign.write_text(campaign.read_text().replace("[1e-9]", f"[{tolerances}]"))
    words = command(campaign, store, "--engine", "local:2")
    ways: Sequence[Callable[[subprocess.Popen[bytes]], None]] = [kill_scheduler]
    ways = [kill_scheduler, kill_all] if sys.platform == "linux" else ways
    subprocess.run(words, check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    uninterrupted, cells = content(store), len(written(store))
    shutil.rmtree(store)
    killed, moments = 0, set()
    while killed < KILLS:
        enough = 0 if killed % 5 == 0 else rng.randint(min(len(written(store)) + 1, cells), cells)
        process = subprocess.Popen(words, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        while process.poll() is None:
            if len(written(store)) >= enough:
                ways[killed % len(ways)](process)
                process.wait()
                killed += process.returncode != 0
            time.sleep(0.005)
        records = written(store)
        assert all(json.loads(record.read_text())["class"] == "converged" for record in records)
        moments.add(len(records))
        if process.returncode == 0:
            shutil.rmtree(store)
    assert len(moments) > 2, moments  # with nothing done, with something, with more
    run(find(str(campaign)), store)
    assert content(store) == uninterrupted


def written(store: Path) -> list[Path]:
    """The records, but for what was being written when a kill came."""
    return [record for record in (store / "cells").glob("*.json") if not record.name.startswith(PART)]


HELD = """
import ctypes, subprocess

from studies.scenes import SCENES
from studies.scenes.benchmarks.cantilever import Cantilever
from dataclasses import dataclass


@dataclass(frozen=True)
class Held(Cantilever):
    name: str = "held"

    def build(self, request):
        subprocess.Popen(["sleep", "600"])
        ctypes.PyDLL(None).sleep(600)  # with the lock of the interpreter, as compiled code may hold it


SCENES["held"] = Held()
"""


@LINUX
@pytest.mark.slow
def test_nothing_outlives_a_scheduler_that_is_killed(tmp_path: Path) -> None:
    """In the middle of compiled code that lets no thread of Python run; with the processes that cells have started."""
    (tmp_path / "planted_cells.py").write_text(HELD)
    campaign = tmp_path / "held.toml"
    campaign.write_text('modules = ["planted_cells"]\n[[cross]]\n[cross.scenes.held]\nmeshes = ["2x1", "4x1"]\n')
    words = command(campaign, tmp_path / "store", "--trust", "--engine", "local:2")
    process = subprocess.Popen(words, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    until, family = time.monotonic() + 60, {}
    while len(family) < 4 and time.monotonic() < until:
        groups = children(process)
        family = {pid: group for pid, group in groups_of_all().items() if group in groups}
        time.sleep(0.1)
    assert len(family) == 4  # two cells and their sleepers
    kill_scheduler(process)
    process.wait()
    until = time.monotonic() + 30
    while family.keys() & groups_of_all().keys() and time.monotonic() < until:
        time.sleep(0.05)
    assert not family.keys() & groups_of_all().keys()
    assert list((tmp_path / "store").rglob(f"{PART}*")) == []


def groups_of_all() -> dict[int, int]:
    """The group of each process that is running."""
    by_name = {}
    for stat in Path("/proc").glob("[0-9]*/stat"):
        try:
            state, _, group = stat.read_text().rpartition(")")[2].split()[:3]
        except (FileNotFoundError, ProcessLookupError):
            continue
        if state != "Z":
            by_name[int(stat.parent.name)] = int(group)
    return by_name


# --- a clock that jumps -------------------------------------------------------------------------------------------

CLOCKS = r"(time|time_ns|localtime|gmtime|ctime|strftime)\b"
WALL = re.compile(
    rf"\btime\.{CLOCKS}|\bfrom time import .*\b{CLOCKS}|\bdatetime\.(now|utcnow|today)\b|\bst_[amc]time|\bget[amc]time"
)


def test_nothing_reads_the_clock_of_the_wall() -> None:
    """It may be set, by a person or by a server; limits and times are of clocks that only go on; results are dated."""
    packages = ("contact", "formulations", "reports", "studies")
    paths = [path for package in packages for path in (ROOT / package).rglob("*.py")]
    assert len(paths) > 200
    dated = ROOT / "studies" / "output" / "provenance.py"
    assert [path for path in paths if path != dated and WALL.search(path.read_text(encoding="utf-8"))] == []
    assert WALL.search("began = time.time()")
    assert not WALL.search("time.monotonic(), time.process_time(), datetime.date.today()")


JUMPING = """
#define _GNU_SOURCE
#include <dlfcn.h>
#include <stdlib.h>
#include <sys/time.h>
#include <time.h>

static double jump(void) {  /* up to 30 years, either way */
    static unsigned seed = 2004;
    return (rand_r(&seed) % 2000001) * 1e3 - 1e9;
}

int clock_gettime(clockid_t id, struct timespec *at) {
    int (*real)(clockid_t, struct timespec *) = dlsym(RTLD_NEXT, "clock_gettime");
    int found = real(id, at);
    if (id == CLOCK_REALTIME || id == CLOCK_REALTIME_COARSE) at->tv_sec += jump();
    return found;
}
time_t time(time_t *at) {
    struct timespec now;
    clock_gettime(CLOCK_REALTIME, &now);
    return at ? (*at = now.tv_sec) : now.tv_sec;
}
int gettimeofday(struct timeval *restrict at, void *restrict zone) {
    struct timespec now;
    clock_gettime(CLOCK_REALTIME, &now);
    at->tv_sec = now.tv_sec, at->tv_usec = now.tv_nsec / 1000;
    return 0;
}
"""
SLEEPING = """
import time
from dataclasses import dataclass

from studies.scenes import SCENES
from studies.scenes.benchmarks.cantilever import Cantilever


@dataclass(frozen=True)
class Sleeping(Cantilever):
    name: str = "sleeping"

    def build(self, request):
        time.sleep(600)


SCENES["sleeping"] = Sleeping()
"""


@LINUX
@pytest.mark.slow
def test_a_clock_that_jumps_changes_nothing(solved: Path, tmp_path: Path) -> None:
    """By thirty years back or ahead whenever anything asks for it, in every process and in compiled code."""
    compiler = shutil.which("cc") or pytest.skip("no compiler of C")
    (tmp_path / "jumping.c").write_text(JUMPING)
    library = tmp_path / "jumping.so"
    subprocess.run([compiler, "-shared", "-fPIC", "-o", library, tmp_path / "jumping.c", "-ldl"], check=True)
    jumping = {**ENVIRONMENT, "LD_PRELOAD": str(library)}
    shown = subprocess.run(
        [sys.executable, "-c", "import time; print(len({time.time() // 1e6 for _ in range(9)}), time.monotonic())"],
        capture_output=True,
        text=True,
        env=jumping,
        check=True,
    )
    times, monotonic = shown.stdout.split()
    assert int(times) > 5
    assert abs(float(monotonic) - time.monotonic()) < 60

    store = tmp_path / "store"
    subprocess.run(command(small(tmp_path), store, "--engine", "local:2"), check=True, env=jumping, capture_output=True)
    assert content(store) == content(solved)

    (tmp_path / "planted_cells.py").write_text(SLEEPING)
    campaign = tmp_path / "asleep.toml"
    campaign.write_text('modules = ["planted_cells"]\n[[cross]]\n[cross.scenes.sleeping]\nmeshes = ["2x1"]\n')
    words = command(campaign, store, "--trust", "--time-limit", "4")
    began = time.monotonic()
    assert subprocess.run(words, env=jumping, capture_output=True).returncode == FAILED
    assert 4 < time.monotonic() - began < 60
    (ended,) = collect(store, "asleep").to_dict("records")
    assert (ended["outcome"], ended["reason"]) == ("time", "killed after 4 s")


# --- memory -------------------------------------------------------------------------------------------------------

HUNGRY = """
import resource
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from scipy import sparse

from contact.solvers.qp_backends import Programme, ask
from contact.solvers.sparse import superlu
from studies.ask.scene import Setting
from studies.scenes import SCENES
from studies.scenes.benchmarks.cantilever import Cantilever

N = 90
WAYS = ("lapack", "superlu", "osqp", "clarabel")
MB = Setting("left_MB", 1.0, "memory that is left", low=0, high=100)


def laplace():
    T = sparse.diags_array([-np.ones(N - 1), 2 * np.ones(N), -np.ones(N - 1)], offsets=[-1, 0, 1])
    I = sparse.eye_array(N)
    return sparse.csc_matrix(sparse.kron(T, I) + sparse.kron(I, T))


def fill(left_MB):
    soft = resource.getrlimit(resource.RLIMIT_DATA)[0]
    used = float(Path("/proc/self/status").read_text().partition("VmData:")[2].split()[0]) * 1024
    return np.empty(int(soft - used - left_MB * 2**20), np.uint8)


@dataclass(frozen=True)
class Hungry(Cantilever):
    name: str = "hungry"
    settings: tuple = (*Cantilever().settings, MB, Setting("way", "lapack", "what", "choice", choices=WAYS))

    def build(self, request):
        way, A = request.settings["way"], laplace()
        identity, dense = sparse.eye_array(N**2, format="csc"), A[:600, :600].toarray()
        programme = Programme(A, np.ones(N**2), identity, np.zeros(N**2))
        if way in WAYS[2:]:
            __import__(way)
        kept = fill(request.number("left_MB"))
        if way == "lapack":
            np.linalg.svd(dense)
        elif way == "superlu":
            superlu(A, permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=1e-3, options={"SymmetricMode": True})
        else:
            ask(way, programme, 1e-6, False)
        del kept
        return super().build(request)


SCENES["hungry"] = Hungry()
"""
LEFT_MB = {"lapack": (3, 8, 100), "superlu": (1, 3, 6, 100), "osqp": (1, 4, 100), "clarabel": (1, 6, 100)}


@LINUX
@pytest.mark.slow
@pytest.mark.parametrize("way", LEFT_MB)
def test_memory_that_ends_in_the_middle_of_a_factorisation_is_an_outcome(way: str, tmp_path: Path) -> None:
    """In LAPACK, in SuperLU, in solvers of C, and of Rust, which aborts; one cell in the end has enough.

    OSQP checks some of its allocations only: measured with 1 to 7 MB left, 4 of 11 cells follow a null pointer, which
    nothing outside of it can know for lack of memory. That is a crash, which the campaign outlives as well.
    """
    if way in ("osqp", "clarabel"):
        pytest.importorskip(way, reason="needs the extra qp")
    (tmp_path / "planted_cells.py").write_text(HUNGRY)
    text = f'modules = ["planted_cells"]\n[[cross]]\n[cross.scenes.hungry]\nmeshes = ["2x1"]\nset.way = "{way}"\n'
    campaign, store = tmp_path / "hungry.toml", tmp_path / "store"
    campaign.write_text(text + f"vary.left_MB = {list(LEFT_MB[way])}\n")
    summary = run(find(str(campaign), trust=True), store, limits=Limits(60.0, 400.0))
    table = collect(store, "hungry")
    lost = table[table["outcome"] != "converged"]
    memory = lost["reason"].str.startswith("more than 400 MB") & (lost["outcome"] == "memory")
    assert (memory | (way == "osqp") & lost["reason"].str.startswith("killed by SIGSEGV")).all()
    assert (summary.classes["converged"], len(lost)) == (1, len(LEFT_MB[way]) - 1)
    assert len(list((store / "cells").glob("*.json"))) == 1
    assert len(list((store / "failures").glob("*.json"))) == len(lost)
    assert list(store.rglob(f"{PART}*")) == []
