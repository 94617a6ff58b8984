"""Decks as lines of text, what is answered to them and what is refused."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np
import pytest

from studies.cli import OK, WRONG_USE, main


def numbers(values: Sequence[float] | np.ndarray) -> str:
    return ", ".join(f"{float(value):.17g}" for value in values)


def mesh_lines(x: np.ndarray, elements: np.ndarray, normals: np.ndarray | None = None) -> list[str]:
    """Nodes and elements from 1, all in the set ALL."""
    rows = x if normals is None else np.hstack([x, normals])
    lines = ["*NODE", *(f"{i}, {numbers(row)}" for i, row in enumerate(rows, 1)), "*ELEMENT, TYPE=S4, ELSET=ALL"]
    return [*lines, *(f"{i}, {', '.join(map(str, row))}" for i, row in enumerate(elements + 1, 1))]


def plate(n1: int, n2: int, length: float, width: float) -> tuple[np.ndarray, np.ndarray]:
    a, b = np.meshgrid(np.linspace(0, length, n1 + 1), np.linspace(0, width, n2 + 1), indexing="ij")
    number = np.arange(a.size).reshape(a.shape)
    elements = np.stack([number[:-1, :-1], number[1:, :-1], number[1:, 1:], number[:-1, 1:]], axis=-1)
    return np.stack([a.ravel(), b.ravel(), np.zeros(a.size)], axis=-1), elements.reshape(-1, 4)


ISOTROPIC = ["*MATERIAL, NAME=M", "*ELASTIC", "1.2e6, 0.", "*SHELL SECTION, ELSET=ALL, MATERIAL=M", "0.1"]
CLAMPED = ["*NSET, NSET=ROOT", "1, 2", "*BOUNDARY", "ROOT, 1, 6"]
SHEARED = ["*NSET, NSET=TIP", "33, 34", "*STEP, NLGEOM", "*STATIC", "*CLOAD", "TIP, 3, 2.", "*NODE FILE", "U"]
STRIP = ["*HEADING", "a strip", *mesh_lines(*plate(16, 1, 10.0, 1.0)), *ISOTROPIC, *CLAMPED, *SHEARED, "*END STEP"]


def written(tmp_path: Path, lines: Sequence[str], name: str = "panel.inp") -> str:
    path = tmp_path / name
    path.write_text("\n".join(lines) + "\n")
    return str(path)


def answered(tmp_path: Path, lines: Sequence[str], *options: str, code: int = OK) -> Mapping[str, float]:
    out = tmp_path / "out"
    assert main(["solve", written(tmp_path, lines), "--out", str(out), *options]) == code
    assert (out / "fields.vtu").is_file()
    return json.loads((out / "result.json").read_text())


def refused(tmp_path: Path, capsys: pytest.CaptureFixture[str], lines: Sequence[str], *options: str) -> str:
    code = main(["solve", written(tmp_path, lines), "--out", str(tmp_path / "out"), *options])
    said = capsys.readouterr().err.strip()
    assert code == WRONG_USE, said
    assert "\n" not in said
    return said


def swapped(lines: Sequence[str], old: str, *new: str) -> list[str]:
    """The deck with a line replaced."""
    assert old in lines
    at = list(lines).index(old)
    return [*lines[:at], *new, *lines[at + 1 :]]
