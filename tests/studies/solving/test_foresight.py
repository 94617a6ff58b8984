"""What a solve is foreseen to take, against processes that did it; and limits that hold."""

from __future__ import annotations

import json
import re
import signal
import subprocess
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

from studies.cli import main
from studies.commands import solve as command
from studies.commands.options import progress_line
from studies.scenes.complete import complete
from studies.solving.refinement.foresight import foresee
from studies.solving.refinement.mesh_error import round_of, solve_with_error

WITHIN, HALF = 0.15, 0.25  # of the memory that a process has taken; of half a tyre too much is foreseen
MEASURED = """
from studies.run.task import status_MB
from studies.scenes.complete import complete
from studies.solving.solve import solve
solve(*complete({scene!r}, {given!r}, {least!r}))
idle = status_MB("VmHWM")
found = solve(*complete({scene!r}, {given!r}, {mesh!r}))
print(found.model.n_unknowns, status_MB("VmHWM") - idle, found.timing["cpu"])
"""
SLOW = pytest.mark.slow


@SLOW
@pytest.mark.skipif(sys.platform != "linux", reason="the peak is in other units elsewhere")
@pytest.mark.parametrize(
    ("scene", "given", "least", "mesh"),
    [
        ("hemisphere", {"load_fraction": "0.02"}, "4x4", "40x40"),
        ("hemisphere", {"load_fraction": "0.02"}, "4x4", "100x100"),
        ("hemisphere", {"load_fraction": "0.02"}, "4x4", "130x130"),
        ("tyre", {"delta_mm": "2"}, "8x8", "80x80"),
    ],
)
def test_memory_and_unknowns_are_those_of_a_process_that_solves_it(
    scene: str, given: dict[str, str], least: str, mesh: str
) -> None:
    ahead = foresee(*complete(scene, given, mesh))
    script = MEASURED.format(scene=scene, given=given, least=least, mesh=mesh)
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True).stdout
    unknowns, memory, _ = map(float, done.split())
    assert ahead.unknowns == pytest.approx(unknowns, rel=0.1)
    assert ahead.memory_MB == pytest.approx(memory, rel=HALF if scene == "tyre" else WITHIN)
    assert ahead.seconds is not None


def test_where_nothing_is_foreseen_nothing_is_said() -> None:
    assert foresee(*complete("hemisphere", {}, "8x8")) is None  # no coarser grids of 100 and 400 elements


@SLOW
def test_of_solids_nothing_is_foreseen() -> None:
    assert foresee(*complete("crushed-ring-solid", {})) is None


