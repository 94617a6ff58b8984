"""Other programs beside shells: what is skipped, what is measured, and that they solve the same problems."""

import importlib.util
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from studies.bench import peers
from studies.bench.peers import lines, measured, shown, unit_of
from studies.bench.problems import LINEAR_SHELLS, Line, LinearShell, Solved, problems, size
from studies.cli import main


def test_without_the_extra_one_line_says_what_to_install(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(importlib.util, "find_spec", lambda name: None)
    assert main(["bench", "peers"]) == 2
    assert (
        capsys.readouterr().err
        == "footprint: peers need the extra peers: pip install -e '.[peers]' in the checkout of Footprint\n"
    )
    _, skipped = peers.available()
    assert skipped[0] == "ngsolve is skipped: no module ngsolve (extra peers)"
    assert skipped[1].startswith("kratos is skipped: no module KratosMultiphysics, ")


def planted(problem: str, values: dict[str, Solved]) -> Line:
    return Line(problem, "made up", "one", tuple(values), values.__getitem__)


def test_errors_are_against_the_reference_and_units_over_the_unit() -> None:
    for only in ("hemisphere", "cantilever", "tyre, isotropic"):
        at = problems()[only].reference
        solves = {"a": Solved(1.01 * at, 10, 3, 4.0, 1.0, 2.0, 0.5), "b": Solved(at, 20, 4, 8.0, 1.0, 2.0, 0.5)}
        table = measured([planted(only, solves)], lambda: 2.0, rounds=2)
        assert table["error"].to_numpy() == pytest.approx([0.01, 0.0])
        assert table[["units", "runs"]].to_numpy().tolist() == [[2.0, 2], [4.0, 2]]
        assert len(shown(table).splitlines()) == 3


def test_a_long_solve_is_not_repeated_and_medians_are_taken_of_the_others() -> None:
    seconds = iter([1.0, 30.0, 5.0, 2.0])
    line = Line(
        "hemisphere", "made up", "one", ("short", "long"), lambda mesh: Solved(8.0, 10, 3, next(seconds), 0.0, 0.0, 0.0)
    )
    table = measured([line], lambda: 1.0, rounds=3)
    assert table[["seconds", "runs"]].to_numpy().tolist() == [[2.0, 3], [30.0, 1]]


def test_references_are_not_ours() -> None:
    known = problems()
    assert known["hemisphere"].reference == 8.178  # Sze, Liu, Lo, table 3.4
    assert known["sze-pullout"].reference == 2.768
    assert known["cantilever"].reference == pytest.approx(6.69964)
    assert known["tyre, isotropic"].reference == pytest.approx(523.76)


def test_every_problem_has_a_line_of_ours_and_parts_add_up_to_no_more_than_the_whole() -> None:
    assert {line.problem for line in lines()} == problems().keys()
    nodal = "hemisphere", "thickness strain at nodes"
    solution = next(line for line in lines() if (line.problem, line.family) == nodal).solve("8x8")
    assert solution.seconds >= solution.start + solution.assembly + solution.factorisation > 0
    assert solution.value == pytest.approx(problems()["hemisphere"].reference, rel=0.1)
    assert 0 < unit_of("8x8")() < 1  # one factorisation


@pytest.mark.slow
def test_the_shell_meets_the_solid() -> None:
    line = next(line for line in lines() if line.family == "element paper")
    solution = line.solve("36x34")
    assert solution.value == pytest.approx(problems()["tyre, isotropic"].reference, rel=0.003)
    assert solution.unknowns < 2000


@pytest.mark.slow
def test_ngsolve_solves_the_same_tyre() -> None:
    pytest.importorskip("ngsolve")
    from studies.bench.ngsolve_tyre import Isotropic, tyre

    shell = next(line for line in lines() if line.family == "element paper").solve("36x34")
    solid = tyre("5x4", 10.0, Isotropic(), 3)
    assert solid.value == pytest.approx(shell.value, rel=0.05)
    assert solid.seconds == pytest.approx(solid.start + solid.assembly + solid.factorisation)


@pytest.mark.slow
def test_plies_of_one_isotropic_material_are_an_isotropic_wall() -> None:
    """Law, axes and layers of the plies against two Lame constants; a quarter against the whole."""
    pytest.importorskip("ngsolve")
    from studies.bench.ngsolve_tyre import AnglePlies, Isotropic, tyre

    E, nu, G = 20.0, 0.45, 20.0 / 2.9
    plies = AnglePlies(ply=(E, E, G, G, nu, nu), layers=1)
    whole = tyre("8x8", 10.0, plies, 2).value
    assert whole == pytest.approx(tyre("8x8", 10.0, Isotropic(share=1), 2).value, rel=1e-6)
    assert whole == pytest.approx(tyre("4x4", 10.0, Isotropic(), 2).value, rel=1e-6)


def test_stiffness_of_plies_is_that_of_the_shell() -> None:
    pytest.importorskip("ngsolve")
    from formulations.section.laminate import Ply
    from studies.bench.ngsolve_tyre import AnglePlies

    wall = AnglePlies()
    voigt = [0, 1, 3, 2, 4, 5]  # L, T, LT, N, LN, TN
    stiffness = wall.stiffness()[np.ix_(voigt, voigt)]
    assert stiffness == pytest.approx(Ply(*wall.ply, 0.0, 1.2).stiffness(), rel=1e-9, abs=1e-9)


@pytest.mark.slow
@pytest.mark.parametrize("kind", ["thick quadrilaterals", "thin quadrilaterals", "thick triangles"])
@pytest.mark.parametrize(("problem", "mesh", "within"), [("cantilever", "16x2", 2e-3), ("hemisphere", "16x16", 0.04)])
def test_kratos_bends_the_same_shells(problem: str, kind: str, mesh: str, within: float) -> None:
    pytest.importorskip("KratosMultiphysics.StructuralMechanicsApplication")
    pytest.importorskip("KratosMultiphysics.LinearSolversApplication")
    from studies.bench.kratos_shells import fewest_steps, shell

    actual = shell(problem, kind, mesh)
    assert actual.value == pytest.approx(problems()[problem].reference, rel=within)
    assert actual.seconds >= actual.factorisation > 0
    assert fewest_steps(problem, kind, size(mesh)) >= 1


@pytest.mark.slow
@pytest.mark.parametrize("each", LINEAR_SHELLS, ids=lambda each: each.name)
def test_kratos_agrees_on_linear_shells(each: LinearShell) -> None:
    """On the finest mesh within what ours leaves there; supports, loads and walls are read off the scene."""
    pytest.importorskip("KratosMultiphysics.StructuralMechanicsApplication")
    pytest.importorskip("KratosMultiphysics.LinearSolversApplication")
    from studies.bench.kratos_shells import linear

    own = next(line for line in lines() if line.problem == each.name).solve(each.meshes[-1]).value
    assert linear(each, each.meshes[-1]).value == pytest.approx(own, rel=0.03)


def test_one_problem_may_be_chosen(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    made_up = planted("hemisphere", {"4x4": Solved(8.0, 10, 3, 4.0, 1.0, 2.0, 0.5)})
    monkeypatch.setattr(peers, "available", lambda: ((made_up,), ("kratos is skipped",)))
    monkeypatch.setattr("studies.bench.peers.unit_of", lambda: lambda: 1.0)
    target = tmp_path / "peers.csv"
    assert main(["bench", "peers", "--only", "hemisphere", "--rounds", "1", "--table", str(target)]) == 0
    assert capsys.readouterr().out.startswith("kratos is skipped\n")
    assert list(pd.read_csv(target)["mesh"]) == ["4x4"]
    assert main(["bench", "peers", "--only", "roof"]) == 2
    assert "'roof' must be one of hemisphere" in capsys.readouterr().err
