"""The command line: results as documented, one clear line for wrong use, exit codes, nothing half-written."""

from __future__ import annotations

import json
import math
from dataclasses import dataclass, make_dataclass
from pathlib import Path

import meshio
import numpy as np
import pandas as pd
import pytest

from contact.algorithms.semismooth import Semismooth
from contact.catalogue import ALGORITHMS
from contact.problem import ContactProblem
from contact.solvers.sparse import SingularMatrixError
from formulations.strains.catalogue import MEASURES
from studies.ask.scene import Setting, UsageError
from studies.cli import main
from studies.output.atomic import write_by, write_json
from studies.scenes.complete import complete
from studies.scenes.tyre.grid_lines import tyre_lines
from studies.scenes.tyre.press import asymmetries, half_extent, to_edges
from studies.solving import branching
from studies.solving.branching import branches_of
from studies.solving.refinement import mesh_error
from studies.solving.solve import solve

SMALL = ["--mesh", "12x12", "--set", "delta_mm=5", "--model", "full"]

TOP_LEVEL = {
    *(
        "scene",
        "measure",
        "contact",
        "newton",
        "mesh",
        "model",
        "model_reason",
        "settings",
        "outcome",
        "class",
        "reason",
        "notes",
        "path_end",
    ),
    *("quantities", "steps", "cuts", "counters", "work", "timing_s", "files", "provenance"),
}
STEP = {
    *("delta_mm", "force_N", "centre_pressure_MPa", "contact_nodes", "half_length_mm", "half_width_mm"),
    *("newton_iterations", "kkt", "central_asymmetry", "mirror_asymmetry"),
}


@pytest.fixture(scope="module")
def solved(tmp_path_factory: pytest.TempPathFactory) -> Path:
    out = tmp_path_factory.mktemp("solved") / "deep" / "out"
    assert main(["solve", "tyre", *SMALL, "--out", str(out)]) == 0
    return out


def test_result_has_the_documented_keys(solved: Path) -> None:
    result = json.loads((solved / "result.json").read_text())
    assert set(result) == TOP_LEVEL
    assert result["outcome"] == "converged"
    assert result["mesh"] == "12x12"
    assert set(result["steps"][0]) >= STEP
    step = result["steps"][0]
    assert set(step["kkt"]) == {"equilibrium", "penetration", "tension", "complementarity"}
    assert set(step["balances"]) == {"energy", "force"}
    assert max(step["balances"].values()) <= 1e-8
    assert step["failures"] == step["diagnosis"] == []
    assert {"dofs", "newton_iterations", "factorisations", "assemblies"} <= set(result["counters"])
    assert {"total", "assembly", "factorisation"} <= set(result["timing_s"])
    assert set(result["provenance"]) == {"version", "commit", "modified", "packages", "blas", "machine", "date"}
    assert {"osqp", "clarabel", "cvxpy"} <= set(result["provenance"]["packages"])
    assert result["provenance"]["machine"]["cpu"]
    assert result["settings"]["epsilon"] == "inf"
    assert result["settings"]["E_L_MPa"] == 510.45
    assert all("_" in name for name in result["quantities"])


@pytest.mark.slow
def test_branches_of_an_unstable_tyre_are_stable_and_lie_lower(tmp_path: Path, capsys) -> None:
    """The potential is not read by the descent: it has to be below that of the state that was left."""
    given = {"gamma_deg": "70", "p0_MPa": "0.1", "delta_mm": "20", "pressure_area": "face", "foundation": "cleat"}
    given |= {"thickness_strain": "balanced", "interpolation": "isoparametric", "epsilon": "inf"}
    asked = ["solve", "tyre", "--contact", "trial-and-error", "--mesh", "14x12"]
    settings = [word for key, value in given.items() for word in ("--set", f"{key}={value}")]
    assert main([*asked, *settings, "--branch", "--out", str(tmp_path)]) == 0
    printed = capsys.readouterr().out
    assert printed.count("\nstable branch ") == 2
    result = json.loads((tmp_path / "result.json").read_text())
    assert [row["found"] for row in result["branches"]] == [True, True]
    left = result["steps"][-1]["force_N"]
    changes = [row["force_N"] / left - 1 for row in result["branches"]]
    assert [row["change_of_force"] for row in result["branches"]] == pytest.approx(changes)
    assert {"branch_1.vtu", "branch_2.vtu"} <= {path.name for path in tmp_path.iterdir()}
    solution = solve(*complete("tyre", given, "14x12", contact="trial-and-error"))
    branches_of(solution)
    energy = solution.end.problem.energy
    left = energy(solution.end.point.solution.u)
    assert all(energy(branch.solution.u) < left - 1e-6 * abs(left) for branch in solution.beside)


