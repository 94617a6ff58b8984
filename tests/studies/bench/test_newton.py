"""What ``footprint bench newton`` and ``scaling`` measure, on meshes too small to time, and wrong use of all tables."""

import numpy as np
import pandas as pd
import pytest

from studies import cli
from studies.bench.newton import MESHES, TIMES, exponents, scaling, shown
from studies.cli import WRONG_USE, main
from studies.run.task import status_MB


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
