"""What ``footprint bench newton`` and ``scaling`` measure, on meshes too small to time, and wrong use of all tables.

The timing lane with a clock made up here, and once for real; the bench of the harness as a function, untimed.
"""

import json
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from studies import cli
from studies.ask.scene import UsageError
from studies.bench.newton import MESHES, TIMES, beside_solving, exponents, harness, scaling, shown
from studies.cli import WRONG_USE, main
from studies.run.campaign import find
from studies.run.collect import collect
from studies.run.running import run
from studies.run.task import status_MB
from studies.run.times import REPEATS, SHARE, Stopwatch, canary, interval, sample, shares, summary, time_campaign


@pytest.fixture(scope="module")
def table() -> pd.DataFrame:
    labels: list[tuple[int, str]] = []
    before = status_MB("VmHWM") / 1024  # of the process, which has run other tests
    measured = scaling(("6x6", "8x6"), lambda done, _, label: labels.append((done, label)), coarse="8x6", seconds=0.0)
    assert labels == [(0, "8x6 into contact"), (0, "6x6"), (1, "8x6"), (2, "done")]
    measured.attrs["before_GiB"] = before
    return measured


@pytest.mark.slow
def test_one_row_a_mesh_with_times_and_memory(table: pd.DataFrame) -> None:
    assert table[["mesh", "dofs", "elements"]].to_numpy().tolist() == [["6x6", 180, 36], ["8x6", 252, 48]]
    assert (table[[f"{name}_s" for name in TIMES]] > 0).all(axis=None)
    assert table["peak_GiB"].between(0.02, table.attrs["before_GiB"] + 1).all()
    assert (table["assembly_s"] >= table["scatter_s"]).all()
    assert len(shown(table).splitlines()) == 4


def test_planted_exponents_are_found_and_small_sizes_do_not_count() -> None:
    for p in (1.0, 1.5):
        sizes = np.array([2_000, 10_000, 40_000, 250_000])
        planted = pd.DataFrame({"dofs": sizes, **{f"{part}_s": 1e-7 * sizes**p for part in TIMES}})
        planted.loc[0, "total_s"] *= 50
        assert exponents(planted) == pytest.approx(dict.fromkeys(TIMES, p))
        assert np.isnan(exponents(planted[:2])["total"])


@pytest.mark.slow
def test_the_command_prints(table: pd.DataFrame, monkeypatch, capsys) -> None:
    asked: list[list[str]] = []
    monkeypatch.setattr("studies.bench.newton.scaling", lambda meshes, _: asked.append(list(meshes)) or table)
    for words in ("scaling", "scaling --mesh 6x6,8x6", "newton"):
        assert main(["bench", *words.split()]) == cli.OK
        assert "exponent" in capsys.readouterr().out
    assert asked == [list(MESHES), ["6x6", "8x6"], ["42x40"]]


def test_wrong_use_of_a_benchmark_is_one_line(capsys: pytest.CaptureFixture[str]) -> None:
    for arguments, words in (
        ("scaling --mesh 6x6,7x6", "mesh 7x6: both numbers must be even"),
        ("scaling --mesh 6x6,,8x6", "mesh '' must be N1xN2"),
        ("scaling --mesh 4000x4000", "at most"),
        ("--rounds 0", "rounds = 0"),
        ("newton --mesh 7x6", "both numbers must be even"),
    ):
        assert main(["bench", *arguments.split()]) == WRONG_USE
        said = capsys.readouterr().err
        assert words in said
        assert said.count("\n") == 1


def test_options_of_other_tables_are_refused(capsys: pytest.CaptureFixture[str]) -> None:
    others = ("scaling --rounds 3", "--mesh 6x6", "overhead --mesh 6x6", "all")
    for arguments in others:
        with pytest.raises(SystemExit) as error:
            main(["bench", *arguments.split()])
        assert error.value.code == WRONG_USE
        assert capsys.readouterr().err.count("\n") == 1


LABELS = ("a", "b", "c")


class Machine:
    """Takes notes; the canary of each block is told beforehand, before and after."""

    def __init__(self, *canaries: float) -> None:
        self.canaries, self.notes = list(canaries), ""

    def watch(self) -> Stopwatch:
        return Stopwatch(self._block, self._canary, self._cell)

    def _block(self) -> None:
        self.notes += "|"

    def _canary(self) -> float:
        self.notes += "!"
        return self.canaries.pop(0)

    def _cell(self, label: str) -> float:
        self.notes += label
        return float(len(self.notes))


def test_rounds_are_interleaved_and_every_block_is_a_fresh_process_between_canaries() -> None:
    machine = Machine(1.0, 1.01, 1.02, 1.0)
    actual, _ = sample([LABELS], machine.watch(), blocks=2, rounds=3)
    assert machine.notes == 2 * "|!abcabcabcabc!"
    assert all([len(actual[label][kind]) for kind in ("warm", "cold", "discarded")] == [6, 2, 0] for label in LABELS)
    assert min(actual["a"]["warm"]) > max(actual["a"]["cold"][:1])


