"""Steps with friction in the collection: certified, made again, told apart, exported and judged."""

from __future__ import annotations

import json
from collections import Counter
from dataclasses import fields, replace
from itertools import islice
from pathlib import Path as File

import numpy as np
import pandas as pd
import pytest
from scipy import io, sparse

from contact.coulomb import State
from contact.interchange.linearised_step import FrozenFrictionalStep, FrozenStep
from studies.arena.collected.certified import EQUATIONS, PROGRAMMES, NotCertifiedError
from studies.arena.collected.certified import confirm_with_friction as confirm
from studies.arena.collected.certified import find_with_friction as find
from studies.arena.collected.collection import FRICTION_SUMS, SUMS, write
from studies.arena.collected.frictional import FAMILIES, FRICTIONAL, choose_frictional, random_steps, row, strips
from studies.arena.collected.rule import STEPS
from studies.arena.solver_run import problems_in
from studies.ask.request import UsageError
from studies.cli import main
from support.problems.frictional import all_answers, klarbring

STATES = ["open", "sticking", "slipping"]


def made(*families: str) -> list:
    return [candidate for family in families for candidate in FAMILIES[family]()]


def test_the_manifest_has_the_listed_steps() -> None:
    kept = FRICTIONAL.manifest()
    assert 40 <= len(kept) <= 60
    assert set(kept["family"]) == set(FAMILIES)
    assert kept["name"].is_unique
    assert not set(kept["name"]) & set(STEPS.manifest()["name"])
    assert set(kept["friction"]) == {"coulomb"}
    assert (kept[STATES].sum(axis=1) == kept["candidates"]).all()
    assert (kept[STATES].sum() > 100).all()
    assert kept["confirmed_by"].str.startswith(EQUATIONS).all()
    assert kept["confirmed_by"].str.contains(PROGRAMMES).sum() >= 30


def test_whatever_is_left_out_has_a_reason() -> None:
    gone = FRICTIONAL.left_out()
    assert gone["why"].str.len().gt(0).all()
    assert not set(gone["name"]) & set(FRICTIONAL.manifest()["name"])
    assert "friction" not in STEPS.manifest().columns


@pytest.mark.slow
def test_small_steps_are_certified_as_the_manifest_says() -> None:
    manifest = FRICTIONAL.manifest().set_index("name")
    for candidate in [*made("rigid", "springs"), *islice(random_steps(), 3)]:
        kept, record = manifest.loc[candidate.name], row(candidate)
        for name in ("open", "sticking", "slipping", "confirmed_by", "several", "mu", "kind"):
            assert str(record[name]) == str(kept[name]), f"{candidate.name}: {name}"
        for name in ("force_N", "friction_N", "displacement_mm"):
            assert record[name] == pytest.approx(float(kept[name]), rel=1e-6, abs=1e-9)


def test_a_strip_that_friction_alone_holds_is_certified_by_all_ways() -> None:
    step = next(strips()).step
    answer = confirm(step, find(step))
    assert answer.confirmed_by == (EQUATIONS, PROGRAMMES)
    assert answer.known.friction[:, 0].sum() == pytest.approx(-20.0, rel=1e-9)  # the pull


def test_a_wrong_answer_is_not_confirmed() -> None:
    step = next(random_steps()).step
    right = find(step)
    with pytest.raises(NotCertifiedError, match="off the equations"):
        confirm(step, replace(right, known=replace(right.known, du=right.known.du * (1 + 1e-5))))
    rubbed = int(np.argmax(right.known.state == State.SLIP))
    state = right.known.state.copy()
    state[rubbed] = State.STICK
    with pytest.raises(NotCertifiedError):
        confirm(step, replace(right, known=replace(right.known, state=state)))


def test_several_answers_are_no_contradiction() -> None:
    """Three at mu = 3: the oracle has one of them, and those that are not its own are said to be one of several."""
    springs = klarbring(3.0, (2.5, -1.0), 1.0)
    first = find(springs)
    counts = Counter()
    for answer in all_answers(springs):
        known = replace(first.known, du=answer.u, normal=answer.normal, friction=answer.friction, state=answer.state)
        counts[confirm(springs, replace(first, known=known)).several] += 1
    assert counts == {True: 2, False: 1}


def test_files_come_out_again(tmp_path: File) -> None:
    candidates = made("rigid")
    rows = [row(c) | {"bytes": write(tmp_path, c).stat().st_size} for c in candidates]
    kept = pd.DataFrame(rows)
    before = {path.name: path.read_bytes() for path in tmp_path.glob("*.npz")}
    assert not FRICTIONAL.unlike(tmp_path, kept)
    (tmp_path / "wedge-sticks.npz").unlink()
    (tmp_path / "slope-slides.npz").write_bytes(b"no zip")
    assert len(FRICTIONAL.unlike(tmp_path, kept)) == 2
    FRICTIONAL.make(tmp_path, kept)
    assert {path.name: path.read_bytes() for path in tmp_path.glob("*.npz")} == before


