"""Frozen steps with friction: what is frozen, the file there and back, FCLib's terms, and damaged files."""

from __future__ import annotations

import math
from dataclasses import fields, replace

import numpy as np
import pytest
from scipy import sparse

from contact.interchange.linearised_step import FrozenFrictionalStep, FrozenStep, FrozenStepError, freeze
from contact.verify import judge
from support.problems.frictional import manufactured

EXACT = 1e-12


@pytest.fixture
def made():
    return manufactured(np.random.default_rng(7), 5)


def same(a: FrozenFrictionalStep, b: FrozenFrictionalStep) -> bool:
    matrices = [(a.K, b.K), (a.G, b.G), (a.S, b.S)]
    vectors = [(a.r, b.r), (a.gap, b.gap), (a.slip, b.slip), (a.mu, b.mu)]
    return all(np.array_equal(x.toarray(), y.toarray()) for x, y in matrices) and all(
        np.array_equal(x, y) for x, y in vectors
    )


def test_there_and_back(made, tmp_path) -> None:
    step, path = made[0], tmp_path / "step of mine"
    tied = replace(step, mu=np.append(step.mu[:-1], math.inf), meta={"scene": "made up"})
    tied.write(path)
    again = FrozenFrictionalStep.read(path)
    assert same(tied, again)
    assert again.meta == {"scene": "made up"}
    tied.write(path)  # over the first
    assert same(tied, FrozenFrictionalStep.read(path))


def test_whoever_reads_the_file_has_its_friction(made, tmp_path) -> None:
    made[0].write(tmp_path / "step.npz")
    found = FrozenStep.read(tmp_path / "step.npz")
    assert isinstance(found, FrozenFrictionalStep)
    assert same(found, made[0])
    assert found.meta == {}


def test_a_problem_frozen_anywhere_has_the_same_answer(made, rng) -> None:
    step, answer = made
    u = answer.u + rng.normal(size=len(answer.u))
    there = freeze(step.problem(), u, answer.normal, {})
    assert judge(there.problem(), answer.u - u, answer.normal, answer.friction).failures() == []
    np.testing.assert_array_equal(there.slip, step.problem().coulomb.slip(u))


def test_the_terms_of_fclib(made) -> None:
    """M v = H r + f,  u = H^T v + w,  contact by contact, the normal first."""
    step, answer = made
    forces = np.column_stack([answer.normal, answer.friction]).ravel()
    np.testing.assert_allclose(step.K @ answer.u, step.H @ forces - step.r, rtol=0, atol=EXACT)
    problem = step.problem()
    relative = np.column_stack([problem.gap(answer.u), problem.coulomb.slip(answer.u)]).ravel()
    np.testing.assert_allclose(step.H.T @ answer.u + step.w, relative, rtol=0, atol=EXACT)


def rewrite(path, **changes) -> None:
    with np.load(path, allow_pickle=False) as arrays:
        kept = {name: arrays[name] for name in arrays.files} | changes
    with path.open("wb") as file:
        np.savez_compressed(file, **{name: array for name, array in kept.items() if array is not None})


DAMAGE = {
    "no S": (lambda s: {"S_data": None}, "S_data"),
    "no slip": (lambda s: {"slip": None}, "slip"),
    "NaN in slip": (lambda s: {"slip": s.slip * math.nan}, "slip must be"),
    "short slip": (lambda s: {"slip": s.slip[:-1]}, "slip must be"),
    "flat slip": (lambda s: {"slip": s.slip.ravel()}, "slip must be"),
    "whole slip": (lambda s: {"slip": np.zeros((5, 2), int)}, "slip must be"),
    "negative mu": (lambda s: {"mu": -s.mu}, "mu must be"),
    "mu no number": (lambda s: {"mu": s.mu * math.nan}, "mu must be"),
    "one mu": (lambda s: {"mu": s.mu[:1]}, "mu must be"),
    "NaN in S": (lambda s: {"S_data": s.S.data * math.nan}, "S_data must be"),
    "index of S": (lambda s: {"S_indices": s.S.indices + 1000}, "S is no 10 x 17"),
    "fractional index": (lambda s: {"S_indices": s.S.indices + 0.5}, "whole numbers"),
    "short S": (lambda s: {"S_indptr": s.S.indptr[:-1]}, "S is no"),
    "no residual": (lambda s: {"r": None}, "r"),
}


@pytest.mark.parametrize(("change", "said"), DAMAGE.values(), ids=DAMAGE)
def test_damaged_files_are_refused_in_one_line(made, tmp_path, change, said) -> None:
    path = tmp_path / "step.npz"
    made[0].write(path)
    rewrite(path, **change(made[0]))
    with pytest.raises(FrozenStepError, match=said) as caught:
        FrozenFrictionalStep.read(path)
    assert "\n" not in str(caught.value)
    assert str(path) in str(caught.value)


def test_steps_without_friction_and_with_consistent_coupling_are_refused(made, tmp_path) -> None:
    contact = {each.name: getattr(made[0], each.name) for each in fields(FrozenStep)}
    FrozenStep(**contact).write(tmp_path / "contact.npz")
    with pytest.raises(FrozenStepError, match="without friction"):
        FrozenFrictionalStep.read(tmp_path / "contact.npz")
    coupled = replace(made[0], coupling=sparse.eye_array(5, format="csr"))
    coupled.write(tmp_path / "coupled.npz")
    with pytest.raises(FrozenStepError, match="lumped"):
        FrozenFrictionalStep.read(tmp_path / "coupled.npz")


def test_cut_and_flipped_files_are_refused_or_still_the_same(made, tmp_path, rng) -> None:
    path, refused = tmp_path / "step.npz", 0
    made[0].write(path)
    whole = path.read_bytes()
    for length in rng.integers(0, len(whole), 8):
        path.write_bytes(whole[:length])
        with pytest.raises(FrozenStepError):
            FrozenFrictionalStep.read(path)
    for place in rng.integers(0, len(whole), 40):
        path.write_bytes(whole[:place] + bytes([whole[place] ^ (1 << rng.integers(8))]) + whole[place + 1 :])
        try:
            assert same(FrozenFrictionalStep.read(path), made[0])
        except FrozenStepError:
            refused += 1
    assert refused > 20
