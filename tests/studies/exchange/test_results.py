"""Results from outside: tables of fields and curves, printed output, and one line for what is none."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from studies.ask.request import UsageError
from studies.exchange.of_scene import problem_of
from studies.exchange.problem import Problem
from studies.exchange.results import GROWTH, read_results


@pytest.fixture(scope="module")
def cantilever() -> Problem:
    return problem_of("cantilever", {"load_fraction": "0.5,1"}, "2x1", measure="linear")


@pytest.fixture(scope="module")
def tyre() -> Problem:
    return problem_of("tyre", {"delta_mm": "5,10"}, "8x8")


def written(path: Path, text: str) -> Path:
    path.write_text(text, encoding="utf-8")
    return path


def test_a_field_by_node_and_load(cantilever: Problem, tmp_path: Path) -> None:
    text = "load_fraction,node,ux_mm,uy_mm,uz_mm\n1,3,1,2,3\n0.5,3,0.5,1,1.5\n1,1,0,0,0\n"
    half, whole = read_results(written(tmp_path / "field.csv", text), cantilever)
    assert (half.load, whole.load) == (0.5, 1.0)
    assert half.u is not None
    assert whole.u is not None
    np.testing.assert_array_equal(whole.u[[0, 2]], [[0, 0, 0], [1, 2, 3]])
    assert np.isnan(whole.u).sum() == 3 * (len(cantilever.bricks.x) - 2)
    assert np.isnan(half.u[0]).all()


def test_a_curve_leaves_out_what_is_not_told(cantilever: Problem, tmp_path: Path) -> None:
    text = "load_fraction, tip_deflection_mm, reaction_z_N\n0.5,1.25,\n1,2.5,-4\n"
    half, whole = read_results(written(tmp_path / "curve.csv", text), cantilever)
    assert half.quantities == {"tip_deflection_mm": 1.25}
    assert whole.quantities == {"tip_deflection_mm": 2.5, "reaction_z_N": -4.0}
    assert whole.u is None


def test_what_is_no_result_is_told_in_one_line(cantilever: Problem, tmp_path: Path) -> None:
    for text, said in (
        ("", "not a table of numbers"),
        ("load_fraction,force_N\n1,two\n", "not a table of numbers"),
        ("delta_mm,force_N\n1,2\n", "no column 'load_fraction'; it has delta_mm, force_N"),
        ("load_fraction,node,ux_mm,uy_mm\n1,1,0,0\n", "no column 'uz_mm'"),
        ("load_fraction,node,ux_mm,uy_mm,uz_mm\n1,0,0,0,0\n", r"node = 0 must be a whole number in \[1, "),
        ("load_fraction,node,ux_mm,uy_mm,uz_mm\n1,1.5,0,0,0\n", r"node = 1.5 must be a whole number in \[1, "),
        ("load_fraction,node,ux_mm,uy_mm,uz_mm\n1,1000000,0,0,0\n", "is the mesh the same"),
        ("load_fraction,force_N\n1,2\n1,3\n", "has 2 rows with load_fraction = 1"),
        ("load_fraction,force_N\n,2\n", "must be finite"),
        ("load_fraction,force_N\n", "has no results"),
    ):
        with pytest.raises(UsageError, match=said) as error:
            read_results(written(tmp_path / "wrong.csv", text), cantilever)
        assert "\n" not in str(error.value)
    with pytest.raises(UsageError, match="has no results"):  # of a run that was stopped before its first step
        read_results(written(tmp_path / "out.dat", ""), cantilever)
    with pytest.raises(FileNotFoundError):
        read_results(tmp_path / "nothing.csv", cantilever)


PRINTED = """
 displacements (vx,vy,vz) for set BODY and time  {time:.7E}

         3  1.000000E+00 -2.000000E+00  3.000000E-01

 total force (fx,fy,fz) for set HELD and time  {time:.7E}

        1.000000E-08  0.000000E+00 -4.000000E+00

 total internal energy for set BODY and time  {time:.7E}

        2.500000E+01
