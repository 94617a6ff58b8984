"""Frozen contact steps: what is frozen, the file there and back, damaged files, and solving one alone.

Frozen steps with friction: what is frozen, the file there and back, FCLib's terms, and damaged files.
"""

import json
import math
import zipfile
from dataclasses import fields, replace

import numpy as np
import pytest
from scipy import sparse

from contact.catalogue import ALGORITHMS, is_exact
from contact.interchange.linearised_step import FrozenFrictionalStep, FrozenStep, FrozenStepError, freeze
from contact.obstacles.drum_sphere import Sphere
from contact.obstacles.foundation import Candidates, against
from contact.problem import ContactSolution, Outcome
from contact.verify import judge
from support.problems.contact_problems import dual_by_nnls, linear_mechanics, random_quadratic
from support.problems.differences import central_difference
from support.problems.frictional import manufactured

ROUNDING = 1e-12
ORACLE = 1e-7


@pytest.fixture
def step(rng) -> FrozenStep:
    data = random_quadratic(rng, "inclined")
    n = len(data.f)
    return freeze(data.problem(), np.zeros(n), np.zeros(6), {"scene": "made up", "load": 2.5})


def same(a: FrozenStep, b: FrozenStep) -> bool:
    couplings = [x.coupling is None for x in (a, b)]
    if couplings[0] != couplings[1]:
        return False
    matrices = [(a.K, b.K), (a.G, b.G)] + ([] if couplings[0] else [(a.coupling, b.coupling)])
    vectors = [(a.r, b.r), (a.gap, b.gap), (a.weights, b.weights), (a.scale, b.scale)]
    return all(np.array_equal(x.toarray(), y.toarray()) for x, y in matrices) and all(
        np.array_equal(x, y) for x, y in vectors
    )


def test_a_frozen_step_is_one_newton_step(rng) -> None:
    """K is the derivative of r - G^T W p at fixed pressures, the curvature of the gap included; G that of the gap."""
    m = 4
    x, w = rng.normal(size=(m, 3)), rng.uniform(0.5, 2, m)
    K = rng.normal(size=(3 * m, 3 * m))
    mechanics = linear_mechanics(K, rng.normal(size=3 * m))
    problem = against(mechanics, Candidates(x, sparse.csr_matrix(np.eye(3 * m)), w), Sphere(np.zeros(3), 0.3))
    u, p, du = 0.1 * rng.normal(size=3 * m), rng.uniform(0, 1, m), rng.normal(size=3 * m)
    step = freeze(problem, u, p, {})

    def imbalance(h: float) -> np.ndarray:
        return problem.linearise(u + h * du, None).residual - problem.contact_force(u + h * du, p)

    np.testing.assert_allclose(step.K @ du, central_difference(imbalance, 1e-3), rtol=0, atol=1e-8)
    np.testing.assert_allclose(step.G @ du, central_difference(lambda h: problem.gap(u + h * du), 1e-3), atol=1e-8)
    np.testing.assert_array_equal(step.r, problem.linearise(u, None).residual)
    np.testing.assert_array_equal(step.gap, problem.gap(u))


@pytest.mark.parametrize("coupling", [False, True])
def test_there_and_back(step, tmp_path, rng, coupling) -> None:
    W = sparse.csr_matrix(np.diag(step.weights) + np.diag(rng.uniform(0, 0.1, 5), 1)) if coupling else None
    step = replace(step, coupling=W)
    path = tmp_path / "step of mine"  # no suffix, and none is added
    step.write(path)
    again = FrozenStep.read(path)
    assert same(step, again)
    assert again.meta == {"scene": "made up", "load": 2.5}


def test_the_container_is_what_is_documented(step, tmp_path) -> None:
    """Read with numpy alone, rebuilt by hand from the arrays of compressed columns and rows."""
    path = tmp_path / "step.npz"
    step.write(path)
    with np.load(path, allow_pickle=False) as arrays:
        assert {name.partition("_")[0] for name in arrays.files} == {"K", "G", "r", "gap", "weights", "scale", "meta"}
        n, K = len(arrays["r"]), np.zeros((len(arrays["r"]),) * 2)
        for column in range(n):
            for k in range(arrays["K_indptr"][column], arrays["K_indptr"][column + 1]):
                K[arrays["K_indices"][k], column] += arrays["K_data"][k]
        meta = json.loads(str(arrays["meta"]))
    np.testing.assert_array_equal(K, step.K.toarray())
    assert (meta["format"], meta["format_version"]) == ("footprint contact step", 1)