def test_a_stable_state_has_no_branch(tmp_path: Path, capsys) -> None:
    assert main(["solve", "tyre", *SMALL, "--branch", "--out", str(tmp_path)]) == 0
    assert "no unstable mode" in capsys.readouterr().out
    assert "branches" not in json.loads((tmp_path / "result.json").read_text())


@pytest.mark.parametrize(
    ("asked", "says"),
    [
        (["roof-b", "--mesh", "4x4"], "traced curve"),
        (["tyre", *SMALL, "--set", "path=arc"], "traced curve"),
        (["tyre", *SMALL, "--set", "mu=0.3"], "friction has none"),
    ],
)
def test_what_has_no_branch_to_leave_is_refused_before_anything_is_solved(
    asked: list[str], says: str, tmp_path: Path, capsys, monkeypatch
) -> None:
    monkeypatch.setattr(mesh_error, "solve_with_error", lambda *given, **options: pytest.fail("solved"))
    assert main(["solve", *asked, "--branch", "--out", str(tmp_path / "o")]) == 2
    assert says in capsys.readouterr().err
    assert not (tmp_path / "o").exists()


@pytest.mark.parametrize(("stopped", "code"), [(SingularMatrixError("no pivot"), 2), (KeyboardInterrupt(), 130)])
def test_a_result_is_written_whatever_becomes_of_its_branches(
    stopped: BaseException, code: int, tmp_path: Path, capsys, monkeypatch
) -> None:
    def stable_branches(*_: object) -> None:
        raise stopped

    monkeypatch.setattr(branching, "stable_branches", stable_branches)
    assert main(["solve", "cantilever", "--mesh", "4x1", "--no-error", "--branch", "--out", str(tmp_path)]) == code
    said = capsys.readouterr()
    assert "tip_deflection_mm" in said.out
    if code == 2:
        why = "--branch: the modes of the tangent are not known: no pivot; the result is written"
        assert said.err == f"footprint: {why}\n"
    written = json.loads((tmp_path / "result.json").read_text())
    assert written["outcome"] == "converged"
    assert all((tmp_path / name).is_file() for name in written["files"])


def test_an_unstable_equilibrium_has_converged_and_is_called_unstable(tmp_path: Path, capsys) -> None:
    asked = ["solve", "sze-moment", "--mesh", "8x1", "--set", "load_fraction=1"]
    assert main([*asked, "--out", str(tmp_path)]) == 0
    printed = capsys.readouterr().out
    assert "\nconverged, unstable: " in printed
    assert "load at 1: unstable: 1 negative eigenvalue of" in printed
    result = json.loads((tmp_path / "result.json").read_text())
    assert (result["outcome"], result["class"]) == ("converged", "unstable")
    assert result["steps"][0]["stability"]["negative"] == 1


