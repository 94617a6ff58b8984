"""``footprint export``: one file, whole or not at all."""

from __future__ import annotations

from pathlib import Path

import pytest

from studies.cli import main

BEGINS = {"inp": "*HEADING", "vtu": '<?xml version="1.0"?>', "json": "{"}
ASKED = ["export", "cantilever", "--mesh", "2x1"]


def test_every_format_is_one_file(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    for kind, begins in BEGINS.items():
        out = tmp_path / kind / f"scene.{kind}"
        assert main([*ASKED, "--format", kind, "--out", str(out)]) == 0
        assert out.read_text(encoding="utf-8").splitlines()[0] == begins
        assert [path.name for path in out.parent.iterdir()] == [out.name]
        assert "2 bricks, 4 steps" in capsys.readouterr().out


def test_wrong_use_is_one_line_and_writes_nothing(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    out = tmp_path / "scene"
    for words, said in (
        ("--format json --through 0", "through = 0 must be a whole number in [1, 16]"),
        ("--format vtu --measure round", "measure 'round' must be one of"),
        ("--format vtu --set load_fraction=0", "load_fraction = '0' must be increasing numbers in (0, 10]"),
        (f"--format inp --out {tmp_path}", "is a directory, not a file"),
    ):
        assert main([*ASKED, "--out", str(out), *words.split()]) == 2
        (line,) = capsys.readouterr().err.splitlines()
        assert said in line
        assert list(tmp_path.iterdir()) == []
    with pytest.raises(SystemExit, match="2"):
        main([*ASKED, "--out", str(out), "--format", "odb"])
    assert "'odb'" in capsys.readouterr().err


def test_cords_that_turn_within_a_brick_are_told(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """On the coarse torus; on Pagano's plate axes do not turn at all."""
    for scene, mesh, told in (("tyre", "8x8", True), ("pagano", "2x2", False)):
        assert main(["export", scene, "--mesh", mesh, "--format", "inp", "--out", str(tmp_path / "scene.inp")]) == 0
        assert ("one direction a brick" in capsys.readouterr().out) is told
