"""Exported problems, read by whoever reads them: the same problem, and the same answer where a solver is at hand.

``footprint solve --freeze`` and ``footprint resolve``: the last contact problem of a tyre, alone.
"""

from __future__ import annotations

import json
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import pytest
from scipy import io, sparse

from contact.algorithms.semismooth import Semismooth
from contact.catalogue import ALGORITHMS, is_exact
from contact.interchange.linearised_step import FrozenStep
from contact.interchange.oracle import Confirmation, confirm, minimise
from contact.problem import ContactProblem, ContactSolution
from studies.arena.answers import accuracy
from studies.arena.collected.candidates import of_complementarity
from studies.arena.collected.formats import FORMATS, export, read_lcp
from studies.arena.replay import algorithm_of, read_step, resolve_step
from studies.ask.request import UsageError
from studies.cli import main
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


FORCE = 1e-9
MESH = ["--mesh", "16x16", "--model", "full"]


@pytest.fixture(scope="module")
def frozen(tmp_path_factory) -> Path:
    """A tyre pressed to 8 mm; result in its folder, the step beside."""
    out = tmp_path_factory.mktemp("frozen")
    tyre = ["solve", "tyre", *MESH, "--set", "delta_mm=4,8", "--set", "element=paper"]
    assert main([*tyre, "--out", str(out / "result"), "--freeze", str(out / "step.npz")]) == 0
    return out


def test_meta_tells_where_the_step_is_from(frozen) -> None:
    meta = FrozenStep.read(frozen / "step.npz").meta
    assert (meta["scene"], meta["stage"], meta["parameter"], meta["mesh"]) == ("tyre", "press", 8.0, "16x16")
    assert meta["settings"]["membrane"] == "compatible"
    assert set(meta) >= {"measure", "contact", "newton", "outcome", "from", "version", "commit"}


def test_a_step_of_a_part_of_the_tyre_says_so(frozen, tmp_path) -> None:
    part = tmp_path / "part.npz"
    solved = ["solve", "tyre", "--mesh", "8x8", "--set", "delta_mm=4", "--out", str(tmp_path / "out")]
    assert main([*solved, "--freeze", str(part)]) == 0
    note = "of the model half alone: forces and nodes are those of that part"
    whole, half = (resolve_step(read_step(path), algorithm_of("semismooth")) for path in (frozen / "step.npz", part))
    assert note in half.lines()
    assert not any("alone" in line for line in whole.lines())


def test_what_an_algorithm_overwrites_is_not_what_is_judged() -> None:
    step = known_step()[0]

    class Overwrites(Semismooth):
        def solve(self, problem: ContactProblem, start: ContactSolution) -> ContactSolution:
            problem.gap_jacobian(start.u).data[:] *= 2
            return super().solve(problem, start)

    assert resolve_step(step, Semismooth()).sound
    assert not resolve_step(step, Overwrites()).sound


@pytest.mark.parametrize(("scene", "mesh"), [("panel", "4x4"), ("plate-contact", "16x1")])
def test_a_step_frozen_at_its_answer_is_sound(scene: str, mesh: str, tmp_path: Path) -> None:
    """Nothing is left to move but by rounding, which does no work that could be balanced."""
    path = tmp_path / "step.npz"
    assert main(["solve", scene, "--mesh", mesh, "--freeze", str(path), "--out", str(tmp_path / "out")]) == 0
    assert main(["resolve", str(path)]) == 0


@pytest.mark.parametrize(
    "name",
    [
        pytest.param(name, marks=[] if name in ("semismooth", "lcp") else [pytest.mark.slow])
        for name in filter(is_exact, ALGORITHMS)
    ],
)
def test_every_algorithm_finds_the_forces_of_the_path(frozen, name) -> None:
    """From no displacement and no set at all; the oracle has the last word."""
    step = json.loads((frozen / "result" / "result.json").read_text())["steps"][-1]
    resolved = resolve_step(read_step(frozen / "step.npz"), algorithm_of(name, np.inf), ask_oracle=True)
    assert resolved.solution.outcome.converged
    assert resolved.certificate["failures"] == []
    force = np.sum(resolved.step.weights * resolved.solution.pressure)
    assert force == pytest.approx(step["force_N"], rel=FORCE)
    assert resolved.solution.active.sum() == step["contact_nodes"]
    assert isinstance(resolved.oracle, Confirmation)
    assert resolved.oracle.agrees
    assert resolved.sound