@pytest.mark.parametrize("name", [*filter(is_exact, ALGORITHMS)])
def test_a_step_is_solved_alone(name, tmp_path) -> None:
    """Frozen at the answer it asks for no displacement and the same pressures; frozen before, for the whole way."""
    data = random_quadratic(np.random.default_rng(1), "definite")
    problem, n = data.problem(), len(data.f)
    u, p = dual_by_nnls(data, math.inf)
    for start, pressure in ((u, p), (np.zeros(n), np.zeros(6)), (np.linspace(-1, 1, n), np.ones(6))):
        path = tmp_path / "step.npz"
        freeze(problem, start, pressure, {}).write(path)
        alone = FrozenStep.read(path).problem()
        solution = ALGORITHMS[name](epsilon=math.inf).solve(alone, ContactSolution.at_rest(n, 6))
        assert solution.outcome is Outcome.CONVERGED
        np.testing.assert_allclose(start + solution.u, u, rtol=0, atol=ORACLE)
        np.testing.assert_allclose(solution.pressure, p, rtol=0, atol=ORACLE)
        assert judge(alone, solution.u, solution.pressure).failures() == []


# --- damaged files ------------------------------------------------------------------------------------------------


def rewrite(path, **changes) -> None:
    """The same file with some arrays replaced, or left out (None)."""
    with np.load(path, allow_pickle=False) as arrays:
        kept = {name: arrays[name] for name in arrays.files} | changes
    with path.open("wb") as file:
        np.savez_compressed(file, **{name: array for name, array in kept.items() if array is not None})


def nan(a):
    return np.where(np.arange(len(a)) == 1, math.nan, a)


DAMAGE = {
    "no residual": (lambda s: {"r": None}, "r"),
    "no matrix": (lambda s: {"K_data": None}, "K_data"),
    "no meta": (lambda s: {"meta": None}, "meta"),
    "meta is no JSON": (lambda s: {"meta": np.array("{")}, "Expecting"),
    "meta is a list": (lambda s: {"meta": np.array("[1]")}, "object"),
    "another format": (lambda s: {"meta": np.array('{"format": "x", "format_version": 1}')}, "format"),
    "a later version": (
        lambda s: {"meta": np.array('{"format": "footprint contact step", "format_version": 2}')},
        "version",
    ),
    "NaN in r": (lambda s: {"r": nan(s.r)}, "r must be"),
    "NaN in K": (lambda s: {"K_data": nan(s.K.data)}, "K_data must be"),
    "infinite gap": (lambda s: {"gap": s.gap / 0.0}, "gap must be"),
    "short gap": (lambda s: {"gap": s.gap[:-1]}, "weights must be 5"),
    "negative weight": (lambda s: {"weights": -s.weights}, "weights"),
    "negative scale": (lambda s: {"scale": np.array(-1.0)}, "scale"),
    "two scales": (lambda s: {"scale": np.ones(2)}, "scale"),
    "whole numbers": (lambda s: {"r": s.r.astype(int)}, "r must be"),
    "text": (lambda s: {"r": np.array(["a"])}, "r must be"),
    "square r": (lambda s: {"r": np.ones((3, 3))}, "r must be"),
    "index too large": (lambda s: {"K_indices": s.K.indices + 1000}, "K is no"),
    "negative index": (lambda s: {"G_indices": s.G.indices - 5}, "G is no"),
    "fractional index": (lambda s: {"G_indices": s.G.indices + 0.5}, "whole numbers"),
    "short index": (lambda s: {"K_indptr": s.K.indptr[:-1]}, "K is no"),
    "falling index": (lambda s: {"K_indptr": s.K.indptr[::-1].copy()}, "K is no"),
    "short r": (lambda s: {"r": s.r[:-1]}, "K is no"),
    "half a coupling": (lambda s: {"W_data": np.ones(3)}, "W_indices"),
}


@pytest.mark.filterwarnings("ignore:divide by zero")
def test_damaged_files_are_refused_in_one_line(step, tmp_path) -> None:
    for change, said in DAMAGE.values():
        path = tmp_path / "step.npz"
        step.write(path)
        rewrite(path, **change(step))
        with pytest.raises(FrozenStepError, match=said) as caught:
            FrozenStep.read(path)
        assert "\n" not in str(caught.value)
        assert str(path) in str(caught.value)


