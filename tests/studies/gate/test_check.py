"""``footprint check``, ``compare`` and ``advise`` from the command line, on a small campaign that is really solved."""

from __future__ import annotations

import math
import shutil
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from studies.cli import main
from studies.commands.comparison import stale
from studies.gate.baseline import BASELINE, TOLERANCES, UPDATES
from studies.output.atomic import write_json
from studies.run.campaign import find
from studies.run.plan import plan

CAMPAIGN = """
title = "small"
[[cross]]
name = "small"
measures = ["exact", "linear"]
[cross.scenes.cantilever]
meshes = ["4x1", "8x1", "16x1"]
set = { load_fraction = "0.25" }
"""


@pytest.fixture(scope="module")
def solved(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("gate")
    (folder / "small.toml").write_text(CAMPAIGN)
    assert main(["run", str(folder / "small.toml"), "--store", str(folder / "store")]) == 0
    shutil.copy(BASELINE.parent / TOLERANCES, folder)
    return folder


@pytest.fixture
def gate(solved: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """Arguments of a check, with a baseline of its own."""
    shutil.copy(solved / TOLERANCES, tmp_path)
    monkeypatch.setattr("studies.commands.comparison.HERE", tmp_path)
    asked = ["check", "--store", str(solved / "store"), "--campaign", "small"]
    assert main([*asked, "--update", "--owner", "Anna", "--reason", "the first"]) == 0
    return asked


def test_a_baseline_is_made_recorded_and_kept(
    gate: list[str], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(gate) == 0
    assert "6 cells of small" in capsys.readouterr().out
    log = pd.read_csv(tmp_path / UPDATES)
    assert log[["owner", "reason", "cells", "changed"]].values.tolist() == [["Anna", "the first", 6, "first baseline"]]


def test_what_is_worse_is_a_table_and_exit_code_1(
    gate: list[str], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "small.csv"
    rows = pd.read_csv(path, dtype=str, keep_default_na=False)
    exact = rows["label"] == "small cantilever exact 8x1"
    rows.loc[exact & (rows["column"] == "c.factorisations"), "value"] = "4"
    rows.loc[exact & (rows["column"] == "error.tip_deflection_mm"), "value"] = "0.0018"
    rows[rows["label"] != "small cantilever linear 4x1"].to_csv(path, index=False)
    assert main(gate) == 1
    lines = capsys.readouterr().out.splitlines()
    assert any(line.startswith("small cantilever exact 8x1") and "c.factorisations" in line for line in lines)
    assert any("error.tip_deflection_mm" in line and "worse" in line for line in lines)
    assert any(line.startswith("small cantilever linear 4x1") and "new" in line for line in lines)
    assert "3 values are worse or different" in lines[-2]


@pytest.mark.parametrize(
    ("more", "message"),
    [
        (["--update"], "--update needs --owner NAME and --reason TEXT"),
        (["--update", "--owner", "Anna"], "--update needs --owner NAME and --reason TEXT"),
        (["--update", "--reason", "why"], "--update needs --owner NAME and --reason TEXT"),
        (["--owner", "Anna"], "--owner and --reason need --update"),
    ],
)
def test_wrong_use_is_one_line(
    gate: list[str], more: list[str], message: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    before = (tmp_path / "small.csv").read_bytes()
    assert main([*gate, *more]) == 2
    assert capsys.readouterr().err == f"footprint: {message}\n"
    assert (tmp_path / "small.csv").read_bytes() == before


def test_a_campaign_without_a_cell_in_common_fails(
    gate: list[str], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "small.csv"
    path.write_text(path.read_text().replace("small cantilever", "other"))
    assert main(gate) == 1
    assert "check failed: zero cells compared" in capsys.readouterr().err


def lane(store: Path, factors: dict[str, float], seed: int, canary: float = 0.03) -> None:
    """Samples as the timing lane leaves them."""
    rng = np.random.default_rng(seed)
    labels = [f"small cantilever {measure} {n}x1" for measure in ("exact", "linear") for n in (4, 8, 16)]
    cells = [
        {
            "id": label.replace(" ", "-"),
            "label": label,
            "warm": [factors.get(label, 1.0) * math.exp(0.005 * rng.normal()) for _ in range(12)],
        }
        for label in labels
    ]
    canaries = [[canary, canary, True], [2 * canary, canary, False], [canary, canary, True]]
    write_json(store / "timing" / "small.json", {"schema": 2, "canaries": canaries, "rounds": 6, "cells": cells})


def test_times_of_two_stores(solved: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    before, same, slow = (tmp_path / name for name in ("before", "same", "slow"))
    changed = {"small cantilever exact 8x1": 1.3, "small cantilever linear 4x1": 0.5}
    for seed, (store, factors) in enumerate(((before, {}), (same, {}), (slow, changed))):
        shutil.copytree(solved / "store", store)
        lane(store, factors, seed)
    words = ["compare", "--campaign", "small", str(before)]
    for now, said in (
        (same, "Wall time: no significant change in 6 cells."),
        (slow, "**Wall time: 2 of 6 cells**"),
        (solved / "store", "has no times of 'small'"),
    ):
        assert main([*words, str(now)]) == 0
        assert said in capsys.readouterr().out
    lane(same, {}, 7, canary=0.04)
    assert main([*words, str(same)]) == 0
    assert "the canary takes 1.33 times as long" in capsys.readouterr().out


def test_two_stores_make_a_comment(solved: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["compare", str(solved / "store"), str(solved / "store"), "--campaign", "small"]) == 0
    text = capsys.readouterr().out
    assert main(["compare", str(solved / "store"), str(solved / "store")]) == 0  # it has no other
    assert capsys.readouterr().out == text
    assert text.startswith("### Campaign small, A → B\n")
    assert "A: 6 of 6 cells ran, 6 converged. B: 6 of 6 cells ran, 6 converged." in text
    assert "Nothing changed beyond the bounds." in text
    assert "6 cells solved in both: newton iterations " in text
    assert "stale" not in text


def test_two_stores_make_a_page(solved: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    store, page = str(solved / "store"), tmp_path / "change.html"
    words = ["compare", store, store, "--campaign", "small", "--out"]
    assert main([*words, str(page)]) == 0
    assert "Campaign small, A → B</h1>" in page.read_text()
    assert main([*words, str(tmp_path)]) == 2
    assert "is a directory" in capsys.readouterr().err


def test_cells_that_other_sources_have_solved_are_stale() -> None:
    ids = {row.cell.label: row.id for row in plan(find("quick"))}
    now = pd.DataFrame({"label": list(ids), "id": [known or "" for known in ids.values()]})
    before = now.assign(id=["0" * 16, "1" * 16, *now["id"][2:]])
    assert stale("quick", before, now) == "2 cells of A are stale: they were solved with other sources."
    assert stale("quick", now, now) == stale("of somebody", before, now) == ""


def test_advice_on_the_command_line(solved: Path, capsys: pytest.CaptureFixture[str]) -> None:
    asked = ["advise", "cantilever", "--store", str(solved / "store"), "--campaign", "small"]
    asked += ["--cost", "dofs", "--error"]  # seconds rank as the machine is busy
    assert main([*asked, "1%"]) == 0
    said = capsys.readouterr().out
    assert "cheapest: exact semismooth mixed refined 8x1" in said
    assert said.endswith("for your own settings on this machine: footprint choose cantilever --error 1% --out DIR\n")
    assert "extrapolated: solved with load_fraction=0.25, not with load_fraction=0.25,0.5,0.75,1\n" in said
    assert main([*asked, "1%", "--set", "load_fraction=0.25"]) == 0
    assert "extrapolated" not in capsys.readouterr().out
    assert main([*asked, "0.01%"]) == 1
    assert "none qualifies of 3 cells" in capsys.readouterr().out  # the linear ones are wrong, not inaccurate
    assert main([*asked, "1%", "--quantity", "force_N"]) == 2
    of_it = "for your own settings: footprint choose cantilever --error 1% --of force_N --out DIR\n"
    assert (said := capsys.readouterr().err).endswith(of_it)
    assert "no verified quantity 'force_N'" in said
    assert main([*asked, "1%", "--set", "load_fraction=0.3"]) == 2
    choose = "footprint choose cantilever --error 1% --set load_fraction=0.3 --out DIR"
    assert capsys.readouterr().err.endswith(f"; for your own settings: {choose}\n")