@pytest.mark.parametrize(
    ("words", "says"),
    [
        (["--memory-limit", "50"], r"40x40: about 10,000 unknowns, .* s, (9\d|1\d0) MB: more than --memory-limit 50; "),
        (["--time-limit", "0.01s"], r"40x40: about 10,000 unknowns, .* MB: more than --time-limit 0.01; "),
        (["--memory-limit", "0"], r"memory-limit = 0.0 must be a number in \(0, 1e\+09\]"),
        (["--memory-limit", "1e30"], r"memory-limit = 1e\+30 must be a number in \(0, 1e\+09\]"),
        (["--time-limit", "1e30"], r"time-limit = 1e\+30 must be a number in \(0, 500000\]"),
        (["--time-limit", "soon"], r"time-limit 'soon' must be a number of seconds above 0, e.g. 5s"),
        (["--time-limit", "5", "--error", "1%"], r"with --error, --budget limits the time: give no --time-limit"),
        (["--error", "1%", "--budget", "-5s"], r"budget '-5s' must be a number of seconds above 0, e.g. 5s"),
    ],
)
def test_more_than_a_limit_is_one_line_and_nothing_is_solved(
    words: list[str], says: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    asked = ["solve", "hemisphere", "--mesh", "40x40", "--set", "load_fraction=0.02", *words]
    assert main([*asked, "--out", str(tmp_path / "out")]) == 2
    printed = capsys.readouterr()
    assert printed.out == ""
    assert printed.err.count("\n") == 1
    assert re.match("footprint: " + says, printed.err)
    assert not (tmp_path / "out").exists()


@contextmanager
def alarm_at(text: str) -> Iterator[Callable[[str], None]]:
    """The limit of time is reached when progress says this."""

    def tell(stated: str) -> None:
        if stated.endswith(text):
            signal.raise_signal(signal.SIGALRM)

    yield tell


def test_at_the_limit_of_time_the_finished_loads_are_written(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(command, "progress_line", lambda whole: alarm_at(": load 0.5"))
    asked = ["solve", "hemisphere", "--mesh", "16x16", "--time-limit", "1000", "--out", str(tmp_path)]
    before = signal.getsignal(signal.SIGALRM)
    assert main(asked) == 3
    assert signal.getsignal(signal.SIGALRM) is before
    said = "stopped at the limit of 1000 s with 1 loads finished"
    assert capsys.readouterr().err == f"footprint: {said}; they are written\n"
    record = json.loads((tmp_path / "result.json").read_text())
    assert (record["outcome"], record["reason"], len(record["steps"])) == ("interrupted", said, 1)


def test_before_the_grid_that_is_asked_for_nothing_is_written(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(command, "progress_line", lambda whole: alarm_at("round 1, 4x4"))
    asked = ["solve", "hemisphere", "--mesh", "16x16", "--time-limit", "1000", "--out", str(tmp_path / "out")]
    assert main(asked) == 3
    said = "stopped at the limit of 1000 s before the requested grid was reached; nothing is written"
    assert capsys.readouterr().err == f"footprint: {said}\n"
    assert not (tmp_path / "out").exists()


@pytest.mark.skipif(sys.platform != "linux", reason="the limit is of private memory where the kernel counts it")
def test_a_process_that_takes_more_than_its_memory_says_so_in_a_line(tmp_path: Path) -> None:
    """Not foreseen, as the limit is just above what is."""
    asked = ["solve", "hemisphere", "--mesh", "18x18", "--memory-limit", "1", "--start", "cold", "--no-error"]
    words = [sys.executable, "-m", "studies.cli", *asked, "--out", str(tmp_path / "out")]
    done = subprocess.run(words, capture_output=True, text=True, check=False, timeout=120)
    assert done.returncode == 1
    assert done.stderr.startswith("footprint: not enough memory; a coarser mesh needs less")
    assert done.stderr.count("\n") == 1
    assert not (tmp_path / "out").exists()


@pytest.mark.slow
@pytest.mark.skipif(sys.platform != "linux", reason="the limit is of private memory where the kernel counts it")
def test_a_small_solve_under_a_small_limit_ends(tmp_path: Path) -> None:
    """A library of linear algebra that is refused its buffer would wait for ever."""
    asked = [
        "solve",
        "hemisphere",
        "--mesh",
        "8x8",
        "--memory-limit",
        "5",
        "--no-error",
        "--out",
        str(tmp_path / "out"),
    ]
    done = subprocess.run([sys.executable, "-m", "studies.cli", *asked], capture_output=True, check=False, timeout=120)
    assert done.returncode in (0, 1)


def test_every_round_is_told_with_what_it_will_take() -> None:
    stated = list[str]()
    scene, request = complete("hemisphere", {"load_fraction": "0.1"}, "16x16")
    solve_with_error(scene, request, stated.append)
    heads = list(dict.fromkeys(text.partition(":")[0] for text in stated))
    assert re.fullmatch(
        r"round 1, 4x4\nround 2, 8x8, about [0-9.e-]+ CPU s\nround 3, 16x16, about [0-9.e-]+ CPU s", "\n".join(heads)
    )
    assert stated[-1].endswith(" CPU s: load 0.1")
    assert round_of(1, request, []) == "round 1, 16x16"


def test_a_terminal_is_told_the_seconds_and_their_bound(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(sys.stderr, "isatty", lambda: True)
    with progress_line() as tell:
        tell("round 1, 4x4")
    with progress_line(60) as tell:
        tell("round 1, 4x4")
    assert re.search(r"round 1, 4x4; 0\.\d s so far.*round 1, 4x4; 0\.\d of 60 s", capsys.readouterr().err)
