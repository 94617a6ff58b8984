"""The collection: what the rule takes, that two ways certify it, and that its files come out again."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path as File

import numpy as np
import pandas as pd
import pytest
from scipy import sparse

from contact.interchange.linearised_step import FrozenStep
from studies.arena.collected import certified, rule
from studies.arena.collected.candidates import RAISED, Path, on_path
from studies.arena.collected.certified import NotCertifiedError, confirm, exact_on, find
from studies.arena.collected.collection import KEPT, Candidate, kept_names, sums, write
from studies.arena.collected.rule import (
    LARGEST,
    MOST,
    STEPS,
    Rule,
    chosen,
    condition,
    keep_agreeing,
    kind,
    raised_states,
)
from support.problems.contact_problems import indefinite, known_step, lopsided

STRIP = Path("strip-contact", "4x1", {"lam_over_a": "0.1"})


def test_certified_is_the_built_in_answer() -> None:
    step, du, pressure = known_step()
    answer = confirm(step, find(step))
    assert np.allclose(answer.du, du, atol=1e-10 * np.abs(du).max())
    assert np.allclose(answer.pressure, pressure, atol=1e-9)
    assert answer.confirmed_by == (
        "equations on the set in extended precision",
        "convex programme by an interior point",
    )


def test_equations_on_a_set_are_solved_beyond_double_precision() -> None:
    step, _du, pressure = known_step()
    ours, forces = exact_on(step, pressure > 0)
    assert np.linalg.norm(step.K @ ours + step.r - step.G.T @ forces) <= 1e-14 * np.linalg.norm(step.r)
    assert np.allclose(forces, step.weights * pressure, atol=1e-10)


def test_a_wrong_answer_is_not_confirmed() -> None:
    """A pressed candidate let go; one that is open, held; displacements that are slightly off."""
    step, _, _ = known_step()
    right = find(step)
    for i in (np.flatnonzero(right.pressed)[0], np.flatnonzero(~right.pressed & ~right.touching)[0]):
        pressure = right.pressure.copy()
        pressure[i] = 0.0 if right.pressed[i] else 1.0
        du, forces = exact_on(step, pressure > 0)
        with pytest.raises(NotCertifiedError):
            confirm(step, replace(right, du=du, pressure=forces / step.weights))
    with pytest.raises(NotCertifiedError, match="displacements"):
        confirm(step, replace(right, du=right.du * (1 + 1e-6)))


def test_who_touches_without_force_is_in_any_set(monkeypatch: pytest.MonkeyPatch) -> None:
    """Rounding presses it in one of two answers that are one; who presses what is open has another answer."""
    step, du, pressure = known_step()
    right = find(step)
    for more, agree in ((right.touching, True), (~right.touching & ~right.pressed, False)):
        assert more.any()
        other = np.where(more, 1e-6, pressure)
        monkeypatch.setattr(certified, "minimise", lambda step, other=other: (du, other))
        if agree:
            assert len(confirm(step, right).confirmed_by) == 2
        else:
            with pytest.raises(NotCertifiedError, match="off the interior point"):
                confirm(step, right)


def test_a_gap_that_is_closed_before_and_after_is_closed_to_the_last_digit(monkeypatch: pytest.MonkeyPatch) -> None:
    """One node on the ground, pushed down, beside one that moves: no gap says how large a gap is."""
    K, G = sparse.csc_matrix([[2.0, -1.0], [-1.0, 2.0]]), sparse.csr_matrix([[1.0, 0.0]])
    step = FrozenStep(K, np.array([3.0, -1.0]), G, np.zeros(1), np.ones(1), 3.0)
    right, last = find(step), np.array([-1e-18, 0.0])
    for below, agree in ((1.0, True), (1e9, False)):
        du, forces = exact_on(step, right.pressed)
        monkeypatch.setattr(certified, "exact_on", lambda *_, du=du + below * last, forces=forces: (du, forces))
        if agree:
            assert confirm(step, right).confirmed_by
        else:
            with pytest.raises(NotCertifiedError, match="wrong sign"):
                confirm(step, right)


def test_an_answer_of_zero_is_zero_to_the_last_digit() -> None:
    """Forces that balance where nothing moves: displacements of rounding are none, larger ones some."""
    K, G = sparse.csc_matrix([[2.0, -1.0], [-1.0, 2.0]]), sparse.csr_matrix(np.eye(2))
    step = FrozenStep(K, np.array([3.0, 5.0]), G, np.zeros(2), np.ones(2), 5.0)
    right = find(step)
    assert not right.du.any()
    assert confirm(step, replace(right, du=np.array([1e-15, -1e-15]))).confirmed_by
    with pytest.raises(NotCertifiedError, match="displacements"):
        confirm(step, replace(right, du=np.array([1e-12, -1e-12])))


def test_kinds_and_condition() -> None:
    """The condition is that of the scaled matrix."""
    step, _, _ = known_step()
    assert [kind(s) for s in (step, indefinite(step), lopsided(step))] == ["definite", "indefinite", "not symmetric"]
    K = step.K.toarray()
    size = 1 / np.sqrt(np.diag(K))
    assert condition(step.K) == pytest.approx(np.linalg.cond(size[:, None] * K * size, 1), rel=0.5)


def test_the_rule_takes_what_is_new_in_its_family_alone() -> None:
    """The same step twice adds nothing; in another family it does, and says so."""
    step = known_step()[0]
    twice = [Candidate("a", "one", {}, step), Candidate("a", "two", {}, step), Candidate("b", "three", {}, step)]
    taken = list(chosen(twice, Rule()))
    names = [t.candidate.name for t in taken if "-" not in t.candidate.name]
    assert names == ["one", "three"]
    assert taken[0].adds == "family"
    assert {t.candidate.name for t in taken} >= {"one-touching", "one-condensed"}


def test_the_rule_names_what_it_leaves_out() -> None:
    """A step beyond the size, and one without an answer: u >= 1 and -u >= 1."""
    step = known_step()[0]
    rule = Rule(largest=1.0)
    assert rule.taken(Candidate("a", "big", {}, step)) is None
    K, G = sparse.csc_matrix([[1.0]]), sparse.csr_matrix([[1.0], [-1.0]])
    nowhere = FrozenStep(K, np.zeros(1), G, -np.ones(2), np.ones(2), 1.0)
    rule = Rule()
    assert rule.taken(Candidate("a", "nowhere", {}, nowhere)) is None
    assert [row["name"] for row in rule.left_out] == ["nowhere"]
    assert rule.left_out[0]["why"]


def test_files_come_out_again(tmp_path: File, monkeypatch: pytest.MonkeyPatch) -> None:
    """Chosen, removed, damaged and made again by the manifest: the same bytes, derived forms included."""
    monkeypatch.setattr(rule, "paths", lambda: iter([STRIP]))
    monkeypatch.setattr(rule, "published", lambda: iter(()))
    taken = list(chosen(on_path(STRIP), Rule()))
    states = {t.candidate.name: t.candidate.states for t in taken if t.candidate.states is not None}
    monkeypatch.setattr(rule, "raised_states", lambda: states)
    rows = [t.row | {"bytes": write(tmp_path, t.candidate).stat().st_size} for t in taken]
    kept = pd.DataFrame(rows)
    assert not STEPS.unlike(tmp_path, kept)
    assert len(kept) > 3
    assert any("-condensed" in name for name in kept["name"])
    before = {path.name: path.read_bytes() for path in tmp_path.glob("*.npz")}
    files = sorted(tmp_path.glob("*.npz"))
    files[0].unlink()
    files[1].write_bytes(b"no zip")
    assert len(STEPS.unlike(tmp_path, kept)) == 2
    made: list[str] = []
    STEPS.make(tmp_path, kept, made.append)
    assert not STEPS.unlike(tmp_path, kept)
    assert {path.name: path.read_bytes() for path in tmp_path.glob("*.npz")} == before


def test_what_is_kept_is_as_the_manifest_says_and_small() -> None:
    """Files that another machine would not make again, and who is raised in every touching form."""
    kept = STEPS.manifest().set_index("name", drop=False)
    names = sorted(kept_names())
    assert names
    folder = File(str(KEPT))
    assert not STEPS.unlike(folder, kept.loc[names])
    assert sum(path.stat().st_size for path in folder.iterdir()) < 2.2e6
    touching = kept[kept["form"] == "touching"]
    states = raised_states()
    assert {name: len(own) for name, own in states.items()} == dict(touching["candidates"].items())
    assert all((own == RAISED).any() for own in states.values())


def test_no_answer_is_looked_for_where_files_are_made(tmp_path: File, monkeypatch: pytest.MonkeyPatch) -> None:
    """What is kept is copied; a form of a step with several answers touches where it was chosen to."""
    names = ["panel-6x6-E_ratio=1000-s1i2-touching", "ring-1x16-h_mm=0.1-delta_mm=1_35_50-s3i1"]
    kept = STEPS.manifest().set_index("name", drop=False).loc[names]
    assert kept["kind"].iloc[0] == "indefinite"
    monkeypatch.setattr(rule, "find", lambda step: pytest.fail("an answer is looked for"))
    walked: list[str] = []
    monkeypatch.setattr(rule, "on_path", lambda path: (walked.append(path.scene), on_path(path))[1])
    STEPS.make(tmp_path, kept)
    assert not STEPS.unlike(tmp_path, kept)
    assert set(walked) == {"panel"}


def kept_of(directory: File, kept: pd.DataFrame) -> pd.DataFrame:
    """The manifest of what agrees."""
    keep_agreeing(directory, kept, directory / "kept")
    return pd.read_csv(directory / "kept" / "manifest.csv")


def test_a_file_of_other_values_is_named(tmp_path: File) -> None:
    step = known_step()[0]
    candidate = Candidate("a", "one", {}, step)
    row = {"name": "one", "family": "a", "unknowns": len(step.r), "candidates": len(step.gap)}
    kept = pd.DataFrame([row | sums(step)])
    write(tmp_path, replace(candidate, step=FrozenStep(**{**vars(step), "r": step.r * (1 + 1e-5)})))
    assert [line.split(" is ")[0] for line in STEPS.unlike(tmp_path, kept)] == ["one: sum_r"]
    assert kept_of(tmp_path, kept).empty
    assert "one" in set(pd.read_csv(tmp_path / "kept" / "left-out.csv")["name"])
    write(tmp_path, replace(candidate, step=FrozenStep(**{**vars(step), "r": step.r * (1 + 1e-8)})))
    assert not STEPS.unlike(tmp_path, kept)
    assert len(kept_of(tmp_path, kept)) == 1


def test_what_is_in_balance_is_compared_by_the_forces_in_it(tmp_path: File) -> None:
    """r of a body in equilibrium is rounding, another on each machine; a thousandth of the forces is not."""
    step = known_step()[0]
    candidate = Candidate("a", "one", {}, FrozenStep(**{**vars(step), "r": 1e-12 * step.r}))
    row = {"name": "one", "family": "a", "unknowns": len(step.r), "candidates": len(step.gap)}
    kept = pd.DataFrame([row | sums(candidate.step)])
    for share, lines in ((3e-12, 0), (1e-3, 1)):
        write(tmp_path, replace(candidate, step=FrozenStep(**{**vars(step), "r": share * step.r})))
        assert len(STEPS.unlike(tmp_path, kept)) == lines


def test_the_kept_manifest_keeps_the_rule() -> None:
    """Hundreds, all certified by two ways or more, of every kind and size, with a licence, in the bytes allowed."""
    kept = STEPS.manifest()
    assert len(kept) >= 200
    assert kept["name"].is_unique
    assert (kept["found_by"] != "").all()
    assert kept["confirmed_by"].str.contains("equations on the set").all()
    assert set(kept["kind"]) == {"definite", "indefinite", "not symmetric"}
    assert set(kept["coupling"]) == {"lumped", "consistent"}
    assert set(kept["licence"]) == {"MIT", "Apache-2.0"}
    assert kept["unknowns"].min() <= 10
    assert kept["unknowns"].max() >= 90_000
    assert kept["candidates"].min() <= 3
    assert kept["candidates"].max() >= 1_000
    assert (kept["touching"] > 0).sum() >= 20
    assert kept["bytes"].sum() <= LARGEST
    assert kept["bytes"].max() <= MOST
    classes = ["family", "adds"]
    assert (kept[classes] != "").all(axis=None)