"""


ROW, TOTAL = "         3  1.000000E+00 -2.000000E+00  3.000000E-01", "        1.000000E-08  0.000000E+00 -4.000000E+00"


def test_a_block_that_breaks_off_is_told(cantilever: Problem, tmp_path: Path) -> None:
    text = PRINTED.format(time=1.0)
    for there, instead, said in (
        (ROW, f"{ROW}\n         4  1.0", "breaks within displacements for set BODY"),
        (ROW, "         3  1.0", "breaks within displacements for set BODY"),
        (ROW, "", "breaks within displacements for set BODY"),
        (TOTAL, "", "breaks within total force for set HELD"),
        ("        2.500000E+01", "", "breaks within total internal energy for set BODY"),
        ("         3 ", "   1000000 ", "has node 1000000, the body 32; is the mesh the same"),
        ("         3 ", "         0 ", "is the mesh the same"),
    ):
        assert there in text
        with pytest.raises(UsageError, match=said):
            read_results(written(tmp_path / "out.dat", text.replace(there, instead)), cantilever)


def test_other_blocks_of_printed_output_are_left_alone(cantilever: Problem, tmp_path: Path) -> None:
    """A block that nobody asked for must not run into the one before it."""
    other = " stresses (elem, integ.pnt.,sxx) for set BODY and time  0.1000000E+01\n\n 3 9.0E+00 9.0E+00 9.0E+00\n"
    mixed = PRINTED.format(time=1.0).replace(" total force", f"{other}\n total force")
    (actual,) = read_results(written(tmp_path / "out.dat", mixed), cantilever)
    assert actual.u is not None
    np.testing.assert_array_equal(actual.u[2], [1.0, -2.0, 0.3])


def test_printed_output_of_two_steps(cantilever: Problem, tmp_path: Path) -> None:
    text = PRINTED.format(time=1.0) + PRINTED.format(time=2.0)
    half, whole = read_results(written(tmp_path / "out.dat", text), cantilever)
    assert (half.load, whole.load) == (0.5, 1.0)
    assert whole.quantities["strain_energy_Nmm"] == 25.0
    assert whole.quantities["reaction_z_N"] == -4.0
    assert whole.u is not None
    np.testing.assert_array_equal(whole.u[2], [1.0, -2.0, 0.3])


def test_loads_on_held_nodes_are_no_reactions(tmp_path: Path) -> None:
    """The point forces of the hemisphere stand on its planes of symmetry, and are printed with them."""
    problem = problem_of("hemisphere", {"load_fraction": "1"}, "2x2", measure="linear")
    text = PRINTED.format(time=1.0).replace("1.000000E-08  0.000000E+00 -4.000000E+00", " 0.0 0.0 0.0")
    (actual,) = read_results(written(tmp_path / "out.dat", text), problem)
    reaction = [actual.quantities[f"reaction_{axis}_N"] for axis in "xyz"]
    np.testing.assert_allclose(reaction, -problem.steps[0].forces.sum(axis=0), atol=1e-12)


def test_energy_of_nonlinear_steps_is_left_out(tmp_path: Path) -> None:
    problem = problem_of("cantilever", {"load_fraction": "1"}, "2x1")
    (actual,) = read_results(written(tmp_path / "out.dat", PRINTED.format(time=1.0)), problem)
    assert "strain_energy_Nmm" not in actual.quantities


def test_the_travel_of_a_tyre_counts_from_its_own_first_touch(tyre: Problem, tmp_path: Path) -> None:
    assert tyre.crown is not None
    assert tyre.touched is not None
    growth, blocks = -1.5, []
    for time, force in ((1.0, 0.0), (2.0, -100.0), (3.0, -300.0)):
        crown = f"{tyre.crown + 1:10d} {growth:.6E} 0.0 0.0"
        blocks.append(f" displacements (vx,vy,vz) for set BODY and time {time:.7E}\n\n{crown}\n")
        blocks.append(f" total force (fx,fy,fz) for set PLANE and time {time:.7E}\n\n {force:.6E} 0.0 0.0\n")
    actual = read_results(written(tmp_path / "out.dat", "\n".join(blocks)), tyre)
    first = tyre.bricks.x[tyre.crown, 0] + growth
    assert [each.load for each in actual] == pytest.approx([5 + first - tyre.touched, 10 + first - tyre.touched])
    assert [each.quantities["plane_force_N"] for each in actual] == [100.0, 300.0]


def test_the_growth_of_a_tyre_that_is_inflated_alone_is_that_of_its_crown(tmp_path: Path) -> None:
    problem = problem_of("tyre", {"delta_mm": "0"}, "8x8")
    assert problem.crown is not None
    text = f" displacements (vx,vy,vz) for set BODY and time 1.0\n\n{problem.crown + 1:10d} -1.5 0.25 0.1\n"
    (actual,) = read_results(written(tmp_path / "out.dat", text), problem)
    assert actual.load == 0.0
    assert actual.quantities == {GROWTH: pytest.approx(-1.5)}
