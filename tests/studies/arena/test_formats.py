"""Exported problems, read by whoever reads them: the same problem, and the same answer where a solver is at hand."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scipy import io, sparse

from contact.interchange.linearised_step import FrozenStep
from studies.arena.answers import accuracy
from studies.arena.collected.candidates import of_complementarity
from studies.arena.collected.formats import FORMATS, export, read_lcp
from studies.ask.request import UsageError
from support.problems.contact_problems import known_step, lopsided


def test_maros_meszaros_arrays(tmp_path: Path) -> None:
    step, du, pressure = known_step()
    export(step, "mat", tmp_path / "p.mat")
    arrays = io.loadmat(tmp_path / "p.mat")
    P, q, A, low = (
        sparse.csc_matrix(arrays["P"]),
        arrays["q"].ravel(),
        sparse.csc_matrix(arrays["A"]),
        arrays["l"].ravel(),
    )
    assert (int(arrays["n"].item()), int(arrays["m"].item())) == (len(du), len(pressure))
    assert np.all(np.isinf(arrays["u"]))
    forces = step.weights * pressure
    assert np.linalg.norm(P @ du + q - A.T @ forces) <= 1e-12 * np.linalg.norm(q)
    assert np.all(A @ du - low >= -1e-12)
    assert abs(forces @ (A @ du - low)) <= 1e-12 * np.linalg.norm(q)


def test_mps_is_read_and_solved_by_another_program(tmp_path: Path) -> None:
    highspy = pytest.importorskip("highspy")
    step, du, pressure = known_step()
    export(step, "mps", tmp_path / "p.mps")
    solver = highspy.Highs()
    for key, value in {"output_flag": False, "qp_regularization_value": 0.0}.items():
        solver.setOptionValue(key, value)
    assert solver.readModel(str(tmp_path / "p.mps")) == highspy.HighsStatus.kOk
    solver.run()
    solution = solver.getSolution()
    assert np.allclose(solution.col_value, du, rtol=0, atol=1e-6 * np.abs(du).max())
    assert np.allclose(
        solution.row_dual, step.weights * pressure, rtol=0, atol=1e-6 * np.abs(step.weights * pressure).max()
    )


def test_mps_says_the_problem(tmp_path: Path) -> None:
    """Read by its sections: the quadratic part is the lower triangle of K."""
    step, _, _ = known_step()
    export(step, "mps", tmp_path / "p.mps")
    lines = (tmp_path / "p.mps").read_text(encoding="ascii").splitlines()
    quadratic = [line.split() for line in lines[lines.index("QUADOBJ") + 1 : lines.index("ENDATA")]]
    K = np.zeros(step.K.shape)
    for column, row, value in quadratic:
        K[int(row[1:]), int(column[1:])] = K[int(column[1:]), int(row[1:])] = float(value)
    assert np.array_equal(K, step.K.toarray())
    between = [line.split() for line in lines[lines.index("COLUMNS") + 1 : lines.index("RHS")]]
    assert [float(value) for _, row, value in between if row == "obj"] == step.r.tolist()


def test_qpsolvers_arrays(tmp_path: Path) -> None:
    step, _, _ = known_step()
    export(step, "qpsolvers", tmp_path / "p.npz")
    with np.load(tmp_path / "p.npz", allow_pickle=True) as file:
        arrays = {"P": step.K.toarray(), "q": step.r, "G": -step.G.toarray(), "h": step.gap}
        assert all(np.array_equal(file[name], value) for name, value in arrays.items())
        assert [file[name].item() for name in ("A", "b", "lb", "ub")] == [None] * 4
    read = pytest.importorskip("qpsolvers").Problem.load(tmp_path / "p.npz")
    assert np.array_equal(read.h, step.gap)
    assert read.A is None


def test_matrix_market_says_the_problem(tmp_path: Path) -> None:
    step = lopsided(known_step()[0])
    step = FrozenStep(**{**vars(step), "meta": {"name": "lopsided"}})
    export(step, "mtx", tmp_path / "p")
    assert np.array_equal(io.mmread(tmp_path / "p" / "K.mtx").toarray(), step.K.toarray())
    assert np.array_equal(io.mmread(tmp_path / "p" / "gap.mtx").ravel(), step.gap)
    head = json.loads((tmp_path / "p" / "problem.json").read_text(encoding="utf-8"))
    assert head == {"name": "lopsided", "scale": step.scale}


def test_the_forces_of_siconos_text_are_those_of_the_step(tmp_path: Path) -> None:
    step, _, pressure = known_step()
    export(step, "siconos", tmp_path / "p.dat")
    M, q = read_lcp(tmp_path / "p.dat")
    forces = step.weights * pressure
    assert accuracy(of_complementarity(M, q), forces, np.maximum(M @ forces + q, 0)).worst <= 1e-12


def test_what_a_format_cannot_have_is_refused(tmp_path: Path) -> None:
    step, _, _ = known_step()
    coupled = replace(step, coupling=sparse.csr_matrix(np.diag(step.weights)))
    for other, form, why in (
        (coupled, "siconos", "need lumped coupling"),
        *((lopsided(step), form, "not symmetric") for form in ("mat", "mps", "qpsolvers")),
        (step, "sif", "format 'sif' must be one of mat, qpsolvers, mps, mtx, siconos"),
    ):
        with pytest.raises(UsageError, match=why):
            export(other, form, tmp_path / "p")
        assert not list(tmp_path.iterdir())
    (tmp_path / "there").write_text("", encoding="utf-8")
    for form in FORMATS:
        with pytest.raises(UsageError, match="there already"):
            export(step, form, tmp_path / "there")


def test_what_is_no_problem_of_siconos_is_refused(tmp_path: Path) -> None:
    for text in ("", "2 1 2 2 2 2 1 0 0 1 1 1", "2 0 3 3 3 3 1 0 0 1 1 1", "2 0 2 2 2 2 1 0 0 1 1", "two"):
        (tmp_path / "p.dat").write_text(text, encoding="utf-8")
        with pytest.raises(UsageError, match="Siconos"):
            read_lcp(tmp_path / "p.dat")