@pytest.mark.parametrize("scene", ["plate-contact", "ring", "heavy-strip"])
def test_the_oracle_confirms_walls_that_bend_far_more_than_contact_lets_them(scene: str, tmp_path, capsys) -> None:
    """Motions without contact are large beside those with it, and cancel: forces were apart by 1e-3."""
    frozen = str(tmp_path / "step.npz")
    assert main(["solve", scene, "--no-error", "--freeze", frozen, "--out", str(tmp_path)]) == 0
    capsys.readouterr()
    assert main(["resolve", frozen, "--oracle"]) == 0
    assert "oracle agrees" in capsys.readouterr().out
    step = FrozenStep.read(Path(frozen))
    du, pressure = minimise(step)
    assert confirm(step, du, pressure).agrees
    assert not confirm(step, du, pressure * (1 + 1e-4)).agrees  # more than rounding leaves unknown


def test_the_command_prints_and_passes(frozen, capsys) -> None:
    assert main(["resolve", str(frozen / "step.npz"), "--oracle"]) == 0
    output = capsys.readouterr().out
    for text in ("scene tyre", "converged", "equilibrium", "oracle agrees"):
        assert text in output


@dataclass(frozen=True)
class Short(Semismooth):
    max_iterations: int = 0


def test_a_step_that_does_not_converge_ends_in_3(frozen, monkeypatch, capsys) -> None:
    monkeypatch.setitem(ALGORITHMS, "semismooth", Short)
    assert main(["resolve", str(frozen / "step.npz")]) == 3
    output = capsys.readouterr().out
    assert "iteration limit" in output
    assert "stale pressure" in output  # frozen where it is solved: only the pressures of rest are not those of the step


@pytest.mark.slow
def test_a_failed_path_freezes_the_step_that_failed(tmp_path, capsys) -> None:
    """Where the last step set out from, with the foundation where it was to go: there is something to do."""
    hopeless = ["--set", "delta_mm=5,95", "--set", "settle=1"]  # at one factorisation an iteration
    tyre = ["solve", "tyre", "--mesh", "12x12", *hopeless, "--out", str(tmp_path / "result")]
    assert main([*tyre, "--freeze", str(tmp_path / "step.npz")]) == 3
    step = FrozenStep.read(tmp_path / "step.npz")
    assert step.meta["from"] < step.meta["parameter"] < 95
    assert step.meta["outcome"] != "converged"
    assert step.gap.min() < 0
    resolved = resolve_step(read_step(tmp_path / "step.npz"), algorithm_of("semismooth"))
    pressed = step.meta["parameter"] - step.meta["from"]
    assert np.abs(resolved.solution.u).max() > 0.9 * pressed


WRONG = (
    (["resolve", "nothing.npz"], "nothing.npz"),
    (["resolve", __file__], "not a frozen contact step"),
    (["resolve", __file__, "--contact", "magic"], "semismooth"),
)


def test_wrong_use_is_one_line(capsys) -> None:
    for arguments, fault in WRONG:
        assert main(arguments) == 2
        error = capsys.readouterr().err
        assert fault in error
        assert error.count("\n") == 1


def test_a_scene_without_contact_has_nothing_to_freeze(tmp_path, capsys) -> None:
    out = ["--out", str(tmp_path / "result"), "--freeze", str(tmp_path / "step.npz")]
    assert main(["solve", "cantilever", "--mesh", "4x1", *out]) == 2
    assert "no contact to freeze" in capsys.readouterr().err
    assert not (tmp_path / "result").exists()  # nothing was solved for it
    assert not (tmp_path / "step.npz").exists()
