"""``footprint export``: one file, whole or not at all."""

from __future__ import annotations

from pathlib import Path

import pytest

from studies.cli import main

BEGINS = {"inp": "*HEADING", "vtu": '<?xml version="1.0"?>', "json": "{"}
ASKED = ["export", "cantilever", "--mesh", "2x1"]


@pytest.mark.parametrize("kind", BEGINS)
def test_every_format_is_written(kind: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    out = tmp_path / "deep" / f"scene.{kind}"
    assert main([*ASKED, "--format", kind, "--out", str(out)]) == 0
    assert out.read_text(encoding="utf-8").splitlines()[0] == BEGINS[kind]
    assert [path.name for path in out.parent.iterdir()] == [out.name]
    assert "2 bricks, 4 steps" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["--format", "odb"], "format 'odb' must be one of inp, vtu, json"),
        (["--format", "inp", "--integration", "none"], "integration 'none' must be one of auto, reduced, full"),
        (["--format", "inp", "--stiffness", "-1"], "stiffness = -1.0 must be a number in (0, inf)"),
        (["--format", "json", "--through", "0"], "through = 0 must be a whole number in [1, 16]"),
        (["--format", "vtu", "--measure", "round"], "measure 'round' must be one of"),
        (["--format", "vtu", "--set", "load_fraction=0"], "load_fraction = '0' must be increasing numbers in (0, 10]"),
    ],
)
def test_wrong_use_is_one_line_and_writes_nothing(
    words: list[str], said: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main([*ASKED, *words, "--out", str(tmp_path / "scene")]) == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert said in line
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(("mesh", "told"), [("8x8", True), ("2x2", False)])
def test_cords_that_turn_within_a_brick_are_told(
    mesh: str, told: bool, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """On the coarse torus; on Pagano's plate axes do not turn at all."""
    scene = "tyre" if told else "pagano"
    assert main(["export", scene, "--mesh", mesh, "--format", "inp", "--out", str(tmp_path / "scene.inp")]) == 0
    assert ("one direction a brick" in capsys.readouterr().out) is told


def test_a_directory_is_no_file(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main([*ASKED, "--format", "inp", "--out", str(tmp_path)]) == 2
    assert "is a directory, not a file" in capsys.readouterr().err