def test_a_solve_prints_how_far_it_is_from_what_is_known(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    def references(load: str) -> list[str]:
        main(
            [
                "solve",
                "cantilever",
                "--mesh",
                "8x1",
                "--no-error",
                "--set",
                f"load_fraction={load}",
                "--out",
                f"{tmp_path}",
            ]
        )
        return [line for line in capsys.readouterr().out.splitlines() if line.startswith("reference ")]

    shortening, _ = references("0.5")
    assert shortening.startswith("reference tip_shortening_mm 1.60642 +- 0.001 % (exact: inextensible elastica")
    record = json.loads((tmp_path / "result.json").read_text())["quantities"]["tip_shortening_mm"]
    assert shortening.endswith(f"; this value differs by {100 * (record / 1.60642 - 1):+.2g} %")
    assert references("0.3") == []


def test_every_default_of_the_paper_is_resolved(solved: Path) -> None:
    settings = json.loads((solved / "result.json").read_text())["settings"]
    expected = {"gamma_deg": 52, "p0_MPa": 0.15, "load": "dead", "pressure_area": "mid", "coupling": "lumped"}
    expected |= {"section": "constant-s33", "plies": 4, "ply_thickness_mm": 1.2, "R1_mm": 50, "R0_mm": 250}
    assert settings.items() >= expected.items()


def test_fields_open_as_hexahedra_with_both_faces(solved: Path) -> None:
    mesh = meshio.read(solved / "fields.vtu")
    n = len(mesh.points) // 2
    assert n == 13 * 12
    (block,) = mesh.cells
    assert block.type == "hexahedron"
    assert len(block.data) == 12 * 12
    assert np.linalg.norm(mesh.points[n:] - mesh.points[:n], axis=1) == pytest.approx(np.full(n, 4.8))
    assert mesh.point_data["displacement"].shape == (2 * n, 3)
    assert np.all(mesh.point_data["pressure"][:n] == 0)
    assert mesh.point_data["pressure"][n:].max() > 0
    assert {"H_11-", "H_11+", "H_22-", "H_12+", "H_13-", "H_23+", "H_33"} <= set(mesh.cell_data)
    corner = mesh.points[block.data]
    edges = [corner[:, i] - corner[:, 0] for i in (1, 3, 4)]
    assert np.all(np.einsum("...i,...i->...", np.cross(edges[0], edges[1]), edges[2]) > 0)


@pytest.mark.parametrize(
    ("contact", "given", "resolved"),
    [
        ("qp", ["backend=clarabel"], {"backend": "clarabel", "eps": 1e-8, "epsilon": "inf"}),
        ("lcp", ["method=active-set"], {"method": "active-set", "epsilon": "inf"}),
        ("augmented-lagrangian", ["c=1e2"], {"c": 100.0, "epsilon": "inf"}),
        ("regularised", ["epsilon=1e6"], {"epsilon": 1e6}),
        ("semismooth", ["settle=0"], {"settle": 0.0, "c": 1.0, "epsilon": "inf"}),
    ],
)
def test_algorithms_take_their_settings_and_agree(
    contact: str, given: list[str], resolved: dict[str, object], solved: Path, tmp_path: Path
) -> None:
    pairs = [part for text in given for part in ("--set", text)]
    assert main(["solve", "tyre", *SMALL, "--contact", contact, *pairs, "--out", str(tmp_path)]) == 0
    actual, usual = (json.loads((path / "result.json").read_text()) for path in (tmp_path, solved))
    assert actual["settings"].items() >= resolved.items()
    rel = 1e-3 if contact == "regularised" else 1e-9
    assert actual["steps"][0]["force_N"] == pytest.approx(usual["steps"][0]["force_N"], rel=rel)


def test_a_refusal_found_on_the_way_is_exit_2_with_its_reason(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "out"
    arguments = ["solve", "tyre", *SMALL, "--set", "section=nonsymmetric", "--contact", "qp"]
    assert main([*arguments, "--out", str(out)]) == 2
    assert not out.exists()
    error = capsys.readouterr().err.strip()
    assert error.count("\n") == 0
    assert "qp does not apply: " in error
    assert "no energy to minimise" in error


def test_tables_match_the_result(solved: Path) -> None:
    step = json.loads((solved / "result.json").read_text())["steps"][0]
    contact = pd.read_csv(solved / "contact.csv")
    assert contact["active"].sum() == step["contact_nodes"]
    assert (contact["gap_mm"] >= -1e-9).all()
    history = pd.read_csv(solved / "history.csv")
    assert {"stage", "parameter", "iteration", "residual", "contact_nodes", "added", "removed"} <= set(history)


WRONG = {
    "unknown scene": (["solve", "bicycle"], "bicycle"),
    "unknown measure": (["solve", "tyre", "--measure", "cubic"], "exact"),
    "unknown algorithm": (["solve", "tyre", "--contact", "magic"], "semismooth"),
    "unknown newton": (["solve", "tyre", "--newton", "lazy"], "mixed"),
    "unavailable model": (["solve", "tyre", "--model", "eighth"], "auto"),
    **{
        f"model of {scene}, which is one": (
            ["solve", scene, "--model", "full"],
            f"model 'full' must be one of auto: {scene} has no other",
        )
        for scene in ("pinched-ring", "ring", "crushed-ring-solid", "two-cylinders")
    },
    "unknown key": (["solve", "tyre", "--set", "colour=red"], "see footprint show"),
    "not KEY=VALUE": (["solve", "tyre", "--set", "gamma_deg"], "KEY=VALUE"),
    "mesh text": (["solve", "tyre", "--mesh", "fine"], "N1xN2"),
    "mesh the other way round": (
        ["solve", "two-rings", "--mesh", "16x1"],
        "mesh '16x1' has one element along two-rings, by default 1x64: is 1x16 meant?",
    ),
    "negative mesh": (["solve", "tyre", "--mesh", "-8x8"], "mesh '-8x8' must be N1xN2 with two whole numbers"),
    "negative error": (
        ["solve", "tyre", "--error", "-1%"],
        "error '-1%' must be a relative error in [0.01%, 50%]",
    ),
    "no campaign file": (["run", "nofile.toml"], "footprint: campaign nofile.toml: No such file or directory\n"),
    "odd mesh": (["solve", "tyre", "--mesh", "41x40"], "even"),
    "huge mesh": (["solve", "tyre", "--mesh", "9999x9999"], "250000"),
    "no steps": (["solve", "tyre", "--steps", "0"], "[1, 10000]"),
    "steps text": (["solve", "tyre", "--steps", "many"], "many"),
    "not positive definite": (["solve", "tyre", "--set", "nu_TT=0.999"], "positive definite"),
    "NaN": (["solve", "tyre", "--set", "p0_MPa=nan"], "a number in"),
    "infinite": (["solve", "tyre", "--set", "R1_mm=inf"], "a number in"),
    "text for a number": (["solve", "tyre", "--set", "gamma_deg=steep"], "[-90, 90]"),
    "negative thickness": (["solve", "tyre", "--set", "ply_thickness_mm=-1"], "(0, 50]"),
    "h >= R": (["solve", "tyre", "--set", "ply_thickness_mm=12.5"], "below R1_mm = 50"),
    "wall across the axis": (["solve", "tyre", "--set", "R0_mm=60"], "R0_mm = 60"),
    "negative modulus": (["solve", "tyre", "--set", "E_L_MPa=-5"], "E_L_MPa"),
    "E without nu": (["solve", "tyre", "--set", "E_MPa=20"], "an isotropic tyre needs both E_MPa and nu"),
    "isotropic mixture": (
        ["solve", "tyre", "--set", "E_MPa=20", "--set", "nu=0.3", "--set", "E_L_MPa=5"],
        "an isotropic tyre needs both E_MPa and nu",
    ),
    "incompressible": (["solve", "tyre", "--set", "E_MPa=20", "--set", "nu=0.5"], "(-1, 0.5)"),
    "falling deltas": (["solve", "tyre", "--set", "delta_mm=10,5"], "increasing"),
    "negative delta": (["solve", "tyre", "--set", "delta_mm=-5"], "[0, 100]"),
    "zero epsilon": (["solve", "tyre", "--set", "epsilon=0"], "(0, inf]"),
    "half a ply": (["solve", "tyre", "--set", "plies=2.5"], "whole number"),
    "unknown choice": (["solve", "tyre", "--set", "load=heavy"], "dead, follower"),
    "key of another scene": (["solve", "cantilever", "--set", "gamma_deg=3"], "load_fraction"),
    "setting of another algorithm": (["solve", "tyre", "--set", "backend=osqp"], "see footprint show tyre"),
    "unknown backend": (["solve", "tyre", "--contact", "qp", "--set", "backend=magic"], "osqp, clarabel"),
    "unknown method": (["solve", "tyre", "--contact", "lcp", "--set", "method=magic"], "lemke, active-set, nnls"),
    "an error from rest": (
        ["solve", "tyre", "--error", "1%", "--start", "cold"],
        "--error starts each grid from the one before: give no --start cold",
    ),
    "an error that is left out": (
        ["solve", "tyre", "--error", "1%", "--no-error"],
        "--error and --no-error exclude each other: give one of them",
    ),
    "nothing free": (
        ["solve", "pressed-panel", "--mesh", "2x1", "--no-error", "--start", "cold"],
        "mesh 2x1: every displacement is held: nothing to solve",
    ),
    "springs of infinite stiffness": (
        ["solve", "tyre", "--mesh", "12x12", "--contact", "regularised", "--set", "epsilon=inf"],
        "finite epsilon",
    ),
    "unknown campaign": (["run", "everything"], "report"),
}


@pytest.mark.parametrize("name", WRONG)
def test_wrong_use_is_one_line_exit_2_and_nothing_written(
    name: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    arguments, hint = WRONG[name]
    target = tmp_path / "out"
    where = ["--store" if arguments[0] == "run" else "--out", str(target)]
    try:
        code = main([*arguments, *where])
    except SystemExit as error:  # argparse leaves by itself
        code = error.code
    message = capsys.readouterr().err
    assert code == 2
    assert len(message.strip().splitlines()) == 1
    assert hint in message
    assert not target.exists()


def test_every_option_of_solve_says_what_it_is(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit):
        main(["solve", "--help"])
    said = capsys.readouterr().out.partition("positional arguments:")[2]
    bare = [words for line in said.splitlines() if (words := line.split()) and line.startswith("  ") and len(words) < 3]
    assert [words for words in bare if words[0].startswith("--") or words == ["scene"]] == []


def test_too_little_memory_is_one_line(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    def hungry(*asked: object) -> None:
        np.empty(2**57)

    monkeypatch.setattr("studies.solving.solve.record", hungry)
    assert main(["solve", "cantilever", "--mesh", "2x1", "--out", str(tmp_path / "out")]) == 1
    said = capsys.readouterr().err
    assert said.startswith("footprint: not enough memory; a coarser mesh needs less: Unable to allocate 1.00 EiB")
    assert said.count("\n") == 1
    assert not (tmp_path / "out").exists()


def test_missing_out_is_one_line(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as error:
        main(["solve", "tyre"])
    assert error.value.code == 2
    assert len(capsys.readouterr().err.strip().splitlines()) == 1


def test_out_that_is_a_file_is_refused(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    occupied = tmp_path / "file"
    occupied.write_text("mine")
    assert main(["solve", "tyre", *SMALL, "--out", str(occupied)]) == 2
    assert occupied.read_text() == "mine"
    assert len(capsys.readouterr().err.strip().splitlines()) == 1


@pytest.mark.slow
def test_no_convergence_is_exit_3_with_everything_kept(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    out = tmp_path / "out"
    hopeless = ["--set", "delta_mm=5,95", "--set", "settle=1"]  # at one factorisation an iteration
    code = main(["solve", "tyre", "--mesh", "12x12", *hopeless, "--out", str(out)])
    assert code == 3
    result = json.loads((out / "result.json").read_text())
    assert result["outcome"] == "limit-point"
    assert "95" in result["reason"]
    assert "last converged at" in result["reason"]
    assert "it turns back where the contact set changes" in result["reason"]
    assert (out / "mode.csv").exists()
    assert [step["delta_mm"] for step in result["steps"]] == [5.0]
    assert np.abs(meshio.read(out / "fields.vtu").point_data["displacement"]).max() > 1
    assert "did not converge" in capsys.readouterr().err


MORE_PICTURES = ("roof-d", "4x4", ""), ("strip-contact", "4x1", "")


@pytest.mark.parametrize(
    ("scene", "mesh", "travel", "pictures"),
    [
        pytest.param("tyre", "12x12", "5", 4, marks=pytest.mark.slow),
        ("tyre", "12x12", "0", 1),
        *(pytest.param(*each, 1, marks=pytest.mark.slow) for each in MORE_PICTURES),
    ],
)
def test_plot_draws_what_was_solved(scene: str, mesh: str, travel: str, pictures: int, tmp_path: Path) -> None:
    settings = ["--set", f"delta_mm={travel}"] if travel else []
    assert main(["solve", scene, "--mesh", mesh, *settings, "--plot", "--out", str(tmp_path)]) == 0
    drawn = list((tmp_path / "figures").glob("*.svg"))
    assert len(drawn) == pictures
    assert all(path.read_text(encoding="utf-8").rstrip().endswith("</svg>") for path in drawn)


@dataclass(frozen=True)
class GivenUp(Semismooth):
    """Never begins."""

    max_iterations: int = -1


def test_a_contact_scene_without_a_converged_step_still_writes_everything(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Nothing has touched yet: the fields are those at rest."""
    monkeypatch.setitem(ALGORITHMS, "semismooth", GivenUp)
    words = "--measure linear --contact semismooth --mesh 8x1 --set load_fraction=1 --out"
    assert main(["solve", "heavy-strip", *words.split(), str(tmp_path)]) == 3
    assert "did not converge" in capsys.readouterr().err
    result = json.loads((tmp_path / "result.json").read_text())
    assert (result["outcome"], result["steps"]) == ("step-limit", [])
    assert (tmp_path / "fields.vtu").exists()


def test_list_names_everything(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["list"]) == 0
    everything = capsys.readouterr().out
    for name in ("tyre", "hemisphere", "exact", "linear", "semismooth", "trial-and-error"):
        assert name in everything
    assert main(["list", "measures"]) == 0
    assert [line.split()[0] for line in capsys.readouterr().out.splitlines()] == list(MEASURES)


@dataclass(frozen=True)
class Refusing(Semismooth):
    """Refuses at once, at the first problem with candidates, or to be made at all."""

    at: str = "once"
    epsilon: float = 1.0

    def __post_init__(self) -> None:
        if self.at == "birth" and math.isinf(self.epsilon):
            raise ValueError("epsilon must be finite")

    def supports(self, problem: ContactProblem) -> str | None:
        return "the matrix is not symmetric" if self.at == "once" or len(problem.weights) else None


@pytest.mark.parametrize("at", ["once", "contact", "birth"])
def test_a_refusal_is_an_outcome_and_one_line_of_a_solve(
    at: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    refusing = make_dataclass("RefusingThere", [("at", str, at)], bases=(Refusing,), frozen=True)
    monkeypatch.setitem(ALGORITHMS, "refusing", refusing)
    words = ["--mesh", "6x6", "--contact", "refusing", "--set", "epsilon=inf"]
    why = "epsilon must be finite" if at == "birth" else "the matrix is not symmetric"
    scene, request = complete("tyre", {"delta_mm": "2", "epsilon": "inf"}, "6x6", contact="refusing")
    refused = solve(scene, request)
    assert refused.verdict == "unsupported"
    assert refused.as_json()["reason"] == f"refusing does not apply: {why}"
    assert refused.steps == []
    assert main(["solve", "tyre", *words, "--out", str(tmp_path / "x")]) == 2
    assert capsys.readouterr().err == f"footprint: refusing does not apply: {why}\n"
    assert not (tmp_path / "x").exists()


def test_writing_leaves_nothing_behind_when_it_fails(tmp_path: Path) -> None:
    def broken(path: Path) -> None:
        path.write_text("half")
        raise RuntimeError

    with pytest.raises(RuntimeError):
        write_by(tmp_path / "a.txt", broken)
    assert list(tmp_path.iterdir()) == []
    write_json(tmp_path / "b.json", {"x": -0.0, "inf": float("inf"), "nan": float("nan")})
    assert json.loads((tmp_path / "b.json").read_text()) == {"x": 0.0, "inf": "inf", "nan": None}
    assert "-0.0" not in (tmp_path / "b.json").read_text()


def test_default_mesh_lines_are_those_of_the_paper_scene() -> None:
    psi, phi = (np.rad2deg(lines) for lines in tyre_lines((42, 40), 120.0))
    assert np.diff(psi) == pytest.approx([6.25] * 12 + [5.0] * 18 + [6.25] * 12)
    assert np.diff(phi) == pytest.approx([157.5 / 11] * 11 + [2.5] * 18 + [157.5 / 11] * 11)


@pytest.mark.parametrize("place", [(1, 1), (0, 0)])
def test_either_mirror_alone_is_an_asymmetry(place: tuple[int, int]) -> None:
    """Lines of psi -1, 0, 1 and of phi 0, 90, 180, -90 deg; a bump on the line 0 of one has its image by the other."""
    pressure = np.ones((3, 4))
    pressure[place] = 1.25
    assert asymmetries(pressure) == pytest.approx({"central_asymmetry": 0.2, "mirror_asymmetry": 0.2})


def test_asymmetries_of_planted_maps() -> None:
    rng = np.random.default_rng(0)
    pressure = rng.random((5, 8))
    turned = (-np.arange(8)) % 8
    central = 0.5 * (pressure + pressure[::-1][:, turned])
    assert asymmetries(central)["central_asymmetry"] == pytest.approx(0, abs=1e-15)
    assert asymmetries(central)["mirror_asymmetry"] > 0.1
    mirrored = 0.5 * (central + central[::-1])
    assert asymmetries(mirrored)["mirror_asymmetry"] == pytest.approx(0, abs=1e-15)
    planted = mirrored / mirrored.max()
    planted[1, 2] += 0.25
    assert asymmetries(planted)["central_asymmetry"] == pytest.approx(0.25 / planted.max())


def test_length_from_the_patch_to_the_edges() -> None:
    """Two meridians of spacings 1, 2, 3, 4, the second twice as long: the shorter way, along the line, on each."""
    x = np.zeros((5, 2, 3))
    x[:, 0, 2], x[:, 1, 2] = [0, 1, 3, 6, 10], [0, 2, 6, 12, 20]
    active = np.zeros((5, 2), bool)
    assert to_edges(x, active) == 20.0
    active[2, 1] = True
    assert to_edges(x, active) == 6.0
    active[3, 0] = True
    assert to_edges(x, active) == 4.0


def test_half_extent_takes_the_rim_half_way() -> None:
    assert half_extent(np.arange(-4.0, 5.0), np.abs(np.arange(-4, 5)) <= 2) == pytest.approx(2.5)
    assert half_extent(np.arange(-4.0, 5.0), np.zeros(9, bool)) == 0.0


@pytest.mark.parametrize("edge", [2.5, 2.6, 3.0, 3.3, 3.49])
def test_half_extent_by_pressure_places_the_rim_within_the_element(edge: float) -> None:
    """Nodes 1 apart collect a pressure of 2 that ends at +-edge; only where it ends is not linear."""
    x = np.arange(-6.0, 7.0)
    pressure = 2 * np.clip(edge - np.abs(x) + 0.5, 0, 1)
    assert half_extent(x, pressure > 0, pressure) == pytest.approx(edge, abs=1e-12)
    assert half_extent(x, pressure > 0) == pytest.approx(2.5 if edge == 2.5 else 3.5)
    assert half_extent(x, np.abs(x) < 1, pressure) == 0.5  # too few nodes to extrapolate from


def test_setting_ranges_are_told() -> None:
    setting = Setting("x", 1.0, "", low=0, high=2, open_low=True)
    assert setting.parse("2") == 2.0
    for text in ("0", "2.1", "nan", "", "1,2"):
        with pytest.raises(UsageError, match=r"\(0, 2\]"):
            setting.parse(text)