def test_a_file_of_other_values_is_named(tmp_path: File) -> None:
    candidate = next(random_steps())
    record = row(candidate)
    write(tmp_path, candidate)
    for part in (*SUMS, *FRICTION_SUMS):
        kept = pd.DataFrame([record | {part: record[part] * (1 + 1e-4)}])
        assert [line.split(" is ")[0] for line in FRICTIONAL.unlike(tmp_path, kept)] == [f"{candidate.name}: {part}"]


def test_solvers_without_friction_are_not_asked(tmp_path: File) -> None:
    candidate = next(random_steps())
    write(tmp_path, candidate)
    with pytest.raises(UsageError, match="friction"):
        problems_in(tmp_path)
    contact = {each.name: getattr(candidate.step, each.name) for each in fields(FrozenStep)}
    FrozenStep(**contact).write(tmp_path / "smooth.npz")
    assert list(problems_in(tmp_path)) == ["smooth"]


def test_the_commands(tmp_path: File, capsys) -> None:
    """judge of a family, with right and wrong answers, and the list of all."""
    folder = tmp_path / "made"
    random = FRICTIONAL.manifest().query("family == 'random'")
    FRICTIONAL.make(folder, random, lambda name: None)
    assert FRICTIONAL.unlike(folder, random) == []
    problem, answer = folder / "random-0.npz", tmp_path / "answer.json"
    step = FrozenFrictionalStep.read(problem)
    known = find(step).known
    given = {"du": known.du.tolist(), "normal": known.normal.tolist(), "friction": known.friction.tolist()}
    answer.write_text(json.dumps(given))
    assert main(["problems", "judge", str(problem), str(answer)]) == 0
    assert "certified: every residual" in capsys.readouterr().out
    answer.write_text(json.dumps(given | {"friction": (-known.friction).tolist()}))
    assert main(["problems", "judge", str(problem), str(answer)]) == 1
    assert "NOT certified" in capsys.readouterr().out
    np.savez(tmp_path / "answer.npz", du=known.du, normal=known.normal, friction=known.friction)
    assert main(["problems", "judge", str(problem), str(tmp_path / "answer.npz")]) == 0
    assert main(["problems", "list"]) == 0
    assert "59 problems with friction" in capsys.readouterr().out


def test_answers_that_are_none_are_refused(tmp_path: File, capsys) -> None:
    problem = write(tmp_path, next(random_steps()))
    short = {"du": [1.0], "normal": [1.0], "friction": [[0.0, 0.0]]}
    for given, fault in (({"du": [1.0]}, "normal"), (short, "unknowns"), ([], "object")):
        (tmp_path / "answer.json").write_text(json.dumps(given))
        assert main(["problems", "judge", str(problem), str(tmp_path / "answer.json")]) == 2
        assert fault in capsys.readouterr().err


def test_exports_are_the_global_problem_of_fclib(tmp_path: File, capsys) -> None:
    """M v = H r + f, u = H^T v + w, contact by contact the normal first, from the files alone."""
    problem = write(tmp_path, next(random_steps()))
    step = FrozenFrictionalStep.read(problem)
    known = find(step).known
    for form, out in (("mtx", tmp_path / "market"), ("fclib", tmp_path / "arrays.npz")):
        assert main(["problems", "export", str(problem), "--format", form, "--out", str(out)]) == 0
    market = {name: io.mmread(tmp_path / "market" / f"{name}.mtx") for name in ("M", "H", "f", "w", "mu")}
    M, H = market["M"].tocsc(), market["H"].tocsc()
    f, w, mu = (market[name].ravel() for name in ("f", "w", "mu"))
    with np.load(tmp_path / "arrays.npz") as arrays:
        n, rows = len(arrays["f"]), len(arrays["w"])
        again = sparse.csc_matrix((arrays["H_x"], arrays["H_i"], arrays["H_p"]), shape=(n, rows))
        assert np.array_equal(again.toarray(), H.toarray())
        assert np.array_equal(arrays["mu"], mu)
    r = np.column_stack([known.normal, known.friction]).ravel()
    np.testing.assert_allclose(M @ known.du, H @ r + f, rtol=0, atol=1e-8)
    ways = (H.T @ known.du + w).reshape(-1, 3)
    assert np.all(ways[:, 0] >= -1e-9)
    assert np.all(np.linalg.norm(r.reshape(-1, 3)[:, 1:], axis=1) <= mu * known.normal + 1e-9)
    assert main(["problems", "export", str(problem), "--format", "mps", "--out", str(tmp_path / "a.mps")]) == 2
    assert "with friction" in capsys.readouterr().err


@pytest.mark.slow
def test_all_files_are_made_again(tmp_path: File) -> None:
    kept = FRICTIONAL.manifest()
    FRICTIONAL.make(tmp_path, kept)
    assert not FRICTIONAL.unlike(tmp_path, kept)


@pytest.mark.slow
def test_the_rule_chooses_the_same_again(tmp_path: File) -> None:
    chosen = choose_frictional(tmp_path, only="greco").set_index("name")
    kept = FRICTIONAL.manifest().query("family == 'greco'").set_index("name")
    pd.testing.assert_frame_equal(chosen[STATES], kept[STATES])