@pytest.mark.parametrize("moved", [(1.0, 1.06), (1.06, 1.0), (1.06, 1.06)])
def test_a_block_whose_canary_has_moved_is_discarded_and_repeated(moved: tuple[float, float]) -> None:
    machine = Machine(1.0, 1.0, *moved, 1.0, 1.0)
    actual, canaries = sample([LABELS], machine.watch(), blocks=2, rounds=2)
    assert [counts for *_, counts in canaries] == [True, False, True]
    assert all(len(actual[label]["warm"]) == 4 and len(actual[label]["discarded"]) == 2 for label in LABELS)


def test_long_solves_have_blocks_of_their_own_so_that_little_is_discarded() -> None:
    """The second block moves: only its cells are timed again."""
    parts = shares({"a": 0.4 * SHARE, "b": 0.5 * SHARE, "c": 2 * SHARE})
    assert parts == [["a", "b"], ["c"]]
    machine = Machine(1.0, 1.0, 1.0, 1.1, 1.0, 1.0)
    actual, _ = sample(parts, machine.watch(), blocks=1, rounds=2)
    assert machine.notes == "|!ababab!|!ccc!|!ccc!"
    assert [len(actual[label]["warm"]) for label in LABELS] == [2, 2, 2]
    assert [len(actual[label]["discarded"]) for label in LABELS] == [0, 0, 2]
    assert shares({}) == []


def test_repeating_has_an_end() -> None:
    machine = Machine(1.0, *(2.0 for _ in range(20)))
    actual, canaries = sample([LABELS], machine.watch(), blocks=1, rounds=1)
    assert len(canaries) == 1 + REPEATS
    assert actual["a"]["warm"] == []
    assert len(actual["a"]["discarded"]) == 1 + REPEATS


def test_the_interval_of_a_median_is_that_of_its_distribution() -> None:
    rng = np.random.default_rng(1)
    covered = 0
    for _ in range(60):
        median, low, high = interval(rng.normal(1.0, 0.1, 25).tolist())
        assert low <= median <= high
        covered += low <= 1.0 <= high
    assert 48 <= covered <= 60
    assert interval([0.5, 0.5, 0.5]) == (0.5, 0.5, 0.5)
    assert np.isnan(interval([0.5])[1])


@pytest.mark.slow
def test_the_canary_is_a_workload_of_some_size() -> None:
    assert 1e-3 < canary() < 10


@pytest.mark.slow
def test_only_what_is_known_to_be_right_is_timed(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Two cells converge, one is refused: nothing of it is timed. All samples and canaries are in the store."""
    for name, value in (("DRIFT", 1e9), ("BLOCKS", 2), ("ROUNDS", 2)):
        monkeypatch.setattr(f"studies.run.times.{name}", value)
    path = tmp_path / "three.toml"
    cross = "[[cross]]\nmeshes = {}\n[cross.scenes.{}]\n"
    path.write_text(cross.format('["2x1", "4x1"]', "cantilever") + cross.format('["7x7"]', "tyre"))
    campaign, store = find(str(path)), tmp_path / "store"
    with pytest.raises(UsageError, match="no converged cell of 'three' to time"):
        time_campaign(campaign, store)
    run(campaign, store)
    table = time_campaign(campaign, store).set_index("label")
    assert list(table.index) == ["cross cantilever 2x1", "cross cantilever 4x1"]
    assert (table["samples"] == 4).all()
    assert (table["low_s"] <= table["median_s"]).all()
    assert (table["factorisations"] > 0).all()
    assert table["operations"].is_monotonic_increasing
    raw = json.loads((store / "timing" / "three.json").read_text())
    assert [len(cell["warm"]) for cell in raw["cells"]] == [4, 4]
    assert len(raw["canaries"]) == 2
    actual = collect(store, "three").set_index("label").loc[list(table.index)]
    assert list(actual["t.seconds"]) == list(table["median_s"])
    assert list(actual["t.seconds_low"]) == list(table["low_s"])
    assert set(actual["canary"]) == {"quiet"}
    with pytest.raises(UsageError, match="no times of 'another'"):
        summary(store, "another")


@pytest.mark.slow
def test_a_machine_that_is_not_quiet_leaves_the_seconds_of_the_solve(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The command fails, and says that the canary has moved; only the cells that were asked for are marked."""
    path, store = tmp_path / "two.toml", tmp_path / "store"
    path.write_text('[[cross]]\nmeshes = ["2x1", "4x1"]\n[cross.scenes.cantilever]\n')
    run(find(str(path)), store)
    timed = ["time", str(path), "--store", str(store), "--only", "4x1"]
    before = collect(store, "two").set_index("label")["t.seconds"]
    for name, value in (("DRIFT", -1.0), ("BLOCKS", 1), ("ROUNDS", 1)):
        monkeypatch.setattr(f"studies.run.times.{name}", value)
    assert main(timed) == 1
    actual = collect(store, "two").set_index("label")
    assert dict(actual["canary"]) == {"cross cantilever 2x1": "", "cross cantilever 4x1": "moved"}
    assert list(actual["t.seconds"]) == list(before)


@pytest.mark.slow
def test_the_bench_of_the_harness_says_what_it_has_done() -> None:
    costs = harness(repeats=2)
    assert [cost.what for cost in costs] == ["cell: trivial", "cell: of about 1 s"]
    assert all(0 < cost.solve < cost.seconds for cost in costs)
    assert len(beside_solving(costs).splitlines()) == 3
