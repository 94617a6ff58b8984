"""``bench solvers``: tables in a store, a run that goes on or refuses to, and ranks that repeat or do not."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pandas as pd
import pytest

from studies.arena import solver_run
from studies.arena.solver_run import FIELDS, Field, problems_in
from studies.arena.solvers.catalogue import SOLVERS
from studies.cli import _parser, main
from studies.output.atomic import write_table
from support.problems.contact_problems import STATES, Told, indefinite, known_step

FIELD = FIELDS["solver"]
TABLES = {"samples", "run", "problems", "table", "summary", "profiles"}


@pytest.fixture(autouse=True)
def field(monkeypatch: pytest.MonkeyPatch) -> Field:
    """One who is right, two who are slower or wrong, and one who is not installed."""
    _, du, pressure = known_step()
    solvers = [
        Told("right", du=du, pressure=pressure),
        Told("slow", du=du, pressure=pressure, spends=0.1),
        Told("liar", du=du, pressure=2 * pressure),
        Told("absent", "no_such_module"),
    ]
    small = replace(FIELDS["solver"], of=lambda: solvers)
    monkeypatch.setitem(solver_run.FIELDS, "solver", small)
    return small


@pytest.fixture
def problems(tmp_path: Path) -> Path:
    folder = tmp_path / "problems"
    folder.mkdir()
    step, *_ = known_step()
    step.write(folder / "a.npz")
    indefinite(step).write(folder / "b.npz")
    return folder


def bench(*arguments: object) -> int:
    return main(["bench", "solvers", "--rounds", "1", "--limit", "5", "--tolerance", "1e-4", *map(str, arguments)])


@pytest.mark.slow
def test_a_run_leaves_its_tables_and_asks_nothing_twice(
    field: Field, problems: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "out"
    assert bench("--problems", problems, "--out", out, "--only", "right", "--only", "absent") == 0
    assert {path.name for path in (out / "tables").iterdir()} == {f"solver_{name}.csv" for name in TABLES}
    output = capsys.readouterr().out
    assert "convex, to 0.0001" in output
    assert "all 1 refused by absent" in output
    before = field.path(out, "samples").read_text()
    assert bench("--problems", problems, "--out", out) == 0
    after = field.path(out, "samples").read_text()
    assert after.startswith(before)
    summary = pd.read_csv(field.path(out, "summary")).query("size == 'all' and kind == 'convex'").set_index("solver")
    assert summary["solved"].to_dict() == {"right": 1, "slow": 1, "liar": 0, "absent": 0}
    assert summary["false"].to_dict() == {"right": 0, "slow": 0, "liar": 1, "absent": 0}
    assert bench("--problems", problems, "--out", out) == 0
    assert field.path(out, "samples").read_text() == after
    assert main(["bench", "solvers", "--problems", str(problems), "--out", str(out), "--limit", "4"]) == 2
    assert "was begun with limit_s 5.0, not 4.0: choose another --out" in capsys.readouterr().err
    step, *_ = known_step(1)
    step.write(problems / "a.npz")
    assert bench("--problems", problems, "--out", out) == 2
    assert "was begun with another file a.npz" in capsys.readouterr().err
    assert field.path(out, "samples").read_text() == after


@pytest.mark.slow
def test_ranks_of_two_runs(field: Field, problems: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Of a run against itself 1; where seconds are turned round, -1."""
    one, other = tmp_path / "one", tmp_path / "other"
    for out in (one, other):
        assert bench("--problems", problems, "--out", out, "--only", "right", "--only", "slow") == 0
    assert bench("--out", one, "--against", other) == 0
    lines = [line.split() for line in capsys.readouterr().out.splitlines() if "repeats" in line]
    assert lines[0] == ["0.0001", "convex", "1", "2", "1.000", "1.000", "repeats"]
    path = field.path(other, "table")
    table = pd.read_csv(path)
    write_table(path, table.assign(seconds=table["seconds"].max() + 0.01 - table["seconds"]))
    assert bench("--out", one, "--against", other) == 1
    output = capsys.readouterr().out
    assert any(line.split()[-3:] == ["-1.000", "-1.000", "BROKEN"] for line in output.splitlines())
    assert output.split()[-4:] == ["NaN", "NaN", "no", "ranks"]  # of the other problem neither knows the answer


def test_wrong_use_is_one_line_and_writes_nothing(
    problems: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    empty, damaged, out = tmp_path / "empty", tmp_path / "damaged", tmp_path / "out"
    empty.mkdir()
    damaged.mkdir()
    (damaged / "c.npz").write_bytes(b"no zip")
    given = ("--problems", problems)
    for arguments, says in (
        ((), "bench solvers needs --problems DIR, --held-out, --against STORE, or several"),
        (("--problems", empty), "no frozen steps (*.npz) in it"),
        (("--problems", damaged), "c.npz is not a frozen contact step"),
        ((*given, "--only", "nobody"), "--only 'nobody' must be one of right; slow; liar; absent"),
        ((*given, "--tolerance", "1e-4,x"), "--tolerance '1e-4,x' must be different numbers"),
        ((*given, "--tolerance", "1e-4,1e-4"), "must be different numbers in (0, 1)"),
        ((*given, "--limit", "0"), "limit = 0.0 must be a number in (0, inf)"),
        ((*given, "--rounds", "0"), "rounds = 0 must be a whole number in [1, 1000]"),
        ((*given, "--results", out), f"the collection, of which --problems {problems} has no file"),
        (("--against", empty), "no run of bench solvers in it (no solver_run.csv)"),
    ):
        assert bench("--out", out, *arguments) == 2
        message = capsys.readouterr().err
        assert says in message
        assert message.count("\n") == 1
        assert not out.exists()


def test_problems_come_smallest_first(problems: Path) -> None:
    step, *_ = known_step(3, states=STATES[:3])
    step.write(problems / "A.npz")
    assert list(problems_in(problems)) == ["A", "a", "b"]


def test_parts_are_taken_after_the_subcommand_and_those_that_came_late_compete(monkeypatch: pytest.MonkeyPatch) -> None:
    assert _parser(["bench"]).parse_args(["bench", "solvers", "--use", "mine.py"]).use == ["mine.py"]
    monkeypatch.setitem(SOLVERS, "late", Told("late"))
    assert "late" in [solver.name for solver in FIELD.solvers]
