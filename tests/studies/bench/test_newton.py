"""What ``footprint bench newton`` and ``scaling`` measure, on meshes too small to time, and wrong use of all tables."""

from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from studies import cli
from studies.bench.newton import FLOORS, MESHES, TIMES, Pressed, exponents, lines, pressed, request_of, scaling
from studies.cli import WRONG_USE, main
from studies.scenes.tyre.scene import Tyre

ROUNDING = 1e-12  # relative


@pytest.fixture(scope="module")
def table() -> pd.DataFrame:
    told: list[tuple[int, str]] = []
    found = scaling(("6x6", "8x6"), lambda done, _, label: told.append((done, label)), coarse="8x6", seconds=0.0)
    assert told == [(0, "8x6 into contact"), (0, "6x6"), (1, "8x6"), (2, "done")]
    return found


@pytest.mark.slow
def test_one_row_a_mesh_with_times_floors_and_memory(table: pd.DataFrame) -> None:
    assert table[["mesh", "dofs", "elements"]].to_numpy().tolist() == [["6x6", 180, 36], ["8x6", 252, 48]]
    assert (table[[f"{name}_s" for name in (*TIMES, "analysis", "superlu", *set(FLOORS.values()))]] > 0).all(axis=None)
    assert (table["backward_error"] <= 1e-13).all()
    assert table["peak_GiB"].between(0.02, 4).all()
    assert (table["assembly_s"] >= table["scatter_s"]).all()
    plain, full = (list(lines(table, floors=floors)) for floors in (False, True))
    assert len(plain) == 4
    assert "(" not in plain[1]
    assert full[1].count("(") == len(TIMES)
    assert "copy of 100 MB" in full[-1]


def test_planted_exponents_are_found_and_small_sizes_do_not_count() -> None:
    for p in (1.0, 1.5):
        sizes = np.array([2_000, 10_000, 40_000, 250_000])
        planted = pd.DataFrame({"dofs": sizes, **{f"{part}_s": 1e-7 * sizes**p for part in TIMES}})
        planted.loc[0, "total_s"] *= 50
        assert exponents(planted) == pytest.approx(dict.fromkeys(TIMES, p))
        assert np.isnan(exponents(planted[:2])["total"])


def test_the_state_on_its_own_mesh_is_itself_and_on_a_finer_one_presses_as_much() -> None:
    coarse_model, model = (Tyre().build(request_of(mesh)) for mesh in ("8x6", "16x12"))
    coarse, (_, state) = Pressed.of(coarse_model), pressed(coarse_model)
    u, pressure = coarse.on(coarse_model)
    np.testing.assert_allclose(u, state.u, rtol=0, atol=ROUNDING * np.abs(state.u).max())
    np.testing.assert_allclose(pressure, state.pressure, rtol=0, atol=ROUNDING * state.pressure.max())
    u, pressure = coarse.on(model)
    assert np.abs(u).max() == pytest.approx(np.abs(state.u).max(), rel=0.05)
    assert pressure.max() == pytest.approx(state.pressure.max())
    assert (pressure > 0).sum() > (state.pressure > 0).sum()


@pytest.mark.slow
def test_the_command_prints_and_writes(table: pd.DataFrame, monkeypatch, capsys, tmp_path: Path) -> None:
    asked: list[list[str]] = []
    monkeypatch.setattr("studies.bench.newton.scaling", lambda meshes, _: asked.append(list(meshes)) or table)
    target = tmp_path / "scaling.csv"
    assert main(["bench", "scaling", "--machine", "floors", "--table", str(target)]) == cli.OK
    assert "exponent" in capsys.readouterr().out
    assert pd.read_csv(target).columns.tolist() == table.columns.tolist()
    assert main(["bench", "scaling", "--mesh", "6x6,8x6"]) == cli.OK
    assert asked == [list(MESHES), ["6x6", "8x6"]]


def test_wrong_use_of_a_benchmark_is_one_line(capsys: pytest.CaptureFixture[str]) -> None:
    for arguments, words in (
        ("scaling --mesh 6x6,7x6", "mesh 7x6: both numbers must be even"),
        ("scaling --mesh 6x6,,8x6", "mesh '' must be N1xN2"),
        ("scaling --mesh 4000x4000", "at most"),
        ("--rounds 0", "rounds = 0"),
        ("newton --repeats 0", "repeats = 0"),
        ("overhead --repeats 0", "repeats = 0"),
        ("newton --mesh 7x6", "both numbers must be even"),
    ):
        assert main(["bench", *arguments.split()]) == WRONG_USE
        said = capsys.readouterr().err
        assert words in said
        assert said.count("\n") == 1


def test_options_of_other_tables_are_refused(capsys: pytest.CaptureFixture[str]) -> None:
    others = ("scaling --repeats 3", "--machine floors", "--mesh 6x6", "overhead --mesh 6x6", "all")
    for arguments in others:
        with pytest.raises(SystemExit) as error:
            main(["bench", *arguments.split()])
        assert error.value.code == WRONG_USE
        assert capsys.readouterr().err.count("\n") == 1
