"""What ``footprint bench`` measures, on meshes too small to time: its lines, its matrices and its exit code."""

from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from contact.solvers.multifrontal import SYMMETRIC
from contact.solvers.sparse import asymmetry
from studies import cli
from studies.bench.costs import (
    AT_LEAST,
    BEYOND,
    COMMAND,
    FORCE_OFF,
    NODES_OFF,
    PARTS,
    SOLVE,
    SOLVES,
    at_rest,
    costs,
    shell_of,
    shifted,
    with_pardiso,
)
from studies.bench.rounds import BROKEN, COLUMNS, HOLDS, PART
from studies.cli import main

MESH = "8x6"


@pytest.fixture(scope="module")
def tangent():
    return at_rest(shell_of(MESH))


def test_shifted_tangents_have_the_inertia_that_is_said(tangent) -> None:
    A, negative = shifted(tangent)
    assert np.linalg.eigvalsh(tangent.toarray())[0] > 0
    assert np.sum(np.linalg.eigvalsh(A.toarray()) < 0) == negative >= AT_LEAST
    np.testing.assert_array_equal(A.indices, tangent.indices)


def test_the_other_section_has_a_tangent_that_is_not_symmetric(tangent) -> None:
    assert asymmetry(tangent) < SYMMETRIC < 1e-6 < asymmetry(at_rest(shell_of(MESH, section="nonsymmetric")))


@pytest.mark.parametrize(("definite", "symmetric"), [(True, True), (False, True), (False, False)])
def test_pardiso_solves_what_it_is_given(tangent, definite: bool, symmetric: bool) -> None:
    pytest.importorskip("pypardiso")
    from studies.bench.costs import Pardiso

    A = tangent if definite else shifted(tangent)[0]
    if not symmetric:
        A = at_rest(shell_of(MESH, section="nonsymmetric"))
    b = np.linspace(-1, 1, A.shape[0])
    x = Pardiso(A, definite=definite, symmetric=symmetric).factorised().solve(b)
    np.testing.assert_allclose(A @ x, b, rtol=0, atol=1e-9)


@pytest.fixture(scope="module")
def table() -> pd.DataFrame:
    return costs(1, sizes=(MESH,), mesh="12x12")


@pytest.mark.slow
def test_all_that_is_asked_for_is_measured(table) -> None:
    units = table[table["what"] == "units"]
    assert (units["median"] > 0).all()
    found = units.groupby("group", sort=False)["line"].apply(list)
    solvers = ["fronts", "splu", *["PARDISO"] * with_pardiso()]
    assert [found[f"factorisation of 252 unknowns, {kind}"] for kind in ("definite", "indefinite")] == [solvers] * 2
    exact = ["semismooth", "lcp", "qp"]
    others = ["trial-and-error", "regularised", "augmented-lagrangian"]
    worth = ["lcp, system=full", "qp, system=full", "semismooth, solver=splu"]
    assert found[SOLVES] == [*exact, *others, *worth]
    assert found[COMMAND][-1] == SOLVE


@pytest.mark.slow
def test_what_is_no_time_holds_on_any_mesh(table) -> None:
    """Backward errors, inertia, factorisations, forces and sets; the reference of a force is another line's solve."""
    barred = table[table["at_most"].notna() & table["holds"].ne("")]
    counted = barred[~barred["what"].str.startswith("x ") & (barred["what"] != "units")]
    assert (counted["holds"] == HOLDS).all()
    bars = counted.groupby("what")["line"].nunique()
    assert [bars[what] for what in (BEYOND, FORCE_OFF, NODES_OFF, "wrong inertia")] == [4, 6, 6, 1]
    forces = table[table["what"] == "force_N"].set_index("line")["median"]
    assert forces["regularised"] == pytest.approx(forces["semismooth"], rel=1e-5)
    assert forces["regularised"] != pytest.approx(forces["semismooth"], rel=1e-9)  # its law is another


@pytest.mark.slow
def test_the_parts_of_a_solve_are_all_of_it(table) -> None:
    own = table[(table["group"].isin([SOLVES, COMMAND])) & table["what"].str.startswith(PART)]
    for line, parts in own.groupby("line"):
        named = [*PARTS, "rest", *["start and files"] * (line == SOLVE)]
        assert sorted(parts["what"]) == sorted(f"{PART}{name}" for name in named)
        assert (parts["median"] > 0).all()
        (whole,) = table[(table["line"] == line) & (table["what"] == "units")]["median"]
        assert 0.9 * whole < parts["median"].sum() <= whole * (1 + 1e-9)


@pytest.mark.parametrize(("verdicts", "code"), [(("", HOLDS), cli.OK), ((HOLDS, BROKEN), cli.FAILED)])
def test_the_command_prints_writes_and_fails_with_a_bar(verdicts, code, monkeypatch, capsys, tmp_path: Path) -> None:
    asked = []

    def measured(rounds: int, largest: bool, progress: object) -> pd.DataFrame:
        asked.append((rounds, largest))
        rows = [("g", f"line {i}", "units", 1.0, 1.0, 2.0, 1.5, word) for i, word in enumerate(verdicts)]
        return pd.DataFrame(rows, columns=list(COLUMNS))

    monkeypatch.setattr("studies.bench.costs.costs", measured)
    target = tmp_path / "costs.csv"
    assert main(["bench", "--rounds", "2", "--largest", "--table", str(target)]) == code
    assert asked == [(2, True)]
    said = capsys.readouterr().out
    assert "1 [1, 2]" in said
    assert ("PARDISO: skipped" in said) is not with_pardiso()
    assert pd.read_csv(target).columns.tolist() == list(COLUMNS)
