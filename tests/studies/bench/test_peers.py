import importlib.util
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from studies.bench.peers import lines, peers, reference, shell_quarter, sufficient
from studies.cli import main


def test_without_the_extra_one_line_says_what_to_install(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(importlib.util, "find_spec", lambda name: None)
    assert main(["bench", "peers"]) == 2
    assert capsys.readouterr().err == "footprint: peers need the extra peers: pip install 'footprint[peers]'\n"


def test_a_coarse_mesh_within_by_luck_is_not_sufficient() -> None:
    shells = pd.DataFrame({"program": "footprint", "unknowns": [1, 2, 3, 4], "seconds": [0.1, 0.2, 0.3, 0.4]})
    assert sufficient(shells.assign(error=[0.0, 0.009, -0.002, 0.001])) == 0.3
    assert np.isnan(sufficient(shells.assign(error=[0.0, 0.0, 0.0, -0.009])))
    assert np.isnan(sufficient(shells.assign(error=np.nan)))


def test_the_shell_meets_the_reference() -> None:
    force, unknowns = shell_quarter("36x34", 10.0)
    assert force == pytest.approx(reference(10.0), rel=0.003)
    assert unknowns < 2000
    assert np.isnan(reference(3.0))


def test_ngsolve_solves_the_same_tyre() -> None:
    pytest.importorskip("ngsolve")
    table = peers(["5x4"], ["36x34"], delta_mm=3.0)
    assert list(table["program"]) == ["footprint", "ngsolve"]
    shell, solid = table["force_N"]
    assert solid == pytest.approx(shell, rel=0.05)
    assert table["ratio"].isna().all()  # there is no reference at 3 mm
    assert len(list(lines(table))) == 3


def test_a_mesh_the_peer_cannot_have_is_refused(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    pytest.importorskip("ngsolve")
    assert main(["bench", "peers", "--mesh", "2x4", "--table", str(tmp_path / "peers.csv")]) == 2
    assert "at least 6" in capsys.readouterr().err
