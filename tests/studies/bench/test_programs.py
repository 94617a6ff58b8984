"""Other programs on decks of ours: what is said without one, what is kept of a run, and why values differ."""

import re
import shutil
from collections.abc import Iterable
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from studies.analysis.everything import fitted
from studies.analysis.uncertainty import agreement
from studies.ask.request import UsageError
from studies.bench import programs
from studies.bench.peers import CASES
from studies.bench.programs import Case
from studies.cli import main
from studies.exchange.deck import ELEMENTS
from studies.exchange.of_scene import problem_of
from studies.exchange.problem import Problem
from studies.exchange.results import Found
from studies.scenes import SCENES
from studies.scenes.tyre.scene import ISOTROPIC
from support.stores.experiments import CHOSEN, FINE, made_up_programs

BEAM = Case("cantilever", ("2x1", "4x1"), "4x1", {"load_fraction": "0.5,1"})


class Planted:
    """A program that finds our own tip, ``off`` times too much, and counts how often it is run."""

    def __init__(self, off: float) -> None:
        self.off, self.runs = off, 0

    def __call__(self, lines: Iterable[str], problem: Problem) -> list[Found]:
        self.runs += 1
        assert "*HEADING" in lines
        record = {0.5: 4.92, 1.0: 6.7}
        return [Found(load, {"tip_deflection_mm": self.off * value}) for load, value in record.items()]


@pytest.fixture
def planted(monkeypatch: pytest.MonkeyPatch) -> Planted:
    program = Planted(1.1)
    monkeypatch.setattr(programs, "found_by", program)
    monkeypatch.setattr(programs, "version", lambda: "ccx 2.20")
    return program


def test_a_row_a_quantity_a_load_and_a_mesh_that_is_run_once(
    planted: Planted, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    table = programs.measured([BEAM], tmp_path)
    assert list(zip(table["mesh"], table["load"], strict=True)) == [(m, f) for m in BEAM.meshes for f in (0.5, 1.0)]
    np.testing.assert_allclose(table["difference"], table["theirs"] / table["ours"] - 1)
    np.testing.assert_allclose(table["theirs"], 1.1 * np.array([4.92, 6.7, 4.92, 6.7]))
    assert set(table["elements"]) == {ELEMENTS["full"]}  # in a single row
    assert table["reference"].iloc[1] == pytest.approx(6.69964)
    assert len(programs.shown(table).splitlines()) == 5
    (tmp_path / "programs" / "cantilever-4x1.csv").unlink()  # stopped there
    again = programs.measured([BEAM], tmp_path)
    pd.testing.assert_frame_equal(again.drop(columns="seconds"), table.drop(columns="seconds"))
    assert planted.runs == 3
    monkeypatch.setattr(programs, "version", lambda: "ccx 2.21")
    programs.measured([BEAM], tmp_path)
    assert planted.runs == 5


def test_reasons_are_found_in_the_numbers() -> None:
    table = made_up_programs()
    record = {name: list(own["reason"]) for name, own in table.groupby("case")}
    assert record["hemisphere"] == [programs.MESH] * 2
    assert record["tyre, isotropic"] == [programs.MESH, ""]
    assert record["tyre, angle plies, inflated"] == [programs.PLIES] * 2
    assert record["ring"] == [programs.OPEN] * 2  # it grows
    rates = table[table["mesh"] == FINE].set_index("case")["rate"]
    assert rates["hemisphere"] == pytest.approx(2.0)
    assert rates["ring"] == pytest.approx(np.log2(0.02 / 0.03))


@pytest.mark.slow
def test_cases_are_scenes_that_can_be_exported() -> None:
    assert len({case.of for case in CASES}) >= 6
    assert len({case.name for case in CASES}) == len(CASES)
    for case in CASES:
        assert case.of in SCENES
        problem = problem_of(case.of, case.settings, case.meshes[0], measure=case.measure)
        assert problem.steps


def test_the_finest_mesh_of_each_case_stands_in_the_table() -> None:
    actual = agreement(made_up_programs())
    assert set(actual["mesh"]) == {FINE}
    assert set(actual["case"]) == set(CHOSEN)


def test_without_a_table_there_is_no_agreement() -> None:
    assert fitted({}.get) == {}
    assert set(fitted({"programs": made_up_programs()}.get)) == {"program_agreement"}


# --- the command ----------------------------------------------------------------------------------------------------


def test_without_the_program_or_the_case_one_line_says_what_is_missing(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(shutil, "which", lambda name: None)
    assert main(["bench", "programs", "--store", str(tmp_path / "store")]) == 2
    assert capsys.readouterr().err == f"footprint: {programs.ABSENT}\n"
    assert not (tmp_path / "store").exists()
    assert main(["bench", "programs", "--only", "moon", "--store", str(tmp_path)]) == 2
    assert "--only 'moon' must be one of 'scordelis-lo'" in capsys.readouterr().err


@pytest.mark.parametrize(("off", "code"), [(1.0, 0), (1.1, 1)])
def test_the_table_goes_to_the_store_and_what_has_no_reason_fails(
    off: float, code: int, planted: Planted, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    planted.off = off
    monkeypatch.setattr("studies.bench.peers.CASES", [Case("cantilever", ("8x1",), "16x1", BEAM.settings)])
    assert main(["bench", "programs", "--store", str(tmp_path)]) == code
    assert len(pd.read_csv(tmp_path / "tables" / "programs.csv")) == 2


# --- what stands for the programs themselves -------------------------------------------------------------------------


@pytest.mark.slow
def test_one_direction_a_brick_changes_a_wall_of_plies_and_no_isotropic_one() -> None:
    plies = problem_of(
        "tyre", {"load": "follower", "pressure_area": "face", "delta_mm": "0", "gamma_deg": "0"}, "14x18"
    )
    isotropic = problem_of("tyre", {**ISOTROPIC, "delta_mm": "0"}, "14x18")
    each, one = (programs.inflated_equator(plies, held=held) for held in (False, True))
    assert one > 1.005 * each  # cords that leave their wall are softer, and this wall grows
    each, one = (programs.inflated_equator(isotropic, held=held) for held in (False, True))
    assert one == pytest.approx(each, rel=1e-9)


@pytest.mark.slow
@pytest.mark.skipif(shutil.which(programs.COMMAND) is None, reason="needs CalculiX: Debian's package calculix-ccx")
def test_calculix_is_run_and_its_failure_is_one_line() -> None:
    problem = problem_of("cantilever", {"load_fraction": "1"}, "2x1", measure="linear")
    assert re.fullmatch(r"ccx \d+\.\d+", programs.version())
    with pytest.raises(UsageError, match="CalculiX does not come to the end of cantilever"):
        programs.found_by(["*NODE", "1, 0., 0., 0.", "*STEP", "*STATIC", "*END STEP"], problem)