def test_cut_and_flipped_files_are_refused_or_still_the_same(step, tmp_path, rng) -> None:
    """A flipped bit in an unused field of the container may pass; a wrong number may not."""
    path, refused = tmp_path / "step.npz", 0
    step.write(path)
    whole = path.read_bytes()
    for length in rng.integers(0, len(whole), 30):
        path.write_bytes(whole[:length])
        with pytest.raises(FrozenStepError):
            FrozenStep.read(path)
    for place in rng.integers(0, len(whole), 150):
        path.write_bytes(whole[:place] + bytes([whole[place] ^ (1 << rng.integers(8))]) + whole[place + 1 :])
        try:
            assert same(FrozenStep.read(path), step)
        except FrozenStepError:
            refused += 1
    assert refused > 75


def test_other_files_are_refused(tmp_path) -> None:
    for name, content in {"empty": b"", "text": b"K, r, G", "array": b"\x93NUMPY"}.items():
        (tmp_path / name).write_bytes(content)
        with pytest.raises(FrozenStepError, match="not a frozen contact step"):
            FrozenStep.read(tmp_path / name)
    with zipfile.ZipFile(tmp_path / "zip", "w") as archive:
        archive.writestr("readme", "hello")
    with pytest.raises(FrozenStepError, match="meta"):
        FrozenStep.read(tmp_path / "zip")
    np.savez(tmp_path / "pickle.npz", meta=np.array([{}], dtype=object))
    with pytest.raises(FrozenStepError, match="pickle"):
        FrozenStep.read(tmp_path / "pickle.npz")
    with pytest.raises(FileNotFoundError):
        FrozenStep.read(tmp_path / "nothing")


@pytest.fixture
def made():
    return manufactured(np.random.default_rng(7), 5)


def rubs_the_same(a: FrozenFrictionalStep, b: FrozenFrictionalStep) -> bool:
    parts = [(a.S.toarray(), b.S.toarray()), (a.slip, b.slip), (a.mu, b.mu)]
    return same(a, b) and all(np.array_equal(x, y) for x, y in parts)


def test_with_friction_there_and_back(made, tmp_path) -> None:
    step, path = made[0], tmp_path / "step of mine"
    tied = replace(step, mu=np.append(step.mu[:-1], math.inf), meta={"scene": "made up"})
    tied.write(path)
    again = FrozenFrictionalStep.read(path)
    assert rubs_the_same(tied, again)
    assert again.meta == {"scene": "made up"}
    tied.write(path)  # over the first
    assert rubs_the_same(tied, FrozenFrictionalStep.read(path))


def test_whoever_reads_the_file_has_its_friction(made, tmp_path) -> None:
    made[0].write(tmp_path / "step.npz")
    actual = FrozenStep.read(tmp_path / "step.npz")
    assert isinstance(actual, FrozenFrictionalStep)
    assert rubs_the_same(actual, made[0])
    assert actual.meta == {}


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
    np.testing.assert_allclose(step.K @ answer.u, step.H @ forces - step.r, rtol=0, atol=ROUNDING)
    problem = step.problem()
    relative = np.column_stack([problem.gap(answer.u), problem.coulomb.slip(answer.u)]).ravel()
    np.testing.assert_allclose(step.H.T @ answer.u + step.w, relative, rtol=0, atol=ROUNDING)


RUBBED_DAMAGE = {
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
    "index of S": (lambda s: {"S_indices": s.S.indices + 1000}, "S is not a 10 x 17"),
    "fractional index": (lambda s: {"S_indices": s.S.indices + 0.5}, "whole numbers"),
    "short S": (lambda s: {"S_indptr": s.S.indptr[:-1]}, "S is not"),
    "no residual": (lambda s: {"r": None}, "r"),
}


def test_with_friction_damaged_files_are_refused_in_one_line(made, tmp_path) -> None:
    for change, said in RUBBED_DAMAGE.values():
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


def test_with_friction_cut_and_flipped_files_are_refused_or_still_the_same(made, tmp_path, rng) -> None:
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
            assert rubs_the_same(FrozenFrictionalStep.read(path), made[0])
        except FrozenStepError:
            refused += 1
    assert refused > 20
