"""What ``footprint bench`` measures, on meshes too small to time: its lines, its matrices and its exit code."""

import numpy as np
import pandas as pd
import pytest

from contact.solvers.multifrontal import SYMMETRIC
from contact.solvers.sparse import asymmetry
from studies import cli
from studies.bench.costs import BROKEN, COLUMNS, COMMAND, HOLDS, SOLVE, SOLVES, at_rest, costs, shell_of
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
    found = units.groupby("group", sort=False)["line"].apply(list)
    kinds = [f"factorisation of 252 unknowns, {kind}" for kind in ("definite", "not symmetric")]
    assert [found[kind] for kind in kinds] == [["fronts", "splu"]] * 2
    exact = ["semismooth", "lcp", "qp"]
    others = ["trial-and-error", "regularised", "augmented-lagrangian"]
    worth = ["lcp, system=full", "qp, system=full", "semismooth, solver=splu"]
    assert found[SOLVES] == [*exact, *others, *worth]
    assert found[COMMAND][-1] == SOLVE


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
