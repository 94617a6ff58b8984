"""``footprint solve --freeze`` and ``footprint resolve``: the last contact problem of a tyre, alone."""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest

from contact.algorithms.semismooth import Semismooth
from contact.catalogue import ALGORITHMS, is_exact
from contact.interchange.linearised_step import FrozenStep
from contact.interchange.oracle import Confirmation
from studies.arena.replay import algorithm_of, read_step, resolve_step
from studies.cli import main

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
    (["resolve", __file__], "no frozen contact step"),
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
