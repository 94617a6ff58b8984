"""What ``footprint bench`` measures, on meshes too small to time: its lines, its matrices and its exit code.

Rounds on a clock made up here: the machine changes its speed, works take what they are said to take.
"""

import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from contact.solvers.multifrontal import SYMMETRIC
from contact.solvers.sparse import asymmetry
from studies import cli
from studies.bench.costs import (
    BROKEN,
    COLUMNS,
    COMMAND,
    HOLDS,
    NO_BAR,
    SOLVE,
    SOLVES,
    VARIES,
    Group,
    Line,
    at_rest,
    child,
    costs,
    cpu,
    in_rounds,
    shell_of,
    shown,
)
from studies.cli import main

MESH = "8x6"


def test_one_tangent_is_symmetric_and_the_other_is_not() -> None:
    plain, other = at_rest(shell_of(MESH)), at_rest(shell_of(MESH, section="nonsymmetric"))
    assert asymmetry(plain) < SYMMETRIC < 1e-6 < asymmetry(other)
    assert np.linalg.eigvalsh(plain.toarray())[0] > 0


@pytest.fixture(scope="module")
def table() -> pd.DataFrame:
    return costs(1, sizes=(MESH,), mesh="12x12")


@pytest.mark.slow
def test_all_that_is_asked_for_is_measured(table) -> None:
    units = table[table["what"] == "units"]
    assert (units["median"] > 0).all()
    actual = units.groupby("group", sort=False)["line"].apply(list)
    kinds = [f"factorisation of 252 unknowns, {kind}" for kind in ("definite", "not symmetric")]
    assert [actual[kind] for kind in kinds] == [["fronts", "splu"]] * 2
    exact = ["semismooth", "lcp", "qp"]
    others = ["trial-and-error", "regularised", "augmented-lagrangian"]
    worth = ["lcp, system=full", "qp, system=full", "semismooth, solver=splu"]
    assert actual[SOLVES] == [*exact, *others, *worth]
    assert actual[COMMAND][-1] == SOLVE


@pytest.mark.parametrize(("verdicts", "code"), [(("", HOLDS), cli.OK), ((HOLDS, BROKEN), cli.FAILED)])
def test_the_command_prints_and_fails_with_a_bar(verdicts, code, monkeypatch, capsys) -> None:
    asked = []

    def measured(rounds: int, progress: object) -> pd.DataFrame:
        asked.append(rounds)
        rows = [("g", f"line {i}", "units", 1.0, 1.0, 2.0, 1.5, word) for i, word in enumerate(verdicts)]
        return pd.DataFrame(rows, columns=list(COLUMNS))

    monkeypatch.setattr("studies.bench.costs.costs", measured)
    assert main(["bench", "--rounds", "2"]) == code
    assert asked == [2]
    assert "median" in capsys.readouterr().out


class Machine:
    """A clock, its speed in each round, and the notes of what was done."""

    def __init__(self, *speeds: float) -> None:
        self.now, self.notes, self.speeds, self.beside = 0.0, "", speeds, 1

    def work(self, name: str, *seconds: float) -> Callable[[], str]:
        """A work of so many seconds at speed 1, round after round the next; ``u`` is done beside each of the others."""

        def done() -> str:
            turn = self.notes.count(name) // (self.beside if name == "u" else 1)
            self.notes += name
            self.now += seconds[turn % len(seconds)] / self.speeds[turn % len(self.speeds)]
            return name

        return done

    def table(self, *lines: Line, rounds: int = 3):
        self.beside = len(lines)
        return in_rounds([Group("g", lines)], self.work("u", 2.0), rounds, clock=lambda: self.now)


def value(table, line: str, what: str):
    (row,) = table[(table["line"] == line) & (table["what"] == what)].to_dict("records")
    return row


def test_the_unit_stands_beside_every_line_and_only_what_keeps_something_is_done_before() -> None:
    machine = Machine(1.0)
    machine.table(Line("a", machine.work("a", 1.0), cold=True), Line("b", machine.work("b", 1.0)), rounds=2)
    assert machine.notes == "b" + 2 * "uaub"


def test_a_machine_that_changes_its_speed_changes_no_number() -> None:
    machine = Machine(1.0, 3.0, 0.2)
    lines = [
        Line("a", machine.work("a", 1.0), cold=True),
        Line("b", machine.work("b", 4.0), over={"a": 3.0}, cold=True),
    ]
    table = machine.table(*lines)
    assert table.columns.tolist() == list(COLUMNS)
    for line, what, expected in (("a", "units", 0.5), ("b", "units", 2), ("b", "x a", 4)):
        row = value(table, line, what)
        assert [row[name] for name in ("median", "low", "high")] == pytest.approx(3 * [expected])


def test_a_line_that_varies_has_its_median_and_its_ends() -> None:
    machine = Machine(1.0)
    table = machine.table(Line("a", machine.work("a", 2.0, 10.0, 3.0), cold=True))
    row = value(table, "a", "units")
    assert [row[name] for name in ("median", "low", "high")] == [1.5, 1.0, 5.0]


@pytest.mark.parametrize(
    ("bar", "verdict"), [(1.51, HOLDS), (1.5, HOLDS), (1.49, VARIES), (1.0, VARIES), (0.99, BROKEN), (NO_BAR, "")]
)
def test_a_bar_is_broken_where_every_round_is_beyond_it(bar: float, verdict: str) -> None:
    for what in ("units", "x b"):
        machine = Machine(1.0)
        bars = {"over": {"b": bar}} if what == "x b" else {"most": bar}
        a = Line("a", machine.work("a", 2.0, 10.0, 3.0), cold=True, **bars)
        table = machine.table(a, Line("b", machine.work("b", 2.0), cold=True))
        assert value(table, "a", what)["holds"] == verdict
        assert (table["holds"] != "").sum() == (verdict != "")


def test_the_terminal_has_every_number_once() -> None:
    machine = Machine(1.0)
    lines = [
        Line("first", machine.work("a", 2.0, 10.0, 3.0), cold=True),
        Line("second", machine.work("b", 8.0), over={"first": 0.5}, most=9.0, cold=True),
    ]
    values = [line.split() for line in shown(machine.table(*lines)).splitlines()]
    assert values[1:] == [
        ["g", "first", "units", "1.5", "1", "5"],
        ["g", "second", "units", "4", "4", "4", "9", "holds"],
        ["g", "second", "x", "first", "2.67", "0.8", "4", "0.5", "BROKEN"],
    ]


def test_a_child_counts_for_who_waits_for_it(tmp_path: Path) -> None:
    before, own = cpu(), time.process_time()
    child(("-c", "sum(range(300_000))"), tmp_path)
    assert cpu() - before > time.process_time() - own
    child(("-c", "raise SystemExit(2)"), tmp_path, 2)
    with pytest.raises(AssertionError, match="wrong"):
        child(("-c", "raise SystemExit('wrong')"), tmp_path)
