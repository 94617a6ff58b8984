"""Advice, cards, derivatives and judgements for a notebook are those of the commands."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from studies import footprint
from studies.cli import main
from studies.footprint import UsageError, advise, gradient, judge, scene, solve

KEPT = Path(footprint.__file__).parents[1] / "arena" / "kept"


def test_every_name_is_there() -> None:
    assert sorted(dir(footprint)) == sorted(footprint.__all__)
    assert all(callable(getattr(footprint, name)) for name in footprint.__all__ if name != "scene")
    assert "two_rings" in dir(scene)
    with pytest.raises(AttributeError, match="no attribute 'solv'"):
        footprint.solv  # noqa: B018


def test_advice_is_that_of_the_command(capsys: pytest.CaptureFixture[str]) -> None:
    actual = advise("cantilever", 0.01)
    assert main(["advise", "cantilever", "--error", "1%"]) == 0
    assert actual.best is not None
    assert f"--mesh {actual.best['mesh']}" in capsys.readouterr().out
    assert actual.best["bound"] <= 0.01
    assert advise("scordelis-lo", "0.01%").best is None
    with pytest.raises(UsageError, match="cost 'euros' must be one of"):
        advise("cantilever", "1%", cost="euros")


def test_a_gradient_is_that_of_the_run() -> None:
    asked = {"mesh": "8x8", "delta_mm": 5}
    actual = gradient("tyre", "force_N", "p0_MPa", **asked)
    assert actual["above"].tolist() == solve("tyre", **asked).gradient("force_N", "p0_MPa")["above"].tolist()
    up, down = (solve("tyre", **asked, p0_MPa=0.15 + step).quantities["force_N"] for step in (1e-5, -1e-5))
    assert actual["above"].iloc[-1] == pytest.approx((up - down) / 2e-5, rel=1e-4)


def test_an_answer_is_judged_from_its_file(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    problem = min(KEPT.glob("*.npz"), key=lambda path: path.stat().st_size)
    answer = tmp_path / "answer.json"
    with np.load(problem) as arrays:
        n, m = len(arrays["r"]), len(arrays["gap"])
    answer.write_text(json.dumps({"du": [0.0] * n, "pressure": [0.0] * m, "claims": {"accuracy": 1e-8}}))
    verdict = judge(problem, answer)
    assert not verdict.sound
    assert main(["problems", "judge", str(problem), str(answer)]) == 1
    assert capsys.readouterr().out.splitlines() == verdict.lines()
    with pytest.raises(UsageError, match=r"tolerance = 0 must be a number in \(0, inf\)"):
        judge(problem, answer, 0)
    with pytest.raises(UsageError, match=r"none\.npz: No such file"):
        judge(tmp_path / "none.npz", answer)
